#include "host_sim/sources/video_source.hpp"

#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host_sim/sources/scaled_source.hpp"
#include "input_messages.hpp"
#include "plane_scene.hpp"
#include "temporary_folder.hpp"
#include "video_options.hpp"

namespace cairn::host {
namespace {

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
  const std::string header = "t_s,speed_mps,steering_rad,wheelbase_m\n";
  const std::string later = "1.02,1,0.1,0.5\n1.05,1,0.2,0.5\n1.08,1,0.3,0.5\n";
  options.odometry = folder.write("odometry.csv", header + "0.96,1,0,0.5\n0.99,1,0,0.5\n" + later);
  options.truth = folder.write("truth.tum", "1.0 0 0 1 0 0 0 1\n1.05 0.05 0 1 0 0 0 1\n");
  const auto source = make_video_source(options);
  EXPECT_EQ(source->info().frame_count, 3);
  ASSERT_TRUE(source->info().odometry.has_value());
  EXPECT_EQ(source->info().odometry->wheelbase_m, 0.5);
  Frame frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_EQ(frame.number, 7);
  ASSERT_EQ(frame.odometry.size(), 1U) << "how the vehicle comes";
  EXPECT_EQ(frame.odometry[0].t_us, 990000);
  ASSERT_TRUE(source->next(frame));
  EXPECT_EQ(frame.t_us, 1050000);
  ASSERT_EQ(frame.odometry.size(), 2U);
  EXPECT_FLOAT_EQ(frame.odometry[1].turn, 0.2F);
  EXPECT_NEAR(frame.true_T_world_camera->translation.x(), 0.05, 1e-12);
  ASSERT_TRUE(source->next(frame));
  EXPECT_FALSE(frame.true_T_world_camera.has_value());
  EXPECT_FALSE(source->next(frame));
  options.odometry = folder.write("odometry.csv", header + "0.7,1,0,0.5\n" + later);
  ASSERT_TRUE(make_video_source(options)->next(frame));
  EXPECT_TRUE(frame.odometry.empty()) << "0.3 s before the first frame says nothing of it";

  options.times = folder.write("times.csv", "frame,t_us\n7,1000000\n8,999\n");
  EXPECT_TRUE(says(message_of([&] { make_video_source(options); }), {"times.csv:3", "increasing"}));
  options.times = folder.write("times.csv", "frame,t_us\n8,999\n");
  EXPECT_TRUE(
      says(message_of([&] { make_video_source(options)->next(frame); }), {"times.csv", "frame 7"}));
  options.camera.clear();
  EXPECT_THROW(make_video_source(options), UsageError);
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

/// GIVEN pictures of a wall 3 m ahead, from a camera that moves sideways.
class SceneOfAVideo : public ::testing::Test {
 protected:
  static constexpr double kDepth = 3.0;
  static constexpr int kFrames = 10;

  SceneOfAVideo() {
    const PinholeCamera<double> camera = test::small_camera();
    std::filesystem::create_directories(folder_.path() / "pictures");
    std::string truth;
    for (int k = 0; k < kFrames; ++k) {
      const Rigid<double> T{Quaternion<double>::Identity(), {0.05 * k, 0.0, 0.0}};
      auto pixels = test::PlaneScene(kDepth).render(camera, T);
      const cv::Mat picture(camera.height, camera.width, CV_8UC1, pixels.data());
      cv::imwrite((folder_.path() / "pictures" / fmt::format("{}.png", k)).string(), picture);
      truth += fmt::format("{} {} 0 0 0 0 0 1\n", 0.1 * k, T.translation.x());
    }
    std::string times = "frame,t_s\n";
    for (int k = 0; k < kFrames; ++k) times += fmt::format("{},{}\n", k, 0.1 * k);
    options_.media = folder_.path() / "pictures";
    options_.camera = folder_.write(
        "camera.yaml",
        fmt::format("fx: {}\nfy: {}\ncx: {}\ncy: {}\nwidth: {}\nheight: {}\n", camera.fx, camera.fy,
                    camera.cx, camera.cy, camera.width, camera.height));
    options_.times = folder_.write("times.csv", times);
    options_.truth = folder_.write("truth.tum", truth);
    options_.scene_points = true;
  }

