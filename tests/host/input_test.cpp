#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "host_sim/io/image_file.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/video_source.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

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
