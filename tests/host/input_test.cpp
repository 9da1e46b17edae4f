#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/video_source.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

testing::AssertionResult says(const std::string& message,
                              std::initializer_list<const char*> parts) {
  for (const char* part : parts) {
    if (message.find(part) == std::string::npos) {
      return testing::AssertionFailure() << "'" << part << "' is not in: " << message;
    }
  }
  return testing::AssertionSuccess();
}

TEST(CsvTable, NamesLineColumnAndExpectation) {
  const TemporaryFolder folder;
  const CsvTable good(folder.write("good.csv", "# note\nt_s, speed_mps\n0.5,1e-1\r\n\n1,+2\n"));
  ASSERT_EQ(good.rows(), 2U);
  EXPECT_EQ(good.number(0, good.column("speed_mps")), 0.1);
  EXPECT_EQ(good.number(1, 1), 2.0);
  EXPECT_TRUE(says(message_of([&] { (void)good.column("turn"); }), {"good.csv:1", "'turn'"}));
  const CsvTable bad(folder.write("bad.csv", "a,b\n1,2\n3,x4\n"));
  EXPECT_TRUE(says(message_of([&] { (void)bad.number(1, 1); }),
                   {"bad.csv:3", "b", "expected a number", "'x4'"}));
  EXPECT_TRUE(says(message_of([&] { CsvTable(folder.write("short.csv", "a,b\n1\n")); }),
                   {"short.csv:2", "expected 2 fields"}));
  EXPECT_TRUE(says(message_of([&] { CsvTable(folder.path() / "none.csv"); }),
                   {"none.csv", "no such file"}));
  for (const char* field : {"nan", "inf", "", "1 2", "0x10", "1,", "--1"}) {
    EXPECT_THROW(parse_number(field, "f", 1, "x"), InputError) << field;
  }
}

TEST(PoseFile, TumRoundTripAndErrors) {
  const TemporaryFolder folder;
  std::vector<TimedPose> poses(2);
  poses[0].t_us = 1305031102175304;
  poses[1].t_us = 1305031102175305;
  poses[1].pose = {rotation_exp(Vector3<double>(0.1, -0.2, 0.3)), {1.0, -2.0, 0.5}};
  write_tum(folder.path() / "a.tum", poses);
  const std::vector<TimedPose> read = read_tum(folder.path() / "a.tum");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].t_us, poses[0].t_us);
  EXPECT_NEAR((read[1].pose.translation - poses[1].pose.translation).norm(), 0.0, 1e-8);
  EXPECT_NEAR(read[1].pose.rotation.angularDistance(poses[1].pose.rotation), 0.0, 1e-7);
  EXPECT_TRUE(says(message_of([&] { read_tum(folder.write("b.tum", "0 0 0 0 0 0 0 1\n1 2 3\n")); }),
                   {"b.tum:2", "8 numbers"}));
  EXPECT_TRUE(says(message_of([&] { read_tum(folder.write("c.tum", "0 0 0 0 0 0 0 2\n")); }),
                   {"c.tum:1", "unit quaternion"}));
  EXPECT_TRUE(says(
      message_of([&] { read_tum(folder.write("d.tum", "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n")); }),
      {"d.tum:2", "increasing"}));
}

TEST(ImageFile, RefusesWhatIsNotAWholeImage) {
  const TemporaryFolder folder;
  cv::Mat image(48, 64, CV_8UC1);
  cv::randu(image, 0, 255);
  cv::Mat grey;
  for (const char* suffix : {".png", ".jpg"}) {
    const std::string name = std::string("whole") + suffix;
    cv::imwrite((folder.path() / name).string(), image);
    EXPECT_NO_THROW(read_grey_image(folder.path() / name, {64, 48}, grey));
    EXPECT_TRUE(says(message_of([&] {
                       read_grey_image(folder.path() / name, {32, 48}, grey);
                     }),
                     {"32x48", "found 64x48"}));
    std::ifstream file(folder.path() / name, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const auto cut = folder.write(std::string("cut") + suffix, bytes.substr(0, bytes.size() / 2));
    EXPECT_TRUE(says(message_of([&] { read_grey_image(cut, {}, grey); }), {"cut", "cut short"}));
  }
  const auto text = folder.write("text.png", "not a picture");
  EXPECT_TRUE(says(message_of([&] { read_grey_image(text, {}, grey); }), {"text.png", "decodes"}));
}

constexpr const char* kOpenCvCamera = R"(%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.1e+02, 0., 3.2e+02, 0., 5.2e+02, 2.4e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ 0.1, -0.2, 0.001, -0.002, 0.05 ]
)";

