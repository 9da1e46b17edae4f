#include "host_sim/recorded/recorded_files.hpp"

#include <cmath>

#include <fmt/format.h>

#include "cairn/base/hash.hpp"
#include "cairn/numeric/math.hpp"

#include "host_sim/base/names.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/recorded/draw_recorded.py.hpp"
#include "host_sim/reports/latency.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr double kDegrees = 180.0 / kPi<double>;

std::string log_hash(const RecordedRun& run) {
  Hash64 hash;
  for (const auto& sample : run.samples) {
    hash.add(sample.pose.position.x());
    hash.add(sample.pose.position.y());
    hash.add(sample.pose.heading);
  }
  for (const auto& landmark : run.landmarks) {
    hash.add(landmark.id);
    hash.add(landmark.position.x());
    hash.add(landmark.position.y());
  }
  return fmt::format("{:016x}", hash.value());
}

std::string tum_line(double t_s, const Eigen::Vector2d& position, double heading) {
  return fmt::format("{:.6f} {:.6f} {:.6f} 0 0 0 {:.9f} {:.9f}\n", t_s, position.x(), position.y(),
                     std::sin(0.5 * heading), std::cos(0.5 * heading));
}

void write_trajectories(const RecordedRun& run, const fs::path& out) {
  OutputFile trajectory(out / "trajectory.tum");
  OutputFile truth(out / "truth.tum");
  OutputFile samples(out / "samples.csv");
  samples.print("t_s,x_m,y_m,heading_rad,true_x_m,true_y_m,true_heading_rad,nees\n");
  for (const auto& sample : run.samples) {
    const Eigen::Vector2d& p = sample.pose.position;
    trajectory.print("{}", tum_line(sample.t_s, p, sample.pose.heading));
    samples.print("{:.3f},{:.6f},{:.6f},{:.6f}", sample.t_s, p.x(), p.y(), sample.pose.heading);
    if (sample.truth) {
      const RecordedTruth& real = *sample.truth;
      truth.print("{}", tum_line(sample.t_s, real.position, real.heading));
      samples.print(",{:.6f},{:.6f},{:.6f},{:.6f}\n", real.position.x(), real.position.y(),
                    real.heading, sample.nees);
    } else {
      samples.print(",,,,\n");
    }
  }
  trajectory.finish();
  truth.finish();
  samples.finish();
}

void write_map(const Recording& recording, const RecordedRun& run, const fs::path& out) {
  OutputFile file(out / "landmarks.csv");
  file.print("id,x_m,y_m,z_m,var_x_m2,cov_xy_m2,var_y_m2,true_x_m,true_y_m\n");
  for (const auto& landmark : run.landmarks) {
    const Eigen::Matrix2d& c = landmark.covariance;
    file.print("{},{:.6f},{:.6f},0,{:.9f},{:.9f},{:.9f},", landmark.id, landmark.position.x(),
               landmark.position.y(), c(0, 0), c(0, 1), c(1, 1));
    const auto real = recording.true_landmarks.find(static_cast<int>(landmark.id));
    if (recording.known_landmarks && real != recording.true_landmarks.end()) {
      file.print("{:.6f},{:.6f}\n", real->second.x(), real->second.y());
    } else {
      file.print(",\n");
    }
  }
  file.finish();
}

/// A step's odometry is the paper's prediction, its scan the paper's pose update; there is no
/// image.
void write_frames(const RecordedRun& run, const fs::path& out) {
  OutputFile file(out / "frames.csv");
  file.print("{}", kFramesHeader);
  int frame = 0;
  for (const auto& step : run.steps) {
    file.print("{},{},{},0,{:.6f},0,{:.6f},0,{:.6f},0,{},{},{},{},\n", frame++,
               std::llround(step.t_s * 1e6), cairn::to_string(step.status), 1e-3 * step.predict_us,
               1e-3 * step.scan_us, 1e-3 * (step.predict_us + step.scan_us), step.sightings,
               step.matches, step.used, step.landmarks);
  }
  file.finish();
}

json with_budget(const std::vector<double>& values_ms, double budget_ms) {
  json latency = latency_json(values_ms, budget_ms);
  latency["budget"] = budget_ms;
  return latency;
}

json latency_of(const RecordedRun& run, double budget_ms) {
  std::vector<double> totals;
  std::vector<double> stages[kStageCount];
  for (const auto& step : run.steps) {
    const double predict_ms = 1e-3 * step.predict_us;
    const double scan_ms = 1e-3 * step.scan_us;
    totals.push_back(predict_ms + scan_ms);
    for (int i = 0; i < kStageCount; ++i) stages[i].push_back(0.0);
    stages[static_cast<int>(Stage::kPosePrediction)].back() = predict_ms;
    stages[static_cast<int>(Stage::kPoseUpdate)].back() = scan_ms;
  }
  json latency = with_budget(totals, budget_ms);
  for (int i = 0; i < kStageCount; ++i) {
    latency["stages"][kStageRows[i].key] = with_budget(stages[i], kStageRows[i].paper_iekf_ms);
  }
  return latency;
}

json optional_json(const std::optional<double>& value) {
  return value ? json(*value) : json(nullptr);
}

