#include "cairn/tracking/odometry_integrator.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {

void OdometryIntegrator::reset(const OdometryNoise& noise, std::int64_t max_step_us,
                               std::int64_t t_us) {
  *this = OdometryIntegrator();
  noise_ = noise;
  max_step_us_ = max_step_us;
  time_us_ = t_us;
}

Status OdometryIntegrator::take(const OdometrySample& sample, Health& health) {
  if (!is_finite(sample.speed_mps) || !is_finite(sample.turn)) {
    ++health.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (sample.t_us < time_us_ && has_motion_ && sample.t_us <= motion_.t_us) {
    ++health.time_errors;
    return Status::kTimeBackwards;
  }
  steady_motion_ = has_motion_ ? steadied(sample) : sample;
  motion_ = sample;
  has_motion_ = true;
  return Status::kOk;
}

/// Low pass of the readings over `steady_s`.
OdometrySample OdometryIntegrator::steadied(const OdometrySample& sample) const {
  const float dt = static_cast<float>(sample.t_us - motion_.t_us) * 1e-6F;
  const float share = dt > 0.0F ? dt / (dt + noise_.steady_s) : 0.0F;
  OdometrySample steady = sample;
  steady.speed_mps =
      steady_motion_.speed_mps + share * (sample.speed_mps - steady_motion_.speed_mps);
  steady.turn = steady_motion_.turn + share * (sample.turn - steady_motion_.turn);
  return steady;
}

PlanarIncrement<float> OdometryIntegrator::increment_over(float dt_s) const {
  // The noise is stated per sample_period: cut into shorter steps its sum must stay the same.
  const float scale = sqrt(noise_.sample_period_s / dt_s);
  PlanarIncrement<float> increment = increment_of(motion_, dt_s, scale);
  // Noise linearised at the reading would correlate with the reading's own error: a steering error
  // would each time be taken for a slower vehicle. Only the size of the speed may come from it.
  OdometrySample linearised = steady_motion_;
  if (abs(motion_.speed_mps) > abs(linearised.speed_mps)) linearised.speed_mps = motion_.speed_mps;
  increment.covariance = increment_of(linearised, dt_s, scale).covariance;
  return increment;
}

PlanarIncrement<float> OdometryIntegrator::increment_of(const OdometrySample& motion, float dt_s,
                                                        float scale) const {
  // The windows must hold what a wild reading says too: one that lies far off those before it.
  constexpr float kFarInSigmas = 3.0F;
  const float off = abs(motion_.turn - steady_motion_.turn) / kFarInSigmas;
  const float sigma_turn = scale * (off > noise_.sigma_turn ? off : noise_.sigma_turn);
  const float sigma_speed = scale * noise_.sigma_speed_mps;
  return motion.kind == OdometrySample::Kind::kAckermann
             ? ackermann_increment(motion.speed_mps, motion.turn, dt_s, noise_.wheelbase_m,
                                   sigma_speed, sigma_turn)
             : twist_increment(motion.speed_mps, motion.turn, dt_s, sigma_speed, sigma_turn);
}

}  // namespace cairn
