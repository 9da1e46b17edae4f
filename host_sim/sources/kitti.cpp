#include <cmath>

#include <fmt/format.h>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/picture_folder.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/time_span.hpp"
#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr double kSpeedSigma = 0.1;
constexpr double kYawRateSigma = 0.01;

/// A rectified camera: its projection, and where its frame sits in that of camera 0.
struct RectifiedCamera {
  PinholeCamera<double> camera;
  Vector3<double> p_camera0 = Vector3<double>::Zero();
};

/// The line of matrix P`index`, or the first line where lines have no names.
TextLine projection_line(const fs::path& path, int index) {
  LineReader lines(path);
  const std::string label = fmt::format("P{}:", index);
  for (TextLine line; lines.next(line);) {
    if (line.text.rfind(label, 0) != 0 && (index > 0 || line.text.find(':') == 2)) continue;
    line.text.erase(0, line.text.rfind(label, 0) == 0 ? label.size() : 0);
    return line;
  }
  throw InputError(path, fmt::format("expected a 3x4 projection matrix in a line of {}", label));
}

RectifiedCamera read_calibration(const fs::path& path, int index, const fs::path& first_image) {
  const TextLine line = projection_line(path, index);
  const std::vector<double> m = parse_numbers(line, 12, path, "a 3x4 projection matrix");
  RectifiedCamera rectified;
  PinholeCamera<double>& camera = rectified.camera;
  camera.fx = m[0];
  camera.fy = m[5];
  camera.cx = m[2];
  camera.cy = m[6];
  cv::Mat picture;
  read_grey_image(first_image, {}, picture);
  camera.width = picture.cols;
  camera.height = picture.rows;
  if (m[1] != 0.0 || m[4] != 0.0 || m[8] != 0.0 || m[9] != 0.0 || m[10] != 1.0) {
    throw InputError(path, line.number,
                     "expected a projection matrix fx 0 cx tx, 0 fy cy ty, 0 0 1 tz, row by row");
  }
  check_camera(camera, path);
  rectified.p_camera0 = {-(m[3] - m[2] * m[11]) / m[0], -(m[7] - m[6] * m[11]) / m[5], -m[11]};
  return rectified;
}

/// Camera 0 on the recording car, whose origin is on the ground below the IMU, near the rear axle.
Rigid<double> mounting() {
  Matrix3<double> R_vehicle_camera;
  R_vehicle_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Quaternion<double>(R_vehicle_camera), Vector3<double>(1.08, -0.32, 1.65)};
}

double heading(const Rigid<double>& T_world_vehicle) {
  const Vector3<double> forward = T_world_vehicle.rotation * Vector3<double>::UnitX();
  return cairn::atan2(forward.y(), forward.x());
}

/// The folder of pictures and the number of its camera: the left grey one, or the left colour one.
std::pair<fs::path, int> pictures_of(const fs::path& folder) {
  for (const auto& [name, index] : {std::pair{"image_0", 0}, {"image_l", 0}, {"image_2", 2}}) {
    if (fs::is_directory(folder / name)) return {folder / name, index};
  }
  return {folder / "image_0", 0};
}

/// poses.txt, or as downloaded poses/NN.txt beside sequences/; empty: there is none.
fs::path poses_of(const fs::path& folder) {
  fs::path sequence = fs::absolute(folder).lexically_normal();
  if (!sequence.has_filename()) sequence = sequence.parent_path();
  const fs::path downloaded =
      sequence.parent_path().parent_path() / "poses" / (sequence.filename().string() + ".txt");
  for (const fs::path& path : {folder / "poses.txt", downloaded}) {
    if (fs::exists(path)) return path;
  }
  if (sequence.parent_path().filename() == "sequences") return {};
  throw InputError(
      folder / "poses.txt",
      fmt::format("no such file, nor {}; expected the true poses, which odometry is made "
                  "of",
                  downloaded.string()));
}

/// Speed and yaw rate that a planar vehicle needs from `from` to `to`, with noise.
OdometrySample odometry_between(const Frame& from, const Frame& to, GaussianRandom& random) {
  const double dt = 1e-6 * static_cast<double>(to.t_us - from.t_us);
  const double turn =
      wrap_angle(heading(*to.true_T_world_vehicle) - heading(*from.true_T_world_vehicle));
  const double middle = heading(*from.true_T_world_vehicle) + 0.5 * turn;
  const Vector3<double> step =
      to.true_T_world_vehicle->translation - from.true_T_world_vehicle->translation;
  double sine = 0.0;
  double cosine = 0.0;
  sin_cos(middle, sine, cosine);
  OdometrySample sample;
  sample.t_us = to.t_us;
  sample.kind = OdometrySample::Kind::kTwist;
  sample.speed_mps =
      static_cast<float>((cosine * step.x() + sine * step.y()) / dt + random.normal(kSpeedSigma));
  sample.turn = static_cast<float>(turn / dt + random.normal(kYawRateSigma));
  return sample;
}

