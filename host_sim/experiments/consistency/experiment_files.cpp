#include "host_sim/experiments/consistency/experiment_files.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "cairn/numeric/math.hpp"

#include "host_sim/base/statistics.hpp"
#include "host_sim/experiments/consistency/draw_consistency.py.hpp"
#include "host_sim/experiments/consistency/filter.hpp"
#include "host_sim/experiments/consistency/operation_count.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/io/python_script.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {

NLOHMANN_JSON_SERIALIZE_ENUM(NoisePoint, {{NoisePoint::kReading, "reading"},
                                          {NoisePoint::kSteady, "steady"},
                                          {NoisePoint::kTruth, "truth"}})

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json sums_json(const FixedSums& sums) {
  return {{"sums", sums.raw()}, {"clamped", sums.clamped()}};
}

void write_series(const ExperimentResult& result, const fs::path& path) {
  OutputFile file(path);
  file.print("t_s,filter,nees,rmse_position_m,rmse_heading_rad\n");
  const SimulationConfig& simulation = result.config.simulation;
  for (int k = 0; k < simulation.steps(); ++k) {
    for (const auto& sums : result.filters) {
      file.print("{:.3f},{},{:.6f},{:.6f},{:.8f}\n", (k + 1) * simulation.time_step_s, sums.filter,
                 sums.nees.mean(k, result.runs_done),
                 std::sqrt(sums.position_squared.mean(k, result.runs_done)),
                 std::sqrt(sums.heading_squared.mean(k, result.runs_done)));
    }
  }
  file.finish();
}

void write_sample(const ExperimentResult& result, const fs::path& path) {
  if (result.sample.empty()) return;
  const SimulatedRun run = simulate_run(result.config.simulation, result.config.seed, 0);
  OutputFile file(path);
  file.print("kind,t_s,x_m,y_m\n");
  for (const auto& landmark : run.landmarks) {
    file.print("landmark,0,{:.6f},{:.6f}\n", landmark.x(), landmark.y());
  }
  for (std::size_t k = 0; k < run.steps.size(); ++k) {
    const double t = static_cast<double>(k + 1) * result.config.simulation.time_step_s;
    const Eigen::Vector2d& p = run.steps[k].truth.position;
    file.print("truth,{:.3f},{:.6f},{:.6f}\n", t, p.x(), p.y());
    for (const auto& path_of : result.sample) {
      const Eigen::Vector2d& q = path_of.poses[k].pose.position;
      file.print("{},{:.3f},{:.6f},{:.6f}\n", path_of.filter, t, q.x(), q.y());
    }
  }
  file.finish();
}

}  // namespace

json configuration_json(const ExperimentConfig& config) {
  const SimulationConfig& s = config.simulation;
  return {{"runs", config.runs},
          {"seed", config.seed},
          {"filters", config.filters},
          {"landmarks", s.landmarks},
          {"loops", s.loops},
          {"speed_sigma_mps", s.speed_sigma_mps},
          {"steering_sigma_rad", s.steering_sigma_rad},
          {"noise_at", s.noise_point},
          {"steady_s", s.steady_s},
          {"observation_sigma_m", s.observation_sigma_m},
          {"position_variance_m2", s.position_variance_m2},
          {"heading_variance_rad2", s.heading_variance_rad2}};
}

json sums_of(const ExperimentResult& result) {
  json document;
  document["runs_done"] = result.runs_done;
  document["shards_done"] = result.shards_done;
  for (const auto& sums : result.filters) {
    document["filters"].push_back({{"filter", sums.filter},
                                   {"nees", sums_json(sums.nees)},
                                   {"position_squared", sums_json(sums.position_squared)},
                                   {"heading_squared", sums_json(sums.heading_squared)},
                                   {"landmark_nees", sums_json(sums.landmark_nees)},
                                   {"landmark_count", sums.landmark_count},
                                   {"saturations", sums.saturations},
                                   {"predict_s", sums.times.predict_s},
                                   {"update_s", sums.times.update_s},
                                   {"predictions", sums.times.predictions},
                                   {"updates", sums.times.updates}});
  }
  for (const auto& sample : result.sample) {
    json poses = json::array();
    for (const auto& estimate : sample.poses) {
      poses.push_back({estimate.pose.position.x(), estimate.pose.position.y()});
    }
    document["sample"].push_back({{"filter", sample.filter}, {"positions", poses}});
  }
  return document;
}

namespace {

void read_sums(const json& from, FixedSums& sums) {
  const auto raw = from.at("sums").get<std::vector<std::int64_t>>();
  if (static_cast<int>(raw.size()) != sums.steps()) {
    throw std::invalid_argument(
        fmt::format("{} values where {} were expected", raw.size(), sums.steps()));
  }
  sums.set_raw(raw, from.at("clamped").get<std::int64_t>());
}

}  // namespace

