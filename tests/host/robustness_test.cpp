#include "host_sim/experiments/robustness/robustness.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/experiments/robustness/robustness_files.hpp"
#include "host_sim/io/input_error.hpp"
#include "two_walls.hpp"

namespace cairn::host {
namespace {

constexpr std::int64_t kStep_us = 33333;

/// A camera in the hand before two textured walls, with its true poses.
std::vector<Frame> walls(int count) {
  std::vector<Frame> frames;
  const PinholeCamera<double> camera = test::small_camera();
  for (int k = 0; k < count; ++k) {
    Frame frame;
    frame.number = 100 + k;
    frame.t_us = 7 + k * kStep_us;
    frame.true_T_world_camera = test::two_walls_pose(k);
    const std::vector<std::uint8_t>& image = test::two_walls(k);
    frame.grey.create(camera.height, camera.width, CV_8UC1);
    std::copy(image.begin(), image.end(), frame.grey.data);
    frames.push_back(frame);
  }
  return frames;
}

SourceInfo walls_info() {
  SourceInfo info;
  info.name = "walls";
  info.camera = test::small_camera();
  return info;
}

RobustnessSettings small_settings() {
  RobustnessSettings settings;
  settings.window_frames = 70;
  settings.step_frames = 10;
  settings.seeds = 2;
  settings.playbacks = {{false, 1}, {true, 2}};
  settings.max_ate_m = 1000.0;
  settings.max_rotation_deg = 360.0;
  return settings;
}

TEST(Playback, BackwardMirrorsTimesAndLeavesOutOdometry) {
  std::vector<Frame> frames(4);
  const std::int64_t times[] = {10, 20, 50, 60};
  for (int i = 0; i < 4; ++i) {
    frames[static_cast<std::size_t>(i)].number = i;
    frames[static_cast<std::size_t>(i)].t_us = times[i];
    frames[static_cast<std::size_t>(i)].odometry.resize(1);
  }
  const std::vector<Frame> played = play(frames, {true, 1});
  ASSERT_EQ(played.size(), 4U);
  const std::int64_t mirrored[] = {10, 20, 50, 60};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(played[static_cast<std::size_t>(i)].number, 3 - i);
    EXPECT_EQ(played[static_cast<std::size_t>(i)].t_us, mirrored[i]);
    EXPECT_TRUE(played[static_cast<std::size_t>(i)].odometry.empty());
  }
  frames[3].t_us = 90;
  EXPECT_EQ(play(frames, {true, 1})[1].t_us, 50);
}

TEST(Playback, ThinnedFramesKeepTheOdometryBetweenThem) {
  std::vector<Frame> frames(5);
  for (int i = 0; i < 5; ++i) {
    frames[static_cast<std::size_t>(i)].number = i;
    frames[static_cast<std::size_t>(i)].t_us = 10 * i;
    OdometrySample sample;
    sample.t_us = 10 * i;
    frames[static_cast<std::size_t>(i)].odometry = {sample};
  }
  const auto source = play_source(make_memory_source({}, frames), {false, 2});
  EXPECT_EQ(source->info().frame_count, 3);
  const std::vector<Frame> read = read_frames(*source);
  const std::vector<Frame> played = play(frames, {false, 2});
  ASSERT_EQ(read.size(), 3U);
  ASSERT_EQ(played.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read[i].number, static_cast<int>(2 * i));
    EXPECT_EQ(played[i].number, read[i].number);
    EXPECT_EQ(read[i].odometry.size(), i == 0 ? 1U : 2U);
    EXPECT_EQ(played[i].odometry.size(), read[i].odometry.size());
  }
}

TEST(Robustness, JudgesEveryWindowBySeedAndPlayback) {
  const std::vector<Frame> frames = walls(90);
  const RobustnessResult result =
      measure_robustness("walls", walls_info(), frames, small_settings());
  EXPECT_TRUE(result.truth);
  ASSERT_EQ(result.windows.size(), 12U);  // 3 windows, 2 seeds, 2 ways
  EXPECT_EQ(result.windows.front().first_frame, 100);
  EXPECT_EQ(result.windows.front().frames, 70);
  EXPECT_EQ(result.windows.back().first_frame, 120);
  EXPECT_EQ(result.windows.back().frames, 35);
  EXPECT_EQ(result.windows.back().seed, 2U);
  for (const WindowResult& window : result.windows) {
    EXPECT_EQ(window.success, window.tracked >= 0.95) << window.first_frame;
    EXPECT_LE(window.sure, window.tracked);
  }
  EXPECT_TRUE(result.windows.front().success);
  ASSERT_TRUE(result.windows.front().ate_m.has_value());
  EXPECT_LT(*result.windows.front().ate_m, 0.05);
}

TEST(Robustness, CallsAWrongPathThatSaysTrackingSilent) {
  RobustnessSettings settings = small_settings();
  settings.max_ate_m = 1e-9;
  const RobustnessResult result = measure_robustness("walls", walls_info(), walls(70), settings);
  EXPECT_TRUE(result.windows.front().silent);
  for (const WindowResult& window : result.windows) {
    EXPECT_FALSE(window.success);
    EXPECT_EQ(window.silent, window.sure >= 0.95);
  }
}

TEST(Robustness, IsTheSameWithAnyNumberOfThreads) {
  const std::vector<Frame> frames = walls(80);
  RobustnessSettings settings = small_settings();
  settings.threads = 1;
  const auto one = measure_robustness("walls", walls_info(), frames, settings);
  settings.threads = 3;
  const auto three = measure_robustness("walls", walls_info(), frames, settings);
  EXPECT_EQ(to_json({one}, settings), to_json({three}, settings));
}

TEST(Robustness, WithoutTruthCountsTrackingAlone) {
  std::vector<Frame> frames = walls(70);
  for (Frame& frame : frames) frame.true_T_world_camera.reset();
  const RobustnessResult result =
      measure_robustness("walls", walls_info(), frames, small_settings());
  EXPECT_FALSE(result.truth);
  EXPECT_FALSE(result.windows.front().ate_m.has_value());
  EXPECT_EQ(result.windows.front().success, result.windows.front().tracked >= 0.95);
  const nlohmann::json json = to_json({result}, small_settings());
  EXPECT_TRUE(json["sets"][0]["ate_rmse_m"]["median"].is_null());
}

TEST(Robustness, RefusesARecordingShorterThanAWindow) {
  EXPECT_THROW(measure_robustness("walls", walls_info(), walls(69), small_settings()), InputError);
}

}  // namespace
}  // namespace cairn::host