/// Row of a file (poses.txt, times.txt) that belongs to each picture. Rows count from 0, as the
/// numbers do, or from the first picture's where they are fewer; as many rows as pictures belong to
/// them in order.
std::vector<std::size_t> rows_of(const std::vector<NumberedFile>& files, std::size_t rows,
                                 const fs::path& path) {
  const int first = files.front().number;
  const auto last = static_cast<std::size_t>(files.back().number);
  const std::size_t spanned = last - static_cast<std::size_t>(first) + 1;
  std::vector<std::size_t> belong;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto number = static_cast<std::size_t>(files[i].number);
    belong.push_back(rows == files.size() ? i
                     : rows > last        ? number
                                          : number - static_cast<std::size_t>(first));
  }
  if (rows == files.size() || rows >= spanned) return belong;
  for (std::size_t i = 1; i < files.size(); ++i) {
    if (files[i].number == files[i - 1].number + 1) continue;
    throw InputError(
        files[i].path,
        fmt::format("expected the picture after {}, or as many rows as the {} pictures "
                    "in {}, found {}",
                    files[i - 1].path.filename().string(), files.size(), path.filename().string(),
                    rows));
  }
  throw InputError(path, fmt::format("expected a row for each of the {} images", files.size()));
}

std::vector<std::int64_t> read_times(const fs::path& path) {
  std::vector<std::int64_t> times;
  LineReader lines(path);
  for (TextLine line; lines.next(line);) {
    const double t_s = parse_numbers(line, 1, path, "a time in seconds")[0];
    times.push_back(parse_time_us(t_s, 1e6, path, line.number));
    if (times.size() > 1 && !(times.back() > times[times.size() - 2])) {
      throw InputError(path, line.number, "expected times in increasing order");
    }
  }
  check_frame_times(path, times);
  return times;
}

}  // namespace

std::unique_ptr<FrameSource> make_kitti_source(const fs::path& folder, const FrameRange& range,
                                               std::uint64_t seed) {
  require_folder(folder, "a folder with image_l or image_0, calib.txt and poses.txt");
  if (fs::is_directory(folder / "sequences")) {
    throw InputError(folder,
                     fmt::format("expected one sequence, such as {}, found the folder of all",
                                 (folder / "sequences" / "00").string()));
  }
  const auto [images, index] = pictures_of(folder);
  const std::vector<NumberedFile> files = list_numbered_files(images, "", {".png", ".jpg"});
  SourceInfo info;
  info.name = "kitti";
  const RectifiedCamera rectified =
      read_calibration(folder / "calib.txt", index, files.front().path);
  info.camera = rectified.camera;
  info.frame_rate_hz = 10.0;
  info.inputs = {folder / "calib.txt"};
  const fs::path poses_path = poses_of(folder);
  const bool has_poses = !poses_path.empty();
  const Rigid<double> T_vehicle_camera0 = mounting();
  std::vector<Rigid<double>> poses;
  if (has_poses) {
    info.T_vehicle_camera = {T_vehicle_camera0.rotation, T_vehicle_camera0 * rectified.p_camera0};
    info.odometry =
        OdometryModel{OdometrySample::Kind::kTwist, kSpeedSigma, kYawRateSigma, 0.0, 0.1};
    info.tilt = TiltParameters<double>::car();
    info.seed = seed;
    info.note = fmt::format("odometry from the poses with noise of {} m/s and {} rad/s",
                            kSpeedSigma, kYawRateSigma);
    info.inputs.push_back(poses_path);
    poses = read_kitti_poses(poses_path);
  } else {
    info.note = "no true poses, so no odometry: hand-held mode";
  }
  std::vector<std::int64_t> times;
  if (fs::exists(folder / "times.txt")) {
    times = read_times(folder / "times.txt");
    info.inputs.push_back(folder / "times.txt");
  }
  std::vector<std::size_t> pose_rows;
  if (has_poses) pose_rows = rows_of(files, poses.size(), poses_path);
  std::vector<std::size_t> time_rows;
  if (!times.empty()) time_rows = rows_of(files, times.size(), folder / "times.txt");
  GaussianRandom random(seed ^ 0x6b177ULL);
  std::vector<SequenceFrame> frames;
  for (std::size_t i = 0; i < files.size(); ++i) {
    SequenceFrame frame;
    frame.image = files[i].path;
    frame.known.number = files[i].number;
    frame.known.t_us = times.empty() ? std::int64_t{100000} * (files[i].number - files[0].number)
                                     : times[time_rows[i]];
    if (has_poses) {
      frame.known.true_T_world_vehicle =
          T_vehicle_camera0 * poses[pose_rows[i]] * T_vehicle_camera0.inverse();
      frame.known.true_T_world_camera = *frame.known.true_T_world_vehicle * info.T_vehicle_camera;
    }
    if (has_poses && i > 0) {
      frame.known.odometry.push_back(odometry_between(frames.back().known, frame.known, random));
    }
    frames.push_back(std::move(frame));
  }
  return make_image_sequence(std::move(info), std::move(frames), range, folder);
}

}  // namespace cairn::host
