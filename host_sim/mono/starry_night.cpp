#include "host_sim/mono/starry_night.hpp"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cairn/mono/mono_ekf.hpp"

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/planar/recorded/number_table.hpp"
#include "host_sim/run/build_info.hpp"
#include "host_sim/run/trajectory_evaluation.hpp"

namespace cairn::host {
namespace {

constexpr int kLandmarks = 20;
using Filter = MonoEkf<float, kLandmarks, kLandmarks>;

struct Track {
  double t_s = 0.0;
  Rigid<double> truth;
  std::vector<std::pair<LandmarkId, Vector2<float>>> seen;
};

std::vector<Track> read_tracks(const std::filesystem::path& folder) {
  const NumberTable poses = read_number_table(
      folder / "gt_imu.csv",
      {"t_s,x,y,z,th1,th2,th3(axis-angle C_vk_i),vx,vy,vz(body),wx,wy,wz(body gyro)", true, 13,
       true});
  const NumberTable pixels = read_number_table(
      folder / "obs.csv", {"k,t_s,landmark(1..20),u_left,v_left,u_right,v_right", true, 7, true});
  std::vector<Track> tracks;
  for (const std::vector<double>& row : poses.rows) {
    Track track;
    track.t_s = row[0];
    track.truth.translation = {row[1], row[2], row[3]};
    track.truth.rotation = rotation_exp(Vector3<double>(-row[4], -row[5], -row[6]));
    tracks.push_back(track);
  }
  for (std::size_t i = 0; i < pixels.rows.size(); ++i) {
    const std::vector<double>& row = pixels.rows[i];
    const bool good = row[0] >= 0.0 && row[0] < static_cast<double>(tracks.size()) &&
                      row[2] >= 1.0 && row[2] <= kLandmarks;
    if (!good) {
      throw InputError(pixels.file, fmt::format("line {}: expected a frame below {} and a landmark "
                                                "from 1 to {}",
                                                pixels.lines[i], tracks.size(), kLandmarks));
    }
    tracks[static_cast<std::size_t>(row[0])].seen.emplace_back(
        static_cast<LandmarkId>(row[2]),
        Vector2<float>(static_cast<float>(row[3]), static_cast<float>(row[4])));
  }
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
  int tracked = 0;
  double nis = 0.0;
  int nis_dof = 0;
  double filter_us = 0.0;
};

Run track(const std::vector<Track>& tracks, const MonoParameters<float>& parameters,
          std::uint64_t seed) {
  const auto filter = std::make_unique<Filter>();
  if (!ok(filter->initialise(camera(), parameters))) throw UsageError("impossible parameters");
  Random random(seed);
  Run run;
  double last_s = tracks.front().t_s;
  for (const Track& frame : tracks) {
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
    run.estimate.push_back({t_us, {pose.rotation.cast<double>(), pose.translation.cast<double>()}});
    run.truth.push_back({t_us, frame.truth});
  }
  run.filter_us /= static_cast<double>(tracks.size());
  return run;
}

std::vector<Rigid<double>> poses_of(const std::vector<TimedPose>& timed) {
  std::vector<Rigid<double>> poses;
  for (const TimedPose& pose : timed) poses.push_back(pose.pose);
  return poses;
}

}  // namespace

ExitCode run_starry_night(const RunOptions& options, const std::string& folder) {
  if (options.mode == "vehicle") throw UsageError("--mode vehicle: starry-night has no odometry");
  if (!options.filter.empty() && options.filter != "mono") {
    throw UsageError("--filter: starry-night is for mono");
  }
  std::vector<Track> tracks = read_tracks(folder);
  if (options.max_frames && static_cast<std::size_t>(*options.max_frames) < tracks.size()) {
    tracks.resize(static_cast<std::size_t>(*options.max_frames));
  }
  MonoParameters<float> parameters;
  parameters.ransac.min_support = 3;
  if (options.fading == "adaptive") {
    parameters.fading = FadingMode::kAdaptive;
  } else if (!options.fading.empty()) {
    parameters.fading_factor = std::strtof(options.fading.c_str(), nullptr);
  }
  const Run run = track(tracks, parameters, options.seed);
  const auto evaluation =
      evaluate_trajectory(poses_of(run.estimate), poses_of(run.truth), Alignment::kSim3);

  std::filesystem::create_directories(options.out);
  write_tum(options.out / "trajectory.tum", run.estimate);
  write_tum(options.out / "truth.tum", run.truth);
  const int frames = static_cast<int>(tracks.size());
  nlohmann::json trajectory = to_json(evaluation, false);
  trajectory["rotation_rmse_deg"] = nullptr;  // the camera's attitude on the IMU is not given
  const nlohmann::json summary = {
      {"frames", frames},
      {"tracked", run.tracked},
      {"lost", frames - run.tracked},
      {"trajectory", trajectory},
      {"nis", {{"mean", run.nis_dof > 0 ? run.nis / run.nis_dof : 0.0}, {"dof", run.nis_dof}}},
      {"filter_us", run.filter_us}};
  std::ofstream(options.out / "summary.json") << summary.dump(2) << '\n';
  const BuildInfo build = build_info();
  const nlohmann::json manifest = {
      {"command", options.command_line}, {"seed", options.seed}, {"version", build.version},
      {"compiler", build.compiler},      {"flags", build.flags}, {"cpu", build.cpu},
      {"config", "20 features"},         {"inputs", {folder}}};
  std::ofstream(options.out / "manifest.json") << manifest.dump(2) << '\n';
  fmt::print("starry-night: {} of {} frames with support, ATE (Sim(3)) {} m, {:.0f} us a frame\n",
             run.tracked, frames, evaluation ? fmt::format("{:.3f}", evaluation->ate_rmse_m) : "-",
             run.filter_us);
  return ExitCode::kOk;
}

}  // namespace cairn::host
