#pragma once

#include <cstdint>

#include "cairn/base/health.hpp"
#include "cairn/base/status.hpp"
#include "cairn/base/time.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/planar/increment.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/odometry_motion.hpp"
#include "cairn/tracking/odometry_trust.hpp"

namespace cairn {

/// Moves a planar filter by odometry samples that come in their own rhythm: late, early, in bursts.
///
/// A sample is the motion since the sample before it. Beyond the newest sample its motion is held,
/// so that the pose can be predicted at a frame's time, with an uncertainty that grows with the
/// time since the sample as if speed and yaw rate drifted to the unknown within `max_step_us`; from
/// then on the motion is unknown. When the next sample arrives, the stretch that was held is
/// corrected by it, except where an image has corrected the pose since. Cut into shorter steps, the
/// noise sums up to the same. The start counts as a sample at rest.
///
/// Where samples are silent for longer than kSilent of the longest step, or contradict the images,
/// the motion held is that which the images show (constant speed and yaw rate), and the time since
/// counts from the last image.
class OdometryIntegrator {
 public:
  static constexpr float kSilent = 0.2F;  ///< of the longest step

  /// Starts anew, at rest at time `t_us`. Motion is held for at most `max_step_us`.
  void reset(const OdometryNoise& noise, std::int64_t max_step_us, std::int64_t t_us);

  /// Integrates up to the sample's time. Refused, nothing changed: kNonFiniteInput;
  /// kInvalidArgument (not OdometryMotion::is_possible(), or half a turn since the sample
  /// before); kTimeBackwards (older than the sample before). Counted, with the motion before
  /// it held less certainly: kGated, the speed changed faster than a vehicle can, or is not what
  /// the images show. kTimeGap: more
  /// than `max_step_us` since the sample before; the pose became as uncertain as that leaves it.
  template <class Filter>
  Status add(const OdometrySample& sample, Filter& filter, Health& health);

  /// What add() refuses of the reading alone, whatever its time: kNonFiniteInput, kInvalidArgument.
  static Status check_reading(const OdometrySample& sample, Health& health);

  /// Brings the pose to `t_us`; nothing to do where it is there already. kTimeGap: the motion since
  /// the newest sample is unknown by now, and the pose became uncertain. Else as Filter::predict().
  template <class Filter>
  Status integrate_to(std::int64_t t_us, Filter& filter, Health& health);

  /// The clock of the inputs was set back, and times count on from `t_us`. How long ago the last
  /// input was is unknown: the pose stays, as uncertain as `max_step_us` leaves it. Errors: as
  /// Filter::widen_pose(), with the clock set all the same.
  template <class Filter>
  Status restart_clock(std::int64_t t_us, Filter& filter);

  /// An image has placed the pose at its present time: what was held until now, or before in a gap,
  /// needs no correction by odometry.
  void note_placed_pose() {
    corrected_us_ = time_us_;
    settling_ = 0;
  }
  /// An image has corrected the pose at its present time, by `ahead_m` along the vehicle's heading
  /// and by `turn_rad`, since the frame `step_s` before: what was held until now needs no
  /// correction by odometry. A correction far beyond the noise means that the wheels slip, and
  /// raises the noise for a while. `sure`: enough landmarks agreed to tell the motion without
  /// odometry; of such images, corrections in one direction that last mean that odometry is wrong
  /// (contradicted()).
  void note_image_update(float ahead_m, float turn_rad, float step_s, bool sure);

  /// Whether the speed that images show differs from the samples' by more than their noise, and by
  /// more than a fifth. After OdometryTrust::kLongestContradiction_s the samples are believed all
  /// the same, since the scale is theirs to tell, and doubted for as long again.
  bool contradicted() const { return trust_.doubts(); }
  float speed_mps() const { return motion_.held().speed_mps; }
  /// Yaw that the motion held makes of a time, rad.
  float turn_over(float step_s) const { return motion_.over(motion_.held(), step_s).yaw_rad; }
  /// The pose by odometry alone at the filter's time, from any start: what images corrected is not
  /// in it.
  PlanarPose<float> path() const;
  /// Whether a sample has come at all: until then the vehicle's rest is only assumed.
  bool begun() const { return motion_.has_sample(); }
  /// Whether the motion at the pose's time follows from samples.
  bool known() const {
    return motion_.has_sample() &&
           difference_us(time_us_, motion_.held().t_us) <= motion_.max_step_us();
  }
  /// Whether the newest sample is exactly no motion.
  bool at_rest() const { return motion_.at_rest(); }
  /// Variance of the yaw increment since the last forget_yaw(), rad^2.
  float yaw_variance() const { return yaw_variance_; }
  void forget_yaw() { yaw_variance_ = 0.0F; }

