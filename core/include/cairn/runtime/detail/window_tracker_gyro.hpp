#pragma once

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/runtime/window_tracker.hpp"

namespace cairn {

/// The time to the frame is one of which nothing is known, or the gyroscope's turn.
template <class Config>
void WindowTracker<Config>::note_gyro_frame(const FrameStep& step, std::int64_t t_us) {
  gyro_.take_frame(t_us);
  if (gyro_.sure()) {
    blind_variance_ += gyro_.turn_variance();
  } else {
    blind_s_ += static_cast<float>(step.us) * 1e-6F;
  }
}

/// What the turn from the keyframe before is worth is weighed as the landmarks are, whose errors
/// count as independent.
template <class Config>
void WindowTracker<Config>::note_gyro_keyframe() {
  Quaternion<float> turned;
  float variance = 0.0F;
  if (gyro_.since_keyframe(turned, variance)) {
    window_.set_turn(turned, variance / square(parameters_.covariance_factor));
  }
  gyro_.note_keyframe();
}

/// A frame whose landmarks left the view, or are blurred, becomes a keyframe where the gyroscope
/// and the velocity before say that it is: the next frame finds what this one shows. The
/// gyroscope's turn ties it to the others.
template <class Config>
void WindowTracker<Config>::bridge(FrameContext& frame) {
  const int least = work::kWindowNewest + features_.new_work(frame) / kLeastKeyframe;
  if (takes_points_ || !frame.work.affords(least)) return;
  static_cast<void>(make_keyframe(frame, true));
}

/// Radius in the shrunk image for the features that are searched first: what a gyroscope that
/// agrees leaves of the turn, and what a hand may have moved since.
template <class Config>
int WindowTracker<Config>::first_radius(const FrameContext& frame, const FrameStep& step) const {
  constexpr float kSigmas = 3.0F;
  const typename Features::Parameters& p = parameters_.features;
  if (!gyro_.sure() || !motion_.moves()) return p.wide_radius_px;
  const float moved = parameters_.rotation.hand_speed_mps * typical_inverse_depth_ * step.seconds();
  const float sigma_px = camera_.fx * sqrt(gyro_.turn_variance() + square(moved));
  const auto shrink = static_cast<float>(shrink_factor(frame.image.width, frame.image.height));
  const int radius = 1 + round_to_int(kSigmas * sigma_px / shrink);
  return clamp(radius, p.narrow_radius_px, p.wide_radius_px);
}

/// Compares the gyroscope with the attitude by the landmarks alone: what it added to a pose is
/// taken from it again.
template <class Config>
void WindowTracker<Config>::compare_gyro(const Rigid<float>& predicted, const Rigid<float>& pose) {
  if (!gyro_.turn().known) return gyro_.note_weak();
  SeenAttitude seen;
  seen.focal_sigma = window_.focal_sigma();
  seen.lens_sigma = parameters_.lens_sigma;
  Quaternion<float> by_landmarks = pose.rotation;
  Matrix3<float> covariance = frame_covariance_.topLeftCorner<3, 3>();
  const float added = guided_information_;
  if (added > 0.0F) {
    constexpr float kLeast = 1e-4F;
    Matrix3<float> information;
    if (!detail::invert_spd(covariance, kLeast, information)) return gyro_.note_weak();
    const Vector3<float> moved = rotation_log(pose.rotation * predicted.rotation.conjugate());
    const Vector3<float> weighed = information * moved;
    for (int i = 0; i < 3; ++i) information(i, i) -= added;
    if (!detail::invert_spd(information, kLeast, covariance)) return gyro_.note_weak();
    by_landmarks = rotation_exp(Vector3<float>(covariance * weighed)) * predicted.rotation;
  }
  seen.R_world_camera = by_landmarks.conjugate();
  seen.variance = square(parameters_.covariance_factor) * covariance.trace() / 3.0F;
  gyro_.note_pose(seen);
}

}  // namespace cairn
