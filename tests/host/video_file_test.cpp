#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "host_sim/sources/cropped_source.hpp"
#include "host_sim/sources/scaled_source.hpp"
#include "host_sim/sources/video_source.hpp"
#include "input_messages.hpp"
#include "quicktime_file.hpp"
#include "temporary_folder.hpp"
#include "video_options.hpp"

namespace cairn::host {
namespace {

TEST(VideoFile, FileSkipsToTheFirstFrameAskedFor) {
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
  // OpenCV takes a picture for a video of one frame without a time.
  options.media = folder.path() / "frame0001.png";
  cv::imwrite(options.media.string(), cv::Mat(240, 320, CV_8UC1, cv::Scalar(90)));
  EXPECT_TRUE(says(message_of([&] { make_video_source(options); }), {"frame0001.png", "folder"}));
}

TEST(VideoFile, FramesOfAVariableRateKeepTheirTimes) {
  const TemporaryFolder folder;
  std::vector<int> durations(20, 33);
  durations.insert(durations.end(), 10, 100);
  durations.insert(durations.end(), 10, 33);
  const auto path = folder.path() / "phone.mov";
  QuickTimeFile(noise_frames(), durations).write(path);
  const Ran ran = run(video(folder, path));
  ASSERT_EQ(ran.t_us.size(), durations.size());
  std::int64_t expected = 0;
  for (std::size_t i = 0; i < durations.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(ran.t_us[i]), static_cast<double>(expected), 1.0) << i;
    EXPECT_EQ(ran.numbers[i], static_cast<int>(i));
    expected += 1000 * durations[i];
  }
  EXPECT_TRUE(ran.info.warnings.empty());
  EXPECT_FALSE(ran.info.damaged);
}

TEST(VideoFile, AnUprightVideoIsTurnedAndNeedsItsCalibration) {
  const TemporaryFolder folder;
  cv::Mat image(240, 320, CV_8UC1, cv::Scalar(0));
  image.colRange(0, 100).setTo(255);  // the left: after a quarter to the right, the top
  const auto path = folder.path() / "upright.mov";
  QuickTimeFile({image}, std::vector<int>(3, 33), true).write(path);
  VideoOptions options = video(folder, path);
  EXPECT_TRUE(says(message_of([&] { make_video_source(options); }),
                   {"upright.mov", "320x240", "found 240x320", "before it is turned"}));
  QuickTimeFile({image}, std::vector<int>(3, 33)).write(path);
  VideoOptions lying = video(folder, path);
  lying.camera =
      folder.write("upright.yaml", "fx: 250\nfy: 250\ncx: 120\ncy: 160\nwidth: 240\nheight: 320\n");
  EXPECT_TRUE(says(message_of([&] { make_video_source(lying); }),
                   {"upright.mov", "240x320", "found 320x240", "was held the other way"}));
  QuickTimeFile({image}, std::vector<int>(3, 33), true).write(path);
  options.camera =
      folder.write("upright.yaml", "fx: 250\nfy: 250\ncx: 120\ncy: 160\nwidth: 240\nheight: 320\n");
  const auto source = make_video_source(options);
  const std::string& note = source->info().note;  // OpenCV's versions count either way round
  EXPECT_TRUE(says(note, {"turned by 90 degrees, as the video says"}) ||
              says(note, {"turned by 270 degrees, as the video says"}));
  Frame frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_GT(frame.grey.at<std::uint8_t>(20, 120), 250);
  EXPECT_LT(frame.grey.at<std::uint8_t>(300, 120), 5);
}

TEST(VideoFile, ColourIsTurnedCroppedAndScaledAsTheGreyPicture) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "upright.mov";
  cv::Mat picture(240, 320, CV_8UC3, cv::Scalar(200, 60, 30));
  picture({0, 0, 160, 120}).setTo(cv::Scalar(20, 40, 220));
  QuickTimeFile({picture}, {40, 40}, true).write(path);
  VideoOptions options;
  options.media = path;
  options.hfov_deg = 40.0;
  Frame frame;
  ASSERT_TRUE(make_video_source(options)->next(frame));
  EXPECT_TRUE(frame.colour.empty());
  options.colour = true;
  const auto source =
      scale_source(crop_source(make_video_source(options), PictureCrop{200, 280, {}, {}}), 0.5);
  ASSERT_TRUE(source->next(frame));
  ASSERT_EQ(frame.colour.size(), cv::Size(100, 140));
  ASSERT_EQ(frame.grey.size(), frame.colour.size());
  cv::Mat grey;
  cv::cvtColor(frame.colour, grey, cv::COLOR_BGR2GRAY);
  EXPECT_LE(cv::norm(grey, frame.grey, cv::NORM_INF), 2.0);
  EXPECT_GT(frame.colour.at<cv::Vec3b>(20, 80)[2], 150);  // the red corner, turned clockwise
  EXPECT_GT(frame.colour.at<cv::Vec3b>(120, 20)[0], 150);
}

