// Data sets in the folders as they are downloaded.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "data_set_pictures.hpp"
#include "host_sim/sources/cropped_source.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSensor =
    "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]\n"
    "rate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [60, 60, 32, 24]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [-0.1, 0.01, 0.0001, 0.0002]\n";

/// Three frames 50 ms apart and the body's poses every 5 ms, in the layout of EuRoC.
void write_euroc(const TemporaryFolder& folder, const std::string& truth, int type = CV_8UC1) {
  const std::string stamps[] = {"1403636579763555584", "1403636579813555456",
                                "1403636579863555584"};
  std::string list = "#timestamp [ns],filename\r\n";
  for (const std::string& stamp : stamps) {
    picture(folder.path() / "mav0/cam0/data" / (stamp + ".png"), 64, 48, type);
    list += stamp + ",";
    list += stamp + ".png\r\n";
  }
  folder.write("mav0/cam0/data.csv", list);
  std::string poses =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x []\n";
  for (int i = 0; i < 30; ++i) {
    poses += std::to_string(1403636579758555392 + 5000000L * i) + "," + std::to_string(0.01 * i) +
             ",2,3,1,0,0,0,0,0,0,0,0,0\n";
  }
  folder.write("mav0/" + truth + "/data.csv", poses);
}

TEST(Euroc, TimesCameraAndTheCamerasTruePoses) {
  const TemporaryFolder folder;
  write_euroc(folder, "state_groundtruth_estimate0");
  folder.write("mav0/cam0/sensor.yaml", kSensor);
  for (const fs::path& path : {folder.path(), folder.path() / "mav0"}) {
    const auto source = make_euroc_source(path, {}, {});
    EXPECT_EQ(source->info().camera.fx, 60.0);
    EXPECT_EQ(source->info().camera.k1, -0.1);
    EXPECT_FALSE(source->info().odometry.has_value());
    EXPECT_NEAR(source->info().frame_rate_hz, 20.0, 0.1);
    const std::vector<Frame> frames = all_frames(*source);
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[0].t_us, 1403636579763556);
    EXPECT_EQ(frames[2].number, 2);
    // The pose 5 ms behind the first one; its camera is turned by a quarter and 0.1, 0.2, 0.3 off.
    ASSERT_TRUE(frames[0].true_T_world_camera.has_value());
    const Vector3<double> ahead = *frames[0].true_T_world_camera * Vector3<double>(1, 0, 0);
    EXPECT_NEAR((ahead - Vector3<double>(0.11, 3.2, 3.3)).norm(), 0.0, 1e-9);
  }
  EXPECT_EQ(all_frames(*make_euroc_source(folder.path(), {}, {1, 1})).front().number, 1);
  const auto colour = [&](bool wanted) {
    return all_frames(*make_euroc_source(folder.path(), {}, {{}, 1, wanted})).front().colour.size();
  };
  EXPECT_EQ(colour(true), cv::Size(64, 48));
  EXPECT_EQ(colour(false), cv::Size());
}

/// WHEN the header names the columns in another order, THEN they are read by their names.
TEST(Euroc, TheRecordingBelowIsNamed) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "dataset-room1_512_16" / "mav0" / "cam0");
  EXPECT_TRUE(says(message_of([&] { make_euroc_source(folder.path(), {}, {}); }),
                   {"mav0/cam0", "dataset-room1_512_16 is one"}));
}

TEST(Euroc, TruePosesAreReadByTheHeader) {
  const TemporaryFolder folder;
  write_euroc(folder, "state_groundtruth_estimate0");
  folder.write("mav0/cam0/sensor.yaml", kSensor);
  const auto write_truth = [&](const std::string& header, const std::string& numbers) {
    std::string text = header + "\n";
    for (int i = 0; i < 30; ++i) {
      text += std::to_string(1403636579758555392 + 5000000L * i) + "," + numbers + "\n";
    }
    folder.write("mav0/state_groundtruth_estimate0/data.csv", text);
  };
  const auto pose = [&] {
    Frame frame;
    EXPECT_TRUE(make_euroc_source(folder.path(), {}, {})->next(frame));
    return *frame.true_T_world_camera;
  };
  const std::string names = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], ";
  write_truth(names + "q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []", "1,2,3,0.8,0,0,0.6");
  const Rigid<double> usual = pose();
  write_truth(names + "q_RS_x [], q_RS_y [], q_RS_z [], q_RS_w []", "1,2,3,0,0,0.6,0.8");
  EXPECT_LT(pose().rotation.angularDistance(usual.rotation), 1e-9);
  EXPECT_EQ(pose().translation, usual.translation);
  write_truth("# q_RS_w, a note", "1,2,3,0.8,0,0,0.6");
  EXPECT_TRUE(says(message_of([&] { pose(); }), {"data.csv:2", "q_rs_w", "another order"}));
}

TEST(Euroc, AFisheyeOfTumViIsCroppedAndSixteenBitsAreShown) {
  const TemporaryFolder folder;
  write_euroc(folder, "mocap0", CV_16UC1);
  folder.write("dso/camchain.yaml",
               "cam0:\n  T_cam_imu:\n  - [1, 0, 0, 0.1]\n  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n"
               "  - [0, 0, 0, 1]\n  camera_model: pinhole\n  distortion_model: equidistant\n"
               "  distortion_coeffs: [0.0034, 0.0007, -0.002, 0.0002]\n"
               "  intrinsics: [19.1, 19.1, 32, 24]\n  resolution: [64, 48]\n");
  EXPECT_TRUE(says(message_of([&] { make_euroc_source(folder.path(), {}, {}); }),
                   {"camchain.yaml", "80 degrees", "--crop"}));
  const auto source = crop_source(make_euroc_source(folder.path(), {}, {}, LensCheck::kLater),
                                  parse_crop("32x32+16+8"));
  EXPECT_EQ(source->info().camera.lens, Lens::kFisheye);
  EXPECT_TRUE(ok(source->info().camera.validate()));
  EXPECT_EQ(source->info().camera.cx, 16.0);
  const std::vector<Frame> frames = all_frames(*source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].grey.size(), cv::Size(32, 32));
  EXPECT_EQ(frames[0].grey.at<unsigned char>(5, 5), 0);
  EXPECT_EQ(frames[0].grey.at<unsigned char>(5, 25), 255);
  EXPECT_NEAR(frames[0].true_T_world_camera->translation.x(), 0.01 - 0.1, 1e-9);
}

