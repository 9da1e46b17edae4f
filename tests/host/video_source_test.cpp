#include "host_sim/sources/video_source.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "host_sim/sources/cropped_source.hpp"
#include "host_sim/sources/odometry_file.hpp"
#include "host_sim/sources/scaled_source.hpp"
#include "input_messages.hpp"
#include "quicktime_file.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

constexpr const char* kCamera = "fx: 250\nfy: 250\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n";

/// Options for a folder of grey pictures 0.png ... with the camera file.
VideoOptions pictures(const TemporaryFolder& folder, int count) {
  const cv::Mat image(240, 320, CV_8UC1, cv::Scalar(50));
  std::filesystem::create_directories(folder.path() / "pictures");
  for (int i = 0; i < count; ++i) {
    cv::imwrite((folder.path() / "pictures" / (std::to_string(i) + ".png")).string(), image);
  }
  VideoOptions options;
  options.media = folder.path() / "pictures";
  options.camera = folder.write("camera.yaml", kCamera);
  return options;
}

struct Ran {
  std::vector<int> numbers;
  std::vector<std::int64_t> t_us;
  SourceInfo info;
};

Ran run(FrameSource& source) {
  Ran ran;
  Frame frame;
  while (source.next(frame)) {
    ran.numbers.push_back(frame.number);
    ran.t_us.push_back(frame.t_us);
  }
  ran.info = source.info();
  return ran;
}

Ran run(const VideoOptions& options) {
  return run(*make_video_source(options));
}

VideoOptions video(const TemporaryFolder& folder, const std::filesystem::path& media) {
  VideoOptions options;
  options.media = media;
  options.camera = folder.write("camera.yaml", kCamera);
  return options;
}

std::vector<cv::Mat> noise_frames() {
  std::vector<cv::Mat> frames(3);
  for (cv::Mat& frame : frames) {
    frame.create(240, 320, CV_8UC1);
    cv::randu(frame, 0, 255);
    cv::GaussianBlur(frame, frame, {5, 5}, 2);
  }
  return frames;
}

TEST(VideoSource, AGuessedCameraIsSaidToBeOne) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 3);
  options.hfov_deg = 60.0;
  EXPECT_THROW(make_video_source(options), UsageError);  // beside a camera file
  options.camera.clear();
  const auto source = make_video_source(options);
  const PinholeCamera<double>& camera = source->info().camera;
  EXPECT_NEAR(camera.fx, 277.13, 0.01);  // 160 px at 30 degrees
  EXPECT_EQ(camera.fy, camera.fx);
  EXPECT_EQ(camera.cx, 159.5);
  EXPECT_EQ(camera.height, 240);
  EXPECT_TRUE(says(source->info().warnings.at(0), {"no calibration", "guess", "--hfov 60", "277"}));
  EXPECT_TRUE(says(source->info().note, {"no calibration"}));
  EXPECT_EQ(run(*source).numbers.size(), 3U);
  options.hfov_deg.reset();
  EXPECT_THROW(make_video_source(options), UsageError);
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

