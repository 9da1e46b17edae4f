#include "host_sim/experiments/consistency/experiment.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <stdexcept>

#include "cairn/numeric/math.hpp"

#include "host_sim/base/parallel_for.hpp"
#include "host_sim/base/statistics.hpp"
#include "host_sim/evaluation/planar_nees.hpp"
#include "host_sim/experiments/consistency/filter.hpp"

namespace cairn::host {
namespace {

using Clock = std::chrono::steady_clock;

// Resolutions: 1e-6 of NEES up to 1e7, 1.5e-11 m^2 up to 1e4, 5.7e-14 rad^2 up to 10; 8e5, 1.3e4
// and 5e4 runs at the very largest sample fit 63 bits.
constexpr double kNeesScale = 1048576.0;
constexpr double kLargestNees = 1e7;
constexpr double kPositionScale = 68719476736.0;
constexpr double kLargestPosition = 1e4;
constexpr double kHeadingScale = 17592186044416.0;
constexpr double kLargestHeading = 10.0;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void add_landmarks(const SimulatedRun& run, const FilterUnderTest& filter, int loop,
                   FilterSums& sums) {
  for (int i = 0; i < static_cast<int>(run.landmarks.size()); ++i) {
    LandmarkEstimate estimate;
    if (!filter.landmark(i, estimate)) continue;
    sums.landmark_nees.add(loop,
                           landmark_nees(estimate, run.landmarks[static_cast<std::size_t>(i)]));
    ++sums.landmark_count[static_cast<std::size_t>(loop)];
  }
}

void run_filter(const SimulationConfig& config, const SimulatedRun& run, FilterSums& sums,
                SamplePath* sample) {
  const auto filter = make_filter_under_test(sums.filter, config.landmarks);
  filter->initialise(run.estimated_start, run.start_covariance);
  const int loop_steps = config.steps_per_loop();
  for (int k = 0; k < config.steps(); ++k) {
    const SimulatedStep& step = run.steps[static_cast<std::size_t>(k)];
    const auto before_predict = Clock::now();
    filter->predict(step.odometry);
    sums.times.predict_s += seconds_since(before_predict);
    ++sums.times.predictions;
    if (step.has_update) {
      const auto before_update = Clock::now();
      filter->update(step.sightings, config.observation_sigma_m);
      sums.times.update_s += seconds_since(before_update);
      ++sums.times.updates;
    }
    const PoseEstimate estimate = filter->pose();
    const double heading_error = wrap_angle(step.truth.heading - estimate.pose.heading);
    sums.nees.add(k, pose_nees(estimate, step.truth));
    sums.position_squared.add(k, (step.truth.position - estimate.pose.position).squaredNorm());
    sums.heading_squared.add(k, heading_error * heading_error);
    if (sample != nullptr) sample->poses.push_back(estimate);
    if ((k + 1) % loop_steps == 0) add_landmarks(run, *filter, k / loop_steps, sums);
  }
  sums.saturations += filter->saturations();
}

void merge_sums(FilterSums& sums, const FilterSums& other) {
  sums.nees.add(other.nees);
  sums.position_squared.add(other.position_squared);
  sums.heading_squared.add(other.heading_squared);
  sums.landmark_nees.add(other.landmark_nees);
  for (std::size_t i = 0; i < sums.landmark_count.size(); ++i) {
    sums.landmark_count[i] += other.landmark_count[i];
  }
  sums.saturations += other.saturations;
  sums.times.predict_s += other.times.predict_s;
  sums.times.update_s += other.times.update_s;
  sums.times.predictions += other.times.predictions;
  sums.times.updates += other.times.updates;
}

std::vector<int> runs_of_shard(const ExperimentConfig& config) {
  std::vector<int> runs;
  for (int run = 0; run < config.runs; ++run) {
    if (config.shard.has(static_cast<std::size_t>(run))) runs.push_back(run);
  }
  return runs;
}

/// Every filter on run `number`, the same for all. The paths of run 0 go into `sample`.
std::vector<FilterSums> one_run(const ExperimentConfig& config, int number,
                                std::vector<SamplePath>& sample) {
  const SimulatedRun run = simulate_run(config.simulation, config.seed, number);
  std::vector<FilterSums> sums;
  for (const std::string& name : config.filters) {
    sums.push_back(make_filter_sums(name, config.simulation));
    if (number == 0) sample.push_back({name, {}});
    run_filter(config.simulation, run, sums.back(), number == 0 ? &sample.back() : nullptr);
  }
  return sums;
}

bool same_experiment(const ExperimentConfig& a, const ExperimentConfig& b) {
  const SimulationConfig& p = a.simulation;
  const SimulationConfig& q = b.simulation;
  return a.runs == b.runs && a.seed == b.seed && a.filters == b.filters &&
         a.shard.count == b.shard.count && p.landmarks == q.landmarks &&
         p.speed_sigma_mps == q.speed_sigma_mps && p.steering_sigma_rad == q.steering_sigma_rad &&
         p.noise_point == q.noise_point && p.steady_s == q.steady_s &&
         p.position_variance_m2 == q.position_variance_m2 &&
         p.heading_variance_rad2 == q.heading_variance_rad2 && p.loops == q.loops;
}

}  // namespace

FilterSums make_filter_sums(const std::string& filter, const SimulationConfig& simulation) {
  FilterSums sums;
  sums.filter = filter;
  sums.nees = FixedSums(simulation.steps(), kNeesScale, kLargestNees);
  sums.position_squared = FixedSums(simulation.steps(), kPositionScale, kLargestPosition);
  sums.heading_squared = FixedSums(simulation.steps(), kHeadingScale, kLargestHeading);
  sums.landmark_nees = FixedSums(simulation.loops, kNeesScale, kLargestNees);
  sums.landmark_count.assign(static_cast<std::size_t>(simulation.loops), 0);
  return sums;
}

ExperimentResult run_experiment(const ExperimentConfig& config,
                                const std::function<void(int, int)>& progress) {
  ExperimentResult result;
  result.config = config;
  result.shards_done = {config.shard.index};
  for (const auto& name : config.filters) {
    result.filters.push_back(make_filter_sums(name, config.simulation));
  }
  const std::vector<int> runs = runs_of_shard(config);
  std::mutex mutex;
  parallel_for(runs.size(), config.threads, [&](std::size_t i) {
    std::vector<SamplePath> sample;
    const std::vector<FilterSums> sums = one_run(config, runs[i], sample);
    const std::lock_guard<std::mutex> lock(mutex);
    for (std::size_t f = 0; f < sums.size(); ++f) merge_sums(result.filters[f], sums[f]);
    if (runs[i] == 0) result.sample = sample;
    ++result.runs_done;
    if (progress) progress(result.runs_done, static_cast<int>(runs.size()));
  });
  return result;
}

void merge_experiment(ExperimentResult& result, const ExperimentResult& other) {
  if (!same_experiment(result.config, other.config)) {
    throw std::invalid_argument("the parts are not shards of one experiment");
  }
  for (const int shard : other.shards_done) {
    if (std::count(result.shards_done.begin(), result.shards_done.end(), shard) > 0) {
      throw std::invalid_argument("shard " + std::to_string(shard) + " is there twice");
    }
    result.shards_done.push_back(shard);
  }
  std::sort(result.shards_done.begin(), result.shards_done.end());
  result.runs_done += other.runs_done;
  for (std::size_t f = 0; f < result.filters.size(); ++f) {
    merge_sums(result.filters[f], other.filters[f]);
  }
  if (result.sample.empty()) result.sample = other.sample;
}

LoopFigures loop_figures(const ExperimentResult& result, const FilterSums& sums, int loop) {
  const int runs = result.runs_done;
  const int count = result.config.simulation.steps_per_loop();
  const Band band = average_nees_band(runs, 3);
  LoopFigures figures;
  int inside = 0;
  double position = 0.0;
  double heading = 0.0;
  for (int k = loop * count; k < (loop + 1) * count; ++k) {
    const double nees = sums.nees.mean(k, runs);
    figures.nees_mean += nees / count;
    if (band.contains(nees)) ++inside;
    position += sums.position_squared.mean(k, runs) / count;
    heading += sums.heading_squared.mean(k, runs) / count;
  }
  figures.inside_percent = 100.0 * inside / count;
  figures.position_rmse_m = std::sqrt(position);
  figures.heading_rmse_rad = std::sqrt(heading);
  const auto landmarks = static_cast<int>(sums.landmark_count[static_cast<std::size_t>(loop)]);
  if (landmarks > 0) figures.landmark_nees_mean = sums.landmark_nees.mean(loop, landmarks);
  return figures;
}

}  // namespace cairn::host
