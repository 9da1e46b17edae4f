#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/listed_files.hpp"
#include "host_sim/sources/true_poses.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr double kUs_of_ns = 1e-3;
constexpr std::size_t kPoseFields =
    8;  // time, p_RS_R x y z, q_RS w x y z; what follows is not read

std::vector<std::string_view> split_commas(std::string_view text) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = text.find(',');
    fields.push_back(trimmed(text.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    text.remove_prefix(comma + 1);
  }
}

std::int64_t read_ns(std::string_view field, const fs::path& path, int line) {
  return parse_time_us(parse_number(field, path, line, "a time in ns"), kUs_of_ns, path, line);
}

void check_increasing(std::int64_t before_us, std::int64_t t_us, const fs::path& path, int line) {
  if (t_us > before_us) return;
  throw InputError(path, line, "expected times in increasing order");
}

std::vector<SequenceFrame> read_frames(const fs::path& list) {
  std::vector<SequenceFrame> frames;
  LineReader lines(list);
  for (TextLine line; lines.next(line);) {
    const std::vector<std::string_view> fields = split_commas(line.text);
    if (fields.size() != 2) throw InputError(list, line.number, "expected: time in ns, file");
    SequenceFrame frame;
    frame.known.number = static_cast<int>(frames.size());
    frame.known.t_us = read_ns(fields[0], list, line.number);
    if (!frames.empty()) {
      check_increasing(frames.back().known.t_us, frame.known.t_us, list, line.number);
    }
    frame.image =
        list.parent_path() / "data" / inside_folder(std::string(fields[1]), list, line.number);
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) throw InputError(list, "expected lines of: time in ns, file");
  return frames;
}

using PoseColumns = std::array<std::size_t, kPoseFields>;

/// Where the header (a comment above the rows) says that time, x, y, z, qw, qx, qy and qz stand; in
/// this order where it names none of them.
PoseColumns pose_columns(const std::string& header, const fs::path& path, int line) {
  static constexpr std::array<std::string_view, kPoseFields> kNames = {
      "timestamp", "p_rs_r_x", "p_rs_r_y", "p_rs_r_z", "q_rs_w", "q_rs_x", "q_rs_y", "q_rs_z"};
  PoseColumns columns = {0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<std::string_view> fields = split_commas(header);
  std::size_t named = 0;
  bool in_order = true;
  for (std::size_t i = 0; i < kPoseFields; ++i) {
    for (std::size_t at = 0; at < fields.size(); ++at) {
      std::string name(fields[at].substr(0, fields[at].find_first_of(" [")));
      for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      if (name != kNames[i]) continue;
      ++named;
      in_order = in_order && at == i;
      columns[i] = at;
    }
  }
  if (named != kPoseFields && !in_order) {
    throw InputError(path, line,
                     fmt::format("expected a header with {}, found another order without all of "
                                 "them",
                                 fmt::join(kNames, ", ")));
  }
  return columns;
}

/// Poses of the body.
std::vector<TimedPose> read_poses(const fs::path& path) {
  std::vector<TimedPose> poses;
  LineReader lines(path);
  PoseColumns columns{};
  for (TextLine line; lines.next(line);) {
    if (poses.empty()) columns = pose_columns(lines.comment(), path, line.number);
    const std::vector<std::string_view> fields = split_commas(line.text);
    if (fields.size() <= *std::max_element(columns.begin(), columns.end())) {
      throw InputError(path, line.number, "expected: time in ns, x, y, z, qw, qx, qy, qz");
    }
    TimedPose timed;
    timed.t_us = read_ns(fields[columns[0]], path, line.number);
    if (!poses.empty()) check_increasing(poses.back().t_us, timed.t_us, path, line.number);
    double v[kPoseFields] = {};
    for (std::size_t i = 1; i < kPoseFields; ++i) {
      v[i] = parse_number(fields[columns[i]], path, line.number, "a number of a pose");
    }
    timed.pose.translation = {v[1], v[2], v[3]};
    timed.pose.rotation = Quaternion<double>(v[4], v[5], v[6], v[7]);
    const double norm = timed.pose.rotation.norm();
    if (!(std::abs(norm - 1.0) <= 0.01)) {
      throw InputError(path, line.number,
                       fmt::format("expected a unit quaternion qw, qx, qy, qz, found one of length "
                                   "{:.3g}",
                                   norm));
    }
    timed.pose.rotation.normalize();
    poses.push_back(timed);
  }
  if (poses.empty())
    throw InputError(path, "expected lines of: time in ns, x, y, z, qw, qx, qy, qz");
  return poses;
}

fs::path first_that_exists(std::initializer_list<fs::path> paths) {
  for (const fs::path& path : paths) {
    if (!path.empty() && fs::exists(path)) return path;
  }
  return {};
}

/// A folder in `folder` that has mav0: archives hold one.
fs::path recording_below(const fs::path& folder) {
  fs::path found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!fs::is_directory(entry.path() / "mav0")) continue;
    if (found.empty() || entry.path() < found) found = entry.path();
  }
  return found;
}

