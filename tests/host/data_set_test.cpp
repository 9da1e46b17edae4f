// Data sets in the folders as they are downloaded.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/sources/cropped_source.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

void picture(const fs::path& path, int width, int height, int type = CV_8UC1) {
  fs::create_directories(path.parent_path());
  cv::Mat image(height, width, type, cv::Scalar(type == CV_16UC1 ? 3000 : 90));
  image(cv::Rect(0, 0, width / 2, height)).setTo(type == CV_16UC1 ? 1000 : 30);
  cv::imwrite(path.string(), image);
}

std::vector<Frame> all_frames(FrameSource& source) {
  std::vector<Frame> frames;
  Frame frame;
  while (source.next(frame)) {
    frames.push_back(frame);
    frames.back().grey = frame.grey.clone();
  }
  return frames;
}

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

constexpr const char* kKittiCalibration =
    "P0: 60 0 32 0 0 60 24 0 0 0 1 0\nP1: 60 0 32 -32 0 60 24 0 0 0 1 0\n"
    "P2: 70 0 30 7 0 70 22 0 0 0 1 0\nP3: 60 0 32 0 0 60 24 0 0 0 1 0\nTr: 1 0 0 0 0 1 0 0 0 0 1 "
    "0\n";

TEST(Kitti, PublicLayoutHasItsPosesBesideTheSequences) {
  const TemporaryFolder folder;
  const std::string sequence = "dataset/sequences/00/";
  std::string poses;
  for (int i = 0; i < 3; ++i) {
    picture(folder.path() / sequence / "image_0" / ("00000" + std::to_string(i) + ".png"), 64, 48);
    poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
  }
  folder.write(sequence + "calib.txt", kKittiCalibration);
  folder.write(sequence + "times.txt", "0.0\n0.103736\n0.207472\n");
  folder.write("dataset/poses/00.txt", poses);
  for (const char* slash : {"", "/"}) {
    const auto source =
        make_kitti_source((folder.path() / sequence).parent_path().string() + slash, {}, 1);
    EXPECT_EQ(source->info().camera.fx, 60.0);
    const std::vector<Frame> frames = all_frames(*source);
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[1].t_us, 103736);
    EXPECT_NEAR(frames[2].true_T_world_camera->translation.x(), 2.0, 1e-9);
    ASSERT_EQ(frames[2].odometry.size(), 1U);
    EXPECT_NEAR(frames[2].odometry[0].speed_mps, 1.0 / 0.103736, 0.5);
  }
  // Without true poses, as the sequences of the benchmark are.
  fs::remove(folder.path() / "dataset/poses/00.txt");
  const auto source = make_kitti_source(folder.path() / sequence, {}, 1);
  EXPECT_FALSE(source->info().odometry.has_value());
  EXPECT_TRUE(says(source->info().note, {"no true poses", "hand-held"}));
  EXPECT_FALSE(all_frames(*source).front().true_T_world_camera.has_value());
}

