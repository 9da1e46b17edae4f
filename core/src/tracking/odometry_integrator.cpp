#include "cairn/tracking/odometry_integrator.hpp"

#include "cairn/base/time.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kExcessWindow_s = 0.25F;
constexpr float kMostHeading_rad = 1.8F;  // a heading of which nothing is known
constexpr float kBlind = 0.5F;            // of the longest step: images then contradict nothing

float larger(float a, float b) {
  return a > b ? a : b;
}

}  // namespace

Status OdometryNoise::validate() const {
  const bool good = is_positive(sigma_speed_mps) && is_positive(sigma_turn) &&
                    is_positive(wheelbase_m) && is_positive(sample_period_s) &&
                    is_finite(steady_s) && steady_s >= 0.0F && is_positive(max_acceleration_mps2) &&
                    is_positive(unknown_speed_mps) && is_positive(unknown_yaw_rate_radps);
  return good ? Status::kOk : Status::kBadConfig;
}

void OdometryIntegrator::reset(const OdometryNoise& noise, std::int64_t max_step_us,
                               std::int64_t t_us) {
  *this = OdometryIntegrator();
  noise_ = noise;
  steady_ = ReadingLowPass<float>(noise.steady_s);
  max_step_us_ = max_step_us;
  interval_s_ = noise.sample_period_s;
  time_us_ = t_us;
  motion_.t_us = t_us;
}

/// The first input may lie far from the time of the start: times then count from it.
void OdometryIntegrator::begin_at(std::int64_t t_us) {
  if (begun_) return;
  begun_ = true;
  const std::int64_t since_us = difference_us(t_us, time_us_);
  if (since_us < -max_step_us_ || since_us > max_step_us_) count_from(t_us);
}

void OdometryIntegrator::count_from(std::int64_t t_us) {
  time_us_ = t_us;
  motion_.t_us = t_us;
  corrected_us_ = t_us;
}

float OdometryIntegrator::seconds_since_sample(std::int64_t t_us) const {
  const std::int64_t since_us = difference_us(t_us, motion_.t_us);
  return since_us > 0 ? static_cast<float>(since_us) * 1e-6F : 0.0F;
}

/// Since the sample, or the image, that tells the motion held.
float OdometryIntegrator::seconds_since_known(std::int64_t t_us) const {
  if (!by_images_) return seconds_since_sample(t_us);
  const std::int64_t since_us = difference_us(t_us, seen_us_);
  return since_us > 0 ? static_cast<float>(since_us) * 1e-6F : 0.0F;
}

