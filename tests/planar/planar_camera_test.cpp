#include <limits>

#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "planar_world.hpp"
#include "vga_camera.hpp"

namespace cairn {
namespace {

using planar_test::Drive;
using planar_test::make_drive;
using planar_test::start;
using planar_test::Step;
using planar_test::WorldSettings;

/// Camera on the vehicle: looking forward, then turned by yaw and pitch (down positive).
Rigid<double> mounting(double yaw, double pitch, const Vector3<double>& at) {
  const Eigen::Matrix3d turned = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix() *
                                 test::looking_ahead<double>();
  Rigid<double> T_vehicle_camera;
  T_vehicle_camera.rotation = Quaternion<double>(turned);
  T_vehicle_camera.translation = at;
  return T_vehicle_camera;
}

struct CameraRun {
  double final_error_m = 0;
  double heading_error_rad = 0;
  double scale = 0;
  double nis_per_dof = 0;
  int updates = 0;
  int refused = 0;
  int outliers = 0;
  int outliers_used = 0;
  int high_innovation = 0;
};

struct CameraSettings {
  double sigma_px = 1.0;
  double outlier_share = 0.0;
  double depth_noise = 0.1;
  Rigid<double> T_vehicle_camera = mounting(0, 0, Vector3<double>::Zero());
};

/// Points-only simulation: 60 landmarks with height, pixels at 2 Hz, new landmarks from a depth
/// with 10 % error.
template <class Filter>
CameraRun run_camera(Filter& filter, const Drive& drive, const CameraSettings& settings,
                     unsigned seed) {
  const PinholeCamera<double> camera = test::vga_camera<double>();
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<double> heights;
  for (std::size_t i = 0; i < drive.landmarks.size(); ++i) {
    heights.push_back(0.2 + 2.0 * uniform(generator));
  }
  const Rigid<double> T_camera_vehicle = settings.T_vehicle_camera.inverse();
  Random random(seed);
  CameraRun out;
  double nis = 0;
  int dof = 0;
  for (const Step& step : drive.steps) {
    EXPECT_TRUE(ok(filter.predict(drive.increment(step))));
    if (!step.update) continue;
    std::vector<PixelMatch<double>> matches;
    std::vector<bool> wrong;
    std::vector<std::pair<LandmarkId, Vector3<double>>> fresh;
    for (std::size_t i = 0; i < drive.landmarks.size(); ++i) {
      Vector3<double> body;
      body.head<2>() = planar_test::rotation(step.truth(2)).transpose() *
                       (drive.landmarks[i] - step.truth.head<2>());
      body.z() = heights[i];
      const Vector3<double> p = T_camera_vehicle * body;
      Vector2<double> pixel;
      if (p.z() < 0.8 || p.z() > 9.0 || !ok(camera.project(p, pixel))) continue;
      if (!camera.contains(pixel)) continue;
      pixel.x() += settings.sigma_px * normal(generator);
      pixel.y() += settings.sigma_px * normal(generator);
      const auto id = static_cast<LandmarkId>(i + 1);
      const int slot = filter.find(id);
      if (slot < 0) {
        fresh.emplace_back(id,
                           Vector3<double>(pixel.x(), pixel.y(),
                                           p.z() * (1 + settings.depth_noise * normal(generator))));
        continue;
      }
      PixelMatch<double> match;
      match.id = id;
      match.slot = slot;
      match.pixel = pixel;
      const bool bad = uniform(generator) < settings.outlier_share;
      if (bad) {
        const double angle = 6.28 * uniform(generator);
        match.pixel += 25.0 * Vector2<double>(std::cos(angle), std::sin(angle));
      }
      matches.push_back(match);
      wrong.push_back(bad);
    }
    UpdateReport report;
    const Status status =
        filter.update_pixels(camera, settings.T_vehicle_camera, settings.sigma_px, matches.data(),
                             static_cast<int>(matches.size()), random, report);
    if (status == Status::kOk) {
      ++out.updates;
      nis += report.nis;
      dof += report.nis_dof;
      out.high_innovation += report.high_innovation;
      for (std::size_t k = 0; k < matches.size(); ++k) {
        out.outliers += wrong[k] ? 1 : 0;
        out.outliers_used += wrong[k] && matches[k].inlier ? 1 : 0;
      }
    } else {
      EXPECT_EQ(status, Status::kNoConsensus);
      ++out.refused;
    }
    for (const auto& [id, seen] : fresh) {
      const Vector3<double> ray = camera.unproject({seen.x(), seen.y()});
      Eigen::Matrix3d J;
      J << seen.z() / camera.fx, 0, ray.x(), 0, seen.z() / camera.fy, ray.y(), 0, 0, 1;
      const double sigma_z = settings.depth_noise * seen.z();
      const Eigen::Vector3d variances(settings.sigma_px * settings.sigma_px,
                                      settings.sigma_px * settings.sigma_px, sigma_z * sigma_z);
      const Eigen::Matrix3d rotation = settings.T_vehicle_camera.rotation.toRotationMatrix();
      Matrix3<double> noise =
          rotation * J * variances.asDiagonal() * J.transpose() * rotation.transpose();
      noise = (0.5 * (noise + noise.transpose())).eval();
      EXPECT_TRUE(ok(filter.add_landmark(id, settings.T_vehicle_camera * (seen.z() * ray), noise)));
    }
  }
  const Eigen::Vector3d truth = drive.steps.back().truth;
  out.final_error_m = (filter.pose().position - truth.head<2>()).norm();
  out.heading_error_rad = std::abs(planar_test::wrapped(filter.pose().heading - truth(2)));
  out.nis_per_dof = nis / dof;
  // Spread of the map over the spread of the true landmarks.
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_true = Eigen::Vector2d::Zero();
  const int n = filter.landmark_count();
  for (int slot = 0; slot < n; ++slot) {
    mean += filter.mean_landmark(slot).template head<2>() / n;
    mean_true += drive.landmarks[filter.landmark_id(slot) - 1] / n;
  }
  double spread = 0;
  double spread_true = 0;
  for (int slot = 0; slot < n; ++slot) {
    spread += (filter.mean_landmark(slot).template head<2>() - mean).squaredNorm();
    spread_true += (drive.landmarks[filter.landmark_id(slot) - 1] - mean_true).squaredNorm();
  }
  out.scale = std::sqrt(spread / spread_true);
  return out;
}

WorldSettings camera_world() {
  WorldSettings s;
  s.landmarks = 60;
  s.position_variance = 1e-6;
  s.heading_variance = 1e-6;
  return s;
}

using Group = GroupIekfSlam<double, 60, 3>;

TEST(PlanarCamera, MapKeepsItsScale) {
  double sum = 0;
  double nis = 0;
  const int runs = 20;
  for (int seed = 0; seed < runs; ++seed) {
    const Drive drive = make_drive(100 + seed, camera_world());
    Group filter;
    ASSERT_TRUE(ok(start(filter, drive)));
    const CameraRun run = run_camera(filter, drive, CameraSettings{}, seed);
    sum += run.scale / runs;
    nis += run.nis_per_dof / runs;
    EXPECT_LT(run.final_error_m, 0.5);
  }
  RecordProperty("scale_ppm", static_cast<int>(1e6 * sum));

  EXPECT_NEAR(sum, 1.0, 0.003);
  EXPECT_NEAR(nis, 1.0, 0.1);
}

TEST(PlanarCamera, AnyFixedMountingWorks) {
  CameraSettings settings;
  settings.T_vehicle_camera = mounting(0.4, 0.15, {0.2, -0.1, 0.6});
  for (int seed = 0; seed < 3; ++seed) {
    const Drive drive = make_drive(200 + seed, camera_world());
    Group filter;
    ASSERT_TRUE(ok(start(filter, drive)));
    const CameraRun run = run_camera(filter, drive, settings, seed);
    EXPECT_LT(run.final_error_m, 0.5);
    EXPECT_NEAR(run.scale, 1.0, 0.02);
  }
}

template <class Filter>
class PlanarCameraFilter : public ::testing::Test {};
using Filters = ::testing::Types<EkfSlam<double, 60, 3>, GroupIekfSlam<double, 60, 3>,
                                 LiftedIekfSlam<double, 60, 3>>;
TYPED_TEST_SUITE(PlanarCameraFilter, Filters, );

TYPED_TEST(PlanarCameraFilter, RejectsWrongMatches) {
  CameraSettings settings;
  settings.outlier_share = 0.2;
  WorldSettings world = camera_world();
  world.loops = 1;
  const Drive drive = make_drive(300, world);
  TypeParam filter;
  ASSERT_TRUE(ok(start(filter, drive)));
  const CameraRun run = run_camera(filter, drive, settings, 5);
  EXPECT_GT(run.outliers, 50);
  EXPECT_LT(run.outliers_used, run.outliers / 20);
  EXPECT_LT(run.final_error_m, 0.5);
  EXPECT_GT(run.high_innovation, 0);
}

TYPED_TEST(PlanarCameraFilter, WithoutConsensusTheStateIsEqualToTheBit) {
  WorldSettings world = camera_world();
  world.loops = 1;
  const Drive drive = make_drive(301, world);
  TypeParam filter;
  ASSERT_TRUE(ok(start(filter, drive)));
  run_camera(filter, drive, CameraSettings{}, 6);
  Hash64 before;
  filter.hash(before);
  const Rigid<double> mount = CameraSettings{}.T_vehicle_camera;
  const PinholeCamera<double> camera = test::vga_camera<double>();
  std::vector<PixelMatch<double>> matches;
  for (int slot = 0; slot < filter.landmark_count(); ++slot) {
    PixelPrediction<double> prediction;
    if (!ok(filter.predict_pixel(slot, camera, mount, 1.0, prediction))) continue;
    EXPECT_EQ(prediction.id, filter.landmark_id(slot));
    PixelMatch<double> match;
    match.id = prediction.id;
    match.slot = prediction.slot;
    // Each off in a direction of its own, inside its gate: no two agree.
    const double angle = 2.4 * static_cast<double>(matches.size());
    const double sigma = std::sqrt(prediction.covariance.diagonal().minCoeff());
    match.pixel =
        prediction.pixel + 3.0 * sigma * Vector2<double>(std::cos(angle), std::sin(angle));
    matches.push_back(match);
  }
  const int count = static_cast<int>(matches.size());
  Random random(1);
  UpdateReport report;
  EXPECT_EQ(filter.update_pixels(camera, mount, 0.2, matches.data(), count, random, report),
            Status::kNoConsensus);
  EXPECT_EQ(filter.update_pixels(camera, mount, -1.0, matches.data(), count, random, report),
            Status::kInvalidArgument);
  EXPECT_EQ(filter.update_pixels(camera, mount, 1.0, nullptr, 3, random, report),
            Status::kInvalidArgument);
  PinholeCamera<double> broken = camera;
  broken.fx = 0;
  EXPECT_EQ(filter.update_pixels(broken, mount, 1.0, matches.data(), count, random, report),
            Status::kBadConfig);
  PixelPrediction<double> prediction;
  EXPECT_EQ(filter.predict_pixel(filter.landmark_count(), camera, mount, 1.0, prediction),
            Status::kNotFound);
  Hash64 after;
  filter.hash(after);
  EXPECT_EQ(before.value(), after.value());
  EXPECT_GT(filter.health().ransac_no_consensus, 0U);
}

/// What lies on the floor is as far away as the camera's height says: the height corrects the
/// distance by what the two errors share.
TYPED_TEST(PlanarCameraFilter, TheHeightOfALandmarkDeterminesItsDistance) {
  TypeParam filter;
  ASSERT_TRUE(ok(start(filter, make_drive(303, camera_world()))));
  const Matrix3<double> before_pose = filter.pose_covariance();
  const Vector3<double> y(3.0, 0.5, 0.1);
  const Vector3<double> ray(3.0, 0.5, -0.9);  // from a camera 1 m above the ground
  const Matrix3<double> outer = ray * ray.transpose();
  const Matrix3<double> R =
      0.01 * outer + 1e-6 * Matrix3<double>::Identity();  // 10 % of the distance
  ASSERT_EQ(filter.add_landmark(7, y, R), Status::kOk);
  const Vector3<double> before = filter.mean_landmark(0);
  const Matrix3<double> P = filter.landmark_covariance(0);
  constexpr double kSigma = 0.02;
  ASSERT_EQ(filter.update_height(7, 0.0, kSigma, 3.84), Status::kOk);
  const Vector3<double> gain = P.col(2) / (P(2, 2) + kSigma * kSigma);
  EXPECT_LT((filter.mean_landmark(0) - (before - 0.1 * gain)).norm(), 1e-3);
  EXPECT_LT((filter.landmark_covariance(0) - (P - gain * P.row(2))).norm(), 1e-4);
  EXPECT_LT((filter.pose_covariance() - before_pose).norm(), 1e-6);
}

TYPED_TEST(PlanarCameraFilter, ARefusedHeightLeavesTheStateEqualToTheBit) {
  TypeParam filter;
  EXPECT_EQ(filter.update_height(7, 0.0, 0.02, 3.84), Status::kNotInitialised);
  ASSERT_TRUE(ok(start(filter, make_drive(303, camera_world()))));
  ASSERT_EQ(filter.add_landmark(7, {3.0, 0.5, 0.4}, 0.01 * Matrix3<double>::Identity()),
            Status::kOk);
  Hash64 before;
  filter.hash(before);
  EXPECT_EQ(filter.update_height(7, 0.0, 0.02, 3.84), Status::kGated);
  EXPECT_EQ(filter.update_height(8, 0.0, 0.02, 3.84), Status::kNotFound);
  EXPECT_EQ(filter.update_height(7, 0.0, 0.0, 3.84), Status::kInvalidArgument);
  EXPECT_EQ(filter.update_height(7, 0.0, 0.02, 0.0), Status::kInvalidArgument);
  EXPECT_EQ(filter.update_height(7, std::numeric_limits<double>::quiet_NaN(), 0.02, 3.84),
            Status::kNonFiniteInput);
  Hash64 after;
  filter.hash(after);
  EXPECT_EQ(before.value(), after.value());
}

/// Rows by the relative vector against differences of the projection, heading and pitch included.
TEST(PlanarCamera, RowsAgreeWithDifferences) {
  PinholeCamera<double> camera = test::vga_camera<double>();
  camera.k1 = -0.1;
  camera.p1 = 1e-3;
  CameraView<double> view(camera, mounting(0.3, 0.2, {0.3, 0.1, 0.5}), 1.0);
  sin_cos(0.8, view.frame.sine, view.frame.cosine);
  const RelativeCovariance<double> covariance;
  const double relative[3] = {2.4, 3.1, 1.3};
  LinearisedObservation<double, 3> pair;
  Vector3<double> p_camera;
  ASSERT_TRUE(view.linearise(relative, covariance, pair, p_camera));
  for (int k = 0; k < 3; ++k) {
    const double h = 1e-6;
    double up[3] = {relative[0], relative[1], relative[2]};
    double down[3] = {relative[0], relative[1], relative[2]};
    up[k] += h;
    down[k] -= h;
    Vector2<double> a;
    Vector2<double> b;
    ASSERT_TRUE(ok(camera.project(view.to_camera(up), a)));
    ASSERT_TRUE(ok(camera.project(view.to_camera(down), b)));
    for (int r = 0; r < 2; ++r) EXPECT_NEAR(pair.h[r][k], (a(r) - b(r)) / (2 * h), 1e-5);
  }
}

TEST(PlanarRangeBearing, RowsAgreeWithDifferences) {
  RelativeFrame<double> frame;
  sin_cos(-2.1, frame.sine, frame.cosine);
  const double relative[2] = {-1.4, 2.2};
  RangeBearingObservation<double> o;
  o.sigma_range = 0.1;
  o.sigma_bearing = 0.01;
  const RangeBearingSensor<double> sensor{0.35};
  const RelativeCovariance<double> none;
  LinearisedObservation<double, 2> pair;
  ASSERT_TRUE(sensor.linearise(o, frame, relative, none, pair));
  for (int k = 0; k < 2; ++k) {
    const double h = 1e-6;
    double up[2] = {relative[0], relative[1]};
    double down[2] = {relative[0], relative[1]};
    up[k] += h;
    down[k] -= h;
    LinearisedObservation<double, 2> a;
    LinearisedObservation<double, 2> b;
    ASSERT_TRUE(sensor.linearise(o, frame, up, none, a));
    ASSERT_TRUE(sensor.linearise(o, frame, down, none, b));
    for (int r = 0; r < 2; ++r) {
      EXPECT_NEAR(pair.h[r][k], -(a.innovation[r] - b.innovation[r]) / (2 * h), 1e-7);
    }
  }
}

/// The gauge: in the group filter the map as seen from the vehicle does not depend on the variance
/// of the absolute heading; in the EKF it does.
TEST(PlanarCamera, GroupFilterKeepsTheGauge) {
  const auto relative_map = [](auto& filter, double heading_variance) {
    WorldSettings world = camera_world();
    world.loops = 1;
    Drive drive = make_drive(302, world);
    drive.start_covariance(2, 2) = heading_variance;
    EXPECT_TRUE(ok(start(filter, drive)));
    run_camera(filter, drive, CameraSettings{}, 7);
    const auto pose = filter.mean_pose();
    std::vector<Eigen::Vector2d> out;
    for (int slot = 0; slot < filter.landmark_count(); ++slot) {
      const Eigen::Vector2d p = filter.mean_landmark(slot).template head<2>();
      out.push_back(planar_test::rotation(pose.heading).transpose() * (p - pose.position));
    }
    return out;
  };
  const auto largest_change = [&](auto sure, auto unsure) {
    const auto a = relative_map(sure, 1e-6);
    const auto b = relative_map(unsure, 0.3);
    double worst = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      worst = std::max(worst, (a[i] - b[i]).norm());
    }
    return worst;
  };
  EXPECT_LT(largest_change(Group{}, Group{}), 1e-6);
  EXPECT_GT(largest_change(EkfSlam<double, 60, 3>{}, EkfSlam<double, 60, 3>{}), 1e-3);
}

}  // namespace
}  // namespace cairn
