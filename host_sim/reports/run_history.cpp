#include <cmath>

#include "host_sim/io/output_file.hpp"
#include "host_sim/reports/run_outputs.hpp"
#include "host_sim/reports/run_summary.hpp"

namespace cairn::host {

void write_uncertainty(const std::filesystem::path& folder, const RunRecord& record) {
  OutputFile file(folder / "uncertainty.csv");
  file.print(
      "frame,t_us,position_xx,position_xy,position_xz,position_yy,position_yz,position_zz,"
      "attitude_sigma_rad,health_score\n");
  for (const FrameRecord& frame : record.frames) {
    file.print("{},{},", frame.number, frame.report.t_us);
    if (frame.position_covariance.has_value()) {
      const Matrix3<double>& c = *frame.position_covariance;
      file.print("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},", c(0, 0), c(0, 1), c(0, 2),
                 c(1, 1), c(1, 2), c(2, 2), frame.attitude_sigma_rad);
    } else {
      file.print(",,,,,,,");
    }
    file.print("{:.4g}\n", frame.health_score);
  }
  file.finish();
}

void write_health(const std::filesystem::path& folder, const RunRecord& record) {
  OutputFile file(folder / "health.csv");
  file.print("frame,t_us,counter,grew\n");
  nlohmann::json before = to_json(Health{});
  for (const FrameRecord& frame : record.frames) {
    nlohmann::json now = to_json(frame.health);
    for (const auto& [counter, value] : now.items()) {
      const auto grew = value.get<std::int64_t>() - before[counter].get<std::int64_t>();
      if (grew > 0) file.print("{},{},{},{}\n", frame.number, frame.report.t_us, counter, grew);
    }
    before = std::move(now);
  }
  file.finish();
}

}  // namespace cairn::host
