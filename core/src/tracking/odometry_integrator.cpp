#include "cairn/tracking/odometry_integrator.hpp"

#include "cairn/base/time.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

float larger(float a, float b) {
  return a > b ? a : b;
}

}  // namespace

void OdometryIntegrator::reset(const OdometryNoise& noise, std::int64_t max_step_us,
                               std::int64_t t_us) {
  *this = OdometryIntegrator();
  motion_.reset(noise, max_step_us, t_us);
  interval_s_ = noise.sample_period_s;
  time_us_ = t_us;
}

/// The first input may lie far from the time of the start: times then count from it.
void OdometryIntegrator::begin_at(std::int64_t t_us) {
  if (begun_) return;
  begun_ = true;
  const std::int64_t since_us = difference_us(t_us, time_us_);
  const std::int64_t most_us = motion_.max_step_us();
  if (since_us < -most_us || since_us > most_us) count_from(t_us);
}

void OdometryIntegrator::count_from(std::int64_t t_us) {
  time_us_ = t_us;
  motion_.count_from(t_us);
  corrected_us_ = t_us;
}

Status OdometryIntegrator::check_reading(const OdometrySample& sample, Health& health) {
  if (!is_finite(sample.speed_mps) || !is_finite(sample.turn)) {
    ++health.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (!OdometryMotion::is_possible(sample)) {
    ++health.odometry_refused;
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

Status OdometryIntegrator::check(const OdometrySample& sample, Health& health) const {
  const Status reading = check_reading(sample, health);
  if (!ok(reading)) return reading;
  if (motion_.has_sample() && sample.t_us < motion_.held().t_us) {
    ++health.time_errors;
    return Status::kTimeBackwards;
  }
  const float longest_s = motion_.max_step_s();
  const float dt_s = motion_.seconds_since_sample(sample.t_us);
  if (!(abs(motion_.over(sample, dt_s < longest_s ? dt_s : longest_s).yaw_rad) <= kPi<float>)) {
    ++health.odometry_refused;
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

/// Whether samples that should have come in a time did not: what the next one says is then the
/// motion at its own time alone.
bool OdometryIntegrator::samples_missing(std::int64_t from_us, std::int64_t to_us) const {
  constexpr float kIntervals = 3.0F;
  const float longest_s = larger(kSilent * motion_.max_step_s(), kIntervals * interval_s_);
  return motion_.has_sample() &&
         static_cast<float>(difference_us(to_us, from_us)) * 1e-6F > longest_s;
}

/// One that is missing counts as two intervals at most.
void OdometryIntegrator::note_interval(float step_s) {
  const float most = 2.0F * interval_s_;
  interval_s_ += 0.125F * ((step_s < most ? step_s : most) - interval_s_);
}

/// What a sample after a gap adds to the motion that was held in it, for the longest step: half of
/// the gap is its own, the other half that of the samples before. Turns end within two steps.
OdometryMotion::Step OdometryIntegrator::bridging(const OdometrySample& sample) {
  const float gap_s = motion_.seconds_since_sample(time_us_);
  const float longest_s = motion_.max_step_s();
  if (!motion_.has_sample() || !(gap_s > longest_s) || !can_bridge(time_us_)) return {};
  const OdometrySample first = motion_.steady();
  const float half_s = 0.5F * gap_s;
  begin_settling(half_s);
  const float turning_s = longest_turn_s(half_s);
  const Step held = motion_.over(motion_.held(), longest_s);
  const float yaw_rad =
      motion_.over(first, turning_s).yaw_rad + motion_.over(sample, turning_s).yaw_rad;
  const float distance_m =
      motion_.over(first, half_s).distance_m + motion_.over(sample, half_s).distance_m;
  return {distance_m - held.distance_m, yaw_rad - held.yaw_rad};
}

/// What a sample adds to what those before it, since a gap, said of the gap: its second half is as
/// their low-passed readings say, since one reading's noise would be a turn.
OdometryMotion::Step OdometryIntegrator::settling(const OdometrySample& sample) {
  constexpr float kUnits = 500.0F;  // a second
  const float passed = kUnits * motion_.seconds_since_sample(sample.t_us) + 0.5F;
  if (passed >= static_cast<float>(settling_)) settling_ = 0;
  if (settling_ == 0) return {};
  const auto units = static_cast<std::uint8_t>(passed);
  settling_ = static_cast<std::uint8_t>(settling_ - (units > 0 ? units : 1));
  const OdometrySample before = motion_.steady();
  const OdometrySample after = motion_.steady_with(sample);
  const float bridged_s = 1e-3F * static_cast<float>(bridged_ms_);
  const float turning_s = longest_turn_s(bridged_s);
  return {motion_.over(after, bridged_s).distance_m - motion_.over(before, bridged_s).distance_m,
          motion_.over(after, turning_s).yaw_rad - motion_.over(before, turning_s).yaw_rad};
}

void OdometryIntegrator::note_image_update(float ahead_m, float turn_rad, float step_s, bool sure) {
  note_placed_pose();
  if (!(step_s > 0.0F)) return;
  if (sure && motion_.has_sample()) follow_image(ahead_m, turn_rad, step_s);
  if (!motion_.by_images()) trust_.note_slip(abs(ahead_m) / step_s, step_s, motion_);
}

/// A constant velocity that the images correct; where they contradict the samples, they begin with
/// what they show now.
void OdometryIntegrator::follow_image(float ahead_m, float turn_rad, float step_s) {
  constexpr float kSettles_s = 0.05F;
  bool settled = motion_.by_images();
  if (!settled) {
    const bool contradicted = trust_.note_image(ahead_m, step_s, motion_);
    const bool silent = motion_.seconds_since_sample(time_us_) > kSilent * motion_.max_step_s();
    if (!silent && !contradicted) return;
    motion_.hold_by_images();
    settled = !contradicted;
  }
  const float share = 1.0F / (step_s + (settled ? kSettles_s : 0.0F));
  motion_.correct(share * ahead_m, share * turn_rad, time_us_);
}

/// A step along an arc, whose chord lies at half the yaw.
PlanarPose<float> OdometryIntegrator::moved(const PlanarPose<float>& pose, const Step& step) {
  float sine = 0.0F;
  float cosine = 0.0F;
  sin_cos(pose.heading + 0.5F * step.yaw_rad, sine, cosine);
  PlanarPose<float> result;
  result.position = pose.position + step.distance_m * Vector2<float>(cosine, sine);
  result.heading = wrap_angle(pose.heading + step.yaw_rad);
  return result;
}

PlanarPose<float> OdometryIntegrator::path() const {
  const float held_s = motion_.seconds_since_sample(time_us_);
  const float max_s = motion_.max_step_s();
  return moved(path_, motion_.over(motion_.held(), held_s < max_s ? held_s : max_s));
}

}  // namespace cairn
