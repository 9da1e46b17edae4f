#include "host_sim/commands/video_kinds.hpp"

#include "host_sim/commands/video_run.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/hall_source.hpp"
#include "host_sim/sources/hand_source.hpp"
#include "host_sim/sources/stress_source.hpp"
#include "host_sim/sources/video_source.hpp"

namespace cairn::host {
namespace {

constexpr int kHallSmallFrames = 60;

/// A lens need be good in the part of the picture alone that is used.
LensCheck lens_check(const RunOptions& options) {
  return options.crop.empty() ? LensCheck::kWholePicture : LensCheck::kLater;
}

/// Whether pictures are drawn of the frames. A backward run keeps all its frames, so without
/// colour.
bool draws(const RunOptions& options) {
  const bool tracked = !options.timing && !options.check_mount && !options.use_source;
  return tracked && !options.playback.backward;
}

/// Whether a second decoding in colour is worth its time: the few pictures of a report are not.
bool in_colour(const RunOptions& options) {
  return draws(options) && (options.video || options.view);
}

FrameRange range_of(const RunOptions& options) {
  return {options.first_frame, options.max_frames, in_colour(options)};
}

HallOptions hall_options(const RunOptions& options) {
  HallOptions hall;
  hall.seed = options.seed;
  hall.base_noise = options.odometry_noise == "base";
  hall.tilt_rad = options.hall_tilt_rad;
  hall.first_frame = options.first_frame.value_or(0);
  if (hall.first_frame < 0) throw UsageError("--first-frame: the hall's frames start at 0");
  hall.frame_count = options.max_frames;
  hall.colour = in_colour(options);
  return hall;
}

}  // namespace

ExitCode run_hall(const RunOptions& options, const std::string& /*argument*/) {
  return run_source(make_hall_source(hall_options(options)), options);
}

ExitCode run_hall_small(const RunOptions& options, const std::string& /*argument*/) {
  HallOptions hall = hall_options(options);
  hall.width = 320;
  hall.frame_count = options.max_frames.value_or(kHallSmallFrames);
  return run_source(make_hall_source(hall), options);
}

ExitCode run_hall_hand(const RunOptions& options, const std::string& /*argument*/) {
  HandOptions hand;
  hand.seed = options.seed;
  hand.first_frame = options.first_frame.value_or(0);
  if (hand.first_frame < 0) throw UsageError("--first-frame: the hall's frames start at 0");
  hand.frame_count = options.max_frames;
  hand.readout_s = 1e-3 * options.hand_readout_ms;
  return run_source(make_hand_source(hand), options);
}

ExitCode run_stress(const RunOptions& options, const std::string& fields) {
  StressScene scene = parse_stress_scene(fields);
  if (options.max_frames.has_value()) scene.frames = *options.max_frames;
  return run_source(make_stress_source(scene), options);
}

ExitCode run_seven_scenes(const RunOptions& options, const std::string& folder) {
  return run_source(
      make_seven_scenes_source(folder, options.camera, range_of(options), lens_check(options)),
      options);
}

ExitCode run_tag_board(const RunOptions& options, const std::string& folder) {
  return run_source(make_tag_board_source(folder, range_of(options)), options);
}

ExitCode run_kitti(const RunOptions& options, const std::string& folder) {
  if (is_kitti_raw(folder)) {
    return run_source(make_kitti_raw_source(folder, range_of(options)), options);
  }
  return run_source(make_kitti_source(folder, range_of(options), options.seed), options);
}

ExitCode run_tum_rgbd(const RunOptions& options, const std::string& folder) {
  return run_source(
      make_tum_rgbd_source(folder, options.camera, range_of(options), lens_check(options)),
      options);
}

ExitCode run_euroc(const RunOptions& options, const std::string& folder) {
  return run_source(
      make_euroc_source(folder, options.camera, range_of(options), lens_check(options)), options);
}

ExitCode run_camera(const RunOptions& options, const std::string& device) {
  VideoOptions camera;
  camera.media = device;
  camera.live = true;
  camera.camera = options.camera;
  camera.range = range_of(options);
  camera.hfov_deg = options.hfov_deg;
  camera.lens = lens_check(options);
  camera.colour = draws(options);
  return run_source(make_video_source(camera), options);
}

ExitCode run_video(const RunOptions& options, const std::string& media) {
  if (options.odometry.empty() && (options.speed_sigma_mps || options.yaw_rate_sigma_radps)) {
    throw UsageError("--odometry-noise-speed, --odometry-noise-yaw-rate: only with --odometry");
  }
  VideoOptions video;
  video.media = media;
  video.camera = options.camera;
  video.odometry = options.odometry;
  video.times = options.times;
  video.truth = options.truth;
  video.scene_points = options.scene_points;
  video.range = range_of(options);
  video.colour = draws(options);
  video.speed_sigma_mps = options.speed_sigma_mps;
  video.yaw_rate_sigma_radps = options.yaw_rate_sigma_radps;
  video.hfov_deg = options.hfov_deg;
  video.lens = lens_check(options);
  return run_source(make_video_source(video), options);
}

}  // namespace cairn::host
