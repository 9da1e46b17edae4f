#include "host_sim/experiments/turntable/turntable_experiment.hpp"

#include <algorithm>
#include <cstdio>
#include <mutex>

#include "host_sim/base/parallel_for.hpp"

namespace cairn::host {
namespace {

std::string format_factor(double factor) {
  char text[32];
  std::snprintf(text, sizeof text, "6dof S=%.3f", factor);
  return text;
}

/// Process noise of the paper's filter, as in the published MATLAB code: 0.007 per frame^2 at 25
/// Hz.
MonoParameters<float> paper_parameters() {
  MonoParameters<float> p;
  p.velocity_noise = 0.875F;
  p.rate_noise = 0.875F;
  p.initial_velocity_sigma_mps = 0.625F;
  p.initial_rate_sigma_radps = 0.625F;
  p.linearity_threshold = 0.1F;
  p.depth_from_map = false;
  return p;
}

void add_with_and_without_focal(std::vector<TurntableVariant>& variants, TurntableVariant variant) {
  variants.push_back(variant);
  variant.name += " + f";
  variant.parameters.estimate_focal_length = true;
  variants.push_back(variant);
}

}  // namespace

std::vector<TurntableCondition> turntable_conditions(const TurntableConfig& config) {
  std::vector<TurntableCondition> conditions;
  for (const bool lever : {false, true}) {
    PointsScenario base;
    base.motion.experiment = config.experiment;
    if (lever) base.motion.lever_m = default_lever();
    const std::string where = lever ? "8 cm off" : "on axis";
    conditions.push_back({where + ", clean", base});
    PointsScenario scenario = base;
    scenario.focal_error = 0.03;
    conditions.push_back({where + ", f +3 %", scenario});
    scenario.focal_error = -0.05;
    conditions.push_back({where + ", f -5 %", scenario});
    scenario = base;
    scenario.noise_px = 1.0;
    conditions.push_back({where + ", noise 1 px", scenario});
    scenario = base;
    scenario.outlier_share = 0.25;
    conditions.push_back({where + ", 25 % outliers", scenario});
    scenario.outlier_share = 0.5;
    conditions.push_back({where + ", 50 % outliers", scenario});
  }
  const auto unwanted = [&](const TurntableCondition& c) {
    return c.name.find(config.condition) == std::string::npos;
  };
  conditions.erase(std::remove_if(conditions.begin(), conditions.end(), unwanted),
                   conditions.end());
  return conditions;
}

std::vector<TurntableVariant> turntable_variants(const TurntableConfig& config,
                                                 const TurntableCondition& condition) {
  std::vector<TurntableVariant> variants;
  for (const double factor : config.fading) {
    TurntableVariant variant{format_factor(factor), paper_parameters(), false};
    variant.parameters.fading_factor = static_cast<float>(factor);
    variants.push_back(variant);
  }
  if (config.adaptive) {
    TurntableVariant variant{"6dof adaptive", paper_parameters(), false};
    variant.parameters.fading = FadingMode::kAdaptive;
    variants.push_back(variant);
  }
  TurntableVariant calm{"6dof, starts at rest", paper_parameters(), false};
  calm.parameters.velocity_noise = 0.05F;
  calm.parameters.initial_velocity_sigma_mps = 0.05F;
  calm.parameters.sigma_px = static_cast<float>(condition.scenario.noise_px);
  variants.push_back(calm);
  TurntableVariant ours{"rotation", paper_parameters(), false};
  ours.parameters.motion = MotionModel::kRotationOnly;
  add_with_and_without_focal(variants, ours);
  const Eigen::Vector3d& lever = condition.scenario.motion.lever_m;
  if (lever.norm() == 0.0) return variants;

  ours.parameters.motion = MotionModel::kPivot;
  ours.parameters.initial_inverse_depth = 0.4F;
  ours.parameters.initial_inverse_depth_sigma = 0.2F;
  ours.name = "pivot, lever known";
  ours.parameters.lever_m = lever.cast<float>();
  ours.parameters.lever_sigma_m = 0.005F;
  add_with_and_without_focal(variants, ours);
  ours.name = "pivot bank, lever unknown";
  ours.parameters.lever_m = {0.0F, 0.0F, 0.07F};
  ours.parameters.lever_sigma_m = 0.07F;
  ours.bank = true;
  add_with_and_without_focal(variants, ours);
  return variants;
}

std::vector<TurntableCell> run_turntable(const TurntableConfig& config,
                                         const std::function<void(int, int)>& progress) {
  struct Job {
    std::size_t cell;
    std::size_t run;
    PointsScenario scenario;
    TurntableVariant variant;
  };
  std::vector<TurntableCell> cells;
  std::vector<Job> jobs;
  std::size_t number = 0;
  for (const TurntableCondition& condition : turntable_conditions(config)) {
    for (const TurntableVariant& variant : turntable_variants(config, condition)) {
      TurntableCell cell{condition.name, variant.name, {}};
      cell.runs.resize(static_cast<std::size_t>(config.seeds));
      for (std::size_t run = 0; run < cell.runs.size(); ++run) {
        Job job{cells.size(), run, condition.scenario, variant};
        job.scenario.seed = config.seed + run;
        if (config.shard.has(number++)) jobs.push_back(job);
      }
      cells.push_back(cell);
    }
  }
  std::mutex mutex;
  int done = 0;
  parallel_for(jobs.size(), 0, [&](std::size_t i) {
    const Job& job = jobs[i];
    cells[job.cell].runs[job.run] =
        run_points<float>(job.scenario, job.variant.parameters, job.variant.bank);
    const std::lock_guard<std::mutex> lock(mutex);
    progress(++done, static_cast<int>(jobs.size()));
  });
  return cells;
}

double median_of(const std::vector<PointsResult>& runs, double PointsResult::*figure) {
  std::vector<double> values;
  for (const PointsResult& run : runs) values.push_back(run.*figure);
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  if (n == 0) return 0.0;
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

double worst_of(const std::vector<PointsResult>& runs, double PointsResult::*figure) {
  double worst = 0.0;
  for (const PointsResult& run : runs) worst = std::max(worst, run.*figure);
  return worst;
}

}  // namespace cairn::host
