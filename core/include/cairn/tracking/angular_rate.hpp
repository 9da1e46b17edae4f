#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// One reading of a gyroscope: the rate about the sensor's own axes, seen by the sensor.
struct AngularRateSample {
  std::int64_t t_us = 0;  ///< of the frames' clock, but for an offset that is estimated
  Vector3<float> rate_radps = Vector3<float>::Zero();
};

/// How a gyroscope is mounted and how good it is. The defaults are those of a phone whose sensor
/// and picture times are not calibrated; a data sheet's noise density and bias are better.
struct GyroParameters {
  static constexpr float kLargestRate_radps = 200.0F;

  /// Turns vectors of the sensor's axes to those of the camera.
  Quaternion<float> R_camera_gyro = Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F);
  float noise_density = 1e-3F;      ///< rad/s/sqrt(Hz)
  float bias_sigma_radps = 0.02F;   ///< of each axis, at the start
  float bias_walk = 1e-4F;          ///< rad/s/sqrt(s)
  float scale_sigma = 0.01F;        ///< of a turn, relative: scale and mounting
  float time_sigma_s = 0.01F;       ///< of the stamps' offset from the frames', at the start
  float range_radps = 34.0F;        ///< an axis that reads more is saturated
  std::int64_t max_gap_us = 50000;  ///< a longer one between samples is not integrated

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const auto share = [](float v, float most) { return v >= 0.0F && v <= most; };
    const float squared = R_camera_gyro.squaredNorm();
    const bool good =
        squared > 0.999F && squared < 1.001F && is_positive(noise_density) &&
        noise_density <= 1.0F && share(bias_sigma_radps, 10.0F) && share(bias_walk, 10.0F) &&
        share(scale_sigma, 1.0F) && share(time_sigma_s, 1.0F) && is_positive(range_radps) &&
        range_radps <= kLargestRate_radps && max_gap_us >= 500 && max_gap_us <= 1000000;
    return good ? Status::kOk : Status::kBadConfig;
  }
};

/// How far the camera turned between two frames, by the gyroscope.
struct GyroTurn {
  bool known = false;                                ///< samples cover the time between the frames
  Vector3<float> rotation = Vector3<float>::Zero();  ///< R_previous_present = Exp(rotation)
  float seconds = 0.0F;
  float variance = 0.0F;  ///< of each axis, of the samples' noise and what was held, rad^2
  Vector3<float> rate_before = Vector3<float>::Zero();  ///< at the frames, camera axes, rad/s
  Vector3<float> rate_after = Vector3<float>::Zero();
};

}  // namespace cairn
