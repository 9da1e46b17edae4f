#pragma once

#include <cstdint>

#include "cairn/base/health.hpp"
#include "cairn/tracking/gyro_calibration.hpp"
#include "cairn/tracking/gyro_integrator.hpp"

namespace cairn {

/// What a tracker knows of its gyroscope.
struct GyroReport {
  GyroTrust trust = GyroTrust::kUnproven;
  Vector3<float> bias_radps = Vector3<float>::Zero();  ///< camera axes
  float bias_sigma_radps = 0.0F;
  float time_offset_s = 0.0F;  ///< by which its stamps are late
  float time_offset_sigma_s = 0.0F;
  std::uint32_t samples = 0;  ///< taken
  std::uint32_t refused = 0;
  std::uint32_t saturated = 0;
  std::uint32_t gaps = 0;
  int ways = 0;             ///< turns compared with the pictures'
  float difference = 0.0F;  ///< of them: 0 equal, 1 no better than nothing, 4 opposite
  Matrix3<float> products = Matrix3<float>::Zero();  ///< as GyroCalibration::products()
};

/// What a gyroscope tells a hand-held tracker: the turn since the frame before and since the last
/// keyframe, and how sure they are. Without samples nothing is ever known.
class HandheldGyro {
 public:
  /// Starts anew. Domain: valid parameters.
  void reset(const GyroParameters& parameters) {
    *this = HandheldGyro();
    integrator_.reset(parameters);
    calibration_.reset(parameters);
  }

  /// As GyroIntegrator::add().
  Status add(const AngularRateSample& sample, Health& health) {
    return integrator_.add(sample, health);
  }

  /// Begins a frame: turn() is that since the frame before.
  void take_frame(std::int64_t t_us) {
    turn_ = integrator_.take_frame(t_us);
    calibration_.age(turn_.seconds);
    keyframe_.add(turn_);
  }
  const GyroTurn& turn() const { return turn_; }
  float turn_variance() const { return calibration_.variance_of(turn_); }
  /// Whether the turn may say where to search.
  bool predicts() const { return turn_.known && calibration_.trust() != GyroTrust::kContradicted; }
  /// Whether it may be measured by: it has been right so far.
  bool sure() const { return turn_.known && calibration_.trust() == GyroTrust::kAgrees; }

  /// The frame's pose holds by the pictures.
  void note_pose(const SeenAttitude& seen) {
    if (!calibration_.add(turn_, seen)) return;
    integrator_.set_bias(calibration_.bias());
    integrator_.set_time_offset(calibration_.time_offset_s());
  }
  /// It does not.
  void note_weak() { calibration_.skip(); }

  /// The frame becomes a keyframe.
  void note_keyframe() { keyframe_ = Way(); }
  /// The turn since the last one: R_keyframe_present, and its variance. False where it is not sure.
  bool since_keyframe(Quaternion<float>& turned, float& variance) const {
    if (keyframe_.broken || calibration_.trust() != GyroTrust::kAgrees) return false;
    turned = keyframe_.turned;
    variance = calibration_.variance_of(keyframe_.noise, rotation_log(turned), keyframe_.seconds,
                                        turn_.rate_after - turned.conjugate() * keyframe_.rate);
    return keyframe_.seconds > 0.0F;
  }

  GyroReport report() const {
    return {calibration_.trust(),
            calibration_.bias(),
            calibration_.bias_sigma(),
            calibration_.time_offset_s(),
            calibration_.time_offset_sigma_s(),
            integrator_.taken(),
            integrator_.refused(),
            integrator_.saturated(),
            integrator_.gaps(),
            calibration_.ways(),
            calibration_.difference(),
            calibration_.products()};
  }
  const GyroIntegrator& integrator() const { return integrator_; }
  const GyroCalibration& calibration() const { return calibration_; }

 private:
  struct Way {
    bool broken = false;
    Quaternion<float> turned = Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F);
    Vector3<float> rate = Vector3<float>::Zero();  ///< at its start
    float seconds = 0.0F;
    float noise = 0.0F;

    void add(const GyroTurn& turn) {
      broken = broken || !turn.known;
      if (broken) return;
      if (!(seconds > 0.0F)) rate = turn.rate_before;
      turned = turned * rotation_exp(turn.rotation);
      turned.coeffs() *= 1.0F / sqrt(turned.squaredNorm());
      seconds += turn.seconds;
      noise += turn.variance;
    }
  };

  GyroIntegrator integrator_;
  GyroCalibration calibration_;
  GyroTurn turn_;
  Way keyframe_;
};

}  // namespace cairn
