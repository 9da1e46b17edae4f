#include "host_sim/experiments/consistency/simulation.hpp"

#include <cmath>
#include <stdexcept>

#include "cairn/numeric/math.hpp"
#include "cairn/planar/steady_ackermann.hpp"

#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

constexpr int kMostPlacementTries = 1000000;

std::vector<Eigen::Vector2d> draw_map(const SimulationConfig& config, GaussianRandom& source) {
  std::vector<Eigen::Vector2d> map;
  const double half = config.field_half_width_m;
  int tries = 0;
  while (static_cast<int>(map.size()) < config.landmarks) {
    if (++tries > kMostPlacementTries) {
      throw std::invalid_argument("the field has no room for so many landmarks at this spacing");
    }
    const double x = source.uniform(-half, half);
    const double y = source.uniform(-half, half);
    const Eigen::Vector2d candidate(x, y);
    bool free = true;
    for (const auto& other : map) {
      free = free && (other - candidate).norm() >= config.landmark_spacing_m;
    }
    if (free) map.push_back(candidate);
  }
  return map;
}

/// Heading change of step k on the closed path.
double path_turn(const SimulationConfig& config, int k) {
  const int count = config.steps_per_loop();
  const double phase = kTwoPi<double> * (k + 0.5) / count;
  return kTwoPi<double> / count * (1.0 + config.corner_sharpness * std::cos(4.0 * phase));
}

Pose2 path_start(const SimulationConfig& config) {
  Pose2 pose;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  const int count = config.steps_per_loop();
  for (int k = 0; k < count; ++k) {
    pose = advance(pose, config.speed_mps * config.time_step_s, path_turn(config, k));
    centre += pose.position / count;
  }
  Pose2 start;
  start.position = -centre;
  return start;
}

struct Ackermann {
  double speed_mps = 0.0;
  double steering_rad = 0.0;
};

Increment increment_of(const SimulationConfig& config, SteadyAckermann<double>& odometry,
                       const Ackermann& motion) {
  return odometry.increment(motion.speed_mps, motion.steering_rad, config.time_step_s,
                            config.wheelbase_m, config.speed_sigma_mps, config.steering_sigma_rad);
}

std::vector<PointSighting> observe(const SimulationConfig& config, const Pose2& truth,
                                   const std::vector<Eigen::Vector2d>& map,
                                   GaussianRandom& source) {
  std::vector<PointSighting> sightings;
  const Eigen::Matrix2d to_vehicle = rotation2(truth.heading).transpose();
  for (int i = 0; i < static_cast<int>(map.size()); ++i) {
    const Eigen::Vector2d point = to_vehicle * (map[i] - truth.position);
    const double range = point.norm();
    if (range >= config.range_m || range <= config.minimum_range_m) continue;
    const double noise_x = source.normal(config.observation_sigma_m);
    const double noise_y = source.normal(config.observation_sigma_m);
    sightings.push_back({i, point + Eigen::Vector2d(noise_x, noise_y)});
  }
  return sightings;
}

}  // namespace

int SimulationConfig::steps_per_loop() const {
  return static_cast<int>(std::lround(loop_s / time_step_s));
}

SimulatedRun simulate_run(const SimulationConfig& config, std::uint64_t seed, int run) {
  GaussianRandom map_source(stream_seed(seed, 2 * static_cast<std::uint64_t>(run)));
  GaussianRandom source(stream_seed(seed, 2 * static_cast<std::uint64_t>(run) + 1),
                        kExperimentPhase);

  SimulatedRun result;
  result.landmarks = draw_map(config, map_source);
  result.true_start = path_start(config);
  result.start_covariance =
      Eigen::Vector3d(config.position_variance_m2, config.position_variance_m2,
                      config.heading_variance_rad2)
          .asDiagonal();
  result.estimated_start = result.true_start;
  for (int axis = 0; axis < 2; ++axis) {
    result.estimated_start.position(axis) += source.normal(std::sqrt(config.position_variance_m2));
  }
  result.estimated_start.heading = wrap_angle(
      result.true_start.heading + source.normal(std::sqrt(config.heading_variance_rad2)));

  Pose2 truth = result.true_start;
  const bool steady = config.noise_point == NoisePoint::kSteady;
  SteadyAckermann<double> odometry(steady ? config.steady_s : 0.0);
  SteadyAckermann<double> at_truth(0.0);
  result.steps.resize(static_cast<std::size_t>(config.steps()));
  for (int k = 0; k < config.steps(); ++k) {
    SimulatedStep& step = result.steps[static_cast<std::size_t>(k)];
    const double forward = config.speed_mps * config.time_step_s;
    const double turn = path_turn(config, k);
    truth = advance(truth, forward, turn);
    const double steering = std::atan(turn * config.wheelbase_m / forward);
    const Ackermann exact = {config.speed_mps, steering};
    Ackermann reading = exact;
    reading.speed_mps += source.normal(config.speed_sigma_mps);
    reading.steering_rad += source.normal(config.steering_sigma_rad);
    step.odometry = increment_of(config, odometry, reading);
    if (config.noise_point == NoisePoint::kTruth) {
      step.odometry.covariance = increment_of(config, at_truth, exact).covariance;
    }
    step.truth = truth;
    step.has_update = k % config.steps_per_update == 0;
    if (step.has_update) step.sightings = observe(config, truth, result.landmarks, source);
  }
  return result;
}

}  // namespace cairn::host