/// The camera, and its place on the body from its file or the data set's own.
CameraFile read_camera(const fs::path& mav, const fs::path& camera_file, LensCheck lens,
                       SourceInfo& info) {
  const fs::path own =
      first_that_exists({mav / "cam0" / "sensor.yaml", mav / ".." / "dso" / "camchain.yaml"});
  const fs::path used = camera_file.empty() ? own : camera_file;
  if (used.empty()) {
    throw InputError(
        mav / "cam0" / "sensor.yaml",
        "no such file, nor dso/camchain.yaml; expected one, or a camera file by --camera");
  }
  CameraFile camera = read_camera_file(used, lens);
  info.inputs.push_back(used);
  if (!camera.T_body_camera.has_value() && used != own && !own.empty()) {
    camera.T_body_camera = read_camera_file(own, LensCheck::kLater).T_body_camera;
    info.inputs.push_back(own);
  }
  info.note = fmt::format("camera of {}", used.filename().string());
  return camera;
}

}  // namespace

std::unique_ptr<FrameSource> make_euroc_source(const fs::path& folder, const fs::path& camera_file,
                                               const FrameRange& range, LensCheck lens) {
  require_folder(folder, "a folder with mav0/cam0");
  const fs::path mav = fs::is_directory(folder / "mav0") ? folder / "mav0" : folder;
  if (!fs::is_directory(mav / "cam0")) {
    const fs::path below = recording_below(folder);
    throw InputError(folder,
                     fmt::format("expected a folder with mav0/cam0, as EuRoC and TUM-VI are "
                                 "downloaded{}",
                                 below.empty() ? "" : "; " + below.string() + " is one"));
  }
  const fs::path list = mav / "cam0" / "data.csv";
  require_file(list, "the list of pictures");
  SourceInfo info;
  info.name = "euroc";
  const CameraFile camera = read_camera(mav, camera_file, lens, info);
  info.camera = camera.camera;
  info.T_body_camera = camera.T_body_camera;
  info.focal_sigma = camera.focal_sigma;
  info.readout = camera.readout;
  info.inputs.push_back(list);
  std::vector<SequenceFrame> frames = read_frames(list);
  std::vector<std::int64_t> times;
  for (const SequenceFrame& frame : frames) times.push_back(frame.known.t_us);
  check_frame_times(list, times);
  if (times.size() > 1) info.frame_rate_hz = 1e6 / static_cast<double>(median_step_us(times));
  const fs::path truth_path = first_that_exists(
      {mav / "state_groundtruth_estimate0" / "data.csv", mav / "mocap0" / "data.csv"});
  if (truth_path.empty()) {
    info.note += "; no true poses";
  } else {
    if (!camera.T_body_camera.has_value()) {
      throw InputError(
          info.inputs.front(), "T_BS",
          "missing; expected the camera's place on the body, whose poses the truth has");
    }
    const std::vector<TimedPose> truth = read_poses(truth_path);
    info.inputs.push_back(truth_path);
    check_truth(truth_path, truth, {times.front(), times.back()}, info);
    for (SequenceFrame& frame : frames) {
      const auto body = pose_near(truth, frame.known.t_us);
      if (body) frame.known.true_T_world_camera = *body * *camera.T_body_camera;
    }
  }
  return make_image_sequence(std::move(info), std::move(frames), range, list);
}

}  // namespace cairn::host
