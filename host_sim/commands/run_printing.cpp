#include "host_sim/commands/run_printing.hpp"

#include <string>

#include <fmt/format.h>

#include "host_sim/base/names.hpp"
#include "host_sim/reports/gyro_meaning.hpp"

namespace cairn::host {
namespace {

void print_row(const char* name, const nlohmann::json& row, double paper_ms) {
  fmt::print("{:<34}{:>9.3f}{:>9.3f}{:>9.3f}{:>9.3f}{:>10.2f} %{:>10.2f}\n", name,
             row["p50"].get<double>(), row["p95"].get<double>(), row["p99"].get<double>(),
             row["max"].get<double>(), 100.0 * row["over_budget"].get<double>(), paper_ms);
}

std::string figure(const nlohmann::json& value, const char* unit) {
  return value.is_null() ? std::string("-") : fmt::format("{:.3f} {}", value.get<double>(), unit);
}

}  // namespace

void print_suspicions(const std::optional<MountOffset>& offset) {
  if (!offset.has_value()) return;
  for (const MountOffset::Part part : kMountParts) {
    if (!offset->suspect[part]) continue;
    fmt::print("calibration suspect: {}: {}\n", describe(*offset, part), meaning_of(part));
  }
}

void print_suspicion(const std::optional<GroundCheck>& ground) {
  if (!ground.has_value() || !ground->suspect()) return;
  fmt::print(
      "speed or camera height suspect: the ground appears {:.2f} times as far below the camera as "
      "its height says: the speed's unit or scale (km/h for m/s: 3.6), or the height\n",
      ground->ratio());
}

void print_suspicion(const std::optional<YawCheck>& yaw) {
  if (!yaw.has_value() || !yaw->suspect()) return;
  fmt::print("odometry's yaw rate suspect: {}\n",
             meaning_of_yaw(static_cast<double>(yaw->ratio())));
}

void print_gyro(const std::optional<GyroReport>& gyro) {
  if (!gyro.has_value()) return;
  fmt::print(
      "gyroscope: {} samples, {} refused, {} saturated, {} gaps; bias {:.4f} {:.4f} {:.4f} rad/s "
      "(sigma {:.4f}), stamps late by {:.1f} ms (sigma {:.1f})\n",
      gyro->samples, gyro->refused, gyro->saturated, gyro->gaps, gyro->bias_radps.x(),
      gyro->bias_radps.y(), gyro->bias_radps.z(), gyro->bias_sigma_radps,
      1e3F * gyro->time_offset_s, 1e3F * gyro->time_offset_sigma_s);
  fmt::print("{}\n", meaning_of_gyro(*gyro));
}

void print_summary(const nlohmann::json& summary) {
  const nlohmann::json& latency = summary["latency_ms"];
  fmt::print("\n{:<34}{:>9}{:>9}{:>9}{:>9}{:>12}{:>10}\n", "per frame, ms", "p50", "p95", "p99",
             "max", "over", "paper");
  for (const StageRow& row : kStageRows) {
    print_row(row.name, latency["stages"][row.key], row.paper_iekf_ms);
  }
  print_row("whole frame", latency, kPaperTotalMs);
  fmt::print("\nframes {}   tracked {}   lost {}   relocalised {}\n", summary["frames"].get<int>(),
             summary["tracked"].get<int>(), summary["lost"].get<int>(),
             summary["relocalised"].get<int>());
  for (const auto& [reason, frames] : summary["not_tracked"].items()) {
    fmt::print("not tracked: {} {}\n", reason, frames.get<int>());
  }
  const nlohmann::json& trajectory = summary["trajectory"];
  if (!trajectory["aligned"].is_null()) {
    fmt::print("trajectory error {} (aligned: {})   rotation {}\n",
               figure(trajectory["ate_rmse_m"], "m"), trajectory["aligned"].get<std::string>(),
               figure(trajectory["rotation_rmse_deg"], "deg"));
  }
  const nlohmann::json& registration = summary["registration_px"];
  if (!registration["mean"].is_null()) {
    fmt::print("registration error mean {}   p95 {}   max {}\n", figure(registration["mean"], "px"),
               figure(registration["p95"], "px"), figure(registration["max"], "px"));
  }
  fmt::print("log hash {}\n", summary["log_hash"].get<std::string>());
  fmt::print("\n{}\n", summary["verdict"]["headline"].get<std::string>());
  for (const nlohmann::json& point : summary["verdict"]["points"]) {
    if (point["grade"] != "good") fmt::print("- {}\n", point["text"].get<std::string>());
  }
}

}  // namespace cairn::host