/// WHEN a picture is missing, THEN those behind it keep their times and poses: rows belong to
/// numbers, from 0 or from the first picture on.
TEST(Kitti, RowsBelongToNumbers) {
  const TemporaryFolder folder;
  folder.write("calib.txt", kKittiCalibration);
  const auto rows = [&](int count) {
    std::string poses;
    std::string times;
    for (int i = 0; i < count; ++i) {
      poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
      times += std::to_string(0.1 * i) + "\n";
    }
    folder.write("poses.txt", poses);
    folder.write("times.txt", times);
  };
  const auto show = [&](const std::vector<int>& numbers) {
    fs::remove_all(folder.path() / "image_0");
    for (const int n : numbers) {
      char name[32];
      std::snprintf(name, sizeof name, "%06d.png", n);
      picture(folder.path() / "image_0" / name, 64, 48);
    }
  };
  /// Rows that the times and the poses of the frames are of.
  const auto taken = [&] {
    std::vector<int> found;
    for (const Frame& frame : all_frames(*make_kitti_source(folder.path(), {}, 1))) {
      found.push_back(static_cast<int>(frame.t_us / 100000));
      EXPECT_NEAR(frame.true_T_world_camera->translation.x(), found.back(), 1e-6);
    }
    return found;
  };
  using Rows = std::vector<int>;
  show({0, 1, 3, 4});
  rows(5);
  EXPECT_EQ(taken(), (Rows{0, 1, 3, 4}));
  rows(4);  // a row for each picture that is there
  EXPECT_EQ(taken(), (Rows{0, 1, 2, 3}));
  show({100, 101, 103});
  rows(200);  // of the whole sequence
  EXPECT_EQ(taken(), (Rows{100, 101, 103}));
  rows(4);  // of the clip
  EXPECT_EQ(taken(), (Rows{0, 1, 3}));
  show({100, 101, 104, 105});
  rows(5);
  const std::string said = message_of([&] { make_kitti_source(folder.path(), {}, 1); });
  EXPECT_TRUE(says(said, {"000104.png", "000101.png", "5", "poses.txt"}));
  show({0, 1, 2});
  rows(2);
  EXPECT_TRUE(says(message_of([&] { make_kitti_source(folder.path(), {}, 1); }),
                   {"poses.txt", "each of the 3 images"}));
  // 10 Hz without times.
  show({7, 8, 10});
  rows(3);
  fs::remove(folder.path() / "times.txt");
  const std::vector<Frame> frames = all_frames(*make_kitti_source(folder.path(), {}, 1));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[2].t_us, 300000);
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

TEST(Kitti, ColourPicturesHaveTheirOwnCamera) {
  const TemporaryFolder folder;
  picture(folder.path() / "image_2/000000.png", 64, 48);
  folder.write("calib.txt", kKittiCalibration);
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const auto source = make_kitti_source(folder.path(), {}, 1);
  EXPECT_EQ(source->info().camera.fx, 70.0);
  const std::vector<Frame> frames = all_frames(*source);
  // 0.1 m to the left of camera 0; the vehicle's y points left.
  EXPECT_NEAR(frames[0].true_T_world_camera->translation.y(), 0.1, 1e-9);
}

void write_kitti_raw(const TemporaryFolder& folder) {
  const std::string drive = "2011_09_26/2011_09_26_drive_0001_sync/";
  const std::string oxts = drive + "oxts/data/";
  std::string camera_times, oxts_times;
  for (int i = 0; i < 4; ++i) {
    const std::string name = "000000000" + std::to_string(i);
    picture(folder.path() / drive / "image_00/data" / (name + ".png"), 64, 48);
    char text[512];
    std::snprintf(text, sizeof text, "2011-09-26 13:02:25.%d50000000\n", 1 + i);
    camera_times += text;
    std::snprintf(text, sizeof text, "2011-09-26 13:02:25.%d40000000\n", 1 + i);
    oxts_times += text;
    // 10 m/s to the north: yaw 90 degrees; 1 m a step.
    std::snprintf(text, sizeof text,
                  "%.12f 8.4 110.0 0 0 1.5707963267948966 10 0 10 0 0 0 0 9.8 0 0 9.8 0 0 0.02 0 0 "
                  "0.02 0.1 0.1 4 10 4 4 0\n",
                  49.0 + i / 6378137.0 * 180.0 / M_PI);
    folder.write(oxts + name + ".txt", text);
  }
  folder.write(drive + "image_00/timestamps.txt", camera_times);
  folder.write(drive + "oxts/timestamps.txt", oxts_times);
  folder.write("2011_09_26/calib_cam_to_cam.txt",
               "calib_time: 09-Jan-2012 13:57:47\nS_00: 70 52\nK_00: 61 0 35 0 61 26 0 0 1\n"
               "D_00: -0.1 0.01 0 0 0\nS_rect_00: 64 48\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
               "P_rect_00: 60 0 32 0 0 60 24 0 0 0 1 0\n");
  folder.write("2011_09_26/calib_velo_to_cam.txt",
               "calib_time: 15\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.08 -0.27\n");
  folder.write("2011_09_26/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.81 0.32 -0.8\n");
}

