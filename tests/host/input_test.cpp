#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/io/pose_file.hpp"
#include "host_sim/sources/data_sets.hpp"
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
  // Times before 0 have their sign, and all of their digits.
  poses[0].t_us = -1466667;
  poses[1].t_us = -1;
  write_tum(folder.path() / "before.tum", poses);
  const std::vector<TimedPose> before = read_tum(folder.path() / "before.tum");
  ASSERT_EQ(before.size(), 2U);
  EXPECT_EQ(before[0].t_us, poses[0].t_us);
  EXPECT_EQ(before[1].t_us, poses[1].t_us);
  EXPECT_TRUE(says(message_of([&] { read_tum(folder.write("b.tum", "0 0 0 0 0 0 0 1\n1 2 3\n")); }),
                   {"b.tum:2", "8 numbers"}));
  EXPECT_TRUE(says(message_of([&] { read_tum(folder.write("c.tum", "0 0 0 0 0 0 0 2\n")); }),
                   {"c.tum:1", "unit quaternion"}));
  EXPECT_TRUE(says(
      message_of([&] { read_tum(folder.write("d.tum", "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n")); }),
      {"d.tum:2", "increasing"}));
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
  const auto source = make_seven_scenes_source(folder.path(), {}, {151, 2});
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
                     make_seven_scenes_source(folder.path(), {}, {900, {}});
                   }),
                   {"900", "none"}));
  folder.write("frame-000151.pose.txt", "1 0 0 0\n0 1 zero 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_TRUE(says(message_of([&] { make_seven_scenes_source(folder.path(), {}, {}); }),
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
  folder.write("freiburg1_desk/groundtruth.txt", "5.0 9 9 9 0 0 0 1\n6.0 1 2 3 0 0 0 1\n");
  EXPECT_TRUE(
      says(message_of([&] { make_tum_rgbd_source(folder.path() / "freiburg1_desk", {}, {}); }),
           {"groundtruth.txt", "1305031102.175 s", "5.000 s to 6.000 s"}));
  folder.write("freiburg1_desk/groundtruth.txt", "1305031102.17 9 9 9 0 0 0 1\n");
  folder.write("freiburg1_desk/rgb.txt", "1305031102.1753\n");
  EXPECT_TRUE(
      says(message_of([&] { make_tum_rgbd_source(folder.path() / "freiburg1_desk", {}, {}); }),
           {"rgb.txt:1", "time file"}));
}

}  // namespace
}  // namespace cairn::host
