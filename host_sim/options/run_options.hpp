#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/base/names.hpp"
#include "host_sim/options/handheld_options.hpp"
#include "host_sim/sources/playback_source.hpp"

namespace cairn::host {

inline constexpr const char* kDefaultVehicleFilter = "group-iekf";
inline constexpr const char* kMonoFilter = "mono";
inline constexpr const char* kWindowFilter = "window";
inline constexpr const char* kDefaultHandheldFilter = kWindowFilter;
inline constexpr double kDefaultBudgetMs = kPaperTotalMs;
/// Of each coordinate of a start that is known, m^2 and rad^2.
inline constexpr double kKnownStartVariance = 1e-6;

/// What `cairn_sim timing` wants of a run; the times are always taken.
struct TimingOptions {
  int counted_frames = 60;    ///< whose instructions are counted; 0: none
  double p99_below_ms = 0.0;  ///< the command fails above it; 0: no check
};

/// Options of `cairn_sim run`, common to video and landmark sources.
struct RunOptions {
  std::string source;  ///< as typed: NAME or NAME:REST
  std::filesystem::path out;
  std::string command_line;
  std::string mode;    ///< vehicle, handheld; empty: the source's own
  std::string filter;  ///< group-iekf, lifted-iekf, ekf, mono, window; empty: the mode's own
  std::string fading;  ///< a number >= 1, adaptive; empty: the filter's own
  double budget_ms = kDefaultBudgetMs;
  std::uint64_t seed = 1;
  std::optional<int> first_frame;
  std::optional<int> max_frames;
  bool video = true;
  bool view = false;               ///< show the run in a window
  std::string overlay = "shaded";  ///< or wireframe
  std::filesystem::path record;    ///< input log to write; empty: none
  std::string odometry_noise = "s1";
  std::optional<double> speed_sigma_mps;       ///< of a video's odometry
  std::optional<double> yaw_rate_sigma_radps;  ///< same
  std::optional<double> start_heading_variance;
  std::optional<double> start_position_variance;
  std::string suspension;  ///< flat, car, rover; empty: the source's own
  std::optional<double> tilt_sigma_rad;
  std::optional<double> tilt_time_constant_s;
  std::optional<double> travel_sigma_rad;  ///< of a vehicle's direction of travel
  double hand_readout_ms = 0.0;            ///< of a picture of hall-hand
  double hall_tilt_rad = 0.0;              ///< how far the hall's vehicle tilts, rms
  std::string profile = "plain";           ///< plain, calibrated: of landmark recordings
  HandheldOptions handheld;
  std::optional<int> work_limit;  ///< units of work a frame; empty: the tracker's own
  std::filesystem::path camera;
  std::filesystem::path odometry;
  std::filesystem::path gyro;             ///< samples of a gyroscope; empty: none
  std::filesystem::path gyro_imu;         ///< description of its IMU; empty: one beside the samples
  std::vector<double> gyro_rotation;      ///< R_camera_gyro as w, x, y, z; empty: by the files
  std::optional<double> gyro_noise;       ///< rad/s/sqrt(Hz)
  std::optional<double> gyro_bias_sigma;  ///< rad/s
  std::optional<double> gyro_bias_walk;   ///< rad/s/sqrt(s)
  std::optional<double> gyro_time_sigma;  ///< s
  std::filesystem::path times;
  std::filesystem::path truth;
  bool scene_points = false;       ///< of a video with truth: triangulated
  std::optional<double> scale;     ///< of the pictures; empty: as far as the tracker needs
  std::string crop;                ///< WIDTHxHEIGHT[+LEFT+TOP] of the pictures; empty: all
  std::optional<double> hfov_deg;  ///< guess in place of a camera file
  bool force = false;              ///< write into a folder that is not empty
  Playback playback;
  std::vector<std::string> given;       ///< names of the options on the command line
  std::optional<TimingOptions> timing;  ///< time the frames instead of evaluating the run
  bool check_mount = false;             ///< say what the drive tells of the mount, write nothing
  /// What to do with the opened source instead of tracking it as a whole; empty: track it.
  std::function<void(FrameSource& source)> use_source;
};

}  // namespace cairn::host