Status OdometryIntegrator::check(const OdometrySample& sample, Health& health) const {
  if (!is_finite(sample.speed_mps) || !is_finite(sample.turn)) {
    ++health.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (has_motion_ && sample.t_us < motion_.t_us) {
    ++health.time_errors;
    return Status::kTimeBackwards;
  }
  const bool ackermann = sample.kind == OdometrySample::Kind::kAckermann;
  const bool possible = static_cast<unsigned>(sample.kind) < OdometrySample::kKindCount &&
                        abs(sample.speed_mps) <= kMaxSpeed_mps &&
                        (!ackermann || abs(sample.turn) <= kMaxSteering_rad) &&
                        abs(sample.turn) <= 1e3F;
  const float longest_s = static_cast<float>(max_step_us_) * 1e-6F;
  const float dt_s = seconds_since_sample(sample.t_us);
  if (!possible ||
      !(abs(motion_over(sample, dt_s < longest_s ? dt_s : longest_s).yaw_rad) <= kPi<float>)) {
    ++health.odometry_refused;
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

/// Whether a reading changed faster than a vehicle can, and is not yet believed for its
/// persistence.
bool OdometryIntegrator::is_glitch(const OdometrySample& sample) {
  constexpr float kNoiseInSigmas = 6.0F;
  const float dt_s = seconds_since_sample(sample.t_us);
  if (!has_motion_ || !(dt_s > 0.0F)) return false;
  const float scale = sqrt(noise_.sample_period_s / dt_s);
  const float most = noise_.max_acceleration_mps2 * dt_s +
                     kNoiseInSigmas * larger(1.0F, scale) * noise_.sigma_speed_mps;
  const float jump = abs(sample.speed_mps - motion_.speed_mps);
  if (jump <= most) {
    glitches_ = 0;
    return false;
  }
  const bool as_before = glitches_ > 0 && abs(sample.speed_mps - glitch_.speed_mps) <= most;
  glitches_ = as_before ? glitches_ + 1 : 1;
  glitch_ = sample;
  if (glitches_ >= kGlitchesToBelieve) {
    glitches_ = 0;
    return false;
  }
  const float unknown = larger(noise_.unknown_speed_mps, abs(motion_.speed_mps));
  slip_mps_ = larger(slip_mps_, jump < unknown ? jump : unknown);
  return true;
}

/// With time, seen or not: what the wheels did a while ago says little about now.
void OdometryIntegrator::fade_slip(float step_s) {
  constexpr float kLasts_s = 0.5F;
  slip_mps_ *= kLasts_s / (kLasts_s + step_s);
  if (!contradicted_ && doubted_s_ > 0.0F) doubted_s_ -= step_s;
}

/// While the images hold the motion a sample is compared with what they show; while they are blind,
/// nothing contradicts it.
bool OdometryIntegrator::is_contradicted(const OdometrySample& sample) {
  if (!contradicted_) return false;
  const float dt_s = seconds_since_sample(sample.t_us);
  const float excess = motion_.speed_mps - sample.speed_mps;
  excess_mps_ += dt_s / (dt_s + kExcessWindow_s) * (excess - excess_mps_);
  const bool agrees = abs(excess_mps_) < 0.5F * most_contradiction(sample.speed_mps);
  const bool blind = seconds_since_known(sample.t_us) > kBlind * max_step_s();
  if (blind) slip_mps_ = larger(slip_mps_, noise_.unknown_speed_mps);
  doubted_s_ += dt_s;
  contradicted_ = !agrees && !blind && doubted_s_ < kLongestContradiction_s;
  if (agrees || blind) doubted_s_ = 0.0F;
  return contradicted_;
}

/// What the samples' noise makes of the low-passed difference, and a share of the speed for what is
/// wrong with scales.
float OdometryIntegrator::most_contradiction(float speed_mps) const {
  constexpr float kSigmas = 3.5F;
  constexpr float kShare = 0.2F;
  return kSigmas * noise_.sigma_speed_mps *
             sqrt(noise_.sample_period_s / (2.0F * kExcessWindow_s)) +
         kShare * abs(speed_mps);
}

/// Whether samples that should have come in a time did not: what the next one says is then the
/// motion at its own time alone.
bool OdometryIntegrator::samples_missing(std::int64_t from_us, std::int64_t to_us) const {
  constexpr float kIntervals = 3.0F;
  const float longest_s = larger(kSilent * max_step_s(), kIntervals * interval_s_);
  return has_motion_ && static_cast<float>(difference_us(to_us, from_us)) * 1e-6F > longest_s;
}

/// One that is missing counts as two intervals at most.
void OdometryIntegrator::note_interval(float step_s) {
  const float most = 2.0F * interval_s_;
  interval_s_ += 0.125F * ((step_s < most ? step_s : most) - interval_s_);
}

/// What a sample after a gap adds to the motion that was held in it, for the longest step: half of
/// the gap is its own, the other half that of the samples before. Turns end within two steps. Of
/// gaps that are much longer, as when the clock was set, the samples say nothing.
OdometryIntegrator::Motion OdometryIntegrator::bridging(const OdometrySample& sample) const {
  constexpr float kMostSteps = 10.0F;
  const float gap_s = seconds_since_sample(time_us_);
  const float longest_s = max_step_s();
  if (!has_motion_ || !(gap_s > longest_s) || gap_s > kMostSteps * longest_s) return {};
  const OdometrySample first = steady_motion();
  const float half_s = 0.5F * gap_s;
  const float turning_s = half_s < 2.0F * longest_s ? half_s : 2.0F * longest_s;
  const Motion held = motion_over(motion_, longest_s);
  const float yaw_rad =
      motion_over(first, turning_s).yaw_rad + motion_over(sample, turning_s).yaw_rad;
  const float distance_m =
      motion_over(first, half_s).distance_m + motion_over(sample, half_s).distance_m;
  return {distance_m - held.distance_m, yaw_rad - held.yaw_rad};
}

/// Held for longer than a sample is meant for, one reading's noise would become a turn.
void OdometryIntegrator::hold_steadily() {
  if (!at_rest()) motion_ = steady_motion();
}

OdometrySample OdometryIntegrator::steady_motion() const {
  OdometrySample motion = motion_;
  if (by_images_) return motion;
  motion.speed_mps = steady_.speed();
  motion.turn = steady_.turn();
  return motion;
}

/// From now on the motion held is the images' to correct, as speed and yaw rate.
void OdometryIntegrator::hold_by_images() {
  motion_.turn = motion_over(motion_, 1.0F).yaw_rad;
  motion_.kind = OdometrySample::Kind::kTwist;
  steady_ = ReadingLowPass<float>(noise_.steady_s);
  steady_.add(motion_.speed_mps, motion_.turn, 0.0F);
  by_images_ = true;
}

void OdometryIntegrator::note_image_update(float ahead_m, float turn_rad, float step_s, bool sure) {
  corrected_us_ = time_us_;
  if (!(step_s > 0.0F)) return;
  if (sure && has_motion_) follow_image(ahead_m, turn_rad, step_s);
  if (!by_images_) note_slip(abs(ahead_m) / step_s, step_s);
}

/// A constant velocity that the images correct; where they contradict the samples, they begin with
/// what they show now.
void OdometryIntegrator::follow_image(float ahead_m, float turn_rad, float step_s) {
  constexpr float kSettles_s = 0.05F;
  bool settled = by_images_;
  if (!by_images_) {
    excess_mps_ += (ahead_m - step_s * excess_mps_) / (step_s + kExcessWindow_s);
    contradicted_ =
        !(doubted_s_ > 0.0F) && abs(excess_mps_) > most_contradiction(motion_.speed_mps);
    const bool silent = seconds_since_sample(time_us_) > kSilent * max_step_s();
    if (!silent && !contradicted_) return;
    hold_by_images();
    settled = !contradicted_;
  }
  const float share = 1.0F / (step_s + (settled ? kSettles_s : 0.0F));
  motion_.speed_mps += share * ahead_m;
  motion_.turn += share * turn_rad;
  seen_us_ = time_us_;
}

/// Wheels that slip are wrong by about the vehicle's speed; more was an error of the pose before.
void OdometryIntegrator::note_slip(float seen_mps, float step_s) {
  constexpr float kFarInSigmas = 3.0F;
  const float most = larger(noise_.unknown_speed_mps, abs(motion_.speed_mps));
  const float rate = seen_mps < most ? seen_mps : most;
  if (rate > kFarInSigmas * noise_.sigma_speed_mps * sqrt(noise_.sample_period_s / step_s)) {
    slip_mps_ = larger(slip_mps_, rate);
  }
}

OdometryIntegrator::Motion OdometryIntegrator::motion_over(const OdometrySample& reading,
                                                           float dt_s) const {
  if (!(dt_s > 0.0F)) return {};
  const PlanarIncrement<float> increment = increment_of(reading, dt_s, 1.0F);
  return {increment.distance_m, increment.turn_rad};
}

/// A step along an arc, whose chord lies at half the yaw.
PlanarPose<float> OdometryIntegrator::moved(const PlanarPose<float>& pose, const Motion& motion) {
  float sine = 0.0F;
  float cosine = 0.0F;
  sin_cos(pose.heading + 0.5F * motion.yaw_rad, sine, cosine);
  PlanarPose<float> result;
  result.position = pose.position + motion.distance_m * Vector2<float>(cosine, sine);
  result.heading = wrap_angle(pose.heading + motion.yaw_rad);
  return result;
}

PlanarPose<float> OdometryIntegrator::path() const {
  const float held_s = seconds_since_sample(time_us_);
  const float max_s = static_cast<float>(max_step_us_) * 1e-6F;
  return moved(path_, motion_over(motion_, held_s < max_s ? held_s : max_s));
}

/// Of one step, at least a third of |reading - low-passed reading|, so that the search windows stay
/// wide enough after an outlier.
float OdometryIntegrator::sigma_speed(float scale) const {
  constexpr float kFarInSigmas = 3.0F;
  const float off = abs(motion_.speed_mps - steady_.speed()) / kFarInSigmas;
  return larger(larger(scale * noise_.sigma_speed_mps, off), slip_mps_);
}

PlanarIncrement<float> OdometryIntegrator::increment_over(float dt_s) const {
  if (!(dt_s > 0.0F)) return {};
  // The noise is stated per sample_period: cut into shorter steps its sum must stay the same.
  const float scale = sqrt(noise_.sample_period_s / dt_s);
  PlanarIncrement<float> increment = increment_of(motion_, dt_s, scale);
  // Noise linearised at the reading would be correlated with the reading's own error: the filter
  // would explain each steering error by a change of speed. Only a larger speed is taken from it.
  OdometrySample linearised = motion_;
  linearised.speed_mps = steady_.speed();
  linearised.turn = steady_.turn();
  if (abs(motion_.speed_mps) > abs(linearised.speed_mps)) linearised.speed_mps = motion_.speed_mps;
  increment.covariance = increment_of(linearised, dt_s, scale).covariance;
  return increment;
}

PlanarIncrement<float> OdometryIntegrator::increment_of(const OdometrySample& reading, float dt_s,
                                                        float scale) const {
  constexpr float kFarInSigmas = 3.0F;
  const float off = abs(motion_.turn - steady_.turn()) / kFarInSigmas;
  const float sigma_turn = scale * (off > noise_.sigma_turn ? off : noise_.sigma_turn);
  return reading.kind == OdometrySample::Kind::kAckermann
             ? ackermann_increment(reading.speed_mps, reading.turn, dt_s, noise_.wheelbase_m,
                                   sigma_speed(scale), sigma_turn)
             : twist_increment(reading.speed_mps, reading.turn, dt_s, sigma_speed(scale),
                               sigma_turn);
}

/// By how much the yaw rate held differs from the low-passed one beyond the noise of a sample.
/// Held, it is wrong by that in one direction.
float OdometryIntegrator::yaw_outlier() const {
  constexpr float kFarInSigmas = 3.0F;
  if (!has_motion_) return 0.0F;
  OdometrySample usual = motion_;
  usual.turn = steady_.turn();
  const float off = abs(motion_over(motion_, 1.0F).yaw_rad - motion_over(usual, 1.0F).yaw_rad);
  OdometrySample noisy = usual;
  noisy.turn += kFarInSigmas * noise_.sigma_turn;
  const float noise = abs(motion_over(noisy, 1.0F).yaw_rad - motion_over(usual, 1.0F).yaw_rad);
  return off > noise ? off - noise : 0.0F;
}

/// Speed and yaw rate, sure at the sample, drift to the unknown within the longest step and stay
/// there: the deviation of the path is u t^2 / (2 max) first, and u (t - max / 2) from then on.
OdometryIntegrator::Drift OdometryIntegrator::drift_between(float from_s, float to_s) const {
  constexpr float kMostPosition_m = 1e3F;
  const float max_s = static_cast<float>(max_step_us_) * 1e-6F;
  const float speed = larger(noise_.unknown_speed_mps, abs(motion_.speed_mps));
  const float yaw_rate =
      larger(noise_.unknown_yaw_rate_radps, abs(motion_over(motion_, 1.0F).yaw_rad));
  const auto variance = [max_s](float rate, float outlier, float t_s, float most) {
    const float time = t_s < max_s ? 0.5F * t_s * t_s / max_s : t_s - 0.5F * max_s;
    const float path = rate * time + outlier * t_s;
    return square(path < most ? path : most);
  };
  const float turned = yaw_outlier();
  return {
      variance(speed, 0.0F, to_s, kMostPosition_m) - variance(speed, 0.0F, from_s, kMostPosition_m),
      variance(yaw_rate, turned, to_s, kMostHeading_rad) -
          variance(yaw_rate, turned, from_s, kMostHeading_rad)};
}

/// Speed and yaw rate walk at random from one sample to the other, as far in the longest step as
/// the unknown, or as they changed: a third of the variance is left where only the first is known,
/// a twelfth where both are. The heading on the way moves the path sideways. Beyond the longest
/// step it is no less than what a vehicle can have done.
OdometryIntegrator::Drift OdometryIntegrator::drift_between_samples(const OdometrySample& first,
                                                                    const OdometrySample& last,
                                                                    float step_s) const {
  constexpr float kBothEnds = 1.0F / 12.0F;
  constexpr float kShare = 0.3F;  // of the speed
  const float turned = motion_over(last, 1.0F).yaw_rad - motion_over(first, 1.0F).yaw_rad;
  const float walked = kBothEnds * step_s * square(step_s) / max_step_s();
  const float fast = larger(abs(first.speed_mps), abs(last.speed_mps));
  const float speed = square(noise_.unknown_speed_mps) + square(kShare * fast) +
                      square(last.speed_mps - first.speed_mps);
  const float heading = walked * (square(noise_.unknown_yaw_rate_radps) + square(turned));
  const float way_m = 0.5F * step_s * (abs(first.speed_mps) + abs(last.speed_mps));
  Drift drift = {walked * speed + 0.25F * square(way_m) * heading, heading};
  if (step_s > max_step_s()) {
    const Drift unknown = drift_between(0.0F, step_s);
    drift = {larger(drift.position, unknown.position), larger(drift.heading, unknown.heading)};
  }
  constexpr float kMostPosition_m2 = 1e6F;
  if (drift.position > kMostPosition_m2) drift.position = kMostPosition_m2;
  if (drift.heading > square(kMostHeading_rad)) drift.heading = square(kMostHeading_rad);
  return drift;
}

}  // namespace cairn