constexpr const char* kKalibrCamera = R"(cam0:
  camera_model: pinhole
  distortion_model: radtan
  distortion_coeffs: [0.1, -0.2, 0.001, -0.002]
  intrinsics: [510, 520, 320, 240]
  resolution: [640, 480]
)";

constexpr const char* kRosCamera = R"(image_width: 640
image_height: 480
camera_name: front
camera_matrix:
  rows: 3
  cols: 3
  data: [510, 0, 320, 0, 520, 240, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.1, -0.2, 0.001, -0.002, 0]
)";

constexpr const char* kFlatCamera =
    "Camera.fx: 510\nCamera.fy: 520\nCamera.cx: 320\nCamera.cy: 240\n"
    "Camera.k1: 0.1\nCamera.k2: -0.2\nCamera.p1: 0.001\nCamera.p2: -0.002\n"
    "Camera.width: 640\nCamera.height: 480\n";

TEST(CameraFile, ReadsEveryDialect) {
  const TemporaryFolder folder;
  for (const char* text : {kOpenCvCamera, kKalibrCamera, kRosCamera, kFlatCamera}) {
    const PinholeCamera<double> c = read_camera_file(folder.write("c.yaml", text)).camera;
    EXPECT_EQ(c.fx, 510.0) << text;
    EXPECT_EQ(c.fy, 520.0);
    EXPECT_EQ(c.cx, 320.0);
    EXPECT_EQ(c.cy, 240.0);
    EXPECT_EQ(c.k1, 0.1);
    EXPECT_EQ(c.k2, -0.2);
    EXPECT_EQ(c.p1, 0.001);
    EXPECT_EQ(c.p2, -0.002);
    EXPECT_EQ(c.width, 640);
    EXPECT_EQ(c.height, 480);
  }
}

TEST(CameraFile, NamesTheKeyThatIsMissingOrWrong) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) {
    return message_of([&] { read_camera_file(folder.write("cam.yaml", text)); });
  };
  const auto without = [](std::string text, const std::string& part) {
    return text.erase(text.find(part), part.size());
  };
  EXPECT_TRUE(says(message(without(kFlatCamera, "Camera.fx: 510\n")),
                   {"cam.yaml", "Camera.fx", "missing", "focal length"}));
  EXPECT_TRUE(says(message(without(kKalibrCamera, "  intrinsics: [510, 520, 320, 240]\n")),
                   {"cam.yaml", "cam0.intrinsics", "missing"}));
  EXPECT_TRUE(says(message("image_width: 640\nimage_height: 480\n"),
                   {"cam.yaml", "camera_matrix", "missing", "focal length"}));
  EXPECT_TRUE(says(message(without(kOpenCvCamera, "5.1e+02")), {"cam.yaml", "camera_matrix"}));
  EXPECT_TRUE(says(message("camera_matrix: [0,0,320,0,500,240,0,0,1]\nimage_width: 640\n"
                           "image_height: 480\n"),
                   {"camera_matrix", "focal lengths above zero"}));
  EXPECT_TRUE(says(message("a: [1, 2\nb: 3\n"), {"cam.yaml:", "expected YAML"}));
  std::string fisheye = kKalibrCamera;
  fisheye.replace(fisheye.find("radtan"), 6, "equidistant");
  EXPECT_TRUE(says(message(fisheye), {"distortion_model", "radtan", "equidistant"}));
}

