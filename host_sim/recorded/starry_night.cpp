#include "host_sim/recorded/starry_night.hpp"

#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cairn/mono/mono_ekf.hpp"

#include "host_sim/evaluation/trajectory_evaluation.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/recorded/number_table.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/trackers/fading.hpp"

namespace cairn::host {
namespace {

constexpr int kLandmarks = 20;
constexpr int kLastFrame = 1000000;
/// Above the recording's noise (with 7 px the NIS is 1 a degree of freedom): at 11 Hz the
/// linearisation errs too.
constexpr double kSigmaPx = 10.0;
constexpr std::size_t kStartLandmarks = 5;  ///< seen in the frame that the filter starts in
using Filter = MonoEkf<float, kLandmarks, kLandmarks>;

struct Track {
  double t_s = 0.0;
  std::optional<Rigid<double>> truth;
  std::vector<std::pair<LandmarkId, Vector2<float>>> seen;
};

/// Frames in the order of their numbers. The observations go on after the true poses end.
std::vector<Track> read_tracks(const std::filesystem::path& folder) {
  const NumberTable poses = read_number_table(
      folder / "gt_imu.csv",
      {"t_s,x,y,z,th1,th2,th3(axis-angle C_vk_i),vx,vy,vz(body),wx,wy,wz(body gyro)", true, 13,
       true});
  const NumberTable pixels = read_number_table(
      folder / "obs.csv", {"k,t_s,landmark(1..20),u_left,v_left,u_right,v_right", true, 7, true});
  std::map<int, Track> frames;
  for (const std::vector<double>& row : poses.rows) {
    const Rigid<double> truth{rotation_exp(Vector3<double>(-row[4], -row[5], -row[6])),
                              {row[1], row[2], row[3]}};
    frames[static_cast<int>(frames.size())] = {row[0], truth, {}};
  }
  for (std::size_t i = 0; i < pixels.rows.size(); ++i) {
    const std::vector<double>& row = pixels.rows[i];
    const double k = row[0];
    const double id = row[2];
    if (!(k >= 0.0 && k <= kLastFrame && k == std::floor(k) && id >= 1.0 && id <= kLandmarks &&
          id == std::floor(id))) {
      throw InputError(pixels.file, pixels.lines[i],
                       fmt::format("expected a frame from 0 to {} and a landmark from 1 to {}",
                                   kLastFrame, kLandmarks));
    }
    Track& track = frames[static_cast<int>(k)];
    if (!track.truth) track.t_s = row[1];
    track.seen.emplace_back(static_cast<LandmarkId>(id),
                            Vector2<float>(static_cast<float>(row[3]), static_cast<float>(row[4])));
  }
  std::vector<Track> tracks;
  tracks.reserve(frames.size());
  for (auto& [number, track] : frames) tracks.push_back(std::move(track));
  return tracks;
}

PinholeCamera<float> camera() {
  PinholeCamera<float> c;
  c.fx = c.fy = 484.5F;
  c.cx = 321.68F;
  c.cy = 247.48F;
  c.width = 640;
  c.height = 480;
  return c;
}

struct Run {
  std::vector<TimedPose> estimate, truth;
  std::vector<Rigid<double>> judged;  ///< estimates whose truth is known
  int before_start = 0;               ///< frames with too few landmarks to begin
  int tracked = 0;
  double nis = 0.0;
  int nis_dof = 0;
  double filter_us = 0.0;
  double focal_px = 0.0;  ///< at the end
};

Run track(const std::vector<Track>& tracks, const PinholeCamera<float>& believed,
          const MonoParameters<float>& parameters, std::uint64_t seed) {
  const auto filter = std::make_unique<Filter>();
  if (!ok(filter->initialise(believed, parameters))) throw UsageError("impossible parameters");
  Random random(seed);
  Run run;
  double last_s = tracks.front().t_s;
  bool started = false;
  for (const Track& frame : tracks) {
    started = started || frame.seen.size() >= kStartLandmarks;
    if (!started) {
      last_s = frame.t_s;
      ++run.before_start;
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    if (frame.t_s > last_s) (void)filter->predict(static_cast<float>(frame.t_s - last_s));
    last_s = frame.t_s;
    std::vector<PixelMatch<float>> matches;
    for (const auto& [id, pixel] : frame.seen) {
      PixelMatch<float> match;
      match.id = id;
      match.slot = filter->find(id);
      match.pixel = pixel;
      if (match.slot >= 0) matches.push_back(match);
    }
    UpdateReport report;
    if (ok(filter->update(matches.data(), static_cast<int>(matches.size()), random, report))) {
      ++run.tracked;
    }
    for (const auto& [id, pixel] : frame.seen) {
      if (filter->find(id) < 0) (void)filter->add_feature(id, pixel);
    }
    const auto end = std::chrono::steady_clock::now();
    run.filter_us += std::chrono::duration<double, std::micro>(end - begin).count();
    run.nis += static_cast<double>(report.nis);
    run.nis_dof += report.nis_dof;
    const std::int64_t t_us = std::llround(1e6 * frame.t_s);
    const Rigid<float> pose = filter->T_world_camera();
    const Rigid<double> estimate{pose.rotation.cast<double>(), pose.translation.cast<double>()};
    run.estimate.push_back({t_us, estimate});
    if (!frame.truth) continue;
    run.judged.push_back(estimate);
    run.truth.push_back({t_us, *frame.truth});
  }
  run.filter_us /= static_cast<double>(tracks.size());
  run.focal_px = static_cast<double>(filter->camera().fx);
  return run;
}

std::vector<Rigid<double>> poses_of(const std::vector<TimedPose>& timed) {
  std::vector<Rigid<double>> poses;
  poses.reserve(timed.size());
  for (const TimedPose& pose : timed) poses.push_back(pose.pose);
  return poses;
}

}  // namespace

ExitCode run_starry_night(const RunOptions& options, const std::string& folder) {
  if (options.mode == "vehicle") throw UsageError("--mode vehicle: starry-night has no odometry");
  if (!options.filter.empty() && options.filter != "mono") {
    throw UsageError("--filter: starry-night is for mono");
  }
  const HandheldOptions& handheld = options.handheld;
  if (!handheld.measurement.empty() || handheld.corner_score) {
    throw UsageError("--measurement, --corner-score: starry-night has no pictures");
  }
  if (!options.record.empty()) throw UsageError("--record: starry-night has no pictures");
  std::vector<Track> tracks = read_tracks(folder);
  if (options.max_frames && static_cast<std::size_t>(*options.max_frames) < tracks.size()) {
    tracks.resize(static_cast<std::size_t>(*options.max_frames));
  }
  MonoParameters<float> parameters;
  // Landmarks come with their names: no match is wrong, and at 11 Hz one match does not tell where
  // the others are. So every match is an inlier of every hypothesis.
  parameters.ransac.min_inliers = 1;
  parameters.inlier_gate = 1e6F;
  set_fading(options.fading, parameters);
  parameters.sigma_px = static_cast<float>(handheld.sigma_px.value_or(kSigmaPx));
  parameters.estimate_focal_length = handheld.estimate_focal_length;
  PinholeCamera<float> believed = camera();
  believed.fx *= static_cast<float>(1.0 + handheld.focal_error);
  believed.fy *= static_cast<float>(1.0 + handheld.focal_error);
  const Run run = track(tracks, believed, parameters, options.seed);
  const auto evaluation = evaluate_trajectory(run.judged, poses_of(run.truth), Alignment::kSim3);

  make_folder(options.out);
  write_tum(options.out / "trajectory.tum", run.estimate);
  write_tum(options.out / "truth.tum", run.truth);
  const int frames = static_cast<int>(tracks.size());
  nlohmann::json trajectory = to_json(evaluation, false);
  trajectory["rotation_rmse_deg"] = nullptr;  // the camera's attitude on the IMU is not given
  const nlohmann::json summary = {
      {"frames", frames},
      {"tracked", run.tracked},
      {"before_start", run.before_start},
      {"lost", frames - run.before_start - run.tracked},
      {"trajectory", trajectory},
      {"nis", {{"mean", run.nis_dof > 0 ? run.nis / run.nis_dof : 0.0}, {"dof", run.nis_dof}}},
      {"focal_px", run.focal_px},
      {"filter_bytes", sizeof(Filter)},
      {"filter_us", run.filter_us}};
  write_json(options.out / "summary.json", summary);
  Manifest manifest;
  manifest.command_line = options.command_line;
  manifest.seed = options.seed;
  manifest.config = "20 features";
  manifest.inputs = nlohmann::json::array({folder});
  write_manifest(options.out, manifest);
  fmt::print(
      "starry-night: {} of {} frames with a consensus, ATE (Sim(3)) {} m, {:.0f} us a frame\n",
      run.tracked, frames, evaluation ? fmt::format("{:.3f}", evaluation->ate_rmse_m) : "-",
      run.filter_us);
  return ExitCode::kOk;
}

}  // namespace cairn::host
