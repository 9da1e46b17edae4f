#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/base/planar_types.hpp"

namespace cairn::host {

/// Where the covariance of an odometry increment is linearised.
enum class NoisePoint {
  kReading,  ///< at the noisy reading itself
  kSteady,   ///< at readings low-passed over SimulationConfig::steady_s
  kTruth,    ///< at the true speed and steering: what no vehicle has, the bound
};

/// The world of paper A, section 4.1: a 20 m x 20 m field of point landmarks, a vehicle with
/// Ackermann odometry on a closed rounded-square path, Cartesian observations of the landmarks in
/// range. The paper leaves sensor, rate, wheelbase, speed and map open; the values here are ours.
struct SimulationConfig {
  double field_half_width_m = 10.0;
  int landmarks = 30;
  double landmark_spacing_m = 0.8;  ///< smallest distance between two landmarks
  double time_step_s = 0.1;
  double loop_s = 80.0;
  int loops = 2;
  double speed_mps = 0.55;
  double wheelbase_m = 0.5;
  double corner_sharpness = 0.6;  ///< curvature k0 (1 + sharpness cos(4 phase)): 0 is a circle
  double range_m = 6.0;
  double minimum_range_m = 0.2;
  int steps_per_update = 5;  ///< an observation every 0.5 s
  double observation_sigma_m = 0.1;
  double speed_sigma_mps = 0.1;
  double steering_sigma_rad = 0.0872664625997165;  ///< 5 degrees
  NoisePoint noise_point = NoisePoint::kReading;
  double steady_s = 0.3;
  double position_variance_m2 = 1.0;
  double heading_variance_rad2 = 0.001;

  int steps_per_loop() const;
  int steps() const { return loops * steps_per_loop(); }
};

/// What the filters get at one step, and the truth after it.
struct SimulatedStep {
  Increment odometry;
  bool has_update = false;
  std::vector<PointSighting> sightings;
  Pose2 truth;
};

struct SimulatedRun {
  std::vector<Eigen::Vector2d> landmarks;
  Pose2 true_start;
  Pose2 estimated_start;  ///< drawn from N(true_start, start_covariance)
  Eigen::Matrix3d start_covariance = Eigen::Matrix3d::Zero();
  std::vector<SimulatedStep> steps;
};

/// Run number `run` of the experiment with seed `seed`: map, start error and all noises. The same
/// arguments give the same run, whatever else is computed before or beside it.
SimulatedRun simulate_run(const SimulationConfig& config, std::uint64_t seed, int run);

}  // namespace cairn::host