TEST(CameraFile, SensorDistortionOfOpenEkfMonoSlamIsConverted) {
  const TemporaryFolder folder;
  const PinholeCamera<double> c =
      read_camera_file(folder.write("config.yml",
                                    "%YAML:1.0\nRunConfiguration:\n  CameraCalibration: \"S3\"\n"
                                    "CameraCalibration:\n  S3:\n    PixelsX: \"640\"\n"
                                    "    PixelsY: \"480\"\n    FX: \"525\"\n    FY: \"524\"\n"
                                    "    K1: \"-7.613e-003\"\n    K2: \"9.388e-004\"\n"
                                    "    CX: \"308.6\"\n    CY: \"236.5\"\n    DX: \"0.00702\"\n"))
          .camera;
  for (const double r_px : {50.0, 150.0, 250.0, 350.0}) {
    const double rd_mm = r_px * 0.00702;
    const double square = rd_mm * rd_mm;
    const double undistorted = r_px / c.fx * (1.0 - 7.613e-3 * square + 9.388e-4 * square * square);
    Vector2<double> pixel;
    ASSERT_TRUE(ok(c.project({undistorted, 0.0, 1.0}, pixel)));
    EXPECT_NEAR(pixel.x() - c.cx, r_px, 0.6) << r_px;
  }
}

std::string pose_text(double x) {
  return "1 0 0 " + std::to_string(x) + "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
}

TEST(SevenScenes, NumbersMayStartAnywhere) {
  const TemporaryFolder folder;
  const cv::Mat image(480, 640, CV_8UC3, cv::Scalar(10, 20, 30));
  for (const int number : {150, 151, 153, 154}) {
    char name[32];
    std::snprintf(name, sizeof name, "frame-%06d", number);
    cv::imwrite((folder.path() / (std::string(name) + ".color.png")).string(), image);
    folder.write(std::string(name) + ".pose.txt", pose_text(number));
  }
  const auto source = make_seven_scenes_source(folder.path(), {151, 2});
  EXPECT_EQ(source->info().frame_count, 2);
  Frame frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_EQ(frame.number, 151);
  EXPECT_EQ(frame.t_us, 5033333);
  EXPECT_EQ(frame.true_T_world_camera->translation.x(), 151.0);
  EXPECT_EQ(frame.grey.type(), CV_8UC1);
  ASSERT_TRUE(source->next(frame));
  EXPECT_EQ(frame.number, 153);
  EXPECT_FALSE(source->next(frame));
  EXPECT_TRUE(says(message_of([&] {
                     make_seven_scenes_source(folder.path(), {900, {}});
                   }),
                   {"900", "none"}));
  folder.write("frame-000151.pose.txt", "1 0 0 0\n0 1 zero 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_TRUE(says(message_of([&] { make_seven_scenes_source(folder.path(), {}); }),
                   {"frame-000151.pose.txt:2", "'zero'"}));
}

TEST(TumRgbd, ReadsListTruthAndCamera) {
  const TemporaryFolder folder;
  const cv::Mat image(480, 640, CV_8UC3, cv::Scalar(10, 20, 30));
  std::filesystem::create_directories(folder.path() / "freiburg1_desk/rgb");
  cv::imwrite((folder.path() / "freiburg1_desk/rgb/1.png").string(), image);
  folder.write("freiburg1_desk/rgb.txt", "# list\n1305031102.1753 rgb/1.png\n");
  folder.write("freiburg1_desk/groundtruth.txt",
               "1305031102.1000 9 9 9 0 0 0 1\n1305031102.1758 1 2 3 0 0 0 1\n");
  const auto source = make_tum_rgbd_source(folder.path() / "freiburg1_desk", {}, {});
  EXPECT_NEAR(source->info().camera.fx, 517.3, 1e-9);
  Frame frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_EQ(frame.t_us, 1305031102175300);
  ASSERT_TRUE(frame.true_T_world_camera.has_value());
  EXPECT_EQ(frame.true_T_world_camera->translation.z(), 3.0);
  folder.write("freiburg1_desk/rgb.txt", "1305031102.1753\n");
  EXPECT_TRUE(
      says(message_of([&] { make_tum_rgbd_source(folder.path() / "freiburg1_desk", {}, {}); }),
           {"rgb.txt:1", "time file"}));
}

