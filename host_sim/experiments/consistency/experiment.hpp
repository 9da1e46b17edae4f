#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/base/shard.hpp"
#include "host_sim/experiments/consistency/fixed_sums.hpp"
#include "host_sim/experiments/consistency/simulation.hpp"

namespace cairn::host {

struct ExperimentConfig {
  SimulationConfig simulation;
  int runs = 50;
  std::uint64_t seed = 1;
  std::vector<std::string> filters;
  Shard shard;
  int threads = 0;  ///< 0: as many as the machine has; never changes the result
};

/// Wall time of the calls of one filter. Not part of what must repeat.
struct CallTimes {
  double predict_s = 0.0;
  double update_s = 0.0;
  std::int64_t predictions = 0;
  std::int64_t updates = 0;
};

/// One filter's sums over the runs done.
struct FilterSums {
  std::string filter;
  FixedSums nees;
  FixedSums position_squared;
  FixedSums heading_squared;
  /// Per loop, at its end: sum of the landmarks' NEES, and the number of landmarks, one entry each.
  FixedSums landmark_nees;
  std::vector<std::int64_t> landmark_count;
  std::int64_t saturations = 0;  ///< of a filter in fixed point
  CallTimes times;
};

/// Estimated path of the first run, for the picture of the field.
struct SamplePath {
  std::string filter;
  std::vector<PoseEstimate> poses;  ///< per step
};

struct ExperimentResult {
  ExperimentConfig config;
  int runs_done = 0;
  std::vector<int> shards_done;  ///< indices, ascending
  std::vector<FilterSums> filters;
  std::vector<SamplePath> sample;  ///< only from the shard that holds run 0
};

/// Fresh sums for the experiment's filters.
FilterSums make_filter_sums(const std::string& filter, const SimulationConfig& simulation);

/// Runs the shard. `progress(done, total)` is called under a lock after every run.
ExperimentResult run_experiment(const ExperimentConfig& config,
                                const std::function<void(int, int)>& progress);

/// Adds `other`'s sums to `result`. Throws std::invalid_argument when the two are not shards of the
/// same experiment, or share a shard.
void merge_experiment(ExperimentResult& result, const ExperimentResult& other);

/// Figures of one filter over one loop.
struct LoopFigures {
  double nees_mean = 0.0;
  double inside_percent = 0.0;  ///< steps whose average NEES lies in the band
  double position_rmse_m = 0.0;
  double heading_rmse_rad = 0.0;
  double landmark_nees_mean = 0.0;  ///< 2 degrees of freedom, at the loop's end
};
LoopFigures loop_figures(const ExperimentResult& result, const FilterSums& sums, int loop);

}  // namespace cairn::host
