#pragma once

#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/tracked_landmarks.hpp"

namespace cairn {

/// Until a map has its first landmark, odometry alone turns the vehicle, and what it errs by then
/// stays in the heading. Seeds have seen the turn meanwhile: theirs is taken where they are far
/// surer of it and do not contradict odometry.
class StartHeading {
 public:
  /// At the first keyframe, if the map has no landmark yet. `Estimate`: VehicleEstimate.
  template <class Estimate>
  void begin(const Estimate& estimate) {
    then_rad_ = estimate.landmarks().size() == 0 ? estimate.filter().mean_pose().heading : kUnknown;
    then_variance_ = estimate.filter().own_pose_covariance()(2, 2);
  }
  /// That keyframe is gone.
  void forget() { then_rad_ = kUnknown; }

  /// While there is no landmark: turns the vehicle as the seeds saw it turn since the first of
  /// `keyframes`, that of begin(). `Numbers`: VehicleNumbers, `Seeds`: SeedPool.
  template <class Numbers, class Seeds, class Keyframes, class Estimate>
  void take(Seeds& seeds, const Keyframes& keyframes, Estimate& estimate);

 private:
  static constexpr float kUnknown = 10.0F;

  float then_rad_ = kUnknown;
  float then_variance_ = 0.0F;  ///< a map that begins after a gap does so with an unsure heading
};

template <class Numbers, class Seeds, class Keyframes, class Estimate>
void StartHeading::take(Seeds& seeds, const Keyframes& keyframes, Estimate& estimate) {
  // On real drives a vehicle that slips, or travels beside its camera's axis, turns the seeds by
  // some of their sigmas: ten times surer leaves odometry where it is nearly as good.
  constexpr float kSurer = 100.0F;  // of variances
  constexpr float kHonest = 4.0F;
  constexpr float kContradiction = 9.0F;  // of variances: one of the two is wrong
  constexpr float kAnywhere_m2 = 1e6F;
  if (then_rad_ == kUnknown || keyframes.empty()) return;
  if (estimate.landmarks().size() > 0) return forget();
  auto& filter = estimate.filter();
  Quaternion<float> now_then;
  float variance = 0.0F;
  const float by_odometry = filter.own_pose_covariance()(2, 2) - then_variance_;
  if (!seeds.turn_since(keyframes[0], now_then, variance) || !(kSurer * variance < by_odometry)) {
    return;
  }
  const Quaternion<float>& mount = estimate.T_vehicle_camera().rotation;
  const Vector3<float> ahead = mount.conjugate() * Vector3<float>::UnitX();
  const Vector3<float> ahead_then = mount * (now_then * ahead);
  PlanarPose<float> pose = filter.mean_pose();
  const float heading = wrap_angle(then_rad_ - atan2(ahead_then.y(), ahead_then.x()));
  const float turned = wrap_angle(heading - pose.heading);
  if (square(turned) > kContradiction * by_odometry) return;
  pose.heading = heading;
  static_cast<void>(filter.place(pose, kAnywhere_m2, kHonest * variance));
  seeds.stand_at(Numbers::T_world_camera(estimate));
}

}  // namespace cairn