 private:
  static constexpr std::uint8_t kSettling = 250;  ///< in 2 ms
  using Step = OdometryMotion::Step;
  using Drift = OdometryMotion::Drift;

  void begin_at(std::int64_t t_us);
  void count_from(std::int64_t t_us);
  Status check(const OdometrySample& sample, Health& health) const;
  bool samples_missing(std::int64_t from_us, std::int64_t to_us) const;
  /// Of gaps that are much longer than the longest step, as when the clock was set, the samples say
  /// nothing.
  bool can_bridge(std::int64_t t_us) const {
    constexpr float kMostSteps = 10.0F;
    return motion_.seconds_since_sample(t_us) <= kMostSteps * motion_.max_step_s();
  }
  template <class Filter>
  Status move(const PlanarIncrement<float>& increment, float step_s, Filter& filter);
  template <class Filter>
  Status bridge_to(const OdometrySample& sample, Filter& filter);
  Step bridging(const OdometrySample& sample);
  float longest_turn_s(float time_s) const {
    const float most_s = 2.0F * motion_.max_step_s();
    return time_s < most_s ? time_s : most_s;
  }
  void begin_settling(float bridged_s) {
    constexpr float kMost_s = 60.0F;
    bridged_ms_ = static_cast<std::uint16_t>(1e3F * (bridged_s < kMost_s ? bridged_s : kMost_s));
    settling_ = kSettling;
  }
  Step settling(const OdometrySample& sample);
  void note_interval(float step_s);
  void follow_image(float ahead_m, float turn_rad, float step_s);
  static PlanarPose<float> moved(const PlanarPose<float>& pose, const Step& step);