TEST(Euroc, WhatIsMissingOrWrongIsNamed) {
  const TemporaryFolder folder;
  const auto problem = [&] {
    return message_of([&] { make_euroc_source(folder.path(), {}, {}); });
  };
  EXPECT_TRUE(says(problem(), {"expected a folder with mav0/cam0"}));
  fs::create_directories(folder.path() / "mav0/cam0");
  EXPECT_TRUE(says(problem(), {"cam0/data.csv", "no such file"}));
  write_euroc(folder, "state_groundtruth_estimate0");
  EXPECT_TRUE(says(problem(), {"sensor.yaml", "--camera", "camchain.yaml"}));
  std::string no_place = kSensor;
  no_place.erase(no_place.find("T_BS"), no_place.find("rate_hz") - no_place.find("T_BS"));
  folder.write("mav0/cam0/sensor.yaml", no_place);
  EXPECT_TRUE(says(problem(), {"sensor.yaml", "T_BS", "body"}));
  folder.write("mav0/cam0/sensor.yaml", kSensor);
  EXPECT_EQ(problem(), "no error");
  folder.write("mav0/cam0/data.csv", "#t,f\n1403636579763555584,../../x.png\n");
  EXPECT_TRUE(says(problem(), {"data.csv:2", "inside"}));
  folder.write("mav0/cam0/data.csv", "#t,f\n2,a.png\n1,b.png\n");
  EXPECT_TRUE(says(problem(), {"data.csv:3", "increasing"}));
  folder.write("mav0/state_groundtruth_estimate0/data.csv", "#t\n1,0,0,0,2,0,0,0\n");
  folder.write("mav0/cam0/data.csv", "1403636579763555584,a.png\n");
  EXPECT_TRUE(says(problem(), {"data.csv:2", "unit quaternion"}));
}

TEST(Tum, AFolderWithoutPicturesIsNamedBeforeItsCamera) {
  const TemporaryFolder folder;
  EXPECT_TRUE(says(message_of([&] { make_tum_rgbd_source(folder.path(), {}, {}, {}); }),
                   {"rgb.txt", "no such file"}));
}

TEST(Tum, RunsWithoutTruePoses) {
  const TemporaryFolder folder;
  const fs::path camera =
      folder.write("c.yaml", "fx: 60\nfy: 60\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n");
  for (const char* name : {"1.000000.png", "1.033333.png"}) {
    picture(folder.path() / "rgb" / name, 64, 48);
  }
  folder.write("rgb.txt",
               "# timestamp filename\n1.0 rgb/1.000000.png\n1.033333 rgb/1.033333.png\n");
  const auto source = make_tum_rgbd_source(folder.path(), camera, {}, {});
  EXPECT_TRUE(says(source->info().note, {"no groundtruth.txt"}));
  ASSERT_TRUE(source->span().has_value());
  EXPECT_EQ(source->span()->first_us, 1000000);
  EXPECT_EQ(source->span()->last_us, 1033333);
  for (const Frame& frame : all_frames(*source)) {
    EXPECT_FALSE(frame.true_T_world_camera.has_value());
  }
}

TEST(Crop, MovesThePrincipalPointAndChecksTheArea) {
  const PictureCrop middle = parse_crop("64x48");
  EXPECT_FALSE(middle.left.has_value());
  const PictureCrop placed = parse_crop("64x48+3+7");
  EXPECT_EQ(placed.left, 3);
  EXPECT_EQ(placed.top, 7);
  for (const char* text : {"", "64", "64x", "x48", "64x48+3", "64x48+3+", "64x48-3+7", "64x48+3+7 ",
                           "8x48", "64*48"}) {
    EXPECT_THROW(parse_crop(text), UsageError) << text;
  }
  const TemporaryFolder folder;
  write_euroc(folder, "state_groundtruth_estimate0");
  folder.write("mav0/cam0/sensor.yaml", kSensor);
  const auto cropped = [&](const char* text) {
    return crop_source(make_euroc_source(folder.path(), {}, {}), parse_crop(text));
  };
  const auto source = cropped("40x30");
  EXPECT_EQ(source->info().camera.cx, 20.0);
  EXPECT_EQ(source->info().camera.cy, 15.0);
  EXPECT_EQ(source->info().camera.width, 40);
  EXPECT_TRUE(says(source->info().note, {"64x48", "40x30+12+9"}));
  const std::vector<Frame> frames = all_frames(*source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].grey.at<unsigned char>(0, 19), 30);
  EXPECT_EQ(frames[0].grey.at<unsigned char>(0, 20), 90);
  EXPECT_THROW(cropped("65x48"), UsageError);
  EXPECT_THROW(cropped("40x30+30+0"), UsageError);
  EXPECT_THROW(cropped("20x20+40+10"), UsageError);  // without the principal point
}

}  // namespace
}  // namespace cairn::host
