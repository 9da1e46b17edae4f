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

constexpr double kCameraHeight = 1.65;  // of the recording car
constexpr double kSpeedSigma = 0.1;
constexpr double kYawRateSigma = 0.01;

PinholeCamera<double> read_calibration(const fs::path& path, const fs::path& first_image) {
  LineReader lines(path);
  TextLine line;
  if (!lines.next(line)) throw InputError(path, "expected a 3x4 projection matrix a line");
  const std::size_t colon = line.text.find(':');
  if (colon != std::string::npos) line.text.erase(0, colon + 1);
  const std::vector<double> m = parse_numbers(line, 12, path, "a 3x4 projection matrix");
  PinholeCamera<double> camera;
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
  return camera;
}

Rigid<double> mounting() {
  Matrix3<double> R_vehicle_camera;
  R_vehicle_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Quaternion<double>(R_vehicle_camera), Vector3<double>(0.0, 0.0, kCameraHeight)};
}

double heading(const Rigid<double>& T_world_vehicle) {
  const Vector3<double> forward = T_world_vehicle.rotation * Vector3<double>::UnitX();
  return cairn::atan2(forward.y(), forward.x());
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
  const fs::path images =
      fs::is_directory(folder / "image_0") ? folder / "image_0" : folder / "image_l";
  const std::vector<NumberedFile> files = list_numbered_files(images, "", {".png"});
  SourceInfo info;
  info.name = "kitti";
  info.camera = read_calibration(folder / "calib.txt", files.front().path);
  info.T_vehicle_camera = mounting();
  info.frame_rate_hz = 10.0;
  info.odometry = OdometryModel{OdometrySample::Kind::kTwist, kSpeedSigma, kYawRateSigma, 0.0, 0.1};
  info.tilt = TiltParameters<double>::car();
  info.seed = seed;
  info.note = fmt::format("odometry from the poses with noise of {} m/s and {} rad/s", kSpeedSigma,
                          kYawRateSigma);
  info.inputs = {folder / "calib.txt", folder / "poses.txt"};
  const std::vector<Rigid<double>> poses = read_kitti_poses(folder / "poses.txt");
  std::vector<std::int64_t> times;
  if (fs::exists(folder / "times.txt")) {
    times = read_times(folder / "times.txt");
    info.inputs.push_back(folder / "times.txt");
  }
  // Rows belong to the images in order, whatever number the first image has.
  if (poses.size() < files.size() || (!times.empty() && times.size() < files.size())) {
    throw InputError(folder / (poses.size() < files.size() ? "poses.txt" : "times.txt"),
                     fmt::format("expected a row for each of the {} images", files.size()));
  }
  GaussianRandom random(seed ^ 0x6b177ULL);
  std::vector<SequenceFrame> frames;
  for (std::size_t i = 0; i < files.size(); ++i) {
    SequenceFrame frame;
    frame.image = files[i].path;
    frame.known.number = files[i].number;
    frame.known.t_us = times.empty() ? 100000 * static_cast<std::int64_t>(i) : times[i];
    frame.known.true_T_world_camera = info.T_vehicle_camera * poses[i];
    frame.known.true_T_world_vehicle =
        *frame.known.true_T_world_camera * info.T_vehicle_camera.inverse();
    if (i > 0) {
      frame.known.odometry.push_back(odometry_between(frames.back().known, frame.known, random));
    }
    frames.push_back(std::move(frame));
  }
  return make_image_sequence(std::move(info), std::move(frames), range, folder);
}

}  // namespace cairn::host
