#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "cairn/geometry/rigid.hpp"
#include "cairn/tracking/angular_rate.hpp"

namespace cairn::host {

/// Reads a gyroscope's samples (CSV with a header): a time (`t_s`, `t_us`, ... or `t`, seconds or,
/// where it is one since 1970, by its size) and the rates about the sensor's axes, `wx`, `wy`, `wz`
/// in rad/s or with a unit in the name. EuRoC's imu0/data.csv is read as it is.
///
/// Throws InputError naming line and column for a rate beyond 200 rad/s either way, times that do
/// not increase, and fewer than two samples.
std::vector<AngularRateSample> read_gyro(const std::filesystem::path& path);

/// What the description of an IMU says (EuRoC's sensor.yaml, Kalibr's imu.yaml).
struct ImuFile {
  std::optional<double> noise_density;      ///< gyroscope_noise_density, rad/s/sqrt(Hz)
  std::optional<double> bias_walk;          ///< gyroscope_random_walk, rad/s/sqrt(s)
  std::optional<Rigid<double>> T_body_imu;  ///< T_BS
};

/// Throws InputError for a file that is none of these, or values outside their domain.
ImuFile read_imu_file(const std::filesystem::path& path);

}  // namespace cairn::host
