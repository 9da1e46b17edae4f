#pragma once

#include <cstdint>

#include "cairn/base/hash.hpp"
#include "cairn/base/health.hpp"
#include "cairn/base/status.hpp"
#include "cairn/runtime/handheld_tracker.hpp"
#include "cairn/runtime/input_log.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"
#include "cairn/runtime/window_tracker.hpp"
#include "cairn/tracking/frame_report.hpp"

namespace cairn {

/// Sets a tracker up as the header of an input log says. kBadConfig when the log is of the other
/// mode, or as the tracker's initialise(). The filter of a log is the caller's to choose: it is the
/// tracker's type. `parameters`: those that no header has; a replay leaves them as they are.
template <class Config, class Filter>
Status start_replay(const InputLogHeader& header, VehicleTracker<Config, Filter>& tracker,
                    typename VehicleTracker<Config, Filter>::Parameters parameters = {});
template <class Config>
Status start_replay(const InputLogHeader& header, HandheldTracker<Config>& tracker);
template <class Config>
Status start_replay(const InputLogHeader& header, WindowTracker<Config>& tracker);

/// Odometry of a log goes to vehicle trackers alone.
template <class Config, class Filter>
Status replay_odometry(const OdometrySample& sample, VehicleTracker<Config, Filter>& tracker) {
  return tracker.add_odometry(sample);
}
template <class Config>
Status replay_odometry(const OdometrySample&, HandheldTracker<Config>&) {
  return Status::kOk;
}
template <class Config>
Status replay_odometry(const OdometrySample&, WindowTracker<Config>&) {
  return Status::kOk;
}

/// A gyroscope's samples of a log go to the trackers that take them.
template <class Config>
Status replay_angular_rate(const AngularRateSample& sample, WindowTracker<Config>& tracker) {
  return tracker.add_angular_rate(sample);
}
template <class Tracker>
Status replay_angular_rate(const AngularRateSample&, Tracker&) {
  return Status::kOk;
}

/// The work that a frame of a log was allowed: its own limit, or the tracker's.
template <class Tracker>
void replay_work_limit(const LogFrame& frame, Tracker& tracker) {
  const int own = typename Tracker::Parameters{}.work_limit;
  static_cast<void>(tracker.set_work_limit(frame.work_limit < 0 ? own : frame.work_limit));
}

/// Feeds everything of a report that the tracker decided (its ticks apart), or every counter, to a
/// hash.
void add_to_hash(Hash64& hash, const FrameReport& report);
void add_to_hash(Hash64& hash, const Health& health);

/// Fingerprint of a tracker after a frame: report, state (pose, covariance, landmarks) and
/// counters.
template <class Tracker>
std::uint64_t frame_hash(const Tracker& tracker, const FrameReport& report) {
  Hash64 hash;
  add_to_hash(hash, report);
  tracker.hash(hash);
  add_to_hash(hash, tracker.health());
  return hash.value();
}

template <class Config, class Filter>
Status start_replay(const InputLogHeader& header, VehicleTracker<Config, Filter>& tracker,
                    typename VehicleTracker<Config, Filter>::Parameters parameters) {
  if (header.mode != LogMode::kVehicle) return Status::kBadConfig;
  parameters.seed = header.seed;
  parameters.odometry.sigma_speed_mps = header.speed_sigma_mps;
  parameters.odometry.sigma_turn = header.turn_sigma;
  // Without a wheelbase a steering angle may turn the vehicle by anything: such samples are
  // refused.
  constexpr float kNoWheelbase_m = 1e-6F;
  const bool named = header.wheelbase_m > 0.0F;
  parameters.odometry.wheelbase_m = named ? header.wheelbase_m : kNoWheelbase_m;
  parameters.odometry.sample_period_s = header.odometry_period_s;
  parameters.filter.tilt = header.tilt;
  typename VehicleTracker<Config, Filter>::Start start;
  start.pose.position = Vector2<float>(header.start_x_m, header.start_y_m);
  start.pose.heading = header.start_theta_rad;
  start.covariance(0, 0) = header.start_position_variance;
  start.covariance(1, 1) = header.start_position_variance;
  start.covariance(2, 2) = header.start_heading_variance;
  start.t_us = header.start_t_us;
  return tracker.initialise(header.camera, header.T_vehicle_camera, start, parameters);
}

template <class Config>
Status start_replay(const InputLogHeader& header, HandheldTracker<Config>& tracker) {
  if (header.mode != LogMode::kHandheld) return Status::kBadConfig;
  typename HandheldTracker<Config>::Parameters parameters;
  parameters.seed = header.seed;
  parameters.filter.fading = header.adaptive_fading ? FadingMode::kAdaptive : FadingMode::kFixed;
  parameters.filter.fading_factor = header.fading;
  return tracker.initialise(header.camera, parameters);
}

template <class Config>
Status start_replay(const InputLogHeader& header, WindowTracker<Config>& tracker) {
  if (header.mode != LogMode::kHandheld) return Status::kBadConfig;
  typename WindowTracker<Config>::Parameters parameters;
  parameters.seed = header.seed;
  parameters.window.focal_sigma = static_cast<float>(header.focal_sigma_e4) / 10000.0F;
  parameters.readout = header.readout;
  parameters.gyro = header.gyro;
  return tracker.initialise(header.camera, parameters);
}

}  // namespace cairn