TEST(VideoSource, FramesOfAVariableRateKeepTheirTimes) {
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

TEST(VideoSource, AnUprightVideoIsTurnedAndNeedsItsCalibration) {
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
  Frame frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_GT(frame.grey.at<std::uint8_t>(20, 120), 250);
  EXPECT_LT(frame.grey.at<std::uint8_t>(300, 120), 5);
}

TEST(VideoSource, ColourIsTurnedCroppedAndScaledAsTheGreyPicture) {
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

TEST(VideoSource, AFolderOfColourPicturesHasColourWhereItIsWanted) {
  const TemporaryFolder folder;
  const auto pictures = folder.path() / "pictures";
  std::filesystem::create_directory(pictures);
  for (const int red : {40, 220}) {
    const cv::Mat picture(240, 320, CV_8UC3, cv::Scalar(20, 60, red));
    cv::imwrite((pictures / (red == 40 ? "0.png" : "1.png")).string(), picture);
  }
  VideoOptions options;
  options.media = pictures;
  options.hfov_deg = 40.0;
  Frame frame;
  ASSERT_TRUE(make_video_source(options)->next(frame));
  EXPECT_TRUE(frame.colour.empty());
  options.colour = true;
  const auto source = make_video_source(options);
  for (const int red : {40, 220}) {
    ASSERT_TRUE(source->next(frame));
    ASSERT_EQ(frame.colour.size(), frame.grey.size());
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(100, 100), cv::Vec3b(20, 60, static_cast<uchar>(red)));
  }
}

TEST(VideoSource, TimesOfAContainerThatStandStillAreRefused) {
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
TEST(VideoSource, FramesThatWereKeptBackToTheEndHaveTimes) {
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

TEST(VideoSource, AVideoThatEndsEarlyIsSaidToBeDamaged) {
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

TEST(VideoSource, FramesThatDoNotDecodeLeaveAGapInNumbersAndTimes) {
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

TEST(VideoSource, RowsOfTimesAreDoubtedWhenFramesAreMissing) {
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

TEST(VideoSource, PicturesOfAnotherSizeOrDepthAreRefusedBeforeTheRun) {
  const TemporaryFolder folder;
  const VideoOptions options = pictures(folder, 3);
  cv::imwrite((options.media / "3.png").string(), cv::Mat(120, 160, CV_8UC1, cv::Scalar(9)));
  EXPECT_TRUE(
      says(message_of([&] { make_video_source(options); }), {"3.png", "320x240", "found 160x120"}));
  cv::imwrite((options.media / "3.png").string(), cv::Mat(240, 320, CV_16UC1, cv::Scalar(9)));
  EXPECT_TRUE(says(message_of([&] { make_video_source(options); }), {"3.png", "8 bits", "16"}));
}

TEST(VideoSource, RecordingsOfAnotherClockAreRefusedWithBothSpans) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 60);
  const auto odometry = [&](double offset, double unit) {
    std::string text = "t_s,speed_mps,yaw_rate_radps\n";
    for (int i = 0; i < 60; ++i) text += std::to_string(offset + unit * i / 30.0) + ",1,0\n";
    options.odometry = folder.write("odometry.csv", text);
    return message_of([&] { make_video_source(options); });
  };
  EXPECT_EQ(odometry(0.0, 1.0), "no error");
  EXPECT_TRUE(says(odometry(1.7e9, 1.0), {"odometry.csv", "0.000 s to 1.967 s", "1700000000.000"}));
  EXPECT_TRUE(says(odometry(-10.0, 1.0), {"odometry.csv", "-10.000 s to -8.033 s"}));
  EXPECT_TRUE(says(odometry(1.9, 1.0), {"odometry.csv", "1.900 s to 3.867 s"}));
  EXPECT_TRUE(says(odometry(0.0, 1000.0), {"odometry.csv", "33.3333 s", "unit"}));
  EXPECT_TRUE(says(odometry(0.0, 0.001), {"odometry.csv", "3.3e-05 s", "unit"}));
  options.odometry.clear();
  const auto truth = [&](double offset) {
    std::string text;
    for (int i = 0; i < 60; ++i) text += std::to_string(offset + i / 30.0) + " 0 0 1 0 0 0 1\n";
    options.truth = folder.write("truth.tum", text);
    return message_of([&] { make_video_source(options); });
  };
  EXPECT_EQ(truth(0.0), "no error");
  EXPECT_TRUE(says(truth(1.7e9), {"truth.tum", "0.000 s to 1.967 s", "1700000000.000 s"}));
}

TEST(VideoSource, WarnsWhereOdometryCoversAPartAlone) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 60);
  options.odometry = folder.write(
      "odometry.csv", "t_s,speed_mps,yaw_rate_radps\n0,1,0\n0.2,1,0\n0.4,1,0\n0.8,1,0\n");
  const auto source = make_video_source(options);
  ASSERT_EQ(source->info().warnings.size(), 1U);
  EXPECT_TRUE(says(source->info().warnings[0], {"odometry.csv", "51 %", "0.000 s to 0.800 s"}));
}

TEST(VideoSource, TruthBesideTheFramesIsSaid) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 3);
  options.times = folder.write("times.csv", "frame,t_s\n0,0\n1,0.1\n2,0.2\n");
  options.truth = folder.write("truth.tum", "0.05 0 0 1 0 0 0 1\n0.15 0 0 1 0 0 0 1\n");
  const Ran ran = run(options);
  EXPECT_TRUE(says(ran.info.warnings.at(0), {"truth.tum", "0 of 3 frames", "20 ms"}));
}

TEST(VideoSource, TimesInAnotherUnitAreRefused) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 3);
  options.times = folder.write("times.csv", "frame,t_s\n0,0\n1,33\n2,66\n");
  EXPECT_TRUE(says(message_of([&] { make_video_source(options); }), {"times.csv", "33 s", "unit"}));
  options.times = folder.write("times.csv", "frame,t_us\n0,0\n1,33000\n");
  EXPECT_TRUE(says(message_of([&] { run(options); }), {"times.csv", "frame 2", "0 to 1"}));
}

