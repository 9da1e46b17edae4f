#include "host_sim/experiments/turntable/turntable_files.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/experiments/turntable/draw_turntable.py.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/io/python_script.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

int count_lost(const std::vector<PointsResult>& runs) {
  int lost = 0;
  for (const PointsResult& run : runs) lost += run.lost ? 1 : 0;
  return lost;
}

int count_mirrored(const std::vector<PointsResult>& runs) {
  int mirrored = 0;
  for (const PointsResult& run : runs) mirrored += run.displacement_ratio < 0.0 ? 1 : 0;
  return mirrored;
}

nlohmann::json cell_summary(const TurntableCell& cell) {
  const auto both = [&](double PointsResult::*figure) {
    return nlohmann::json{{"median", median_of(cell.runs, figure)},
                          {"worst", worst_of(cell.runs, figure)}};
  };
  return {{"condition", cell.condition},
          {"variant", cell.variant},
          {"seeds", cell.runs.size()},
          {"yaw_error_deg",
           {{"largest", both(&PointsResult::max_yaw_error_deg)},
            {"mean_absolute", both(&PointsResult::mean_yaw_error_deg)},
            {"mean_square", both(&PointsResult::mse_yaw_error_deg2)}}},
          {"pitch_error_mean_deg", both(&PointsResult::mean_pitch_error_deg)},
          {"attitude_error_mean_deg", both(&PointsResult::mean_attitude_error_deg)},
          {"attitude_nees_mean", both(&PointsResult::mean_nees)},
          {"nis_per_dof", both(&PointsResult::mean_nis)},
          {"focal_factor", both(&PointsResult::focal_factor)},
          {"filter_us", both(&PointsResult::mean_filter_us)},
          {"lost", count_lost(cell.runs)},
          {"mirrored", count_mirrored(cell.runs)}};
}

void write_runs(const TurntableConfig& config, const std::vector<TurntableCell>& cells,
                const std::filesystem::path& path) {
  OutputFile file(path);
  file.print(
      "condition,variant,seed,yaw_max_deg,yaw_mean_deg,yaw_mse_deg2,yaw_final_deg,"
      "pitch_mean_deg,attitude_mean_deg,nees,nis_per_dof,focal_factor,displacement_ratio,lost\n");
  for (const TurntableCell& cell : cells) {
    for (std::size_t i = 0; i < cell.runs.size(); ++i) {
      const PointsResult& r = cell.runs[i];
      file.print(
          "\"{}\",\"{}\",{},{:.5f},{:.5f},{:.6f},{:.5f},{:.5f},{:.5f},{:.4f},{:.4f},{:.5f},{:.3f},"
          "{}\n",
          cell.condition, cell.variant, config.seed + i, r.max_yaw_error_deg, r.mean_yaw_error_deg,
          r.mse_yaw_error_deg2, r.final_yaw_error_deg, r.mean_pitch_error_deg,
          r.mean_attitude_error_deg, r.mean_nees, r.mean_nis, r.focal_factor, r.displacement_ratio,
          r.lost ? 1 : 0);
    }
  }
  file.finish();
}

void write_frames(const std::vector<TurntableCell>& cells, const std::filesystem::path& path) {
  OutputFile file(path);
  file.print(
      "condition,variant,t_s,true_yaw_deg,yaw_error_deg,pitch_error_deg,attitude_error_deg,"
      "nees,nis,nis_dof,features,inliers,fading\n");
  for (const TurntableCell& cell : cells) {
    for (const PointsFrame& f : cell.runs.front().frames) {
      file.print("\"{}\",\"{}\",{:.3f},{:.4f},{:.5f},{:.5f},{:.5f},{:.4f},{:.4f},{},{},{},{:.4f}\n",
                 cell.condition, cell.variant, f.t_s, f.true_yaw_deg, f.yaw_error_deg,
                 f.pitch_error_deg, f.attitude_error_deg, f.attitude_nees, f.nis, f.nis_dof,
                 f.features, f.inliers, f.fading_factor);
    }
  }
  file.finish();
}

}  // namespace

void write_turntable(const TurntableConfig& config, const std::vector<TurntableCell>& cells,
                     const std::filesystem::path& out) {
  write_runs(config, cells, out / "runs.csv");
  write_frames(cells, out / "frames.csv");
  nlohmann::json summary = {{"experiment", experiment_name(config.experiment)},
                            {"seed", config.seed},
                            {"seeds", config.seeds},
                            {"cells", nlohmann::json::array()}};
  for (const TurntableCell& cell : cells) summary["cells"].push_back(cell_summary(cell));
  write_json(out / "summary.json", summary);
  write_text(out / "summary.md", turntable_table(cells));
}

std::string turntable_table(const std::vector<TurntableCell>& cells) {
  std::string table =
      "| condition | filter | yaw max, median | worst | mean | MSE | attitude | NEES (3) | NIS a "
      "dof "
      "| mirrored | lost |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const TurntableCell& cell : cells) {
    table += fmt::format(
        "| {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.4f} | {:.3f} | {:.1f} | {:.2f} | {} | {} |\n",
        cell.condition, cell.variant, median_of(cell.runs, &PointsResult::max_yaw_error_deg),
        worst_of(cell.runs, &PointsResult::max_yaw_error_deg),
        median_of(cell.runs, &PointsResult::mean_yaw_error_deg),
        median_of(cell.runs, &PointsResult::mse_yaw_error_deg2),
        median_of(cell.runs, &PointsResult::mean_attitude_error_deg),
        median_of(cell.runs, &PointsResult::mean_nees),
        median_of(cell.runs, &PointsResult::mean_nis), count_mirrored(cell.runs),
        count_lost(cell.runs));
  }
  return table;
}

std::optional<std::string> draw_turntable(const std::filesystem::path& out) {
  return draw_with_python("pictures", kTurntableScript, out);
}

}  // namespace cairn::host
