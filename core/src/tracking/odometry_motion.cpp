#include "cairn/tracking/odometry_motion.hpp"

#include "cairn/base/time.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kMostHeading_rad = 1.8F;  // a heading of which nothing is known
constexpr float kFarInSigmas = 3.0F;
constexpr float kMostTurnCentre_m = 10.0F;

float larger(float a, float b) {
  return a > b ? a : b;
}

}  // namespace

Status OdometryNoise::validate() const {
  const bool good = is_positive(sigma_speed_mps) && is_positive(sigma_turn) &&
                    is_positive(wheelbase_m) && is_positive(sample_period_s) &&
                    is_finite(steady_s) && steady_s >= 0.0F && is_positive(max_acceleration_mps2) &&
                    turn_centre_m >= 0.0F && turn_centre_m <= kMostTurnCentre_m &&
                    is_positive(unknown_speed_mps) && is_positive(unknown_yaw_rate_radps);
  return good ? Status::kOk : Status::kBadConfig;
}

void OdometryMotion::reset(const OdometryNoise& noise, std::int64_t max_step_us,
                           std::int64_t t_us) {
  *this = OdometryMotion();
  noise_ = noise;
  steady_ = ReadingLowPass<float>(noise.steady_s);
  max_step_us_ = max_step_us;
  held_.t_us = t_us;
}

bool OdometryMotion::is_possible(const OdometrySample& reading) {
  constexpr float kMostTurn = 1e3F;
  const bool ackermann = reading.kind == OdometrySample::Kind::kAckermann;
  return static_cast<unsigned>(reading.kind) < OdometrySample::kKindCount &&
         abs(reading.speed_mps) <= kMaxSpeed_mps &&
         abs(reading.turn) <= (ackermann ? kMaxSteering_rad : kMostTurn);
}

bool OdometryMotion::at_rest() const {
  const bool ackermann = held_.kind == OdometrySample::Kind::kAckermann;
  return held_.speed_mps == 0.0F && (ackermann || held_.turn == 0.0F);
}

float OdometryMotion::seconds_between(std::int64_t later_us, std::int64_t earlier_us) {
  const std::int64_t since_us = difference_us(later_us, earlier_us);
  return since_us > 0 ? static_cast<float>(since_us) * 1e-6F : 0.0F;
}

float OdometryMotion::seconds_since_sample(std::int64_t t_us) const {
  return seconds_between(t_us, held_.t_us);
}

float OdometryMotion::seconds_since_known(std::int64_t t_us) const {
  return seconds_between(t_us, by_images_ ? seen_us_ : held_.t_us);
}

void OdometryMotion::take(const OdometrySample& sample) {
  steady_.add(sample.speed_mps, sample.turn,
              has_sample_ ? seconds_since_sample(sample.t_us) : 0.0F);
  held_ = sample;
  has_sample_ = true;
  by_images_ = false;
}

void OdometryMotion::hold_steadily() {
  if (!at_rest()) held_ = steady();
}

OdometrySample OdometryMotion::steady() const {
  OdometrySample motion = held_;
  if (by_images_) return motion;
  motion.speed_mps = steady_.speed();
  motion.turn = steady_.turn();
  return motion;
}

OdometrySample OdometryMotion::steady_with(const OdometrySample& sample) const {
  ReadingLowPass<float> readings = steady_;
  readings.add(sample.speed_mps, sample.turn, seconds_since_sample(sample.t_us));
  OdometrySample motion = sample;
  motion.speed_mps = readings.speed();
  motion.turn = readings.turn();
  return motion;
}

void OdometryMotion::hold_by_images() {
  held_.turn = over(held_, 1.0F).yaw_rad;
  held_.kind = OdometrySample::Kind::kTwist;
  steady_ = ReadingLowPass<float>(noise_.steady_s);
  steady_.add(held_.speed_mps, held_.turn, 0.0F);
  by_images_ = true;
}

void OdometryMotion::correct(float speed_mps, float yaw_rate, std::int64_t t_us) {
  held_.speed_mps += speed_mps;
  held_.turn += yaw_rate;
  seen_us_ = t_us;
}

OdometryMotion::Step OdometryMotion::over(const OdometrySample& reading, float dt_s) const {
  if (!(dt_s > 0.0F)) return {};
  const PlanarIncrement<float> increment = increment_of(reading, dt_s, 1.0F, 0.0F);
  return {increment.distance_m, increment.turn_rad};
}

