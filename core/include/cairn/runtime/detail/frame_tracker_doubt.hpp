#pragma once

#include "cairn/runtime/frame_tracker.hpp"

// FrameTracker: what it does not believe, its inputs' or its own.

namespace cairn {

/// Where inputs are in doubt the landmarks' agreement does not make the pose known.
template <class Config, class Filter>
TrackingState FrameTracker<Config, Filter>::state() const {
  const TrackingState state = monitor_.state();
  return state == TrackingState::kTracking && doubted() ? TrackingState::kUncertain : state;
}

/// The pictures contradict the odometry, its turns, the mount or the camera's height, it is silent
/// and so the scale is not measured, or the body tilts by more than its suspension allows.
template <class Config, class Filter>
bool FrameTracker<Config, Filter>::doubted() const {
  constexpr float kTiltInSigmas = 5.0F;
  if (odometry_.contradicted() || !odometry_.known()) return true;
  if (mount_offset().any_suspect() || ground().suspect() || yaw().suspect()) return true;
  if (!filter().tilts()) return false;
  const VehicleTilt<float> tilt = filter().tilt();
  const TiltParameters<float>& usual = filter().parameters().tilt;
  return abs(tilt.pitch) > kTiltInSigmas * usual.sigma_pitch_rad ||
         abs(tilt.roll) > kTiltInSigmas * usual.sigma_roll_rad;
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::check_yaw(const ImageView& image) {
  if (odometry_.known()) {
    yaw_check_.add(image, {odometry_.path().heading, odometry_.yaw_variance(),
                           odometry_.speed_mps(), frame_step_s_});
  } else {
    yaw_check_.skip();
  }
  health_.yaw_suspicions += yaw_check_.suspect() ? 1 : 0;
}

/// Since the pose was last seen the heading became so unsure that landmarks are not where they are
/// expected: few of them in view say nothing, and matches in windows of that size are mostly
/// chance.
template <class Config, class Filter>
bool FrameTracker<Config, Filter>::unsure() const {
  constexpr float kMostYaw_rad = 0.12F;
  return monitor_.state() != TrackingState::kInitialising &&
         unseen_yaw_ + odometry_.yaw_variance() > square(kMostYaw_rad);
}

/// An update about the pose that the matches agree on; nothing changes where there is none.
template <class Config, class Filter>
PixelUpdate FrameTracker<Config, Filter>::update_unsure(Frame& frame,
                                                        typename Measurement::Matches& matches) {
  auto& scratch = *new (&scratch_.relocaliser.near) typename Relocaliser<Config>::Scratch::Near();
  PixelUpdate update;
  update.status = Status::kNoConsensus;
  PlanarPose<float> agreed;
  if (!estimate_.find_agreed(frame, matches, scratch.sightings, agreed)) return update;
  const typename Estimate::Placement before = estimate_.place(agreed);
  const int least = monitor_.parameters().min_inliers;
  const int wanted = min_inliers();
  update = estimate_.update(frame, matches, wanted > least ? wanted : least);
  if (update.inliers == 0) estimate_.filter().put_back(before);
  return update;
}

/// From odometry's pose, as unsure as it is. What was mapped before would be found in the new map's
/// place by chance; the library keeps it.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::begin_anew(Frame& frame) {
  local_map_.drop_seeds();
  for (int slot = estimate_.size() - 1; slot >= 0; --slot) {
    if (estimate_.landmarks().find(estimate_.id(slot)) == nullptr) continue;
    if (!frame.work.take(work::kRemoval)) return;
    estimate_.remove(frame, slot);
  }
  map_reuse_.end_relocalisation();
  monitor_.restart();
  unseen_yaw_ = 0.0F;
  odometry_.forget_yaw();
}

}  // namespace cairn