void write_manifest(const Recording& recording, const RecordedRunOptions& options,
                    const std::string& command_line, const fs::path& out) {
  Manifest manifest;
  manifest.command_line = command_line;
  manifest.seed = options.seed;
  manifest.config = {{"mode", "vehicle"},
                     {"filter", options.filter},
                     {"start_heading_variance", optional_json(options.start_heading_variance)},
                     {"start_position_variance", optional_json(options.start_position_variance)},
                     {"gate", options.parameters.gate},
                     {"range_sigma_m", recording.noise.range_sigma_m},
                     {"range_sigma_per_m", recording.noise.range_sigma_per_m},
                     {"bearing_sigma_rad", recording.noise.bearing_sigma_rad},
                     {"slip_density_m2_per_s", recording.slip_density}};
  manifest.source = {{"name", recording.name}, {"note", recording.note}};
  manifest.inputs = hashes_of(recording.inputs);
  write_manifest(out, manifest);
}

json times_json(const StepTimes& times) {
  return {{"mean", times.mean()},        {"p50", times.quantile(0.5)},
          {"p95", times.quantile(0.95)}, {"p99", times.quantile(0.99)},
          {"max", times.quantile(1.0)},  {"n", times.values_us.size()}};
}

json health_json(const Health& health) {
  return {{"non_finite_inputs", health.non_finite_inputs},
          {"innovations_used", health.innovations_used},
          {"innovations_gated", health.innovations_gated},
          {"innovations_singular", health.innovations_singular},
          {"landmarks_added", health.landmarks_added},
          {"landmarks_removed", health.landmarks_removed},
          {"landmarks_replaced", health.landmarks_replaced},
          {"landmarks_refused", health.landmarks_refused},
          {"reacquisitions", health.reacquisitions}};
}

}  // namespace

json recorded_summary(const Recording& recording, const RecordedRunOptions& options,
                      const RecordedRun& run) {
  const RecordedErrors e = recorded_errors(recording, run);
  const bool heading = recording.truth_has_heading;
  json summary;
  summary["frames"] = run.steps.size();
  summary["tracked"] = run.steps.size();
  summary["samples"] = run.samples.size();
  summary["lost"] = 0;
  summary["relocalised"] = run.health.reacquisitions;
  summary["latency_ms"] = latency_of(run, options.budget_ms);
  summary["trajectory"] = {
      {"aligned", heading ? "start" : "se2"},
      {"ate_rmse_m", heading ? e.position_rmse_m : e.aligned_rmse_m},
      {"heading_rmse_deg", heading ? json(e.heading_rmse_rad * kDegrees) : json(nullptr)},
      {"rotation_rmse_deg", heading ? json(e.heading_rmse_rad * kDegrees) : json(nullptr)},
      {"final_drift_m", heading ? json(e.final_drift_m) : json(nullptr)},
      {"compared", e.samples},
      {"se2",
       {{"ate_rmse_m", e.aligned_rmse_m},
        {"median_m", e.aligned_median_m},
        {"p95_m", e.aligned_p95_m}}}};
  if (heading) {
    summary["nees"] = {
        {"mean", e.nees_mean}, {"inside_percent", e.nees_inside_percent}, {"dof", 3}};
  } else {
    summary["nees"] = nullptr;
  }
  summary["nis"] = {
      {"mean_per_dof",
       run.nis_dof > 0 ? json(run.nis_sum / static_cast<double>(run.nis_dof)) : json(nullptr)},
      {"dof", run.nis_dof}};
  summary["registration_px"] = nullptr;
  const bool map_known = recording.known_landmarks && e.map_landmarks > 0;
  summary["map"] = {{"landmarks", run.landmarks.size()},
                    {"added", run.health.landmarks_added},
                    {"removed", run.health.landmarks_removed + run.health.landmarks_replaced},
                    {"rmse_m", map_known ? json(e.map_rmse_m) : json(nullptr)},
                    {"aligned_rmse_m", map_known ? json(e.map_aligned_rmse_m) : json(nullptr)},
                    {"nees_mean", map_known ? json(e.map_nees_mean) : json(nullptr)}};
  summary["sightings"] = run.sightings;
  summary["ambiguous_sightings"] = run.ambiguous;
  summary["tentative_dropped"] = run.tentative_dropped;
  summary["refused_calls"] = run.refused_calls;
  summary["step_us"] = {{"predict", times_json(run.predict)}, {"scan", times_json(run.scan)}};
  summary["health"] = health_json(run.health);
  summary["health"]["saturations"] = run.saturations;
  summary["log_hash"] = log_hash(run);
  return summary;
}

void write_recorded_run(const Recording& recording, const RecordedRunOptions& options,
                        const RecordedRun& run, const std::string& command_line,
                        const fs::path& out) {
  make_folder(out);
  remove_earlier_run(out);
  write_manifest(recording, options, command_line, out);
  write_trajectories(run, out);
  write_map(recording, run, out);
  write_frames(run, out);
  write_json(out / "summary.json", recorded_summary(recording, options, run));
  if (const auto problem = draw_with_python("report.html", kRecordedScript, out)) {
    fmt::print(stderr, "{}\n", *problem);
  }
}

}  // namespace cairn::host
