#include "host_sim/commands/source_options.hpp"

#include "host_sim/commands/option_checks.hpp"

namespace cairn::host {

void add_range_options(CLI::App& command, RunOptions& options) {
  command.add_option("--first-frame", options.first_frame, "Number of the first frame to use");
  command.add_option("--max-frames", options.max_frames, "Stop after this many frames")
      ->check(count());
}

void add_picture_options(CLI::App& command, RunOptions& options) {
  command
      .add_option("--scale", options.scale,
                  "Scale pictures and calibration by this factor; by default as far as needed")
      ->check(between(0.01, 1.0));
  command.add_option("--crop", options.crop,
                     "Use a part of the pictures, WIDTHxHEIGHT[+LEFT+TOP]; by default its middle");
  command.add_option("--camera", options.camera, "Camera file of a video source");
  command
      .add_option(
          "--hfov", options.hfov_deg,
          "Guess in place of a camera file: the picture's horizontal field of view, degrees")
      ->check(between(10.0, 150.0));
  command.add_option("--times", options.times, "Frame times of a video source (CSV)");
  command.add_option("--truth", options.truth, "True camera poses of a video source (TUM)");
}

void add_gyro_options(CLI::App& command, RunOptions& options) {
  command.add_option("--gyro", options.gyro,
                     "Gyroscope of the camera (CSV: t, wx, wy, wz; EuRoC's imu0/data.csv)");
  command.add_option("--gyro-imu", options.gyro_imu,
                     "Its noise and mounting (YAML: EuRoC's sensor.yaml, Kalibr's imu.yaml); by "
                     "default sensor.yaml beside the samples");
  command
      .add_option("--gyro-rotation", options.gyro_rotation,
                  "W,X,Y,Z: turns the gyroscope's axes to those of the camera; by default by "
                  "T_BS or T_cam_imu of the files")
      ->delimiter(',')
      ->expected(4);
  command.add_option("--gyro-noise", options.gyro_noise, "Its noise density, rad/s/sqrt(Hz)")
      ->check(between(1e-6, 1.0));
  command
      .add_option("--gyro-bias", options.gyro_bias_sigma,
                  "Standard deviation of its bias at the start, rad/s")
      ->check(between(0.0, 10.0));
  command
      .add_option("--gyro-bias-walk", options.gyro_bias_walk, "How its bias walks, rad/s/sqrt(s)")
      ->check(between(0.0, 10.0));
  command
      .add_option("--gyro-time-sigma", options.gyro_time_sigma,
                  "Standard deviation of its time stamps' offset from the frames', s")
      ->check(between(0.0, 1.0));
}

void add_odometry_options(CLI::App& command, RunOptions& options) {
  command.add_option("--odometry", options.odometry, "Odometry of a video source (CSV)");
  command
      .add_option("--odometry-noise-speed", options.speed_sigma_mps,
                  "Standard deviation of the speed in a video's odometry, m/s a sample")
      ->check(above_zero());
  command
      .add_option("--odometry-noise-yaw-rate", options.yaw_rate_sigma_radps,
                  "Standard deviation of the yaw rate in a video's odometry, rad/s a sample")
      ->check(above_zero());
}

}  // namespace cairn::host