ExperimentResult read_sums(const json& c, const json& document) {
  ExperimentResult result;
  ExperimentConfig& config = result.config;
  c.at("runs").get_to(config.runs);
  c.at("seed").get_to(config.seed);
  c.at("filters").get_to(config.filters);
  c.at("landmarks").get_to(config.simulation.landmarks);
  c.at("loops").get_to(config.simulation.loops);
  c.at("speed_sigma_mps").get_to(config.simulation.speed_sigma_mps);
  c.at("steering_sigma_rad").get_to(config.simulation.steering_sigma_rad);
  c.at("noise_at").get_to(config.simulation.noise_point);
  c.at("steady_s").get_to(config.simulation.steady_s);
  c.at("observation_sigma_m").get_to(config.simulation.observation_sigma_m);
  c.at("position_variance_m2").get_to(config.simulation.position_variance_m2);
  c.at("heading_variance_rad2").get_to(config.simulation.heading_variance_rad2);
  document.at("runs_done").get_to(result.runs_done);
  document.at("shards_done").get_to(result.shards_done);
  for (const json& entry : document.at("filters")) {
    FilterSums sums = make_filter_sums(entry.at("filter").get<std::string>(), config.simulation);
    read_sums(entry.at("nees"), sums.nees);
    read_sums(entry.at("position_squared"), sums.position_squared);
    read_sums(entry.at("heading_squared"), sums.heading_squared);
    read_sums(entry.at("landmark_nees"), sums.landmark_nees);
    entry.at("landmark_count").get_to(sums.landmark_count);
    entry.at("saturations").get_to(sums.saturations);
    entry.at("predict_s").get_to(sums.times.predict_s);
    entry.at("update_s").get_to(sums.times.update_s);
    entry.at("predictions").get_to(sums.times.predictions);
    entry.at("updates").get_to(sums.times.updates);
    result.filters.push_back(sums);
  }
  if (document.contains("sample")) {
    for (const json& entry : document.at("sample")) {
      SamplePath sample{entry.at("filter").get<std::string>(), {}};
      for (const json& position : entry.at("positions")) {
        PoseEstimate estimate;
        estimate.pose.position = {position.at(0).get<double>(), position.at(1).get<double>()};
        sample.poses.push_back(estimate);
      }
      result.sample.push_back(sample);
    }
  }
  return result;
}

namespace {

json optional_number(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

double per_call_us(double seconds, std::int64_t calls) {
  return calls > 0 ? 1e6 * seconds / static_cast<double>(calls) : 0.0;
}

}  // namespace

json experiment_summary(const ExperimentResult& result) {
  const Band band = average_nees_band(result.runs_done, 3);
  json summary;
  summary["experiment"] = configuration_json(result.config);
  summary["runs"] = result.runs_done;
  summary["nees_band"] = {band.low, band.high};
  summary["nees_dof"] = 3;
  summary["landmark_nees_dof"] = 2;
  for (const auto& sums : result.filters) {
    json filter;
    for (int loop = 0; loop < result.config.simulation.loops; ++loop) {
      const LoopFigures f = loop_figures(result, sums, loop);
      filter["loops"].push_back({{"loop", loop + 1},
                                 {"nees_mean", f.nees_mean},
                                 {"inside_percent", f.inside_percent},
                                 {"rmse_position_m", f.position_rmse_m},
                                 {"rmse_heading_rad", f.heading_rmse_rad},
                                 {"landmark_nees_mean", f.landmark_nees_mean}});
    }
    const OperationCount count = count_operations(sums.filter, result.config.simulation);
    filter["predict_us"] = per_call_us(sums.times.predict_s, sums.times.predictions);
    filter["update_us"] = per_call_us(sums.times.update_s, sums.times.updates);
    filter["predict_flops"] = optional_number(count.per_predict);
    filter["update_flops"] = optional_number(count.per_update);
    filter["clamped_samples"] = sums.nees.clamped() + sums.position_squared.clamped() +
                                sums.heading_squared.clamped() + sums.landmark_nees.clamped();
    filter["saturations"] = sums.saturations;
    summary["filters"][sums.filter] = filter;
  }
  return summary;
}

std::string experiment_table(const ExperimentResult& result) {
  const Band band = average_nees_band(result.runs_done, 3);
  const SimulationConfig& s = result.config.simulation;
  std::string table = fmt::format(
      "{} runs, start variance {:g} m^2 and {:g} rad^2, odometry {:g} m/s and {:.3g} deg\n"
      "average NEES of (x, y, heading), 95 % band [{:.2f}, {:.2f}]\n"
      "{:<20} {:>4} {:>9} {:>9} {:>10} {:>12} {:>14} {:>11} {:>10} {:>10}\n",
      result.runs_done, s.position_variance_m2, s.heading_variance_rad2, s.speed_sigma_mps,
      s.steering_sigma_rad * 180.0 / kPi<double>, band.low, band.high, "filter", "loop", "NEES",
      "inside %", "position m", "heading rad", "landmark NEES", "predict us", "update us",
      "saturated");
  for (const auto& sums : result.filters) {
    for (int loop = 0; loop < s.loops; ++loop) {
      const LoopFigures f = loop_figures(result, sums, loop);
      table += fmt::format("{:<20} {:>4} {:>9.3f} {:>9.1f} {:>10.4f} {:>12.5f} {:>14.3f}",
                           loop == 0 ? sums.filter : "", loop + 1, f.nees_mean, f.inside_percent,
                           f.position_rmse_m, f.heading_rmse_rad, f.landmark_nees_mean);
      if (loop == 0) {
        table +=
            fmt::format(" {:>11.2f} {:>10.2f} {:>10}",
                        per_call_us(sums.times.predict_s, sums.times.predictions),
                        per_call_us(sums.times.update_s, sums.times.updates), sums.saturations);
      }
      table += '\n';
    }
  }
  return table;
}

void write_experiment(const ExperimentResult& result, const fs::path& out) {
  make_folder(out);
  write_series(result, out / "consistency.csv");
  write_sample(result, out / "sample.csv");
  write_json(out / "summary.json", experiment_summary(result));
}

std::optional<std::string> draw_experiment(const fs::path& out) {
  return draw_with_python("pictures", kConsistencyScript, out);
}

}  // namespace cairn::host
