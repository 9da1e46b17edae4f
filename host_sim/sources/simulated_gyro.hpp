#pragma once

#include <cstdint>
#include <vector>

#include "cairn/tracking/angular_rate.hpp"

#include "host_sim/io/pose_file.hpp"

namespace cairn::host {

/// A gyroscope that a camera's true poses would have moved.
struct GyroSimulation {
  double rate_hz = 200.0;
  double noise_density = 1e-3;     ///< rad/s/sqrt(Hz)
  double bias_sigma_radps = 0.01;  ///< of each axis at the start
  double bias_walk = 1e-4;         ///< rad/s/sqrt(s)
  double delay_s = 0.0;            ///< stamps are later than what they tell by so much
  double range_radps = 34.9;       ///< readings stop there
  Quaternion<double> R_camera_gyro = Quaternion<double>(1.0, 0.0, 0.0, 0.0);
  std::uint64_t seed = 1;
};

/// Samples over the time of `truth` (T_world_camera): the rate of a smooth rotation through the
/// poses (Hermite, the rates at the poses from their neighbours), a constant and a walking bias,
/// and white noise. Steps of the truth longer than 0.2 s have none. Domain: two poses or more,
/// strictly increasing times.
std::vector<AngularRateSample> simulate_gyro(const std::vector<TimedPose>& truth,
                                             const GyroSimulation& settings);

}  // namespace cairn::host