  TemporaryFolder folder_;
  VideoOptions options_;
};

TEST_F(SceneOfAVideo, HasPointsWhereTheyAre) {
  const auto source = make_video_source(options_);
  EXPECT_TRUE(says(source->info().note, {"scene points", "true poses"}));
  std::map<std::uint32_t, int> views;
  Frame frame;
  for (int k = 0; k < kFrames; ++k) {
    ASSERT_TRUE(source->next(frame));
    EXPECT_GE(frame.scene_points.size(), 10U) << "frame " << k;
    for (const ScenePointView& point : frame.scene_points) {
      ++views[point.id];
      EXPECT_NEAR(point.p_camera.z(), kDepth, 0.1);
      Vector2<double> pixel;
      ASSERT_TRUE(ok(source->info().camera.project(point.p_camera, pixel)));
      EXPECT_LT((pixel - point.pixel).norm(), 0.5);
    }
  }
  EXPECT_GE(views.size(), 20U);
  for (const auto& [id, count] : views) EXPECT_GE(count, 5) << id;
}

TEST_F(SceneOfAVideo, HasNoneWhereTheTruthIsMissing) {
  options_.truth = folder_.write("truth.tum", "0 0 0 0 0 0 0 1\n0.1 0.05 0 0 0 0 0 1\n");
  const auto source = make_video_source(options_);
  EXPECT_TRUE(says(source->info().warnings.back(), {"--scene-points", "no point", "truth.tum"}));
  Frame frame;
  while (source->next(frame)) EXPECT_TRUE(frame.scene_points.empty());
  options_.truth.clear();
  EXPECT_THROW(make_video_source(options_), UsageError);
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

TEST(VideoSource, WarnsWhereMorePicturesAreMissingThanThere) {
  const TemporaryFolder folder;
  const VideoOptions options = pictures(folder, 8);
  EXPECT_TRUE(make_video_source(options)->info().warnings.empty());
  std::filesystem::rename(options.media / "7.png", options.media / "12.png");
  EXPECT_TRUE(make_video_source(options)->info().warnings.empty());
  std::filesystem::rename(options.media / "12.png", options.media / "9999.png");
  const auto source = make_video_source(options);
  ASSERT_EQ(source->info().warnings.size(), 1U);
  EXPECT_TRUE(says(source->info().warnings[0], {"333.1 s", "between frames 6 and 9999"}));
}

TEST(VideoSource, WarnsWhereTheTruthMovesTooFast) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 3);
  options.truth =
      folder.write("truth.tum", "0 1 0 0 0 0 0 1\n0.033 1000 0 0 0 0 0 1\n0.067 1 0 0 0 0 0 1\n");
  const auto source = make_video_source(options);
  ASSERT_EQ(source->info().warnings.size(), 1U);
  EXPECT_TRUE(says(source->info().warnings[0], {"truth.tum", "999 m within 0.033 s", "not in m"}));
}

TEST(VideoSource, TruthBesideTheFramesIsSaid) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 3);
  options.times = folder.write("times.csv", "frame,t_s\n0,0\n1,0.1\n2,0.2\n");
  options.truth = folder.write("truth.tum", "0.05 0 0 1 0 0 0 1\n0.15 0 0 1 0 0 0 1\n");
  const Ran ran = run(options);
  EXPECT_TRUE(says(ran.info.warnings.at(0), {"truth.tum", "0 of 3 frames", "20 ms"}));
  // Frame numbers in place of times meet the first frame alone.
  options.truth = folder.write("truth.tum", "0 0 0 1 0 0 0 1\n1 0 0 1 0 0 0 1\n2 0 0 1 0 0 0 1\n");
  const Ran numbers = run(options);
  EXPECT_TRUE(says(numbers.info.warnings.at(0), {"truth.tum", "1 of 3 frames"}));
}

TEST(VideoSource, TimesInAnotherUnitAreRefused) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 3);
  options.times = folder.write("times.csv", "frame,t_s\n0,0\n1,33\n2,66\n");
  EXPECT_TRUE(says(message_of([&] { make_video_source(options); }), {"times.csv", "33 s", "unit"}));
  options.times = folder.write("times.csv", "frame,t_us\n0,0\n1,33000\n");
  EXPECT_TRUE(says(message_of([&] { run(options); }), {"times.csv", "frame 2", "0 to 1"}));
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
