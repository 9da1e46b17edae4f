#include "host_sim/reports/run_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/base/names.hpp"
#include "host_sim/base/statistics.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/reports/gyro_meaning.hpp"
#include "host_sim/reports/latency.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/reports/verdict.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;

Rigid<double> planar_rigid(const PlanarPoseEstimate& pose) {
  return {rotation_exp(Vector3<double>(0.0, 0.0, wrap_angle(pose.theta_rad))),
          Vector3<double>(pose.x_m, pose.y_m, 0.0)};
}

/// The pose that the trajectory files hold: the vehicle as the filter has it, or the camera.
std::optional<Rigid<double>> estimated_pose(const FrameRecord& frame, Mode mode) {
  if (mode == Mode::kVehicle) {
    if (!frame.vehicle.has_value()) return std::nullopt;
    return planar_rigid(*frame.vehicle);
  }
  if (!frame.has_pose()) return std::nullopt;
  return to_double(frame.report.T_map_camera);
}

const std::optional<Rigid<double>>& true_pose(const FrameRecord& frame, Mode mode) {
  return mode == Mode::kVehicle ? frame.true_T_world_vehicle : frame.true_T_world_camera;
}

std::string field(const std::optional<double>& value) {
  return value.has_value() ? fmt::format("{:.4f}", *value) : std::string();
}

json nees_json(const RunRecord& record) {
  json result = {{"mean", nullptr}, {"inside_percent", nullptr}, {"dof", nullptr}};
  double sum = 0.0;
  double filter_sum = 0.0;
  int inside = 0;
  int count = 0;
  int filter_count = 0;
  const Band band = chi_square_band_95(3);
  for (const FrameRecord& frame : record.frames) {
    if (!frame.nees.has_value()) continue;
    sum += *frame.nees;
    inside += band.contains(*frame.nees) ? 1 : 0;
    ++count;
    if (!frame.filter_nees.has_value()) continue;
    filter_sum += *frame.filter_nees;
    ++filter_count;
  }
  if (count == 0) return result;
  result = {{"mean", sum / count}, {"inside_percent", 100.0 * inside / count}, {"dof", 3}};
  if (filter_count > 0) result["filter_mean"] = filter_sum / filter_count;
  return result;
}

json nis_json(const RunRecord& record) {
  json result = {{"mean", nullptr}, {"inside_percent", nullptr}, {"dof", nullptr}};
  double sum = 0.0;
  double dof = 0.0;
  int inside = 0;
  int count = 0;
  for (const FrameRecord& frame : record.frames) {
    const UpdateReport& update = frame.report.update;
    if (update.nis_dof <= 0) continue;
    const Band band = chi_square_band_95(update.nis_dof);
    sum += update.nis;
    dof += update.nis_dof;
    inside += band.contains(update.nis) ? 1 : 0;
    ++count;
  }
  if (count == 0) return result;
  return {{"mean", sum / count}, {"inside_percent", 100.0 * inside / count}, {"dof", dof / count}};
}

json monitor_json(const RunRecord& record) {
  int healthy = 0;
  for (const FrameRecord& frame : record.frames) healthy += frame.health_score < 1.0F ? 1 : 0;
  json events = json::array();
  for (const HealthRecord& event : record.events) {
    events.push_back(
        {{"t_us", event.t_us}, {"event", to_string(event.event)}, {"count", event.count}});
  }
  return {{"healthy_frames", healthy}, {"last_events", events}};
}

json registration_json(const RegistrationResult& registration) {
  std::vector<double> values;
  for (const std::optional<double>& px : registration.frame_px) {
    if (px.has_value()) values.push_back(*px);
  }
  if (values.empty()) {
    return {{"mean", nullptr}, {"median", nullptr}, {"p95", nullptr}, {"max", nullptr}, {"n", 0}};
  }
  const Statistics s = statistics_of(values);
  return {{"mean", s.mean},
          {"median", s.p50},
          {"p95", s.p95},
          {"max", s.max},
          {"n", registration.points},
          {"frames", s.n},
          {"map_scale", registration.map_scale}};
}

}  // namespace

