#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/csv_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/picture_folder.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/data_sets.hpp"

namespace cairn::host {
namespace {

constexpr std::int64_t kTags = 587;

struct SeenCorner {
  std::uint32_t id = 0;
  Vector2<double> pixel;
};

std::map<std::int64_t, Rigid<double>> read_board_poses(const std::filesystem::path& path) {
  CsvReader table(path);
  const std::size_t frame = table.column("frame");
  std::array<std::size_t, 12> columns{};
  for (int i = 0; i < 12; ++i) columns[i] = table.column(fmt::format("m{}{}", i / 4, i % 4));
  std::map<std::int64_t, Rigid<double>> poses;
  while (table.next()) {
    std::array<double, 12> m{};
    for (int i = 0; i < 12; ++i) m[i] = table.number(columns[i]);
    Matrix3<double> matrix;
    matrix << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
    Rigid<double> pose;
    if (!to_rotation(matrix, pose.rotation)) {
      throw InputError(path, table.line(), "expected a rotation in m00 ... m22");
    }
    pose.translation = {m[3], m[7], m[11]};
    poses[table.integer(frame)] = pose;
  }
  return poses;
}

std::map<std::int64_t, std::vector<SeenCorner>> read_corners(const std::filesystem::path& path) {
  CsvReader table(path);
  const std::size_t frame = table.column("frame");
  const std::size_t tag = table.column("tag_id_36h11");
  std::array<std::size_t, 8> columns{};
  for (int k = 0; k < 4; ++k) {
    columns[2 * k] = table.column(fmt::format("u{}", k));
    columns[2 * k + 1] = table.column(fmt::format("v{}", k));
  }
  std::map<std::int64_t, std::vector<SeenCorner>> corners;
  while (table.next()) {
    const std::int64_t id = table.integer(tag);
    if (id < 0 || id >= kTags) {
      table.fail(tag, fmt::format("expected a tag of the family 36h11, 0 to {}", kTags - 1));
    }
    for (int k = 0; k < 4; ++k) {
      SeenCorner corner;
      corner.id = static_cast<std::uint32_t>(4 * id + k + 1);
      corner.pixel = {table.number(columns[2 * k]), table.number(columns[2 * k + 1])};
      corners[table.integer(frame)].push_back(corner);
    }
  }
  return corners;
}

/// Place of each corner on the board (its plane is z = 0): the mean over all frames.
std::map<std::uint32_t, Vector3<double>> board_points(
    const PinholeCamera<double>& camera, const std::map<std::int64_t, Rigid<double>>& poses,
    const std::map<std::int64_t, std::vector<SeenCorner>>& corners) {
  std::map<std::uint32_t, Vector3<double>> sums;
  std::map<std::uint32_t, int> counts;
  for (const auto& [number, seen] : corners) {
    const auto pose = poses.find(number);
    if (pose == poses.end()) continue;
    const Rigid<double> T_board_camera = pose->second.inverse();
    for (const SeenCorner& corner : seen) {
      const Vector3<double> ray = T_board_camera.rotation * camera.unproject(corner.pixel);
      if (std::abs(ray.z()) < 1e-6) continue;
      const double depth = -T_board_camera.translation.z() / ray.z();
      sums.emplace(corner.id, Vector3<double>::Zero()).first->second +=
          T_board_camera.translation + depth * ray;
      ++counts[corner.id];
    }
  }
  for (auto& [id, sum] : sums) sum /= counts[id];
  return sums;
}

}  // namespace

std::unique_ptr<FrameSource> make_tag_board_source(const std::filesystem::path& folder,
                                                   const FrameRange& range) {
  require_folder(folder, "a folder with gray/, cam.json, cMo_grid.csv and tag_corners.csv");
  SourceInfo info;
  info.name = "tag-board";
  info.camera = read_camera_file(folder / "cam.json").camera;
  info.frame_rate_hz = 30.0;
  info.note = "the recording's rate is not stated: 30 Hz assumed";
  info.inputs = {folder / "cam.json", folder / "cMo_grid.csv", folder / "tag_corners.csv"};
  const auto poses = read_board_poses(folder / "cMo_grid.csv");
  const auto corners = read_corners(folder / "tag_corners.csv");
  const auto points = board_points(info.camera, poses, corners);
  std::vector<SequenceFrame> frames;
  for (const NumberedFile& file : list_numbered_files(folder / "gray", "", {".png"})) {
    SequenceFrame frame;
    frame.image = file.path;
    frame.known.number = file.number;
    frame.known.t_us = std::llround(1e6 * file.number / info.frame_rate_hz);
    const auto pose = poses.find(file.number);
    if (pose != poses.end()) {
      frame.known.true_T_world_camera = pose->second.inverse();
      const auto seen = corners.find(file.number);
      if (seen != corners.end()) {
        for (const SeenCorner& corner : seen->second) {
          frame.known.scene_points.push_back(
              {corner.id, corner.pixel, pose->second * points.at(corner.id)});
        }
      }
    }
    frames.push_back(std::move(frame));
  }
  return make_image_sequence(std::move(info), std::move(frames), range, folder);
}

}  // namespace cairn::host
