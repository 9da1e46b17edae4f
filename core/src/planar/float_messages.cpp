#include "cairn/planar/fixed/float_messages.hpp"

namespace cairn {
namespace {

using Count = std::uint32_t;

}  // namespace

FixedPose fixed_of(const PlanarPose<float>& pose, Count& saturations) {
  FixedPose out;
  out.x = fixed_of<FixedCoordinate>(pose.position.x(), saturations);
  out.y = fixed_of<FixedCoordinate>(pose.position.y(), saturations);
  const auto heading =
      fixed_of<Fixed<std::int64_t, FixedAngle::kFractionBits>>(pose.heading, saturations);
  out.heading = wrapped_angle(heading.raw());
  return out;
}

PlanarPose<float> float_of(const FixedPose& pose) {
  PlanarPose<float> out;
  out.position = {float_of(pose.x), float_of(pose.y)};
  out.heading = float_of(pose.heading);
  return out;
}

FixedCovariance2 fixed_of(const Matrix2<float>& covariance, Count& saturations) {
  const auto at = [&](int i, int j) {
    return fixed_of<FixedVariance>(covariance(i, j), saturations);
  };
  return {at(0, 0), at(1, 0), at(1, 1)};
}

Matrix2<float> float_of(const FixedCovariance2& covariance) {
  Matrix2<float> out;
  out(0, 0) = float_of(covariance.xx);
  out(1, 0) = out(0, 1) = float_of(covariance.xy);
  out(1, 1) = float_of(covariance.yy);
  return out;
}

FixedCovariance3 fixed_of(const Matrix3<float>& covariance, Count& saturations) {
  const auto at = [&](int i, int j) {
    return fixed_of<FixedVariance>(covariance(i, j), saturations);
  };
  return {at(0, 0), at(1, 0), at(1, 1), at(2, 0), at(2, 1), at(2, 2)};
}

Matrix3<float> float_of(const FixedCovariance3& c) {
  Matrix3<float> out;
  const FixedVariance* const lower[] = {&c.xx, &c.xy, &c.yy, &c.xz, &c.yz, &c.zz};
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) out(i, j) = out(j, i) = float_of(*lower[k++]);
  }
  return out;
}

FixedPoseCovariance fixed_pose_covariance_of(const Matrix3<float>& covariance, Count& saturations) {
  const FixedCovariance3 c = fixed_of(covariance, saturations);
  return {{c.xx, c.xy, c.yy}, c.xz, c.yz, c.zz};
}

Matrix3<float> float_of(const FixedPoseCovariance& c) {
  return float_of(FixedCovariance3{c.position.xx, c.position.xy, c.position.yy, c.x_heading,
                                   c.y_heading, c.heading});
}

FixedIncrement fixed_of(const PlanarIncrement<float>& increment, Count& saturations) {
  FixedIncrement out;
  out.distance = fixed_of<FixedOffset>(increment.distance_m, saturations);
  out.turn = fixed_of<FixedAngle>(increment.turn_rad, saturations);
  const FixedCovariance2 noise = fixed_of(increment.covariance, saturations);
  out.distance_variance = noise.xx;
  out.distance_turn = noise.xy;
  out.turn_variance = noise.yy;
  out.model = increment.model;
  return out;
}

FixedRansacParameters fixed_of(const OnePointRansacParameters& ransac, Count& saturations) {
  FixedRansacParameters out;
  out.probability = fixed_of<FixedRatio>(ransac.probability, saturations);
  out.max_hypotheses = ransac.max_hypotheses;
  out.min_inliers = ransac.min_inliers;
  out.min_inlier_share = fixed_of<FixedRatio>(ransac.min_inlier_share, saturations);
  return out;
}

FixedPlanarParameters fixed_of(const PlanarParameters<float>& parameters, Count& saturations) {
  FixedPlanarParameters out;
  out.gate = fixed_of<FixedScore>(parameters.gate, saturations);
  out.reacquire_after = parameters.reacquire_after;
  out.reacquire_steps = parameters.reacquire_steps;
  out.reacquire_position = fixed_of<FixedLength>(parameters.reacquire_position_m, saturations);
  out.reacquire_heading = fixed_of<FixedAngle>(parameters.reacquire_heading_rad, saturations);
  out.reacquire_landmark_after = parameters.reacquire_landmark_after;
  out.reacquire_landmark = fixed_of<FixedLength>(parameters.reacquire_landmark_m, saturations);
  out.replace_after = parameters.replace_after;
  out.rest_sigmas = fixed_of<FixedScore>(parameters.rest_sigmas, saturations);
  out.tilt.sigma_pitch = fixed_of<FixedAngle>(parameters.tilt.sigma_pitch_rad, saturations);
  out.tilt.sigma_roll = fixed_of<FixedAngle>(parameters.tilt.sigma_roll_rad, saturations);
  out.tilt.time_constant = fixed_of<FixedOffset>(parameters.tilt.time_constant_s, saturations);
  out.ransac = fixed_of(parameters.ransac, saturations);
  out.ransac_threshold = fixed_of<FixedScore>(parameters.ransac_threshold, saturations);
  out.rescue_gate = fixed_of<FixedScore>(parameters.rescue_gate, saturations);
  return out;
}

void float_of(const FixedPixelPrediction& expected, PixelPrediction<float>& out) {
  out.id = expected.id;
  out.slot = expected.slot;
  out.pixel = {float_of(expected.pixel[0]), float_of(expected.pixel[1])};
  out.covariance(0, 0) = float_of(expected.xx);
  out.covariance(1, 0) = out.covariance(0, 1) = float_of(expected.xy);
  out.covariance(1, 1) = float_of(expected.yy);
  for (int axis = 0; axis < 3; ++axis) out.p_camera(axis) = float_of(expected.p_camera[axis]);
}

}  // namespace cairn