RunTrajectory evaluate_run(const RunRecord& record, Mode mode) {
  RunTrajectory trajectory;
  trajectory.planar = mode == Mode::kVehicle;
  trajectory.alignment = mode == Mode::kVehicle ? Alignment::kStart : Alignment::kSim3;
  std::vector<Rigid<double>> estimate, truth;
  for (std::size_t i = 0; i < record.frames.size(); ++i) {
    const FrameRecord& frame = record.frames[i];
    const std::optional<Rigid<double>> pose = estimated_pose(frame, mode);
    std::optional<Rigid<double>> real = true_pose(frame, mode);
    if (!pose.has_value() || !real.has_value()) continue;
    if (mode == Mode::kVehicle) {  // compared in the plane of the estimate
      const Vector3<double> forward = real->rotation * Vector3<double>::UnitX();
      real = planar_rigid({real->translation.x(), real->translation.y(),
                           cairn::atan2(forward.y(), forward.x()), Matrix3<double>::Zero()});
    }
    estimate.push_back(*pose);
    truth.push_back(*real);
    trajectory.compared.push_back(i);
  }
  trajectory.evaluation = evaluate_trajectory(estimate, truth, trajectory.alignment);
  return trajectory;
}

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

void write_trajectories(const std::filesystem::path& folder, const RunRecord& record, Mode mode) {
  std::vector<TimedPose> estimate, truth, estimate_of_both, truth_of_both;
  for (const FrameRecord& frame : record.frames) {
    const std::int64_t t_us = frame.report.t_us;
    const auto pose = estimated_pose(frame, mode);
    const auto& real = true_pose(frame, mode);
    if (pose) estimate.push_back({t_us, *pose});
    if (real) truth.push_back({t_us, *real});
    if (!pose || !real) continue;
    estimate_of_both.push_back({t_us, *pose});
    truth_of_both.push_back({t_us, *real});
  }
  write_tum(folder / "trajectory.tum", estimate);
  // Rows of this format have no time: they are compared one by one.
  write_kitti(folder / "trajectory_kitti.txt", truth.empty() ? estimate : estimate_of_both);
  if (truth.empty()) return;
  write_tum(folder / "truth.tum", truth);
  write_kitti(folder / "truth_kitti.txt", truth_of_both);
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

/// How much of what is seen from the second lap on was first seen in an earlier one: by sighting
/// and by landmark. Null for a path that does not repeat.
json reuse_json(const RunRecord& record) {
  if (!record.lap_frames.has_value() || record.frames.empty()) return nullptr;
  const int lap = *record.lap_frames;
  std::map<LandmarkId, int> first_lap;
  std::set<std::pair<int, LandmarkId>> landmarks;
  std::size_t sightings = 0, old_sightings = 0, old_landmarks = 0;
  for (const FrameRecord& frame : record.frames) {
    const int now = (frame.number - record.frames.front().number) / lap;
    for (const LandmarkId id : frame.measured) {
      const bool old = first_lap.emplace(id, now).first->second < now;
      if (now == 0) continue;
      ++sightings;
      old_sightings += old ? 1 : 0;
      if (landmarks.emplace(now, id).second) old_landmarks += old ? 1 : 0;
    }
  }
  if (sightings == 0) return nullptr;
  const auto percent = [](std::size_t part, std::size_t whole) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  };
  return {{"sightings_percent", percent(old_sightings, sightings)},
          {"landmarks_percent", percent(old_landmarks, landmarks.size())},
          {"landmarks", landmarks.size()}};
}

/// Why a frame was not tracked: in hand-held mode, where the core gives no reason, by what it says
/// of the frame. Empty: it was.
std::string why_not_tracked(const FrameRecord& frame) {
  const FrameReport& report = frame.report;
  if (report.not_tracked != NotTracked::kTracked) return to_string(report.not_tracked);
  if (frame.is_measured()) return {};
  const bool lost = report.state == TrackingState::kLost;
  if (report.status == Status::kLowTexture) return lost ? "lost_low_texture" : "low_texture";
  return lost ? "lost" : "starting";
}

