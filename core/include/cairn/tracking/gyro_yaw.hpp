#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/gyro_integrator.hpp"

namespace cairn {

/// A gyroscope's yaw rate in the place of the wheels': each odometry sample gets the mean rate
/// about the vehicle's vertical axis over the time since the sample before it, where the
/// gyroscope's samples cover it. Its bias is what it reads at rest (odometry says exactly none), or
/// else what it reads more than the wheels over a long time.
///
/// A part of its own before VehicleTracker::add_odometry(), so that vehicles without a gyroscope
/// pay nothing: OdometryNoise::sigma_turn is then GyroYaw::sigma_turn().
class GyroYaw {
 public:
  /// Starts anew. Domain: valid parameters, a mounting that validate_mounting() takes.
  void reset(const GyroParameters& parameters, const Rigid<float>& T_vehicle_camera);

  /// As GyroIntegrator::add(); samples up to an odometry sample's time come before it.
  Status add(const AngularRateSample& sample, Health& health) {
    return integrator_.add(sample, health);
  }
  /// The sample with the gyroscope's yaw rate, of kind kTwist; as it is where the gyroscope does
  /// not tell. `wheels_sigma`: of the wheels' own yaw rate, rad/s a sample.
  OdometrySample replace(const OdometrySample& sample, float wheels_sigma);

  /// Standard deviation of a yaw rate that replace() gives, rad/s, over `period_s`, with a bias as
  /// it is known at the start.
  static float sigma_turn(const GyroParameters& parameters, float period_s) {
    return sqrt(square(parameters.noise_density) / period_s + square(parameters.bias_sigma_radps));
  }

  float bias_radps() const { return bias_; }  ///< about the vehicle's axis
  float bias_sigma_radps() const { return sqrt(variance_); }
  const GyroIntegrator& integrator() const { return integrator_; }

 private:
  void correct(float seen, float variance);

  GyroParameters parameters_;
  GyroIntegrator integrator_;
  float bias_ = 0.0F;
  float variance_ = 0.0F;
};

}  // namespace cairn
