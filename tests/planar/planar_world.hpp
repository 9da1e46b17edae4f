#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Dense>

#include "cairn/numeric/math.hpp"
#include "cairn/planar/increment.hpp"
#include "cairn/planar/observation/point.hpp"
#include "cairn/planar/types.hpp"

namespace cairn::planar_test {

/// A small copy of paper A's experiment 4.1: 20 m x 20 m, a rounded square driven in 80 s,
/// Ackermann odometry at 10 Hz, Cartesian points within 6 m at 2 Hz.
struct WorldSettings {
  int landmarks = 20;
  int loops = 2;
  int steps_per_loop = 800;
  int steps_per_update = 5;
  double dt_s = 0.1;
  double wheelbase_m = 0.5;
  double speed = 0.55;
  double sigma_v = 0.05;
  double sigma_phi = 0.0349;
  double sigma_r = 0.1;
  double range_m = 6.0;
  double position_variance = 1.0;
  double heading_variance = 0.001;
  IncrementModel model = IncrementModel::kEuler;
};

struct Sighting {
  LandmarkId id = kNoLandmark;
  Eigen::Vector2d y = Eigen::Vector2d::Zero();
};

struct Step {
  double v = 0;
  double phi = 0;
  bool update = false;
  std::vector<Sighting> sightings;
  Eigen::Vector3d truth = Eigen::Vector3d::Zero();  ///< x, y, heading
};

struct Drive {
  WorldSettings settings;
  std::vector<Eigen::Vector2d> landmarks;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  Eigen::Vector3d start_estimate = Eigen::Vector3d::Zero();
  Eigen::Matrix3d start_covariance = Eigen::Matrix3d::Zero();
  std::vector<Step> steps;

  PlanarIncrement<double> increment(const Step& step) const {
    return ackermann_increment(step.v, step.phi, settings.dt_s, settings.wheelbase_m,
                               settings.sigma_v, settings.sigma_phi, settings.model);
  }
};

inline Eigen::Matrix2d rotation(double angle) {
  Eigen::Matrix2d r;
  r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return r;
}

inline double wrapped(double angle) {
  return std::remainder(angle, kTwoPi<double>);
}

inline Drive make_drive(unsigned seed, const WorldSettings& s = WorldSettings{}) {
  Drive drive;
  drive.settings = s;
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(-10.0, 10.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int i = 0; i < s.landmarks; ++i) {
    const double x = uniform(generator);
    drive.landmarks.emplace_back(x, uniform(generator));
  }
  const double turn_rate = kTwoPi<double> / (s.steps_per_loop * s.dt_s);
  Eigen::Vector3d x(0.0, -s.speed / turn_rate, 0.0);
  drive.start = x;
  drive.start_covariance =
      Eigen::Vector3d(s.position_variance, s.position_variance, s.heading_variance).asDiagonal();
  for (int i = 0; i < 3; ++i) {
    drive.start_estimate(i) = x(i) + std::sqrt(drive.start_covariance(i, i)) * normal(generator);
  }
  for (int k = 0; k < s.loops * s.steps_per_loop; ++k) {
    const double phase = kTwoPi<double> * (k + 0.5) / s.steps_per_loop;
    const double turn = turn_rate * s.dt_s * (1.0 + 0.6 * std::cos(4.0 * phase));
    const double phi = std::atan(turn * s.wheelbase_m / (s.dt_s * s.speed));
    const bool arc = s.model == IncrementModel::kExactArc;
    const double distance = s.dt_s * s.speed * (arc ? std::sin(0.5 * turn) / (0.5 * turn) : 1.0);
    const double direction = x(2) + (arc ? 0.5 * turn : 0.0);
    x(0) += distance * std::cos(direction);
    x(1) += distance * std::sin(direction);
    x(2) = wrapped(x(2) + turn);
    Step step;
    step.v = s.speed + s.sigma_v * normal(generator);
    step.phi = phi + s.sigma_phi * normal(generator);
    step.truth = x;
    step.update = k % s.steps_per_update == 0;
    for (int i = 0; step.update && i < s.landmarks; ++i) {
      const Eigen::Vector2d y = rotation(x(2)).transpose() * (drive.landmarks[i] - x.head<2>());
      if (y.norm() > s.range_m || y.norm() < 0.2) continue;
      Sighting sighting;
      sighting.id = static_cast<LandmarkId>(i + 1);
      const double e0 = normal(generator);
      sighting.y = y + s.sigma_r * Eigen::Vector2d(e0, normal(generator));
      step.sightings.push_back(sighting);
    }
    drive.steps.push_back(step);
  }
  return drive;
}

template <class T>
PlanarIncrement<T> cast_increment(const PlanarIncrement<double>& d) {
  PlanarIncrement<T> increment;
  increment.distance_m = static_cast<T>(d.distance_m);
  increment.turn_rad = static_cast<T>(d.turn_rad);
  increment.covariance = d.covariance.cast<T>();
  increment.covariance(1, 0) = increment.covariance(0, 1);
  increment.model = d.model;
  return increment;
}

/// Starts a filter where a drive does; `more` are further settings of its initialise().
template <class Filter, class... More>
Status start(Filter& filter, const Drive& drive,
             PlanarParameters<typename Filter::Scalar> parameters = {}, const More&... more) {
  using T = typename Filter::Scalar;
  PlanarPose<T> pose;
  pose.position = drive.start_estimate.template head<2>().cast<T>();
  pose.heading = static_cast<T>(drive.start_estimate(2));
  const Matrix3<T> covariance = drive.start_covariance.template cast<T>();
  return filter.initialise(pose, covariance, parameters, more...);
}

/// Noise covariance of a sighting: isotropic, which makes references in the two frames comparable.
inline Eigen::Matrix2d sighting_noise(const Drive& drive) {
  return drive.settings.sigma_r * drive.settings.sigma_r * Eigen::Matrix2d::Identity();
}

/// Feeds one step to a filter: prediction, update with what it knows, then the new landmarks.
template <class Filter>
UpdateReport feed(Filter& filter, const Drive& drive, const Step& step) {
  using T = typename Filter::Scalar;
  UpdateReport report;
  if (!ok(filter.predict(cast_increment<T>(drive.increment(step))))) ADD_FAILURE();
  if (!step.update) return report;
  std::vector<PointObservation<T>> points;
  for (const Sighting& s : step.sightings) {
    PointObservation<T> o;
    o.id = s.id;
    o.y = s.y.cast<T>();
    o.R = sighting_noise(drive).cast<T>();
    points.push_back(o);
  }
  const Span<PointObservation<T>> view(points.data(), static_cast<int>(points.size()));
  if (!ok(filter.update_points(view, report))) ADD_FAILURE();
  for (const PointObservation<T>& o : points) {
    if (filter.find(o.id) >= 0) continue;
    constexpr int kDim = Filter::kLandmarkDim;
    Vector<T, kDim> y = Vector<T, kDim>::Zero();
    Matrix<T, kDim, kDim> r = Matrix<T, kDim, kDim>::Identity();
    y.template head<2>() = o.y;
    r.template topLeftCorner<2, 2>() = o.R;
    if (!ok(filter.add_landmark(o.id, y, r))) ADD_FAILURE();
  }
  return report;
}

/// Settings without gate, for comparisons with ungated references.
template <class T>
PlanarParameters<T> ungated() {
  PlanarParameters<T> p;
  p.gate = static_cast<T>(1e9);
  return p;
}

}  // namespace cairn::planar_test
