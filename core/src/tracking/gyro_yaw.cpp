#include "cairn/tracking/gyro_yaw.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {

void GyroYaw::reset(const GyroParameters& parameters, const Rigid<float>& T_vehicle_camera) {
  *this = GyroYaw();
  parameters_ = parameters;
  // In the vehicle's axes: z up is what a yaw turns about.
  GyroParameters mounted = parameters;
  mounted.R_camera_gyro = T_vehicle_camera.rotation * parameters.R_camera_gyro;
  integrator_.reset(mounted);
  variance_ = square(parameters.bias_sigma_radps);
}

/// What the gyroscope reads beyond the motion is the bias: a Kalman filter of one state. Beyond 5
/// sigma it is something else.
void GyroYaw::correct(float seen, float variance) {
  constexpr float kGate = 25.0F;
  const float off = seen - bias_;
  const float total = variance_ + variance;
  if (!(total > 0.0F) || off * off > kGate * total) return;
  bias_ += variance_ / total * off;
  variance_ -= square(variance_) / total;
}

OdometrySample GyroYaw::replace(const OdometrySample& sample, float wheels_sigma) {
  constexpr float kWheels = 3.0F;       // of their noise, which lasts
  constexpr float kWheelsShare = 0.1F;  // of their yaw rate: scale and slip
  const GyroTurn turn = integrator_.take_frame(sample.t_us);
  if (!turn.known || !(turn.seconds > 0.0F)) return sample;
  variance_ += square(parameters_.bias_walk) * turn.seconds;
  const float rate = turn.rotation.z() / turn.seconds;
  const float own = turn.variance / square(turn.seconds);
  const bool twist = sample.kind == OdometrySample::Kind::kTwist;
  const bool rests = sample.speed_mps == 0.0F && (!twist || sample.turn == 0.0F);
  if (rests) {
    correct(rate, own);
  } else if (twist && is_finite(sample.turn)) {
    correct(rate - sample.turn,
            own + square(kWheels * wheels_sigma) + square(kWheelsShare * sample.turn));
  }
  OdometrySample replaced = sample;
  replaced.kind = OdometrySample::Kind::kTwist;
  replaced.turn = rests ? 0.0F : rate - bias_;
  return replaced;
}

}  // namespace cairn
