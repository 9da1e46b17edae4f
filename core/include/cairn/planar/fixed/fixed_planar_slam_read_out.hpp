#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"
#include "cairn/planar/fixed/map_frame.hpp"

// FixedPlanarSlam: pose and landmarks with their covariances, and the hash of all.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedLandmark FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::mean_landmark(int slot) const {
  return {state_.in_world(state_.landmark_at(slot, 0), 0),
          state_.in_world(state_.landmark_at(slot, 1), 1),
          {}};
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::pose(
    FixedPose& mean, FixedPoseCovariance& covariance) const {
  std::uint32_t none = 0;
  mean = mean_pose();
  covariance = errors_.pose_covariance(state_, none);
  if (kWorld) return;
  const detail::FixedMoments moments =
      detail::turned_point_moments(state_.vehicle(0), state_.vehicle(1), covariance, none);
  covariance = moments.covariance;
  for (int axis = 0; axis < 2; ++axis) {
    FixedCoordinate& to = axis == 0 ? mean.x : mean.y;
    to = state_.in_world(multiply<FixedCoordinate>(state_.vehicle_at(axis), moments.shrink, none),
                         axis);
  }
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedPoseCovariance FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::own_pose_covariance() const {
  std::uint32_t none = 0;
  const FixedPoseCovariance own = errors_.pose_covariance(state_, none, false);
  if (kWorld) return own;
  return detail::turned_point_moments(state_.vehicle(0), state_.vehicle(1), own, none).covariance;
}

/// Of odometry's noise the vehicle's own counts, as in PlanarSlam::framed_pose_covariance().
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedPoseCovariance FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::framed_pose_covariance(
    LandmarkId origin, LandmarkId ahead) const {
  std::uint32_t none = 0;
  const int slots[2] = {find(origin), find(ahead)};
  if (slots[0] < 0 || slots[1] < 0) return {};
  const detail::FixedMapFrame<State> frame(state_, slots[0], slots[1]);
  FixedLength lambda[2];
  if (!frame.place(state_.vehicle_at(0), state_.vehicle_at(1), lambda, none)) return {};
  detail::FixedStateRow rows[3];
  frame.pose_rows(lambda, rows);
  const FixedCovariance3 own = errors_.covariance_of(rows);
  const detail::FixedMotionNoise& motion = errors_.motion();
  const FixedCovariance2& waiting = motion.position();
  const auto both = [&](FixedVariance x, FixedVariance y) { return add(x, y, none); };
  return {{both(own.xx, waiting.xx), both(own.xy, waiting.xy), both(own.yy, waiting.yy)},
          both(own.xz, motion.x_heading()),
          both(own.yz, motion.y_heading()),
          both(own.zz, motion.heading())};
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCovariance3 FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::relative_landmark_covariance(
    int slot) const {
  std::uint32_t none = 0;
  detail::FixedStateRow rows[3];
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    rows[axis].add(state_of(slot) + axis, 1, 0);
    if (axis < 2) rows[axis].add(1 + axis, -1, 0);
  }
  FixedCovariance3 out = errors_.covariance_of(rows);
  const FixedCovariance2 waiting = errors_.waiting_noise(state_, slot, none);
  out.xx = add(out.xx, waiting.xx, none);
  out.xy = add(out.xy, waiting.xy, none);
  out.yy = add(out.yy, waiting.yy, none);
  return out;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedVariance FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::landmark_height_variance(
    int slot) const {
  if (LandmarkDim == 2) return {};
  return factor_covariance(state_of(slot) + 2, state_of(slot) + 2);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCovariance3 FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::landmark_covariance(
    int slot) const {
  std::uint32_t none = 0;
  const FixedCovariance2 plane = landmark(slot).covariance;
  FixedCovariance3 out = {plane.xx, plane.xy, plane.yy, {}, {}, landmark_height_variance(slot)};
  if (LandmarkDim != 3 || kWorld) return out;
  const int l = state_of(slot);
  const FixedVariance turn = factor_covariance(l + 2, 0);
  const FixedVariance rho = FixedVariance::from_raw(
      exp_negative_44(wide::round_shift(errors_.pose_covariance(state_, none).heading.raw(), 1)));
  const auto with_height = [&](int axis, FixedLength by) {
    const auto turned = multiply<FixedVariance>(multiply<FixedVariance>(turn, rho, none), by, none);
    return add(factor_covariance(l + 2, l + axis), turned, none);
  };
  out.xz = with_height(0, -state_.landmark(slot, 1));
  out.yz = with_height(1, state_.landmark(slot, 0));
  return out;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedLandmark FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::landmark(int slot) const {
  std::uint32_t none = 0;
  const int l = state_of(slot);
  if (kWorld) {
    FixedLandmark own = mean_landmark(slot);
    own.covariance = {factor_covariance(l, l), factor_covariance(l + 1, l),
                      factor_covariance(l + 1, l + 1)};
    return own;
  }
  const detail::FixedMoments moments =
      detail::turned_point_moments(state_.landmark(slot, 0), state_.landmark(slot, 1),
                                   errors_.landmark_covariance(state_, slot), none);
  const auto mean = [&](int axis) {
    return state_.in_world(
        multiply<FixedCoordinate>(state_.landmark_at(slot, axis), moments.shrink, none), axis);
  };
  return {mean(0), mean(1), moments.covariance.position};
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::hash(Hash64& hash) const {
  state_.hash_pose(hash);
  errors_.factor().hash(hash);
  std::uint32_t none = 0;
  const FixedPoseCovariance c = errors_.pose_covariance(state_, none);
  for (const FixedVariance v :
       {c.heading, c.x_heading, c.y_heading, c.position.xx, c.position.xy, c.position.yy}) {
    hash.add(v.raw());
  }
  rest_.hash(hash);
  if (kWorld) errors_.hash_moved(hash);
  if (tilts()) {
    hash.add(state_.tilt().pitch.raw());
    hash.add(state_.tilt().roll.raw());
  }
  hash.add(saturations_);
}

}  // namespace cairn
