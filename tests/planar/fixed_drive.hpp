#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "cairn/numeric/random.hpp"
#include "cairn/planar/fixed/fixed_group_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

namespace cairn::planar_test {

using RingLandmark = std::pair<LandmarkId, Vector2<double>>;

/// Twelve landmarks about a drive that starts at (3, -4).
inline std::array<RingLandmark, 12> ring() {
  std::array<RingLandmark, 12> landmarks;
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.5 * i;
    landmarks[static_cast<std::size_t>(i)] = {
        static_cast<LandmarkId>(i + 1),
        Vector2<double>(3.0 + (6.0 + 0.3 * i) * std::cos(angle), 2.0 + 6.0 * std::sin(angle))};
  }
  return landmarks;
}

/// A drive past landmarks that the filter without floating point and its like in double share: both
/// get the same numbers, those that fit the formats.
template <class FixedFilter, class DoubleFilter>
class FixedDriveOf {
 public:
  /// `rest_sigmas`: 0 where every update counts.
  explicit FixedDriveOf(std::uint64_t seed, double gate = 1e9, double rest_sigmas = 4.0)
      : random_(seed) {
    const FixedVariance variances[3] = {FixedVariance::nearest(0.04), FixedVariance::nearest(0.01),
                                        FixedVariance::nearest(0.002)};
    FixedPoseCovariance covariance;
    covariance.position = {variances[0], {}, variances[1]};
    covariance.heading = variances[2];
    Matrix3<double> of_double = Matrix3<double>::Zero();
    for (int i = 0; i < 3; ++i) of_double(i, i) = variances[i].to_double();
    FixedPose pose;
    pose.x = FixedCoordinate::nearest(3.0);
    pose.y = FixedCoordinate::nearest(-4.0);
    pose.heading = FixedAngle::nearest(0.5);
    PlanarPose<double> start;
    start.position = {3.0, -4.0};
    start.heading = pose.heading.to_double();
    true_ = start;
    FixedPlanarParameters fixed_parameters;
    fixed_parameters.gate = FixedScore::nearest(gate);
    PlanarParameters<double> parameters;
    parameters.gate = gate;
    fixed_parameters.rest_sigmas = FixedScore::nearest(rest_sigmas);
    parameters.rest_sigmas = rest_sigmas;
    good_ = ok(fixed_->initialise(pose, covariance, fixed_parameters)) &&
            ok(double_->initialise(start, of_double, parameters));
  }

  bool good() const { return good_; }
  FixedFilter& fixed() { return *fixed_; }
  DoubleFilter& reference() { return *double_; }

  void move(double distance_m, double turn_rad, IncrementModel model) {
    FixedIncrement step;
    step.distance = FixedOffset::nearest(distance_m + 0.01 * normal());
    step.turn = FixedAngle::nearest(turn_rad + 0.01 * normal());
    step.distance_variance = FixedVariance::nearest(1e-4);
    step.distance_turn = FixedVariance::nearest(2e-5);
    step.turn_variance = FixedVariance::nearest(1e-4);
    step.model = model;
    const bool rests = distance_m == 0.0 && turn_rad == 0.0;
    if (rests) {
      step.distance = FixedOffset();
      step.turn = FixedAngle();
    }
    PlanarIncrement<double> increment;
    increment.distance_m = step.distance.to_double();
    increment.turn_rad = step.turn.to_double();
    increment.covariance << step.distance_variance.to_double(), step.distance_turn.to_double(),
        step.distance_turn.to_double(), step.turn_variance.to_double();
    increment.model = model;
    good_ = good_ && ok(fixed_->predict(step)) && ok(double_->predict(increment));
    true_.position +=
        distance_m * Vector2<double>(std::cos(true_.heading), std::sin(true_.heading));
    true_.heading = wrap_angle(true_.heading + turn_rad);
  }

  /// A sighting of landmark `id` by a point with correlated noise.
  void see_point(LandmarkId id, const Vector2<double>& landmark) {
    const Vector2<double> y = in_vehicle(landmark);
    FixedPointObservation seen;
    seen.id = id;
    seen.x = FixedLength::nearest(y.x() + 0.05 * normal());
    seen.y = FixedLength::nearest(y.y() + 0.05 * normal());
    seen.noise = {FixedVariance::nearest(0.004), FixedVariance::nearest(0.001),
                  FixedVariance::nearest(0.0025)};
    PointObservation<double> reference;
    reference.id = id;
    reference.y = {seen.x.to_double(), seen.y.to_double()};
    reference.R << seen.noise.xx.to_double(), seen.noise.xy.to_double(), seen.noise.xy.to_double(),
        seen.noise.yy.to_double();
    if (fixed_->find(id) < 0) {
      good_ = good_ && ok(fixed_->add_landmark(id, seen.x, seen.y, seen.noise)) &&
              ok(double_->add_landmark(id, reference.y, reference.R));
      return;
    }
    FixedUpdateReport fixed_report;
    UpdateReport report;
    good_ = good_ && ok(fixed_->update_points({&seen, 1}, fixed_report)) &&
            ok(double_->update_points({&reference, 1}, report)) &&
            fixed_report.nis_dof == report.nis_dof;
  }