  OdometryMotion motion_;
  OdometryTrust trust_;
  PlanarPose<float> path_;         ///< at the newest sample
  float interval_s_ = 0.0F;        ///< usual, from one sample to the next
  std::int64_t time_us_ = 0;       ///< of the filter's pose
  std::int64_t corrected_us_ = 0;  ///< until then an image has corrected the pose
  float yaw_variance_ = 0.0F;
  std::uint16_t bridged_ms_ = 0;  ///< of the last gap, what moved as the samples after it say
  std::uint8_t settling_ = 0;  ///< of kSettling, in which these tell it better than the first one
  bool begun_ = false;
};

template <class Filter>
Status OdometryIntegrator::add(const OdometrySample& sample, Filter& filter, Health& health) {
  begin_at(sample.t_us);
  const Status checked = check(sample, health);
  if (!ok(checked)) return checked;
  const bool gap = motion_.seconds_since_sample(sample.t_us) > motion_.max_step_s();
  const bool glitch =
      trust_.is_contradicted(sample, motion_) || (!gap && trust_.is_glitch(sample, motion_));
  Step correction;
  if (!glitch && samples_missing(time_us_, sample.t_us) && can_bridge(sample.t_us)) {
    const Status bridged = bridge_to(sample, filter);
    if (!ok(bridged)) return bridged;
    health.odometry_timeouts += gap ? 1 : 0;
  } else if (gap) {
    if (corrected_us_ <= motion_.held().t_us && !glitch) correction = bridging(sample);
    static_cast<void>(integrate_to(sample.t_us, filter, health));
  } else if (!glitch) {
    // What was held beyond the last sample, and no image has corrected, moves as this sample says.
    const std::int64_t sample_us = motion_.held().t_us;
    const std::int64_t from = corrected_us_ > sample_us ? corrected_us_ : sample_us;
    const float held_s = OdometryMotion::seconds_between(time_us_, from);
    const Step measured = motion_.over(sample, held_s);
    const Step held = motion_.over(motion_.held(), held_s);
    const Step settled = settling(sample);
    correction = {measured.distance_m - held.distance_m + settled.distance_m,
                  measured.yaw_rad - held.yaw_rad + settled.yaw_rad};
  }
  const float since_s = motion_.seconds_since_sample(sample.t_us);
  path_ = moved(path_, motion_.over(glitch ? motion_.held() : sample, since_s));
  if (glitch) {
    motion_.count_from(sample.t_us);
    ++health.odometry_glitches;
  } else {
    if (settling_ == kSettling) motion_.forget_steady();
    motion_.take(sample);
    note_interval(since_s);
  }
  const float step_s = OdometryMotion::seconds_between(sample.t_us, time_us_);
  PlanarIncrement<float> increment = motion_.increment_over(step_s, trust_.slip_mps());
  increment.distance_m += correction.distance_m;
  increment.turn_rad += correction.yaw_rad;
  if (step_s > 0.0F) time_us_ = sample.t_us;
  if (step_s > 0.0F || correction.distance_m != 0.0F || correction.yaw_rad != 0.0F) {
    const Status moved = move(increment, step_s, filter);
    if (!ok(moved)) return moved;
    trust_.fade(step_s);
  }
  if (glitch) return Status::kGated;
  return gap ? Status::kTimeGap : Status::kOk;
}

template <class Filter>
Status OdometryIntegrator::move(const PlanarIncrement<float>& increment, float step_s,
                                Filter& filter) {
  // Over a gap readings may add up to more than half a turn, which no filter takes in one step.
  PlanarIncrement<float> within = increment;
  if (abs(within.turn_rad) > kPi<float>) {
    within.turn_rad = within.turn_rad > 0.0F ? kPi<float> : -kPi<float>;
  }
  const Status moved = filter.predict(within);
  if (!ok(moved)) return moved;
  yaw_variance_ += increment.covariance(1, 1);
  return filter.slip_laterally(motion_.lateral_slip_over(step_s));
}

/// Over a time in which samples are missing, which the pose has not been moved through: as the
/// samples before and after say together.
template <class Filter>
Status OdometryIntegrator::bridge_to(const OdometrySample& sample, Filter& filter) {
  constexpr float kNoiseOfTwo = 0.71F;
  const float step_s = OdometryMotion::seconds_between(sample.t_us, time_us_);
  const OdometrySample first = motion_.steady();
  OdometrySample mean = sample;
  mean.speed_mps = 0.5F * (first.speed_mps + sample.speed_mps);
  mean.turn = 0.5F * (first.turn + sample.turn);
  const PlanarIncrement<float> increment =
      motion_.increment_of(mean, step_s, kNoiseOfTwo, trust_.slip_mps());
  const Status moved = move(increment, step_s, filter);
  if (!ok(moved)) return moved;
  const Drift drift = motion_.drift_between_samples(first, sample, step_s);
  begin_settling(0.5F * step_s);
  time_us_ = sample.t_us;
  yaw_variance_ += drift.heading;
  trust_.fade(step_s);
  return filter.widen_pose(drift.position, drift.heading);
}

template <class Filter>
Status OdometryIntegrator::restart_clock(std::int64_t t_us, Filter& filter) {
  const Drift drift = motion_.drift_between(0.0F, motion_.max_step_s());
  count_from(t_us);
  yaw_variance_ += drift.heading;
  return filter.widen_pose(drift.position, drift.heading);
}

template <class Filter>
Status OdometryIntegrator::integrate_to(std::int64_t t_us, Filter& filter, Health& health) {
  begin_at(t_us);
  if (t_us <= time_us_) return Status::kOk;
  if (samples_missing(motion_.held().t_us, t_us)) motion_.hold_steadily();
  const float max_s = motion_.max_step_s();
  const float from_s = motion_.seconds_since_known(time_us_);
  const float to_s = motion_.seconds_since_known(t_us);
  const float held_s = (to_s < max_s ? to_s : max_s) - from_s;
  time_us_ = t_us;
  Status status = Status::kOk;
  if (motion_.has_sample() && held_s > 0.0F) {
    status = move(motion_.increment_over(held_s, trust_.slip_mps()), held_s, filter);
  }
  trust_.fade(to_s - from_s);
  const Drift drift = motion_.drift_between(from_s, to_s);
  if (drift.position > 0.0F || drift.heading > 0.0F) {
    const Status widened = filter.widen_pose(drift.position, drift.heading);
    if (ok(status)) status = widened;
    yaw_variance_ += drift.heading;
  }
  if (motion_.seconds_since_sample(t_us) <= max_s) return status;
  ++health.odometry_timeouts;
  return ok(status) ? Status::kTimeGap : status;
}

}  // namespace cairn
