#include "cairn/tracking/odometry_trust.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kExcessWindow_s = 0.25F;
constexpr float kBlind = 0.5F;  // of the longest step: images then contradict nothing

float larger(float a, float b) {
  return a > b ? a : b;
}

/// What the samples' noise makes of the low-passed difference, and a share of the speed for what is
/// wrong with scales.
float most_contradiction(float speed_mps, const OdometryNoise& noise) {
  constexpr float kSigmas = 3.5F;
  constexpr float kShare = 0.2F;
  return kSigmas * noise.sigma_speed_mps * sqrt(noise.sample_period_s / (2.0F * kExcessWindow_s)) +
         kShare * abs(speed_mps);
}

}  // namespace

bool OdometryTrust::is_glitch(const OdometrySample& sample, const OdometryMotion& motion) {
  constexpr float kNoiseInSigmas = 6.0F;
  const OdometryNoise& noise = motion.noise();
  const float dt_s = motion.seconds_since_sample(sample.t_us);
  if (!motion.has_sample() || !(dt_s > 0.0F)) return false;
  const float scale = sqrt(noise.sample_period_s / dt_s);
  const float most = noise.max_acceleration_mps2 * dt_s +
                     kNoiseInSigmas * larger(1.0F, scale) * noise.sigma_speed_mps;
  const float jump = abs(sample.speed_mps - motion.held().speed_mps);
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
  const float unknown = larger(noise.unknown_speed_mps, abs(motion.held().speed_mps));
  slip_mps_ = larger(slip_mps_, jump < unknown ? jump : unknown);
  return true;
}

bool OdometryTrust::is_contradicted(const OdometrySample& sample, const OdometryMotion& motion) {
  if (!contradicted_) return false;
  const float dt_s = motion.seconds_since_sample(sample.t_us);
  const float excess = motion.held().speed_mps - sample.speed_mps;
  excess_mps_ += dt_s / (dt_s + kExcessWindow_s) * (excess - excess_mps_);
  const bool agrees =
      abs(excess_mps_) < 0.5F * most_contradiction(sample.speed_mps, motion.noise());
  const bool blind = motion.seconds_since_known(sample.t_us) > kBlind * motion.max_step_s();
  if (blind) slip_mps_ = larger(slip_mps_, motion.noise().unknown_speed_mps);
  doubted_s_ += dt_s;
  contradicted_ = !agrees && !blind && doubted_s_ < kLongestContradiction_s;
  if (agrees || blind) doubted_s_ = 0.0F;
  return contradicted_;
}

bool OdometryTrust::note_image(float ahead_m, float step_s, const OdometryMotion& motion) {
  excess_mps_ += (ahead_m - step_s * excess_mps_) / (step_s + kExcessWindow_s);
  contradicted_ = !(doubted_s_ > 0.0F) &&
                  abs(excess_mps_) > most_contradiction(motion.held().speed_mps, motion.noise());
  return contradicted_;
}

/// Wheels that slip are wrong by about the vehicle's speed; more was an error of the pose before.
void OdometryTrust::note_slip(float seen_mps, float step_s, const OdometryMotion& motion) {
  constexpr float kFarInSigmas = 3.0F;
  const OdometryNoise& noise = motion.noise();
  const float most = larger(noise.unknown_speed_mps, abs(motion.held().speed_mps));
  const float rate = seen_mps < most ? seen_mps : most;
  if (rate > kFarInSigmas * noise.sigma_speed_mps * sqrt(noise.sample_period_s / step_s)) {
    slip_mps_ = larger(slip_mps_, rate);
  }
}

void OdometryTrust::fade(float step_s) {
  constexpr float kLasts_s = 0.5F;
  slip_mps_ *= kLasts_s / (kLasts_s + step_s);
  if (!contradicted_ && doubted_s_ > 0.0F) doubted_s_ -= step_s;
}

}  // namespace cairn
