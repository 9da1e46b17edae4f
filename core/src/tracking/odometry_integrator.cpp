#include "cairn/tracking/odometry_integrator.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {

void OdometryIntegrator::reset(const OdometryNoise& noise, std::int64_t max_step_us,
                               std::int64_t t_us) {
  *this = OdometryIntegrator();
  noise_ = noise;
  steady_ = SteadyReading<float>(noise.steady_s);
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
  steady_.take(sample.speed_mps, sample.turn,
               static_cast<float>(sample.t_us - motion_.t_us) * 1e-6F);
  motion_ = sample;
  has_motion_ = true;
  return Status::kOk;
}

PlanarIncrement<float> OdometryIntegrator::increment_over(float dt_s) const {
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

PlanarIncrement<float> OdometryIntegrator::increment_of(const OdometrySample& motion, float dt_s,
                                                        float scale) const {
  // Sigma is at least a third of |reading - low-passed reading|, so that the search windows stay
  // wide enough after an outlier.
  constexpr float kFarInSigmas = 3.0F;
  const float off = abs(motion_.turn - steady_.turn()) / kFarInSigmas;
  const float sigma_turn = scale * (off > noise_.sigma_turn ? off : noise_.sigma_turn);
  const float sigma_speed = scale * noise_.sigma_speed_mps;
  return motion.kind == OdometrySample::Kind::kAckermann
             ? ackermann_increment(motion.speed_mps, motion.turn, dt_s, noise_.wheelbase_m,
                                   sigma_speed, sigma_turn)
             : twist_increment(motion.speed_mps, motion.turn, dt_s, sigma_speed, sigma_turn);
}

}  // namespace cairn
