#include "host_sim/reports/run_summary.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "host_sim/base/names.hpp"
#include "host_sim/base/statistics.hpp"
#include "host_sim/reports/calibration_summary.hpp"
#include "host_sim/reports/latency.hpp"
#include "host_sim/reports/verdict.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;

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

}  // namespace

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
      {"travel", travel_json(record)},
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
