#include <gtest/gtest.h>

#include "host_sim/experiments/robustness/robustness.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/sources/hand_source.hpp"
#include "host_sim/sources/scaled_source.hpp"
#include "host_sim/trackers/window_adapter.hpp"
#include "input_messages.hpp"
#include "video_options.hpp"

namespace cairn::host {
namespace {

HandOptions hand(double readout_s, int frames, std::uint64_t seed = 1) {
  HandOptions options;
  options.readout_s = readout_s;
  options.frame_count = frames;
  options.seed = seed;
  return options;
}

double difference(const cv::Mat& a, const cv::Mat& b, int row) {
  return cv::norm(a.row(row), b.row(row), cv::NORM_L1) / a.cols;
}

TEST(HandSource, RowsShowWhereTheCameraWasAtTheirOwnTime) {
  constexpr double kPeriod_s = 1.0 / 30.0;
  const std::vector<Frame> instant = read_frames(*make_hand_source(hand(0.0, 3)));
  const std::vector<Frame> rolled = read_frames(*make_hand_source(hand(2.0 * kPeriod_s, 3)));
  const cv::Mat& picture = rolled[1].grey;
  constexpr double kNoise = 5.0;  // grey levels, of two pictures' sensors
  EXPECT_LT(difference(picture, instant[0].grey, 0), kNoise);
  EXPECT_LT(difference(picture, instant[1].grey, 240), kNoise);
  EXPECT_LT(difference(picture, instant[2].grey, 479), kNoise);
  EXPECT_GT(difference(picture, instant[1].grey, 0), 1.5 * kNoise);
  EXPECT_GT(difference(picture, instant[1].grey, 479), 1.5 * kNoise);
}

/// Sum of the position errors of pictures with a rolling shutter, played both ways, where the
/// tracker is told `told` of the row time.
double error_of_rolled(double told) {
  RobustnessSettings settings;
  settings.window_frames = settings.step_frames = 80;
  settings.playbacks = {{false, 1}, {true, 1}};
  double sum = 0.0;
  for (const std::uint64_t seed : {1U, 2U}) {
    const auto source = make_hand_source(hand(0.033, 80, seed));
    SourceInfo info = source->info();
    info.readout.row_time_s *= static_cast<float>(told);
    for (const WindowResult& window :
         measure_robustness("hall-hand", info, read_frames(*source), settings).windows) {
      sum += window.ate_m.value_or(1.0);
    }
  }
  return sum;
}

TEST(RollingShutter, ToldToTheTrackerHalvesItsErrorBothWays) {
  EXPECT_LT(error_of_rolled(1.0), 0.5 * error_of_rolled(0.0));
}

std::string with(const std::string& lines) {
  return std::string(kVideoCamera) + lines + "\n";
}

TEST(RollingShutter, IsReadFromTheCameraFileAndScaledWithThePicture) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 2);
  options.camera = folder.write("rows.yaml", with("row_time: 50e-6\ncolumn_time: -1e-5"));
  const ReadoutTimes read = make_video_source(options)->info().readout;
  EXPECT_FLOAT_EQ(read.row_time_s, 50e-6F);
  EXPECT_FLOAT_EQ(read.column_time_s, -1e-5F);
  const ReadoutTimes half = scale_source(make_video_source(options), 0.5)->info().readout;
  EXPECT_FLOAT_EQ(half.row_time_s, 100e-6F);
  EXPECT_FLOAT_EQ(half.column_time_s, -2e-5F);
  const auto kalibr = folder.write("delay.yaml", with("line_delay: 4e-5"));
  EXPECT_FLOAT_EQ(read_camera_file(kalibr).readout.row_time_s, 4e-5F);
}

TEST(RollingShutter, TimesThatNoCameraHasAreRefused) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& lines, const char* key) {
    return says(message_of([&] { read_camera_file(folder.write("c.yaml", with(lines))); }),
                {"c.yaml", key});
  };
  EXPECT_TRUE(refused("row_time: 0.0333", "'row_time'"));
  EXPECT_TRUE(refused("row_time: fast", "'row_time'"));
  EXPECT_TRUE(refused("column_time: .nan", "'column_time'"));
  EXPECT_TRUE(refused("row_time: 1e-5\nline_delay: 1e-5", "'line_delay'"));
}

TEST(RollingShutter, OfTheCommandLineGoesBeforeTheFiles) {
  SourceInfo info;
  info.camera.width = 640;
  info.camera.height = 480;
  info.readout.row_time_s = 50e-6F;
  HandheldOptions options;
  EXPECT_EQ(window_readout(options, info).row_time_s, 50e-6F);
  options.row_time_s = 0.0;
  EXPECT_TRUE(window_readout(options, info).instant());
  options.row_time_s = 0.033;
  EXPECT_THROW(window_readout(options, info), UsageError);
}

}  // namespace
}  // namespace cairn::host
