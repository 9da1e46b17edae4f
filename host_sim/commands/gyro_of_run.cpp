#include "host_sim/commands/gyro_of_run.hpp"

#include <cmath>
#include <filesystem>
#include <utility>

#include "host_sim/io/input_error.hpp"
#include "host_sim/sources/gyro_file.hpp"
#include "host_sim/sources/gyro_source.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

/// The gyroscope's noise and mounting: options before the IMU's file before the defaults.
GyroParameters gyro_parameters(const RunOptions& options, SourceInfo& info) {
  GyroParameters gyro;
  ImuFile imu;
  fs::path file = options.gyro_imu;
  if (file.empty() && fs::exists(options.gyro.parent_path() / "sensor.yaml")) {
    file = options.gyro.parent_path() / "sensor.yaml";
  }
  if (!file.empty()) {
    imu = read_imu_file(file);
    info.inputs.push_back(file);
  }
  const auto set = [](float& value, const std::optional<double>& by_file,
                      const std::optional<double>& by_option) {
    if (by_file) value = static_cast<float>(*by_file);
    if (by_option) value = static_cast<float>(*by_option);
  };
  set(gyro.noise_density, imu.noise_density, options.gyro_noise);
  set(gyro.bias_walk, imu.bias_walk, options.gyro_bias_walk);
  set(gyro.bias_sigma_radps, std::nullopt, options.gyro_bias_sigma);
  set(gyro.time_sigma_s, std::nullopt, options.gyro_time_sigma);
  Quaternion<double> rotation;
  if (!options.gyro_rotation.empty()) {
    const std::vector<double>& q = options.gyro_rotation;
    rotation = Quaternion<double>(q[0], q[1], q[2], q[3]);
    if (!(std::abs(rotation.norm() - 1.0) <= 0.01)) {
      throw UsageError("--gyro-rotation: expected a unit quaternion W,X,Y,Z");
    }
  } else if (info.T_body_camera) {
    const Rigid<double> T_body_imu = imu.T_body_imu.value_or(Rigid<double>());
    rotation = info.T_body_camera->rotation.conjugate() * T_body_imu.rotation;
  } else {
    throw UsageError(
        "--gyro: how it is turned against the camera is not known: expected --gyro-rotation, or "
        "T_BS, T_cam_imu or T_imu_cam in the camera file");
  }
  gyro.R_camera_gyro = rotation.normalized().cast<float>();
  return gyro;
}

}  // namespace

std::unique_ptr<FrameSource> with_gyro(std::unique_ptr<FrameSource> source,
                                       const RunOptions& options) {
  if (options.gyro.empty()) {
    const bool told = !options.gyro_imu.empty() || !options.gyro_rotation.empty() ||
                      options.gyro_noise || options.gyro_bias_sigma || options.gyro_bias_walk ||
                      options.gyro_time_sigma;
    if (told) throw UsageError("--gyro-...: only with --gyro");
    return source;
  }
  SourceInfo info = source->info();
  const GyroParameters parameters = gyro_parameters(options, info);
  return add_gyro(std::move(source), read_gyro(options.gyro), parameters, options.gyro);
}

}  // namespace cairn::host
