#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/base/shard.hpp"
#include "host_sim/experiments/turntable/points_simulation.hpp"

namespace cairn::host {

/// A sensor and its faults.
struct TurntableCondition {
  std::string name;
  PointsScenario scenario;
};

/// A filter as it is configured by someone who knows, or does not know, the camera's lever.
struct TurntableVariant {
  std::string name;
  MonoParameters<float> parameters;
  bool bank = false;
};

struct TurntableCell {
  std::string condition;
  std::string variant;
  std::vector<PointsResult> runs;  ///< by seed
};

struct TurntableConfig {
  TurntableExperiment experiment = TurntableExperiment::kYaw70;
  std::vector<double> fading = {1.0, 1.003, 1.006, 1.009, 1.015, 1.03};
  bool adaptive = true;
  std::string condition;  ///< only conditions with this in their name
  std::uint64_t seed = 1;
  int seeds = 20;
  Shard shard;  ///< runs are numbered by cell, then seed; those of other shards stay empty
};

/// On the axis and 8 cm off it: clean, focal length wrong by +3 % and -5 %, noise of 1 px, 25 % and
/// 50 % outliers; those that `config` wants.
std::vector<TurntableCondition> turntable_conditions(const TurntableConfig& config);

/// Paper B's filter with every fading factor and with the adaptive one; six degrees of freedom that
/// know that the camera starts at rest (velocity 0 +- 0.05 m/s, 0.05 m/s per sqrt(s)) and how noisy
/// a pixel is; and ours: rotation only (on
/// the axis), pivot with the lever known to 5 mm and pivot bank with the lever unknown (off it),
/// each with and without the focal length in the state.
std::vector<TurntableVariant> turntable_variants(const TurntableConfig& config,
                                                 const TurntableCondition& condition);

/// Every variant in every condition, on all of the machine's threads; the result does not depend on
/// them.
std::vector<TurntableCell> run_turntable(const TurntableConfig& config,
                                         const std::function<void(int, int)>& progress);

/// Median over the runs of one figure, and the largest.
double median_of(const std::vector<PointsResult>& runs, double PointsResult::*figure);
double worst_of(const std::vector<PointsResult>& runs, double PointsResult::*figure);

}  // namespace cairn::host
