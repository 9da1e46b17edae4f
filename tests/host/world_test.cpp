#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "cairn/base/hash.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/replay/scene_objects.hpp"
#include "host_sim/sources/hall_source.hpp"
#include "host_sim/world/drive.hpp"
#include "host_sim/world/hall.hpp"
#include "host_sim/world/renderer.hpp"

namespace cairn::host {
namespace {

TEST(LapDrive, ClosesItsLapAtConstantSpeed) {
  const LapDrive drive;
  EXPECT_NEAR(drive.speed_mps(), 0.55, 1e-12);
  const PlanarPose start = drive.pose_at_time(0.0);
  const PlanarPose end = drive.pose_at_time(80.0);
  EXPECT_NEAR(std::hypot(end.x_m - start.x_m, end.y_m - start.y_m), 0.0, 1e-6);
  EXPECT_NEAR(end.theta_rad - start.theta_rad, kTwoPi<double>, 1e-9);
  double length = 0.0;
  PlanarPose before = start;
  for (double t = 0.01; t <= 80.0 + 1e-9; t += 0.01) {
    const PlanarPose pose = drive.pose_at_time(t);
    const double step = std::hypot(pose.x_m - before.x_m, pose.y_m - before.y_m);
    EXPECT_NEAR(step, 0.0055, 1e-5) << t;
    const double along = std::atan2(pose.y_m - before.y_m, pose.x_m - before.x_m);
    EXPECT_NEAR(wrap_angle(along - 0.5 * (pose.theta_rad + before.theta_rad)), 0.0, 1e-4) << t;
    length += step;
    before = pose;
  }
  EXPECT_NEAR(length, 44.0, 1e-3);
}

/// A tracker that knows the truth: what augment() asks of one.
struct TrueDrive {
  Rigid<float> T_map_vehicle;
  PinholeCamera<float> camera;
  TrackingState state() const { return TrackingState::kTracking; }
};

bool find_object_place(const TrueDrive& drive, ObjectPlacement& placement, Rigid<float>& place) {
  place = drive.T_map_vehicle;
  place.translation = drive.T_map_vehicle * placement.p_vehicle_object;
  return true;
}

PinholeCamera<float> drawing_camera(const TrueDrive& drive) {
  return drive.camera;
}

TEST(Demo, AnObjectIsInViewInNearlyEveryFrameOfALap) {
  constexpr int kFrames = 2387;
  HallOptions options;
  const SourceInfo info = make_hall_source(options)->info();
  SceneObjects objects(kVehicleObjectHeight);
  const LapDrive laps;
  TrueDrive drive;
  drive.camera = {500.0F, 500.0F, 319.5F, 239.5F, 0, 0, 0, 0, 0, 640, 480};
  cv::Mat blank(480, 640, CV_8UC1);
  int in_view = 0;
  for (int k = 0; k < kFrames; ++k) {
    const Rigid<double> pose = to_rigid(laps.pose_at_time(k / 30.0));
    drive.T_map_vehicle = {pose.rotation.cast<float>(), pose.translation.cast<float>()};
    FrameReport report;
    const Rigid<double> T_world_camera = pose * info.T_vehicle_camera;
    report.T_map_camera = {T_world_camera.rotation.cast<float>(),
                           T_world_camera.translation.cast<float>()};
    blank.setTo(0);
    objects.draw(drive, to_mutable_view(blank), TickSource{}, report);
    in_view += cv::countNonZero(blank) > 20 ? 1 : 0;
  }
  EXPECT_GE(in_view, 0.95 * kFrames);
}

TEST(Renderer, ColoursAPictureByItsSurfaces) {
  const std::unique_ptr<FrameSource> source = make_hall_source([] {
    HallOptions options;
    options.colour = true;
    options.width = 320;
    return options;
  }());
  Frame frame;
  ASSERT_TRUE(source->next(frame));
  ASSERT_EQ(frame.colour.size(), frame.grey.size());
  ASSERT_EQ(frame.colour.type(), CV_8UC3);
  cv::Mat grey, channels[3], apart;
  cv::cvtColor(frame.colour, grey, cv::COLOR_BGR2GRAY);
  EXPECT_LT(cv::norm(grey, frame.grey, cv::NORM_L1) / static_cast<double>(grey.total()), 12.0);
  cv::split(frame.colour, channels);
  cv::absdiff(channels[0], channels[2], apart);
  EXPECT_GT(cv::mean(apart)[0], 4.0);
}

PinholeCamera<double> test_camera() {
  PinholeCamera<double> camera;
  camera.fx = camera.fy = 300.0;
  camera.cx = 159.5;
  camera.cy = 119.5;
  camera.width = 320;
  camera.height = 240;
  return camera;
}

/// A 4 m x 2 m wall in front of the camera, black left of its middle, white right of it.
Scene half_black_wall() {
  cv::Mat image(256, 512, CV_8UC1, cv::Scalar(0));
  image.colRange(256, 512).setTo(255);
  Scene scene;
  scene.textures.emplace_back(image);
  scene.quads.push_back({{-2.0, -1.0, 3.0}, {4.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, 0, 256});
  return scene;
}

/// Where intensity crosses one half along a row, linear between pixels.
double crossing(const cv::Mat& image, int y, int from, int to) {
  for (int x = from; x < to; ++x) {
    const double a = image.at<std::uint16_t>(y, x) / 16.0;
    const double b = image.at<std::uint16_t>(y, x + 1) / 16.0;
    if (a < 127.5 && b >= 127.5) return x + (127.5 - a) / (b - a);
  }
  return -1.0;
}

TEST(Renderer, EdgesAreWhereTheCameraProjectsThem) {
  const PinholeCamera<double> camera = test_camera();
  const Scene scene = half_black_wall();
  Renderer renderer(camera);
  cv::Mat image;
  double error_sum = 0.0;
  int count = 0;
  for (const double yaw : {0.0, 0.2, -0.3}) {
    for (const double shift : {0.0, 0.013, -0.4}) {
      const Rigid<double> T_world_camera{rotation_exp(Vector3<double>(0.0, yaw, 0.0)),
                                         {shift, 0.1, -0.5}};
      renderer.render(scene, T_world_camera, image);
      for (const double height : {-0.5, 0.0, 0.4}) {
        Vector2<double> pixel;
        const Vector3<double> p_camera =
            T_world_camera.inverse() * Vector3<double>(0.0, height, 3.0);
        ASSERT_TRUE(ok(camera.project(p_camera, pixel)));
        const int y = round_to_int(pixel.y());
        Vector2<double> on_row;  // the edge is vertical in the world: nearly so in the image
        const double slope = (y - pixel.y()) * p_camera.z() / camera.fy;
        ASSERT_TRUE(ok(camera.project(p_camera + Vector3<double>(0, slope, 0), on_row)));
        const int x = static_cast<int>(on_row.x());
        const double error = crossing(image, y, x - 4, x + 4) - on_row.x();
        error_sum += error;
        ++count;
        // The straight line between two pixels is not the edge's profile: up to 0.1 px, no bias.
        EXPECT_NEAR(error, 0.0, 0.12)
            << "yaw " << yaw << " shift " << shift << " height " << height;
        EXPECT_NEAR(static_cast<double>(renderer.inverse_depth(x, y)) * p_camera.z(), 1.0, 0.01);
      }
    }
  }
  EXPECT_NEAR(error_sum / count, 0.0, 0.03);
}

TEST(Renderer, NearSurfacesHideFarOnesAndBacksAreNotSeen) {
  const PinholeCamera<double> camera = test_camera();
  Scene scene = half_black_wall();
  scene.textures.emplace_back(cv::Mat(64, 64, CV_8UC1, cv::Scalar(100)));
  scene.quads.push_back({{-0.2, -0.2, 2.0}, {0.4, 0.0, 0.0}, {0.0, 0.4, 0.0}, 1, 256});
  scene.quads.push_back({{0.2, -0.2, 1.0}, {-0.4, 0.0, 0.0}, {0.0, 0.4, 0.0}, 1, 128});
  Renderer renderer(camera);
  cv::Mat image;
  renderer.render(scene, {}, image);
  EXPECT_EQ(image.at<std::uint16_t>(120, 160) / 16, 100);
  EXPECT_NEAR(renderer.inverse_depth(160, 120), 0.5F, 1e-4F);
  EXPECT_NEAR(renderer.inverse_depth(60, 120), 1.0F / 3.0F, 1e-4F);
}

std::uint64_t hash_of_frames(const HallOptions& options) {
  const auto source = make_hall_source(options);
  Hash64 hash;
  Frame frame;
  while (source->next(frame)) {
    hash.add_bytes(frame.grey.data, static_cast<int>(frame.grey.total()));
    for (const OdometrySample& sample : frame.odometry) {
      hash.add(sample.speed_mps);
      hash.add(sample.turn);
    }
  }
  return hash.value();
}

TEST(HallSource, RepeatsToTheByteAndFollowsItsSeed) {
  HallOptions options;
  options.width = 320;
  options.frame_count = 5;
  const std::uint64_t first = hash_of_frames(options);
  EXPECT_EQ(first, hash_of_frames(options));
  options.seed = 2;
  EXPECT_NE(first, hash_of_frames(options));
}

TEST(HallSource, TiltsTheBodyWhereAsked) {
  HallOptions options;
  options.width = 32;
  options.frame_count = 3000;
  options.tilt_rad = 0.01;
  const auto level = make_hall_source(HallOptions{});
  EXPECT_FALSE(level->info().tilt.tilts());
  const auto source = make_hall_source(options);
  EXPECT_EQ(source->info().tilt.sigma_roll_rad, 0.01);
  Frame frame;
  double squares[2] = {};
  double steps = 0.0;
  double before = 0.0;
  while (source->next(frame)) {
    const Rigid<double>& T = *frame.true_T_world_vehicle;
    const double pitch = -std::asin((T.rotation * Vector3<double>::UnitX()).z());
    const double roll = std::asin((T.rotation * Vector3<double>::UnitY()).z());
    squares[0] += pitch * pitch;
    squares[1] += roll * roll;
    if (frame.number > 0) steps += (pitch - before) * (pitch - before);
    before = pitch;
    const Rigid<double> T_vehicle_camera = T.inverse() * *frame.true_T_world_camera;
    EXPECT_LT((T_vehicle_camera.translation - source->info().T_vehicle_camera.translation).norm(),
              1e-12);
  }
  // 100 s of a process that returns in 0.5 s: some 100 independent values.
  EXPECT_NEAR(std::sqrt(squares[0] / 3000) / 0.01, 1.0, 0.2);
  EXPECT_NEAR(std::sqrt(squares[1] / 3000) / 0.01, 1.0, 0.2);
  EXPECT_NEAR(std::sqrt(steps / 3000) / 0.01, std::sqrt(2.0 * (1.0 - std::exp(-1.0 / 15.0))), 0.03);

  options.width = 320;
  options.frame_count = 5;
  EXPECT_EQ(hash_of_frames(options), hash_of_frames(options));
  const std::uint64_t tilted = hash_of_frames(options);
  options.tilt_rad = 0.0;
  EXPECT_NE(hash_of_frames(options), tilted);
}

TEST(HallSource, OdometryHasTheStatedNoiseAboutTheTruth) {
  HallOptions options;
  options.width = 32;
  options.frame_count = 2400;
  const auto source = make_hall_source(options);
  const OdometryModel model = *source->info().odometry;
  EXPECT_NEAR(model.speed_sigma_mps / std::sqrt(3.0), 0.1, 1e-9);
  EXPECT_NEAR(model.turn_sigma / std::sqrt(3.0), 5.0 * kPi<double> / 180.0, 1e-9);
  Frame frame;
  double speed_sum = 0.0, speed_square = 0.0, turn_square = 0.0;
  int count = 0;
  Rigid<double> before;
  while (source->next(frame)) {
    if (!frame.odometry.empty()) {
      const Rigid<double> step = before.inverse() * *frame.true_T_world_vehicle;
      const double turn = rotation_log(step.rotation).z();
      const double steering = std::atan(model.wheelbase_m * turn / (0.55 / 30.0));
      const double speed_error = static_cast<double>(frame.odometry[0].speed_mps) - 0.55;
      speed_sum += speed_error;
      speed_square += speed_error * speed_error;
      turn_square += std::pow(static_cast<double>(frame.odometry[0].turn) - steering, 2);
      ++count;
    }
    before = *frame.true_T_world_vehicle;
  }
  EXPECT_EQ(count, 2399);
  EXPECT_NEAR(speed_sum / count, 0.0, 4.0 * model.speed_sigma_mps / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(speed_square / count) / model.speed_sigma_mps, 1.0, 0.06);
  EXPECT_NEAR(std::sqrt(turn_square / count) / model.turn_sigma, 1.0, 0.06);
}

TEST(HallSource, EveryScenePointIsSeenInALap) {
  HallOptions options;
  options.width = 64;
  const auto source = make_hall_source(options);
  EXPECT_EQ(source->info().frame_count, 2387);
  Frame frame;
  int views[41] = {};
  while (source->next(frame)) {
    for (const ScenePointView& view : frame.scene_points) ++views[view.id];
  }
  for (int id = 1; id <= 40; ++id) EXPECT_GE(views[id], 100) << "point " << id;
  EXPECT_EQ(build_hall(1).scene_points.size(), 40U);
}

}  // namespace
}  // namespace cairn::host
