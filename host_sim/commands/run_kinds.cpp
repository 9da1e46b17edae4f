#include "host_sim/commands/run_kinds.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "host_sim/commands/source_of_path.hpp"
#include "host_sim/commands/suggestion.hpp"
#include "host_sim/commands/video_kinds.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/recorded/recorded_kinds.hpp"
#include "host_sim/recorded/starry_night.hpp"

namespace cairn::host {

namespace {

using Names = std::vector<std::string>;

Names joined(const Names& a, const Names& b) {
  Names all = a;
  all.insert(all.end(), b.begin(), b.end());
  return all;
}

Names without(Names names, const Names& others) {
  const auto other = [&](const std::string& name) {
    return std::find(others.begin(), others.end(), name) != others.end();
  };
  names.erase(std::remove_if(names.begin(), names.end(), other), names.end());
  return names;
}

const Names& picture_options() {
  static const Names names = {"--first-frame",
                              "--work-limit",
                              "--record",
                              "--overlay",
                              "--view",
                              "--scale",
                              "--crop",
                              "--playback",
                              "--every",
                              "--budget-ms",
                              "--start-heading-variance",
                              "--start-position-variance",
                              "--suspension",
                              "--tilt-sigma",
                              "--tilt-time-constant",
                              "--travel-sigma",
                              "--measurement",
                              "--corner-score",
                              "--sigma-px",
                              "--focal-error",
                              "--estimate-focal-length",
                              "--focal-sigma",
                              "--row-time",
                              "--gyro",
                              "--gyro-imu",
                              "--gyro-rotation",
                              "--gyro-noise",
                              "--gyro-bias",
                              "--gyro-bias-walk",
                              "--gyro-time-sigma"};
  return names;
}

/// Refuses options that other kinds use and this one would ignore.
void check_options(const RunKind& kind, const Names& given) {
  const auto uses = [](const RunKind& any, const std::string& option) {
    return std::find(any.options.begin(), any.options.end(), option) != any.options.end();
  };
  for (const std::string& option : given) {
    const bool of_kinds = std::any_of(run_kinds().begin(), run_kinds().end(),
                                      [&](const RunKind& any) { return uses(any, option); });
    if (of_kinds && !uses(kind, option)) {
      throw UsageError(fmt::format("{}: source '{}' does not use it", option, kind.name));
    }
  }
}

const RunKind* find_kind(const std::string& name) {
  for (const RunKind& kind : run_kinds()) {
    if (name == kind.name) return &kind;
  }
  return nullptr;
}

ExitCode run_kind(const RunKind& kind, const RunOptions& options) {
  const std::size_t colon = options.source.find(':');
  const bool has_rest = colon != std::string::npos;
  const bool is_empty = has_rest && colon + 1 == options.source.size();
  if (has_rest == kind.argument.empty() || (is_empty && kind.argument != "FIELDS")) {
    throw UsageError(fmt::format("source '{}': expected {}{}", options.source, kind.name,
                                 kind.argument.empty() ? "" : ":" + kind.argument));
  }
  if ((options.timing.has_value() || options.use_source) && !kind.gives_pictures) {
    throw UsageError(fmt::format("source '{}' gives no pictures", options.source));
  }
  if (!kind.has_end && !options.max_frames && (options.timing.has_value() || options.use_source)) {
    throw UsageError(fmt::format("source {}: expected --max-frames: it has no end", kind.name));
  }
  check_options(kind, options.given);
  return kind.run(options, has_rest ? options.source.substr(colon + 1) : std::string());
}

}  // namespace

const std::vector<RunKind>& run_kinds() {
  static const Names hall = joined(picture_options(), {"--odometry-noise", "--uneven-floor"});
  static const Names stress(picture_options().begin() + 1, picture_options().end());
  static const Names video = joined(
      picture_options(), {"--camera", "--hfov", "--odometry", "--times", "--truth",
                          "--scene-points", "--odometry-noise-speed", "--odometry-noise-yaw-rate"});
  static const Names camera =
      joined(without(picture_options(), {"--first-frame", "--playback"}), {"--camera", "--hfov"});
  static const Names landmarks = {"--budget-ms", "--start-heading-variance",
                                  "--start-position-variance"};
  static const std::vector<RunKind> kinds = {
      {"hall", "", run_hall, hall},
      {"hall-small", "", run_hall_small, hall},
      {"hall-hand", "", run_hall_hand, joined(picture_options(), {"--readout"})},
      {"stress", "FIELDS", run_stress, stress},
      {"seven-scenes", "DIR", run_seven_scenes, joined(picture_options(), {"--camera"})},
      {"tag-board", "DIR", run_tag_board, picture_options()},
      {"kitti", "DIR", run_kitti, picture_options()},
      {"tum-rgbd", "DIR", run_tum_rgbd, joined(picture_options(), {"--camera"})},
      {"tum", "DIR", run_tum_rgbd, joined(picture_options(), {"--camera"})},
      {"euroc", "DIR", run_euroc, joined(picture_options(), {"--camera"})},
      {"tum-vi", "DIR", run_euroc, joined(picture_options(), {"--camera"})},
      {"video", "FILE_OR_FOLDER", run_video, video},
      {"camera", "DEVICE", run_camera, camera, true, false},
      {"lost-in-the-woods", "DIR", run_lost_in_the_woods, joined(landmarks, {"--profile"}), false},
      {"mrclam", "DIR:ROBOT", run_mrclam, joined(landmarks, {"--profile"}), false},
      {"victoria-park", "DIR", run_victoria_park, landmarks, false},
      {"starry-night",
       "DIR",
       run_starry_night,
       {"--sigma-px", "--focal-error", "--estimate-focal-length"},
       false},
  };
  return kinds;
}

ExitCode dispatch_run(const RunOptions& options) {
  const auto name_of = [](const std::string& source) { return source.substr(0, source.find(':')); };
  const std::string name = name_of(options.source);
  if (const RunKind* kind = find_kind(name)) return run_kind(*kind, options);
  RunOptions found = options;
  found.source = source_of_path(options.source);
  if (const RunKind* kind = find_kind(name_of(found.source))) {
    fmt::print("{}: taken as {}\n", options.source, found.source);
    return run_kind(*kind, found);
  }
  std::string known;
  std::vector<std::string> names;
  for (const RunKind& kind : run_kinds()) {
    names.push_back(kind.name);
    known += fmt::format("{}{}{}{}", known.empty() ? "" : ", ", kind.name,
                         kind.argument.empty() ? "" : ":", kind.argument);
  }
  throw UsageError(fmt::format("source '{}': expected a file, a folder, or one of {}{}",
                               options.source, known, did_you_mean(name, names)));
}

}  // namespace cairn::host