  /// One sighting of several known landmarks by range and bearing.
  template <class Landmarks>
  void see_ranges(const Landmarks& landmarks, double sensor_offset_m, double wrong_rad = 0.0) {
    std::array<FixedRangeBearingObservation, 16> seen;
    std::array<RangeBearingObservation<double>, 16> reference;
    const FixedLength offset = FixedLength::nearest(sensor_offset_m);
    int count = 0;
    for (const auto& [id, position] : landmarks) {
      const Vector2<double> y = in_vehicle(position) - Vector2<double>(sensor_offset_m, 0.0);
      auto& o = seen[static_cast<std::size_t>(count)];
      o.id = id;
      o.range = FixedLength::nearest(y.norm() + 0.05 * normal());
      o.bearing =
          FixedAngle::nearest(wrap_angle(std::atan2(y.y(), y.x()) + 0.01 * normal() + wrong_rad));
      o.sigma_range = FixedLength::nearest(0.05);
      o.sigma_bearing = FixedAngle::nearest(0.01);
      auto& r = reference[static_cast<std::size_t>(count)];
      r = {id, o.range.to_double(), o.bearing.to_double(), o.sigma_range.to_double(),
           o.sigma_bearing.to_double()};
      ++count;
    }
    FixedUpdateReport fixed_report;
    UpdateReport report;
    good_ =
        good_ && ok(fixed_->update_range_bearing({seen.data(), count}, offset, fixed_report)) &&
        ok(double_->update_range_bearing({reference.data(), count}, offset.to_double(), report)) &&
        fixed_report.matches == report.matches && fixed_report.gated == report.gated &&
        std::abs(fixed_report.nis.to_double() - static_cast<double>(report.nis)) <
            1e-2 * (1.0 + static_cast<double>(report.nis));
  }

  /// Largest difference of the means, m and rad.
  double mean_difference() const {
    FixedPose pose;
    FixedPoseCovariance covariance;
    fixed_->pose(pose, covariance);
    const PlanarPose<double> expected = double_->pose();
    double largest = std::abs(wrap_angle(pose.heading.to_double() - expected.heading));
    largest = std::max(largest, std::abs(pose.x.to_double() - expected.position.x()));
    largest = std::max(largest, std::abs(pose.y.to_double() - expected.position.y()));
    for (int slot = 0; slot < fixed_->landmark_count(); ++slot) {
      const FixedLandmark landmark = fixed_->landmark(slot);
      const int other = double_->find(fixed_->landmark_id(slot));
      if (other < 0) return HUGE_VAL;
      const Vector2<double> p = double_->landmark_position(other);
      largest = std::max(largest, std::abs(landmark.x.to_double() - p.x()));
      largest = std::max(largest, std::abs(landmark.y.to_double() - p.y()));
    }
    return largest;
  }

  /// Largest difference of the covariances of pose and landmarks, as a share of the deviations.
  double covariance_difference() const {
    FixedPose pose;
    FixedPoseCovariance c;
    fixed_->pose(pose, c);
    Matrix3<double> fixed;
    fixed << c.position.xx.to_double(), c.position.xy.to_double(), c.x_heading.to_double(),
        c.position.xy.to_double(), c.position.yy.to_double(), c.y_heading.to_double(),
        c.x_heading.to_double(), c.y_heading.to_double(), c.heading.to_double();
    double largest = share(fixed, double_->pose_covariance());
    for (int slot = 0; slot < fixed_->landmark_count(); ++slot) {
      const FixedCovariance2 l = fixed_->landmark(slot).covariance;
      Matrix2<double> of_landmark;
      of_landmark << l.xx.to_double(), l.xy.to_double(), l.xy.to_double(), l.yy.to_double();
      const int other = double_->find(fixed_->landmark_id(slot));
      if (other < 0) return HUGE_VAL;
      largest = std::max(largest, share(of_landmark, double_->landmark_covariance(other)));
    }
    return largest;
  }

 private:
  template <class Matrix>
  static double share(const Matrix& a, const Matrix& b) {
    double largest = 0.0;
    for (int i = 0; i < b.rows(); ++i) {
      for (int j = 0; j < b.cols(); ++j) {
        largest = std::max(largest, std::abs(a(i, j) - b(i, j)) / std::sqrt(b(i, i) * b(j, j)));
      }
    }
    return largest;
  }
  Vector2<double> in_vehicle(const Vector2<double>& p) const {
    const Vector2<double> d = p - true_.position;
    const double c = std::cos(true_.heading);
    const double s = std::sin(true_.heading);
    return {c * d.x() + s * d.y(), c * d.y() - s * d.x()};
  }
  /// Near enough to a normal deviate.
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += random_.next() / 4294967296.0;
    return sum;
  }

  Random random_;
  PlanarPose<double> true_;
  std::unique_ptr<FixedFilter> fixed_ = std::make_unique<FixedFilter>();
  std::unique_ptr<DoubleFilter> double_ = std::make_unique<DoubleFilter>();
  bool good_ = false;
};

template <int MaxLandmarks>
using FixedDrive = FixedDriveOf<FixedGroupSlam<MaxLandmarks>, GroupIekfSlam<double, MaxLandmarks>>;

}  // namespace cairn::planar_test