/// Frames that were not tracked, by reason.
json not_tracked_json(const RunRecord& record) {
  json reasons = json::object();
  for (const FrameRecord& frame : record.frames) {
    const std::string reason = why_not_tracked(frame);
    if (reason.empty()) continue;
    json& count = reasons[reason];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  return reasons;
}

/// The frames before the first that was tracked; null where none was.
json start_json(const RunRecord& record) {
  const auto first = std::find_if(record.frames.begin(), record.frames.end(),
                                  [](const FrameRecord& frame) { return frame.is_measured(); });
  if (first == record.frames.end()) return nullptr;
  const std::int64_t us = first->report.t_us - record.frames.front().report.t_us;
  return {{"frames", first - record.frames.begin()}, {"s", 1e-6 * static_cast<double>(us)}};
}

/// Tracked frames whose pose is called uncertain, and those of them in which too few landmarks were
/// found or agreed, so that it is extrapolated.
json uncertain_json(const RunRecord& record) {
  int frames = 0, extrapolated = 0;
  for (const FrameRecord& frame : record.frames) {
    if (!frame.is_measured() || frame.report.state != TrackingState::kUncertain) continue;
    ++frames;
    const Status status = frame.report.status;
    extrapolated += status == Status::kLowTexture || status == Status::kNoConsensus ? 1 : 0;
  }
  return {{"frames", frames}, {"extrapolated", extrapolated}};
}

/// What the pictures say of mount and focal length, degrees and percent; null in hand-held mode.
json mount_json(const RunRecord& record) {
  if (!record.mount.has_value()) return nullptr;
  const auto part = [&](MountOffset::Part which, double unit) {
    return json{{"off", unit * static_cast<double>(record.mount->value[which])},
                {"sigma", unit * static_cast<double>(record.mount->sigma[which])},
                {"suspect", record.mount->suspect[which]}};
  };
  constexpr double kDegrees = 180.0 / kPi<double>;
  return {
      {"yaw_deg", part(MountOffset::kYaw, kDegrees)},
      {"pitch_deg", part(MountOffset::kPitch, kDegrees)},
      {"roll_deg", part(MountOffset::kRoll, kDegrees)},
      {"focal_percent", part(MountOffset::kFocal, 100.0)},
      {"first_suspect_frame",
       record.mount_suspect_frame.has_value() ? json(*record.mount_suspect_frame) : json(nullptr)}};
}

/// How high the camera is above the ground by the pictures, in heights that were told; null in
/// hand-held mode.
json ground_json(const RunRecord& record) {
  if (!record.ground.has_value()) return nullptr;
  const float ratio = record.ground->ratio();
  return {{"ratio", ratio > 0.0F ? json(ratio) : json(nullptr)},
          {"suspect", record.ground->suspect()},
          {"suspect_frames", record.health.ground_suspicions}};
}

/// The focal length as a factor on what was told; null where it is not estimated.
json focal_json(const RunRecord& record) {
  if (!record.focal.has_value()) return nullptr;
  return {{"value", record.focal->value},
          {"sigma", record.focal->sigma},
          {"told_sigma", record.focal->told_sigma}};
}

/// Yaw rate of the odometry over that of the pictures; null in hand-held mode.
json yaw_json(const RunRecord& record) {
  if (!record.yaw.has_value()) return nullptr;
  const float ratio = record.yaw->ratio();
  return {{"ratio", ratio != 0.0F ? json(ratio) : json(nullptr)},
          {"suspect", record.yaw->suspect()},
          {"suspect_frames", record.health.yaw_suspicions}};
}

/// What is known of the gyroscope; null without one.
json gyro_json(const RunRecord& record) {
  if (!record.gyro.has_value()) return nullptr;
  const GyroReport& gyro = *record.gyro;
  const char* const kTrust[] = {"unproven", "agrees", "contradicted"};
  return {{"trust", kTrust[static_cast<int>(gyro.trust)]},
          {"meaning", meaning_of_gyro(gyro)},
          {"turns", gyro.ways},
          {"difference", gyro.difference},
          {"bias_radps", {gyro.bias_radps.x(), gyro.bias_radps.y(), gyro.bias_radps.z()}},
          {"bias_sigma_radps", gyro.bias_sigma_radps},
          {"late_s", gyro.time_offset_s},
          {"late_sigma_s", gyro.time_offset_sigma_s},
          {"samples", gyro.samples},
          {"refused", gyro.refused},
          {"saturated", gyro.saturated},
          {"gaps", gyro.gaps}};
}

json summarise(const RunRecord& record, const RunTrajectory& trajectory,
               const RegistrationResult& registration, double budget_ms, const SourceInfo& source) {
  int tracked = 0, lost = 0, relocalised = 0, added = 0, removed = 0;
  std::vector<double> totals, on_core;
  std::vector<double> stages[kStageCount];
  for (const FrameRecord& frame : record.frames) {
    tracked += frame.is_measured() ? 1 : 0;
    lost += frame.report.state == TrackingState::kLost ? 1 : 0;
    relocalised += frame.report.relocalised ? 1 : 0;
    added += frame.report.added;
    removed += frame.report.removed;
    totals.push_back(frame.total_ms);
    on_core.push_back(frame.core_ms);
    for (int i = 0; i < kStageCount; ++i) stages[i].push_back(frame.stage_ms[i]);
  }
  json latency = latency_json(totals, budget_ms);
  latency["budget"] = budget_ms;
  latency["on_core"] = latency_json(on_core, budget_ms);
  for (int i = 0; i < kStageCount; ++i) {
    json stage = latency_json(stages[i], kStageRows[i].paper_iekf_ms);
    stage["budget"] = kStageRows[i].paper_iekf_ms;
    latency["stages"][kStageRows[i].key] = stage;
  }
  json pictures = json::array();
  for (const auto& picture : record.pictures) pictures.push_back(picture.filename().string());
  const std::size_t active =
      static_cast<std::size_t>(record.frames.empty() ? 0 : record.frames.back().report.landmarks);
  json summary = {
      {"mode", trajectory.planar ? "vehicle" : "handheld"},
      {"frames", record.frames.size()},
      {"tracked", tracked},
      {"not_tracked", not_tracked_json(record)},
      {"start", start_json(record)},
      {"uncertain", uncertain_json(record)},
      {"lost", lost},
      {"relocalised", relocalised},
      {"latency_ms", latency},
      {"trajectory", to_json(trajectory.evaluation, trajectory.planar)},
      {"nees", nees_json(record)},
      {"nis", nis_json(record)},
      {"registration_px", registration_json(registration)},
      {"map",
       {{"landmarks", active},
        {"added", added},
        {"removed", removed},
        {"capacity", record.landmark_capacity},
        {"library", record.library_size < 0 ? json(nullptr) : json(record.library_size)},
        {"reused", reuse_json(record)}}},
      {"health", to_json(record.health)},
      {"mount", mount_json(record)},
      {"ground", ground_json(record)},
      {"focal_scale", focal_json(record)},
      {"odometry_yaw", yaw_json(record)},
      {"gyro", gyro_json(record)},
      {"monitor", monitor_json(record)},
      {"pictures", pictures},
      {"video", record.overlay.empty() ? json(nullptr)
                                       : json{{"file", record.overlay.filename().string()},
                                              {"rate_hz", source.frame_rate_hz}}},
      {"log_hash", fmt::format("{:016x}", record.log_hash)},
      {"input",
       {{"frames_expected", source.frame_count ? json(*source.frame_count) : json(nullptr)},
        {"warnings", source.warnings},
        {"damaged", source.damaged}}},
      {"interrupted_by", record.interrupted_by == 0 ? json(nullptr) : json(record.interrupted_by)}};
  summary["verdict"] = to_json(judge(summary, source.camera.width));
  return summary;
}

json to_json(const Health& h) {
  return {{"non_finite_inputs", h.non_finite_inputs},
          {"time_errors", h.time_errors},
          {"images_refused", h.images_refused},
          {"frame_gaps", h.frame_gaps},
          {"odometry_refused", h.odometry_refused},
          {"odometry_glitches", h.odometry_glitches},
          {"odometry_timeouts", h.odometry_timeouts},
          {"repeated_images", h.repeated_images},
          {"innovations_used", h.innovations_used},
          {"innovations_gated", h.innovations_gated},
          {"innovations_singular", h.innovations_singular},
          {"ransac_no_consensus", h.ransac_no_consensus},
          {"landmarks_added", h.landmarks_added},
          {"landmarks_removed", h.landmarks_removed},
          {"landmarks_replaced", h.landmarks_replaced},
          {"landmarks_refused", h.landmarks_refused},
          {"candidates_dropped", h.candidates_dropped},
          {"corners_dropped", h.corners_dropped},
          {"searches_deferred", h.searches_deferred},
          {"covariance_repairs", h.covariance_repairs},
          {"depth_repairs", h.depth_repairs},
          {"reacquisitions", h.reacquisitions},
          {"resets", h.resets},
          {"losses", h.losses},
          {"landmarks_archived", h.landmarks_archived},
          {"landmarks_reactivated", h.landmarks_reactivated},
          {"map_messages_dropped", h.map_messages_dropped},
          {"relocalisations", h.relocalisations},
          {"false_relocalisations_refused", h.false_relocalisations_refused},
          {"budget_exceeded", h.budget_exceeded},
          {"low_texture_frames", h.low_texture_frames},
          {"mount_suspicions", h.mount_suspicions},
          {"ground_suspicions", h.ground_suspicions},
          {"yaw_suspicions", h.yaw_suspicions}};
}

}  // namespace cairn::host