/// Of one step, at least a third of |reading - low-passed reading|, so that the search windows stay
/// wide enough after an outlier.
float OdometryMotion::sigma_speed(float scale, float slip_mps) const {
  const float off = abs(held_.speed_mps - steady_.speed()) / kFarInSigmas;
  return larger(larger(scale * noise_.sigma_speed_mps, off), slip_mps);
}

PlanarIncrement<float> OdometryMotion::increment_over(float dt_s, float slip_mps) const {
  if (!(dt_s > 0.0F)) return {};
  // The noise is stated per sample_period: cut into shorter steps its sum must stay the same.
  const float scale = sqrt(noise_.sample_period_s / dt_s);
  PlanarIncrement<float> increment = increment_of(held_, dt_s, scale, slip_mps);
  // Noise linearised at the reading would be correlated with the reading's own error: the filter
  // would explain each steering error by a change of speed. Only a larger speed is taken from it.
  OdometrySample linearised = held_;
  linearised.speed_mps = steady_.speed();
  linearised.turn = steady_.turn();
  if (abs(held_.speed_mps) > abs(linearised.speed_mps)) linearised.speed_mps = held_.speed_mps;
  increment.covariance = increment_of(linearised, dt_s, scale, slip_mps).covariance;
  return increment;
}

PlanarIncrement<float> OdometryMotion::increment_of(const OdometrySample& reading, float dt_s,
                                                    float scale, float slip_mps) const {
  // Along the arc: a step that keeps the old heading leaves out half a turn's way to the side,
  // which the camera sees, and the filter takes for a turn.
  constexpr IncrementModel kModel = IncrementModel::kExactArc;
  const float off = abs(held_.turn - steady_.turn()) / kFarInSigmas;
  const float sigma_turn = scale * (off > noise_.sigma_turn ? off : noise_.sigma_turn);
  const float sigma = sigma_speed(scale, slip_mps);
  return reading.kind == OdometrySample::Kind::kAckermann
             ? ackermann_increment(reading.speed_mps, reading.turn, dt_s, noise_.wheelbase_m, sigma,
                                   sigma_turn, kModel)
             : twist_increment(reading.speed_mps, reading.turn, dt_s, sigma, sigma_turn, kModel);
}

/// In a turn the vehicle slips in one direction for about a second: noise that stays correlated for
/// a time tau adds 2 sigma^2 tau a second to the variance.
float OdometryMotion::lateral_slip_over(float dt_s) const {
  constexpr float kTurn_s = 1.0F;
  if (at_rest()) return 0.0F;
  const float yaw_rate = over(steady(), 1.0F).yaw_rad;
  return 2.0F * kTurn_s * dt_s * square(noise_.turn_centre_m * yaw_rate);
}

/// By how much the yaw rate held differs from the low-passed one beyond the noise of a sample.
/// Held, it is wrong by that in one direction.
float OdometryMotion::yaw_outlier() const {
  if (!has_sample_) return 0.0F;
  OdometrySample usual = held_;
  usual.turn = steady_.turn();
  const float off = abs(over(held_, 1.0F).yaw_rad - over(usual, 1.0F).yaw_rad);
  OdometrySample noisy = usual;
  noisy.turn += kFarInSigmas * noise_.sigma_turn;
  const float noise = abs(over(noisy, 1.0F).yaw_rad - over(usual, 1.0F).yaw_rad);
  return off > noise ? off - noise : 0.0F;
}

/// Speed and yaw rate, sure at the sample, drift to the unknown within the longest step and stay
/// there: the deviation of the path is u t^2 / (2 max) first, and u (t - max / 2) from then on.
OdometryMotion::Drift OdometryMotion::drift_between(float from_s, float to_s) const {
  constexpr float kMostPosition_m = 1e3F;
  const float max_s = max_step_s();
  const float speed = larger(noise_.unknown_speed_mps, abs(held_.speed_mps));
  const float yaw_rate = larger(noise_.unknown_yaw_rate_radps, abs(over(held_, 1.0F).yaw_rad));
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
OdometryMotion::Drift OdometryMotion::drift_between_samples(const OdometrySample& first,
                                                            const OdometrySample& last,
                                                            float step_s) const {
  constexpr float kBothEnds = 1.0F / 12.0F;
  constexpr float kShare = 0.3F;  // of the speed
  const float turned = over(last, 1.0F).yaw_rad - over(first, 1.0F).yaw_rad;
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
