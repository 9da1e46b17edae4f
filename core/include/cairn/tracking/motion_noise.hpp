#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// The motion noise of a hand-held camera as its estimated motion shows it: how much velocity and
/// rate change from frame to frame. It rises at once with a change and falls slowly, so that a calm
/// hand has small search windows and a fast one large enough ones.
class MotionNoise {
 public:
  struct Parameters {
    float least_velocity_noise = 0.14F;  ///< m/s per sqrt(s)
    float most_velocity_noise = 2.0F;
    float least_rate_noise = 0.35F;  ///< rad/s per sqrt(s)
    float most_rate_noise = 4.0F;
    float gain = 1.0F;         ///< noise for each unit of change per sqrt(s) seen
    float memory = 0.9F;       ///< share of the largest squared change that a frame leaves
    float weak_growth = 2.0F;  ///< factor for each frame without a consensus

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = is_positive(least_velocity_noise) && is_positive(least_rate_noise) &&
                        is_finite(most_velocity_noise) && is_finite(most_rate_noise) &&
                        most_velocity_noise >= least_velocity_noise &&
                        most_rate_noise >= least_rate_noise && is_positive(gain) &&
                        memory >= 0.0F && memory <= 1.0F && is_finite(weak_growth) &&
                        weak_growth >= 1.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    begin();
  }
  /// Expects calm motion, and no change to the motion of the next frame.
  void begin() {
    velocity_level_ = rate_level_ = 0.0F;
    known_ = false;
  }

  /// The camera's motion after a frame that was tracked, `dt_s` after the one before.
  void note(const Vector3<float>& velocity_mps, const Vector3<float>& rate_radps, float dt_s) {
    if (known_ && dt_s > 0.0F) {
      raise((velocity_mps - velocity_).squaredNorm() / (3.0F * dt_s), velocity_level_);
      raise((rate_radps - rate_).squaredNorm() / (3.0F * dt_s), rate_level_);
    }
    velocity_ = velocity_mps;
    rate_ = rate_radps;
    known_ = true;
  }
  /// The rate changed by so much within the step that is predicted next, as the pictures show.
  void note_rate_change(const Vector3<float>& change_radps, float dt_s) {
    if (dt_s > 0.0F) raise(change_radps.squaredNorm() / (3.0F * dt_s), rate_level_, 1.0F);
  }
  /// A frame whose motion could not be told: it was more than expected.
  void note_weak() {
    const float growth = parameters_.weak_growth / parameters_.gain;
    velocity_level_ = square(growth * velocity_noise());
    rate_level_ = square(growth * rate_noise());
    known_ = false;
  }

  /// Of the next prediction.
  float velocity_noise() const {
    return clamp(parameters_.gain * sqrt(velocity_level_), parameters_.least_velocity_noise,
                 parameters_.most_velocity_noise);
  }
  float rate_noise() const {
    return clamp(parameters_.gain * sqrt(rate_level_), parameters_.least_rate_noise,
                 parameters_.most_rate_noise);
  }

 private:
  void raise(float squared_change, float& level) const {
    raise(squared_change, level, parameters_.memory);
  }
  static void raise(float squared_change, float& level, float memory) {
    level *= memory;
    if (squared_change > level) level = squared_change;
  }

  Parameters parameters_;
  Vector3<float> velocity_ = Vector3<float>::Zero();
  Vector3<float> rate_ = Vector3<float>::Zero();
  float velocity_level_ = 0.0F;  ///< squared noise
  float rate_level_ = 0.0F;
  bool known_ = false;  ///< velocity_ and rate_ are of the frame before
};

}  // namespace cairn
