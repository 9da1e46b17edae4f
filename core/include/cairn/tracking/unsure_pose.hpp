#pragma once

#include <new>

#include "cairn/tracking/landmark_measurement.hpp"
#include "cairn/tracking/vehicle_estimate.hpp"
#include "cairn/tracking/vehicle_frame.hpp"

namespace cairn {

/// Search and update of a vehicle whose heading became unsure. A window is smaller than what such a
/// heading moves a landmark by, and within an unsure pose false matches agree: so frames search
/// from one heading after the other, and a pose on which matches agree counts once most of the
/// landmarks that are to be seen from it are found there.

/// The filter's pose becomes `pose`, as sure as the largest search windows allow, or by `share` of
/// that: until put_back(). A call of its own, as what follows: stack that the searches need.
template <class Filter>
__attribute__((noinline)) typename Filter::Placement look_from(VehicleEstimate<Filter>& estimate,
                                                               const PlanarPose<float>& pose,
                                                               float share) {
  constexpr float kSigmas = 4.3F;  // 99.99 %
  constexpr float kOfHeight = 0.25F;
  constexpr float kReach_px = PatchSearchParameters::kMaxHalfWindow;
  const float position_m = share * kOfHeight * estimate.T_vehicle_camera().translation.z();
  const float heading_rad = share * kReach_px / (kSigmas * estimate.camera().fx);
  return estimate.filter().place(pose, square(position_m), square(heading_rad));
}

/// Places the estimate where this frame's landmarks are to be searched from, for put_back(): at the
/// mean, and in the next frames turned to its sides in turn, as far as one standard deviation.
template <class Filter>
__attribute__((noinline)) typename Filter::Placement look_aside(VehicleEstimate<Filter>& estimate,
                                                                const TrackingMonitor& monitor) {
  constexpr float kStep_px = 1.8F * PatchSearchParameters::kMaxHalfWindow;
  const float step_rad = kStep_px / estimate.camera().fx;
  const float sigma_rad = sqrt(estimate.filter().own_pose_covariance()(2, 2));
  const int most = round_to_int((sigma_rad < kPi<float> ? sigma_rad : kPi<float>) / step_rad);
  const int look = monitor.weak_frames() % (2 * most + 1);
  const int steps = look % 2 == 1 ? (look + 1) / 2 : -look / 2;
  PlanarPose<float> pose = estimate.filter().mean_pose();
  pose.heading = wrap_angle(pose.heading + static_cast<float>(steps) * step_rad);
  return look_from(estimate, pose, 1.0F);
}

/// Whether the frame's matches agree on a pose, `frame.agreed`.
template <class Config, class Filter>
__attribute__((noinline)) bool agree(VehicleFrame<Config>& frame,
                                     const VehicleEstimate<Filter>& estimate,
                                     LandmarkMeasurement<Config::kMaxLandmarks>& measurement) {
  using Near = typename Relocaliser<Config>::Scratch::Near;
  auto& near = *new (&frame.scratch.relocaliser.near) Near();
  return estimate.find_agreed(frame, measurement.matches(), near.sightings, frame.agreed);
}

/// Places the estimate where a second search is to look, where the matches of the first one, from
/// look_aside(), agree on a pose; whether they do.
template <class Config, class Filter>
__attribute__((noinline)) bool look_again(VehicleFrame<Config>& frame,
                                          VehicleEstimate<Filter>& estimate,
                                          LandmarkMeasurement<Config::kMaxLandmarks>& measurement) {
  constexpr float kOfReach = 0.5F;
  if (!agree(frame, estimate, measurement)) return false;
  static_cast<void>(look_from(estimate, frame.agreed, kOfReach));
  return true;
}

/// Whether the matches of the second search agree on a pose, and most of those sought are there.
template <class Config, class Filter>
__attribute__((noinline)) bool confirm(VehicleFrame<Config>& frame,
                                       const VehicleEstimate<Filter>& estimate,
                                       LandmarkMeasurement<Config::kMaxLandmarks>& measurement,
                                       const TrackingMonitor& monitor) {
  const int searched = measurement.counts().searched;
  return agree(frame, estimate, measurement) &&
         monitor.confirms_place(measurement.matches().size(), searched);
}

/// The filter's pose is `pose`, which was recognised by `matches`, to a tenth of a radian, and in
/// position to what turns the view of them by as much.
template <class Filter>
__attribute__((noinline)) typename Filter::Placement place_at(
    VehicleEstimate<Filter>& estimate, const PlanarPose<float>& pose,
    const typename VehicleEstimate<Filter>::Matches& matches) {
  constexpr float kSigma_rad = 0.1F;
  Filter& filter = estimate.filter();
  float distances_m = 0.0F;
  for (const PixelMatch<float>& match : matches) {
    const Vector3<float> place = filter.mean_landmark(filter.find(match.id));
    distances_m += (place.template head<2>() - pose.position).norm();
  }
  const float mean_m = matches.empty() ? 0.0F : distances_m / static_cast<float>(matches.size());
  return filter.place(pose, square(kSigma_rad * mean_m), square(kSigma_rad));
}

/// After the update at such a pose: what it left unsure of the pose stays so. The next frames see
/// the same few landmarks, whose errors last, and do not average them out.
template <class Filter>
__attribute__((noinline)) void keep_pose_error(Filter& filter) {
  const Matrix3<float> covariance = filter.own_pose_covariance();
  const float position = covariance(0, 0) > covariance(1, 1) ? covariance(0, 0) : covariance(1, 1);
  static_cast<void>(filter.drift_world(position, covariance(2, 2)));
}

/// Updates the estimate about the pose that the frame's matches agree on; nothing changes,
/// kNoConsensus, where they do not.
template <class Config, class Filter>
__attribute__((noinline)) PixelUpdate update_unsure(
    VehicleFrame<Config>& frame, VehicleEstimate<Filter>& estimate,
    LandmarkMeasurement<Config::kMaxLandmarks>& measurement, const TrackingMonitor& monitor) {
  PixelUpdate result;
  result.status = Status::kNoConsensus;
  if (!frame.agrees) return result;
  const auto before = place_at(estimate, frame.agreed, measurement.matches());
  result = estimate.update(frame, measurement.matches(),
                           monitor.min_inliers(measurement.counts(), estimate.min_inliers()));
  if (result.inliers == 0) {
    estimate.filter().put_back(before);
  } else {
    keep_pose_error(estimate.filter());
  }
  return result;
}

}  // namespace cairn