TEST(KittiRaw, OxtsIsOdometryAndTruth) {
  const TemporaryFolder folder;
  write_kitti_raw(folder);
  const fs::path drive = folder.path() / "2011_09_26/2011_09_26_drive_0001_sync";
  ASSERT_TRUE(is_kitti_raw(drive));
  EXPECT_FALSE(is_kitti_raw(folder.path()));
  const auto source = make_kitti_raw_source(drive, {});
  EXPECT_EQ(source->info().camera.fx, 60.0);
  // 0.81 + 0.27 m ahead of the IMU, 0.93 + 0.8 - 0.08 m above the ground.
  const Vector3<double> place = source->info().T_vehicle_camera.translation;
  EXPECT_NEAR((place - Vector3<double>(1.08, -0.32, 1.65)).norm(), 0.0, 1e-9);
  const std::vector<Frame> frames = all_frames(*source);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[0].t_us, 1317042145150000);
  EXPECT_TRUE(frames[0].odometry.empty());
  ASSERT_EQ(frames[1].odometry.size(), 1U);
  EXPECT_EQ(frames[1].odometry[0].t_us, 1317042145240000);
  EXPECT_EQ(frames[1].odometry[0].speed_mps, 10.0F);
  EXPECT_EQ(frames[1].odometry[0].turn, 0.02F);
  // A tenth of the way from one pose to the next, northwards.
  const Vector3<double> vehicle = frames[1].true_T_world_vehicle->translation;
  EXPECT_NEAR(vehicle.y(), 1.1, 1e-3);
  EXPECT_NEAR(vehicle.x(), 0.0, 1e-6);
  EXPECT_NEAR(vehicle.z(), -0.93, 1e-9);
  const Vector3<double> ahead = frames[1].true_T_world_vehicle->rotation * Vector3<double>::UnitX();
  EXPECT_NEAR(ahead.y(), 1.0, 1e-9);
}

TEST(KittiRaw, WhatIsMissingOrWrongIsNamed) {
  const TemporaryFolder folder;
  write_kitti_raw(folder);
  const fs::path drive = folder.path() / "2011_09_26/2011_09_26_drive_0001_sync";
  const std::string name = "2011_09_26/2011_09_26_drive_0001_sync/";
  const auto problem = [&] { return message_of([&] { make_kitti_raw_source(drive, {}); }); };
  EXPECT_EQ(problem(), "no error");
  folder.write(name + "oxts/timestamps.txt", "2011-09-26 13:02:25.14\n2011-09-26 13:02\n");
  EXPECT_TRUE(says(problem(), {"oxts/timestamps.txt:2", "2011-09-26 13:02:25"}));
  folder.write(name + "oxts/timestamps.txt", "2011-09-26 13:02:25.14\n");
  EXPECT_TRUE(says(problem(), {"oxts/timestamps.txt", "0000000001.txt", "1 lines"}));
  write_kitti_raw(folder);
  folder.write(name + "oxts/data/0000000002.txt", "1 2 3\n");
  EXPECT_TRUE(says(problem(), {"0000000002.txt:1", "30 numbers"}));
  write_kitti_raw(folder);
  picture(drive / "image_00/data/0000000000.png", 60, 48);
  EXPECT_TRUE(says(problem(), {"0000000000.png", "S_rect_00", "60x48"}));
  write_kitti_raw(folder);
  fs::remove(folder.path() / "2011_09_26/calib_imu_to_velo.txt");
  EXPECT_TRUE(says(problem(), {"2011_09_26/calib_imu_to_velo.txt", "no such file"}));
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
