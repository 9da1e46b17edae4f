#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: pose and landmarks with their covariances, and the hash of all.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedPoseCovariance FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::error_covariance(
    std::uint32_t& saturations, bool with_shared) const {
  if constexpr (kWorld) {
    const auto of = [&](int i, int k) {
      return FixedVariance::from_raw(factor_.covariance(i, k, saturations));
    };
    detail::FixedMotionNoise taken_in;
    taken_in.start({{of(1, 1), of(2, 1), of(2, 2)}, of(1, 0), of(2, 0), of(0, 0)});
    taken_in.turn(convert<FixedOffset>(moved_[0], saturations),
                  convert<FixedOffset>(moved_[1], saturations), saturations);
    const auto both = [&](FixedVariance a, FixedVariance b) { return add(a, b, saturations); };
    const FixedCovariance2& a = taken_in.position();
    const FixedCovariance2& b = motion_.position();
    return {{both(a.xx, b.xx), both(a.xy, b.xy), both(a.yy, b.yy)},
            both(taken_in.x_heading(), motion_.x_heading()),
            both(taken_in.y_heading(), motion_.y_heading()),
            both(taken_in.heading(), motion_.heading())};
  }
  FixedPoseCovariance sum = motion_.about(vehicle(0), vehicle(1), saturations);
  const auto enter = [&](FixedVariance& to, FixedVariance shared, int i, int k) {
    const auto own = FixedVariance::from_raw(factor_.covariance(i, k, saturations));
    if (with_shared) to = add(to, shared, saturations);
    to = add(to, own, saturations);
  };
  enter(sum.heading, shared_.heading, 0, 0);
  enter(sum.x_heading, shared_.x_heading, 1, 0);
  enter(sum.y_heading, shared_.y_heading, 2, 0);
  enter(sum.position.xx, shared_.position.xx, 1, 1);
  enter(sum.position.xy, shared_.position.xy, 2, 1);
  enter(sum.position.yy, shared_.position.yy, 2, 2);
  return sum;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedPose FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::mean_pose() const {
  std::uint32_t none = 0;
  return {add(anchor_[0], x_[0], none), add(anchor_[1], x_[1], none), heading_};
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedLandmark FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::mean_landmark(int slot) const {
  std::uint32_t none = 0;
  return {add(anchor_[0], p_[slot][0], none), add(anchor_[1], p_[slot][1], none), {}};
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::pose(
    FixedPose& mean, FixedPoseCovariance& covariance) const {
  std::uint32_t none = 0;
  if (kWorld) {
    mean = mean_pose();
    covariance = error_covariance(none);
    return;
  }
  const detail::FixedMoments moments =
      detail::turned_point_moments(vehicle(0), vehicle(1), error_covariance(none), none);
  covariance = moments.covariance;
  for (int axis = 0; axis < 2; ++axis) {
    FixedCoordinate& to = axis == 0 ? mean.x : mean.y;
    to = add(anchor_[axis], multiply<FixedCoordinate>(x_[axis], moments.shrink, none), none);
  }
  mean.heading = heading_;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedPoseCovariance FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::own_pose_covariance() const {
  std::uint32_t none = 0;
  const FixedPoseCovariance own = error_covariance(none, false);
  if (kWorld) return own;
  return detail::turned_point_moments(vehicle(0), vehicle(1), own, none).covariance;
}

/// Covariance of three rows over the states, without odometry that waits and what all share.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCovariance3 FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::covariance_of(
    const detail::FixedStateRow (&rows)[3]) const {
  constexpr int kBits = 40;
  constexpr int kDown = 2 * kBits - FixedVariance::kFractionBits;
  std::uint32_t none = 0;
  std::int64_t sums[6] = {};
  for (int column = 0; column < factor_.size(); ++column) {
    std::int64_t v[3] = {};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < rows[i].count; ++k) {
        const int state = rows[i].state[k];
        if (column > state) continue;
        const std::int64_t part = rows[i].coefficient[k] * factor_.at(state, column);
        const int shift = kBits - rows[i].bits[k] - factor_.bits(state);
        v[i] = wide::add(v[i], wide::scale(part, shift, none), none);
      }
    }
    for (int i = 0, at = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j, ++at) {
        sums[at] = wide::add(sums[at], wide::multiply(v[i], v[j], kDown, none), none);
      }
    }
  }
  FixedVariance c[6];
  for (int k = 0; k < 6; ++k) c[k] = FixedVariance::from_raw(sums[k]);
  return {c[0], c[1], c[2], c[3], c[4], c[5]};
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
  FixedCovariance3 out = covariance_of(rows);
  const FixedCovariance2 waiting = waiting_noise(slot, none);
  out.xx = add(out.xx, waiting.xx, none);
  out.xy = add(out.xy, waiting.xy, none);
  out.yy = add(out.yy, waiting.yy, none);
  return out;
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
      exp_negative_44(wide::round_shift(error_covariance(none).heading.raw(), 1)));
  const auto with_height = [&](int axis, FixedLength by) {
    const auto turned = multiply<FixedVariance>(multiply<FixedVariance>(turn, rho, none), by, none);
    return add(factor_covariance(l + 2, l + axis), turned, none);
  };
  out.xz = with_height(0, -landmark_local(slot, 1));
  out.yz = with_height(1, landmark_local(slot, 0));
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
  const FixedLength x = landmark_local(slot, 0);
  const FixedLength y = landmark_local(slot, 1);
  detail::FixedMotionNoise turn;
  turn.widen(FixedVariance(), motion_.heading(), none);
  FixedPoseCovariance sum = turn.about(x, y, none);
  // What the deferred noise makes of a point is seen by its heading and by the point alone.
  const auto enter = [&](FixedVariance& to, FixedVariance shared, int i, int k) {
    const auto own = FixedVariance::from_raw(factor_.covariance(i, k, none));
    to = add(add(to, shared, none), own, none);
  };
  enter(sum.heading, shared_.heading, 0, 0);
  enter(sum.x_heading, shared_.x_heading, l, 0);
  enter(sum.y_heading, shared_.y_heading, l + 1, 0);
  enter(sum.position.xx, shared_.position.xx, l, l);
  enter(sum.position.xy, shared_.position.xy, l + 1, l);
  enter(sum.position.yy, shared_.position.yy, l + 1, l + 1);
  const detail::FixedMoments moments = detail::turned_point_moments(x, y, sum, none);
  FixedLandmark out;
  out.x = add(anchor_[0], multiply<FixedCoordinate>(p_[slot][0], moments.shrink, none), none);
  out.y = add(anchor_[1], multiply<FixedCoordinate>(p_[slot][1], moments.shrink, none), none);
  out.covariance = moments.covariance.position;
  return out;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::hash(Hash64& hash) const {
  hash.add(heading_.raw());
  for (int i = 0; i < 2; ++i) {
    hash.add(x_[i].raw());
    hash.add(anchor_[i].raw());
  }
  for (int slot = 0; slot < slots_.size(); ++slot) {
    hash.add(slots_.id(slot));
    for (int i = 0; i < LandmarkDim; ++i) hash.add(p_[slot][i].raw());
  }
  factor_.hash(hash);
  std::uint32_t none = 0;
  const FixedPoseCovariance c = error_covariance(none);
  for (const FixedVariance v :
       {c.heading, c.x_heading, c.y_heading, c.position.xx, c.position.xy, c.position.yy}) {
    hash.add(v.raw());
  }
  rest_.hash(hash);
  if (kWorld) {
    for (const FixedCoordinate moved : moved_) hash.add(moved.raw());
  }
  if (tilts()) {
    hash.add(tilt_.pitch.raw());
    hash.add(tilt_.roll.raw());
  }
  hash.add(saturations_);
}

}  // namespace cairn