TEST(OdometryFile, SamplesOutsideTheDomainAreRefusedByLine) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) {
    return message_of([&] { read_odometry(folder.write("o.csv", text)); });
  };
  const std::string twist = "t_s,speed_mps,yaw_rate_radps\n0,1,0\n";
  const std::string steering = "t_s,speed_mps,steering_rad,wheelbase_m\n0,1,0,0.5\n";
  EXPECT_EQ(problem(twist + "0.1,-3,9.9\n"), "no error");
  EXPECT_EQ(problem(steering + "0.1,-0.3,1.4,0.5\n"), "no error");
  EXPECT_TRUE(says(problem(twist + "1,1,200\n"), {"o.csv:3", "yaw_rate_radps", "10", "200"}));
  EXPECT_TRUE(says(problem(twist + "1,500,0\n"), {"o.csv:3", "speed_mps", "100", "500"}));
  EXPECT_TRUE(says(problem(steering + "1,1,20,0.5\n"), {"o.csv:3", "steering_rad", "1.4", "20"}));
  EXPECT_TRUE(says(problem(twist + "0.9,1,5\n"), {"o.csv:3", "yaw_rate_radps", "4.5 rad"}));
  EXPECT_TRUE(says(problem(steering + "0.9,9,1.3,0.5\n"), {"o.csv:3", "steering_rad", "turn"}));
  EXPECT_TRUE(says(problem(steering + "1,1,0,0.6\n"), {"o.csv:3", "wheelbase_m", "same", "0.6"}));
  EXPECT_TRUE(says(problem("t_s,speed_mps,steering_rad,wheelbase_m\n0,1,0,-1\n"),
                   {"o.csv:2", "wheelbase_m", "above 0"}));
  EXPECT_TRUE(says(problem(twist + "0,1,0\n"), {"o.csv:3", "increasing", "0.000000 s"}));
  EXPECT_TRUE(says(problem(twist), {"o.csv", "two or more"}));
  EXPECT_TRUE(says(problem("t_s,speed_mps,steering_rad\n0,1,0\n"), {"o.csv:1", "wheelbase_m"}));
}

TEST(OdometryFile, UnitsOfTheHeaderAreConverted) {
  const TemporaryFolder folder;
  const OdometryFile odometry = read_odometry(
      folder.write("o.csv", "Yaw rate [deg/s],Speed (km/h),t_ms\n90,36,0\n-90,-36,500\n"));
  ASSERT_EQ(odometry.samples.size(), 2U);
  EXPECT_EQ(odometry.samples[1].t_us, 500000);
  EXPECT_FLOAT_EQ(odometry.samples[0].speed_mps, 10.0F);
  EXPECT_FLOAT_EQ(odometry.samples[1].turn, -1.5707963F);
  EXPECT_DOUBLE_EQ(odometry.model.period_s, 0.5);
}

TEST(ScaledSource, PictureAndCalibrationShrinkTogether) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 1);
  cv::Mat image(240, 320, CV_8UC1, cv::Scalar(0));
  cv::circle(image, {240, 60}, 12, cv::Scalar(255), cv::FILLED);
  cv::imwrite((options.media / "0.png").string(), image);
  const auto full = make_video_source(options);
  const auto small = scale_source(make_video_source(options), 0.3);
  Frame frame;
  ASSERT_TRUE(small->next(frame));
  EXPECT_EQ(frame.grey.size(), cv::Size(96, 72));
  EXPECT_EQ(small->info().camera.width, 96);
  EXPECT_EQ(small->info().camera.height, 72);
  // The disc is seen in the same direction.
  const cv::Moments m = cv::moments(frame.grey);
  const Vector3<double> ray = small->info().camera.unproject({m.m10 / m.m00, m.m01 / m.m00});
  const Vector3<double> expected = full->info().camera.unproject({240.0, 60.0});
  EXPECT_NEAR((ray - expected).norm(), 0.0, 5e-4);
  EXPECT_TRUE(says(small->info().note, {"320x240", "96x72"}));
  EXPECT_THROW(scale_source(make_video_source(options), 0.05), InputError);
}

TEST(ScaledSource, FitsEitherWayRound) {
  PinholeCamera<double> camera;
  camera.width = 1920;
  camera.height = 1080;
  EXPECT_DOUBLE_EQ(fitting_factor(camera, 1280, 960), 1280.0 / 1920.0);
  std::swap(camera.width, camera.height);
  EXPECT_DOUBLE_EQ(fitting_factor(camera, 1280, 960), 0.5);
  camera.width = 640;
  camera.height = 480;
  EXPECT_DOUBLE_EQ(fitting_factor(camera, 1280, 960), 1.0);
}

}  // namespace
}  // namespace cairn::host
