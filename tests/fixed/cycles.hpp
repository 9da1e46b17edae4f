#pragma once

#include "cairn/planar/fixed/fixed_group_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

// The update cycles of planar_cycles.hpp, 5 odometry steps and 1 update of 8 landmarks, for the
// filter without floating point and for its like in float.

namespace cairn::planar_test {

inline constexpr int kFixedMapLandmarks = 30;

template <class Filter>
struct FixedCycles;

template <>
struct FixedCycles<FixedGroupSlam<kFixedMapLandmarks>> {
  static constexpr int kSeen = 8;
  FixedGroupSlam<kFixedMapLandmarks> filter;
  FixedPointObservation points[kSeen];
  FixedIncrement increment;

  bool start(int landmarks) {
    FixedPlanarParameters parameters;
    parameters.gate = FixedScore::most();
    FixedPoseCovariance covariance;
    constexpr FixedVariance kVariance = FixedVariance::nearest(0.01);
    covariance.position = {kVariance, {}, kVariance};
    covariance.heading = kVariance;
    bool good = ok(filter.initialise({}, covariance, parameters));
    for (int i = 0; i < landmarks; ++i) good = good && ok(add(i));
    for (int k = 0; k < kSeen; ++k) points[k] = seen(k * landmarks / kSeen);
    increment.distance = kStep;
    increment.turn = kTurn;
    increment.distance_variance = kStepVariance;
    increment.turn_variance = kTurnVariance;
    return good;
  }
  bool predict() { return ok(filter.predict(increment)); }
  bool update() {
    FixedUpdateReport report;
    return ok(filter.update_points({points, kSeen}, report)) && report.nis_dof == 2 * kSeen;
  }

 private:
  static constexpr FixedLength kX = FixedLength::nearest(3.0);
  static constexpr FixedLength kXStep = FixedLength::nearest(0.1);
  static constexpr FixedLength kY = FixedLength::nearest(-2.0);
  static constexpr FixedLength kYStep = FixedLength::nearest(0.4);
  static constexpr FixedOffset kStep = FixedOffset::nearest(0.002);
  static constexpr FixedAngle kTurn = FixedAngle::nearest(4e-5);
  static constexpr FixedVariance kStepVariance = FixedVariance::nearest(2.5e-5);
  static constexpr FixedVariance kTurnVariance = FixedVariance::nearest(1.45e-8);

  static FixedPointObservation seen(int i) {
    FixedPointObservation point;
    point.id = static_cast<LandmarkId>(i + 1);
    point.x = FixedLength::from_raw(kX.raw() + kXStep.raw() * (i % 7));
    point.y = FixedLength::from_raw(kY.raw() + kYStep.raw() * (i % 11));
    constexpr FixedVariance kVariance = FixedVariance::nearest(0.01);
    point.noise = {kVariance, {}, kVariance};
    return point;
  }
  Status add(int i) {
    const FixedPointObservation point = seen(i);
    return filter.add_landmark(point.id, point.x, point.y, point.noise);
  }
};

template <>
struct FixedCycles<GroupIekfSlam<float, kFixedMapLandmarks>> {
  static constexpr int kSeen = 8;
  GroupIekfSlam<float, kFixedMapLandmarks> filter;
  PointObservation<float> points[kSeen];
  PlanarIncrement<float> increment;

  bool start(int landmarks) {
    PlanarParameters<float> parameters;
    parameters.gate = 1e6F;
    bool good = ok(filter.initialise({}, Matrix3<float>::Identity() * 0.01F, parameters));
    for (int i = 0; i < landmarks; ++i) {
      const PointObservation<float> point = seen(i);
      good = good && ok(filter.add_landmark(point.id, point.y, point.R));
    }
    for (int k = 0; k < kSeen; ++k) points[k] = seen(k * landmarks / kSeen);
    increment.distance_m = 0.002F;
    increment.turn_rad = 4e-5F;
    increment.covariance << 2.5e-5F, 0.0F, 0.0F, 1.45e-8F;
    return good;
  }
  bool predict() { return ok(filter.predict(increment)); }
  bool update() {
    UpdateReport report;
    return ok(filter.update_points({points, kSeen}, report)) && report.nis_dof == 2 * kSeen;
  }

 private:
  static PointObservation<float> seen(int i) {
    PointObservation<float> point;
    point.id = static_cast<LandmarkId>(i + 1);
    point.y = {3.0F + 0.1F * static_cast<float>(i % 7), -2.0F + 0.4F * static_cast<float>(i % 11)};
    point.R = Matrix2<float>::Identity() * 0.01F;
    return point;
  }
};

}  // namespace cairn::planar_test
