#include "host_sim/commands/source_options.hpp"

#include "host_sim/commands/option_checks.hpp"

namespace cairn::host {

void add_range_options(CLI::App& command, RunOptions& options) {
  command.add_option("--first-frame", options.first_frame, "Number of the first frame to use");
  command.add_option("--max-frames", options.max_frames, "Stop after this many frames")
      ->check(above_zero());
}

void add_picture_options(CLI::App& command, RunOptions& options) {
  command
      .add_option("--scale", options.scale,
                  "Scale pictures and calibration by this factor; by default as far as needed")
      ->check(CLI::Range(0.01, 1.0));
  command.add_option("--crop", options.crop,
                     "Use a part of the pictures, WIDTHxHEIGHT[+LEFT+TOP]; by default its middle");
  command.add_option("--camera", options.camera, "Camera file of a video source");
  command
      .add_option(
          "--hfov", options.hfov_deg,
          "Guess in place of a camera file: the picture's horizontal field of view, degrees")
      ->check(CLI::Range(10.0, 150.0));
  command.add_option("--times", options.times, "Frame times of a video source (CSV)");
  command.add_option("--truth", options.truth, "True camera poses of a video source (TUM)");
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
