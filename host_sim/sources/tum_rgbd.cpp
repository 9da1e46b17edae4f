#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/time_span.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLargestTimeDifference_us = 20000;

PinholeCamera<double> published_camera(const fs::path& folder) {
  PinholeCamera<double> camera;
  camera.width = 640;
  camera.height = 480;
  const std::string name = fs::absolute(folder).lexically_normal().string();
  const auto set = [&](double fx, double fy, double cx, double cy) {
    camera.fx = fx;
    camera.fy = fy;
    camera.cx = cx;
    camera.cy = cy;
  };
  const auto distort = [&](double k1, double k2, double p1, double p2, double k3) {
    camera.k1 = k1;
    camera.k2 = k2;
    camera.p1 = p1;
    camera.p2 = p2;
    camera.k3 = k3;
  };
  if (name.find("freiburg1") != std::string::npos) {
    set(517.3, 516.5, 318.6, 255.3);
    distort(0.2624, -0.9531, -0.0054, 0.0026, 1.1633);
  } else if (name.find("freiburg2") != std::string::npos) {
    set(520.9, 521.0, 325.1, 249.7);
    distort(0.2312, -0.7849, -0.0033, -0.0001, 0.9172);
  } else if (name.find("freiburg3") != std::string::npos) {
    set(535.4, 539.2, 320.1, 247.6);
  } else {
    throw InputError(folder,
                     "expected 'freiburg1', 'freiburg2' or 'freiburg3' in the folder's name,"
                     " or a camera file by --camera");
  }
  return camera;
}

/// A list names files of its own folder alone: a path that leads out of it is refused.
fs::path inside_folder(const fs::path& file, const fs::path& list, int line) {
  const fs::path plain = file.lexically_normal();
  if (plain.is_absolute() || plain.empty() || *plain.begin() == "..") {
    throw InputError(
        list, line,
        fmt::format("expected a file inside the list's folder, found '{}'", file.string()));
  }
  return plain;
}

void check_truth(const fs::path& path, const std::vector<TimedPose>& truth, const TimeSpan& frames,
                 SourceInfo& info) {
  constexpr std::int64_t kLeastStep_us = 100;
  constexpr std::int64_t kMostStep_us = 10000000;
  std::vector<std::int64_t> times;
  for (const TimedPose& pose : truth) times.push_back(pose.t_us);
  const auto warning = check_overlap(path, "the truth", times, frames, kLeastStep_us, kMostStep_us);
  if (warning.has_value()) info.warnings.push_back(*warning);
}

std::optional<Rigid<double>> pose_at(const std::vector<TimedPose>& poses, std::int64_t t_us) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), t_us,
                       [](const TimedPose& p, std::int64_t t) { return p.t_us < t; });
  std::optional<Rigid<double>> best;
  std::int64_t best_difference = kLargestTimeDifference_us + 1;
  for (const auto it : {after, after == poses.begin() ? after : after - 1}) {
    if (it == poses.end()) continue;
    const std::int64_t difference = std::abs(it->t_us - t_us);
    if (difference < best_difference) {
      best_difference = difference;
      best = it->pose;
    }
  }
  return best;
}

}  // namespace

std::unique_ptr<FrameSource> make_tum_rgbd_source(const fs::path& folder,
                                                  const fs::path& camera_file,
                                                  const FrameRange& range) {
  require_folder(folder, "a folder with rgb.txt and groundtruth.txt");
  SourceInfo info;
  info.name = "tum-rgbd";
  info.camera =
      camera_file.empty() ? published_camera(folder) : read_camera_file(camera_file).camera;
  if (!camera_file.empty()) info.inputs.push_back(camera_file);
  info.frame_rate_hz = 30.0;
  const fs::path list = folder / "rgb.txt";
  const std::vector<TimedPose> truth = read_tum(folder / "groundtruth.txt");
  info.inputs.push_back(list);
  info.inputs.push_back(folder / "groundtruth.txt");
  std::vector<SequenceFrame> frames;
  LineReader lines(list);
  for (TextLine line; lines.next(line);) {
    const std::vector<std::string_view> fields = split_blanks(line.text);
    if (fields.size() != 2) throw InputError(list, line.number, "expected: time file");
    SequenceFrame frame;
    frame.known.number = static_cast<int>(frames.size());
    frame.known.t_us =
        parse_time_us(parse_number(fields[0], list, line.number, "time"), 1e6, list, line.number);
    if (!frames.empty() && frame.known.t_us <= frames.back().known.t_us) {
      throw InputError(list, line.number, "expected times in increasing order");
    }
    frame.image = folder / inside_folder(std::string(fields[1]), list, line.number);
    frame.known.true_T_world_camera = pose_at(truth, frame.known.t_us);
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) throw InputError(list, "expected lines of: time file");
  std::vector<std::int64_t> frame_times;
  for (const SequenceFrame& frame : frames) frame_times.push_back(frame.known.t_us);
  check_frame_times(list, frame_times);
  check_truth(folder / "groundtruth.txt", truth, {frame_times.front(), frame_times.back()}, info);
  return make_image_sequence(std::move(info), std::move(frames), range, list);
}

}  // namespace cairn::host