TEST(VideoSource, FolderWithTimesOdometryAndTruth) {
  const TemporaryFolder folder;
  const cv::Mat image(240, 320, CV_8UC1, cv::Scalar(50));
  std::filesystem::create_directories(folder.path() / "pictures");
  for (const int number : {7, 8, 9}) {
    cv::imwrite((folder.path() / "pictures" / (std::to_string(number) + ".png")).string(), image);
  }
  VideoOptions options;
  options.media = folder.path() / "pictures";
  options.camera =
      folder.write("camera.yaml", "fx: 250\nfy: 250\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
  options.times = folder.write("times.csv", "frame,t_us\n7,1000000\n8,1050000\n9,1100000\n");
  options.odometry = folder.write("odometry.csv",
                                  "t_s,speed_mps,steering_rad,wheelbase_m\n0.99,1,0,0.5\n"
                                  "1.02,1,0.1,0.5\n1.05,1,0.2,0.5\n1.08,1,0.3,0.5\n");
  options.truth = folder.write("truth.tum", "1.0 0 0 1 0 0 0 1\n1.05 0.05 0 1 0 0 0 1\n");
  const auto source = make_video_source(options);
  EXPECT_EQ(source->info().frame_count, 3);
  ASSERT_TRUE(source->info().odometry.has_value());
  EXPECT_EQ(source->info().odometry->wheelbase_m, 0.5);
  Frame frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_EQ(frame.number, 7);
  EXPECT_TRUE(frame.odometry.empty());
  ASSERT_TRUE(source->next(frame));
  EXPECT_EQ(frame.t_us, 1050000);
  ASSERT_EQ(frame.odometry.size(), 2U);
  EXPECT_FLOAT_EQ(frame.odometry[1].turn, 0.2F);
  EXPECT_NEAR(frame.true_T_world_camera->translation.x(), 0.05, 1e-12);
  ASSERT_TRUE(source->next(frame));
  EXPECT_FALSE(frame.true_T_world_camera.has_value());
  EXPECT_FALSE(source->next(frame));

  options.times = folder.write("times.csv", "frame,t_us\n7,1000000\n8,999\n");
  EXPECT_TRUE(says(message_of([&] { make_video_source(options); }), {"times.csv:3", "increasing"}));
  options.times = folder.write("times.csv", "frame,t_us\n8,999\n");
  EXPECT_TRUE(
      says(message_of([&] { make_video_source(options)->next(frame); }), {"times.csv", "frame 7"}));
  options.camera.clear();
  EXPECT_THROW(make_video_source(options), UsageError);
}

TEST(VideoSource, FileSkipsToTheFirstFrameAskedFor) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "clip.avi";
  cv::VideoWriter writer(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0,
                         {320, 240});
  ASSERT_TRUE(writer.isOpened());
  for (int i = 0; i < 6; ++i) writer.write(cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(40 * i)));
  writer.release();
  VideoOptions options;
  options.media = path;
  options.camera =
      folder.write("camera.yaml", "fx: 250\nfy: 250\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
  options.range = {3, 2};
  const auto source = make_video_source(options);
  Frame frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_EQ(frame.number, 3);
  EXPECT_EQ(frame.t_us, 120000);
  EXPECT_NEAR(frame.grey.at<std::uint8_t>(100, 100), 120, 3);
  ASSERT_TRUE(source->next(frame));
  EXPECT_FALSE(source->next(frame));
  options.media = folder.write("noise.avi", "this is no video");
  EXPECT_TRUE(says(message_of([&] { make_video_source(options); }), {"noise.avi", "decode"}));
}

}  // namespace
}  // namespace cairn::host
