#include "host_sim/reports/run_outputs.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/base/names.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/reports/latency.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;

std::string field(const std::optional<double>& value) {
  return value.has_value() ? fmt::format("{:.4f}", *value) : std::string();
}

}  // namespace

void write_manifest(const std::filesystem::path& folder, const RunIdentity& identity,
                    const SourceInfo& source, const RunRecord& record) {
  const TrackerOptions& options = identity.options;
  const PinholeCamera<double>& c = source.camera;
  Manifest manifest;
  manifest.command_line = identity.command_line;
  manifest.seed = options.seed;
  manifest.config = {{"mode", options.mode == Mode::kVehicle ? "vehicle" : "handheld"},
                     {"filter", options.filter},
                     {"fading", options.fading.empty() ? json(nullptr) : json(options.fading)},
                     {"budget_ms", options.budget_ms},
                     {"start_position_variance", options.start_position_variance},
                     {"start_heading_variance", options.start_heading_variance},
                     {"tilt",
                      {{"sigma_pitch_rad", options.tilt.sigma_pitch_rad},
                       {"sigma_roll_rad", options.tilt.sigma_roll_rad},
                       {"time_constant_s", options.tilt.time_constant_s}}},
                     {"travel_sigma_rad",
                      options.travel_sigma_rad ? json(*options.travel_sigma_rad) : json(nullptr)},
                     {"tracker", record.tracker}};
  manifest.source = {{"name", identity.source},
                     {"frame_rate_hz", source.frame_rate_hz},
                     {"note", source.note},
                     {"warnings", source.warnings},
                     {"camera",
                      {{"fx", c.fx},
                       {"fy", c.fy},
                       {"cx", c.cx},
                       {"cy", c.cy},
                       {"k1", c.k1},
                       {"k2", c.k2},
                       {"p1", c.p1},
                       {"p2", c.p2},
                       {"k3", c.k3},
                       {"k4", c.k4},
                       {"k5", c.k5},
                       {"k6", c.k6},
                       {"lens", c.lens == Lens::kFisheye ? "fisheye" : "radial-tangential"},
                       {"width", c.width},
                       {"height", c.height}}}};
  manifest.inputs = hashes_of(source.inputs);
  write_manifest(folder, manifest);
}

void write_frames(const std::filesystem::path& folder, const RunRecord& record,
                  const RegistrationResult& registration) {
  OutputFile frames(folder / "frames.csv");
  OutputFile tracking(folder / "tracking.csv");
  frames.print("{}", kFramesHeader);
  tracking.print(
      "frame,t_us,state,searched,hypotheses,low_innovation,high_innovation,gated,added,removed,"
      "reactivated,from_library,relocalised,nis,nis_dof,nees\n");
  for (std::size_t i = 0; i < record.frames.size(); ++i) {
    const FrameRecord& frame = record.frames[i];
    const FrameReport& r = frame.report;
    frames.print("{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{},{},{},{},{},{}\n",
                 frame.number, r.t_us, cairn::to_string(r.status), frame.stage_ms[0],
                 frame.stage_ms[1], frame.stage_ms[2], frame.stage_ms[3], frame.stage_ms[4],
                 frame.total_ms, r.corners, r.candidates, r.matches, r.inliers, r.landmarks,
                 field(registration.frame_px[i]));
    tracking.print("{},{},{},{},{},{},{},{},{},{},{},{},{},{:.4f},{},{}\n", frame.number, r.t_us,
                   to_string(r.state), r.searched, r.update.hypotheses, r.update.low_innovation,
                   r.update.high_innovation, r.update.gated, r.added, r.removed, r.reactivated,
                   r.from_library, r.relocalised ? 1 : 0, r.update.nis, r.update.nis_dof,
                   field(frame.nees));
  }
  frames.finish();
  tracking.finish();
}

void write_landmarks(const std::filesystem::path& folder, const RunRecord& record) {
  OutputFile file(folder / "landmarks.csv");
  file.print("id,active,x,y,z,sigma_x,sigma_y,sigma_z\n");
  for (const MapLandmark& landmark : record.landmarks) {
    const Vector3<double> sigma = landmark.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    file.print("{},{},{:.6g},{:.6g},{:.6g},{:.4g},{:.4g},{:.4g}\n", landmark.id,
               landmark.active ? 1 : 0, landmark.p_map.x(), landmark.p_map.y(), landmark.p_map.z(),
               sigma.x(), sigma.y(), sigma.z());
  }
  file.finish();
}

}  // namespace cairn::host