TEST(VideoFile, TimesOfAContainerThatStandStillAreRefused) {
  const TemporaryFolder folder;
  std::vector<int> durations(20, 33);
  durations[9] = 0;
  const auto path = folder.path() / "still.mov";
  QuickTimeFile(noise_frames(), durations).write(path);
  EXPECT_TRUE(says(message_of([&] { run(video(folder, path)); }),
                   {"still.mov", "0.297 s for frame 10", "--times"}));
}

/// OpenCV gives the time 0 to the frames that H.264 keeps back, for others that refer to them,
/// until the video ends.
TEST(VideoFile, FramesThatWereKeptBackToTheEndHaveTimes) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "clip.mp4";
  cv::VideoWriter writer(path.string(), cv::VideoWriter::fourcc('a', 'v', 'c', '1'), 25.0,
                         {320, 240});
  if (!writer.isOpened()) GTEST_SKIP() << "OpenCV has no encoder for H.264";
  const std::vector<cv::Mat> frames = noise_frames();
  for (std::size_t i = 0; i < 12; ++i) {
    cv::Mat colour;
    cv::cvtColor(frames[i % frames.size()], colour, cv::COLOR_GRAY2BGR);
    writer.write(colour);
  }
  writer.release();
  const Ran ran = run(video(folder, path));
  ASSERT_EQ(ran.t_us.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(ran.numbers[i], static_cast<int>(i));
    EXPECT_NEAR(static_cast<double>(ran.t_us[i]), 40000.0 * static_cast<double>(i), 2.0);
  }
}

TEST(VideoFile, AVideoThatEndsEarlyIsSaidToBeDamaged) {
  const TemporaryFolder folder;
  std::string bytes = QuickTimeFile(noise_frames(), std::vector<int>(40, 33)).bytes();
  const std::size_t end = bytes.find("moov");
  bytes.replace(end / 2, end - end / 2 - 4, std::string(end - end / 2 - 4, '\0'));
  const auto path = folder.write("cut.mov", bytes);
  const Ran ran = run(video(folder, path));
  EXPECT_LT(ran.numbers.size(), 25U);
  EXPECT_TRUE(ran.info.damaged);
  ASSERT_EQ(ran.info.warnings.size(), 1U);
  EXPECT_TRUE(says(ran.info.warnings[0], {"cut.mov", "of the 40 frames"}));

  VideoOptions part = video(folder, path);
  part.range.count = 10;
  const Ran first = run(part);
  EXPECT_EQ(first.numbers.size(), 10U);
  EXPECT_FALSE(first.info.damaged);
  EXPECT_TRUE(first.info.warnings.empty());
}

TEST(VideoFile, FramesThatDoNotDecodeLeaveAGapInNumbersAndTimes) {
  const TemporaryFolder folder;
  std::string bytes = QuickTimeFile(noise_frames(), std::vector<int>(40, 40)).bytes();
  const std::size_t frame = bytes.find("moov") / 40;
  bytes.replace(12 * frame, 3 * frame, std::string(3 * frame, '\0'));
  const Ran ran = run(video(folder, folder.write("hole.mov", bytes)));
  ASSERT_LT(ran.numbers.size(), 40U);
  EXPECT_GE(ran.numbers.size(), 35U);
  EXPECT_EQ(ran.numbers.back(), 39);
  for (std::size_t i = 0; i < ran.numbers.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(ran.t_us[i]), 40000.0 * ran.numbers[i], 1.0);
  }
  EXPECT_FALSE(ran.info.damaged);
  ASSERT_EQ(ran.info.warnings.size(), 1U);
  EXPECT_TRUE(says(ran.info.warnings[0], {"hole.mov", "of the 40 frames"}));
}

TEST(VideoFile, RowsOfTimesAreDoubtedWhenFramesAreMissing) {
  const TemporaryFolder folder;
  std::string bytes = QuickTimeFile(noise_frames(), std::vector<int>(40, 40)).bytes();
  const std::size_t frame = bytes.find("moov") / 40;
  bytes.replace(12 * frame, 3 * frame, std::string(3 * frame, '\0'));
  VideoOptions options = video(folder, folder.write("hole.mov", bytes));
  std::string times = "frame,t_s\n";
  for (int i = 0; i < 40; ++i) times += std::to_string(i) + "," + std::to_string(0.04 * i) + "\n";
  options.times = folder.write("times.csv", times);
  const Ran ran = run(options);
  EXPECT_TRUE(ran.info.damaged);
  ASSERT_EQ(ran.info.warnings.size(), 2U);
  EXPECT_TRUE(says(ran.info.warnings[1], {"--times"}));
}

}  // namespace
}  // namespace cairn::host
