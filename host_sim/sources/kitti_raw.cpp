// Drives of KITTI's raw data (Geiger et al. 2013; formats as in its development kit).
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/picture_folder.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/odometry_file.hpp"
#include "host_sim/sources/time_span.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr double kImuHeight_m = 0.93;         // above the ground
constexpr double kEarthRadius_m = 6378137.0;  // of the kit's Mercator projection
constexpr double kSpeedSigma_mps = 0.1;
constexpr double kYawRateSigma_radps = 0.01;
constexpr double kLargestSpeed_mps = 100.0;
constexpr double kLargestYawRate_radps = 10.0;
constexpr std::size_t kOxtsFields = 30;
constexpr std::int64_t kLargestGap_us = 200000;  // over which a pose is interpolated
constexpr std::int64_t kOutside_us = 20000;      // how far outside of the poses one still counts

/// Days from 1970-01-01 (Hinnant's days_from_civil).
std::int64_t days_of(std::int64_t year, std::int64_t month, std::int64_t day) {
  year -= month <= 2 ? 1 : 0;
  const std::int64_t era = year / 400;
  const std::int64_t of_era = year - 400 * era;
  const std::int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return 146097 * era + 365 * of_era + of_era / 4 - of_era / 100 + of_year - 719468;
}

/// 2011-09-26 13:02:25.964389445
std::int64_t parse_stamp(const TextLine& line, const fs::path& path) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0;
  double second = -1.0;
  const bool read = std::sscanf(line.text.c_str(), "%4d-%2d-%2d %2d:%2d:%lf", &year, &month, &day,
                                &hour, &minute, &second) == 6;
  const bool good = read && year >= 1970 && year < 2100 && month >= 1 && month <= 12 && day >= 1 &&
                    day <= 31 && hour < 24 && minute < 60 && second >= 0.0 && second < 61.0;
  if (!good) {
    throw InputError(
        path, line.number,
        fmt::format("expected a time such as 2011-09-26 13:02:25.964389445, found '{}'",
                    line.text.substr(0, 40)));
  }
  const std::int64_t minutes = (days_of(year, month, day) * 24 + hour) * 60 + minute;
  return minutes * 60000000 + std::llround(1e6 * second);
}

std::vector<std::int64_t> read_stamps(const fs::path& path) {
  std::vector<std::int64_t> times;
  LineReader lines(path);
  for (TextLine line; lines.next(line);) {
    times.push_back(parse_stamp(line, path));
    if (times.size() > 1 && times.back() <= times[times.size() - 2]) {
      throw InputError(path, line.number, "expected times in increasing order");
    }
  }
  if (times.empty()) throw InputError(path, "expected a time a line");
  return times;
}

/// Lines `NAME: numbers` of a calibration file.
class CalibrationFile {
 public:
  explicit CalibrationFile(fs::path path) : path_(std::move(path)) {
    LineReader lines(path_);
    for (TextLine line; lines.next(line);) {
      const std::size_t colon = line.text.find(':');
      if (colon == std::string::npos) continue;
      const std::string name = line.text.substr(0, colon);
      line.text.erase(0, colon + 1);
      lines_[name] = line;
    }
  }

  std::vector<double> numbers(const std::string& name, std::size_t count) const {
    const auto found = lines_.find(name);
    if (found == lines_.end()) throw InputError(path_, name, "missing");
    return parse_numbers(found->second, count, path_, name);
  }

  Matrix3<double> matrix(const std::string& name) const {
    const std::vector<double> m = numbers(name, 9);
    Matrix3<double> matrix;
    matrix << m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8];
    return matrix;
  }

  Quaternion<double> rotation(const std::string& name) const {
    Quaternion<double> rotation;
    if (!to_rotation(matrix(name), rotation)) throw InputError(path_, name, "expected a rotation");
    return rotation;
  }

  /// Keys R and T.
  Rigid<double> pose() const {
    const std::vector<double> t = numbers("T", 3);
    return {rotation("R"), Vector3<double>(t[0], t[1], t[2])};
  }

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  std::map<std::string, TextLine> lines_;
};

/// The calibration lies beside the drives of a day.
fs::path calibration_path(const fs::path& folder, const std::string& name) {
  if (fs::exists(folder / name)) return folder / name;
  return fs::absolute(folder / "").lexically_normal().parent_path().parent_path() / name;
}

bool has_size(const std::vector<double>& size, const cv::Size& picture) {
  return std::lround(size[0]) == picture.width && std::lround(size[1]) == picture.height;
}

/// Camera and its place in the IMU's frame; which one is told by the pictures' size.
CameraFile read_calibration(const fs::path& folder, int index, const fs::path& first_picture,
                            SourceInfo& info) {
  const CalibrationFile cameras(calibration_path(folder, "calib_cam_to_cam.txt"));
  const CalibrationFile from_velodyne(calibration_path(folder, "calib_velo_to_cam.txt"));
  const CalibrationFile from_imu(calibration_path(folder, "calib_imu_to_velo.txt"));
  info.inputs = {cameras.path(), from_velodyne.path(), from_imu.path()};
  cv::Mat grey;
  read_grey_image(first_picture, {}, grey);
  const std::string number = fmt::format("{:02d}", index);
  CameraFile file;
  PinholeCamera<double>& camera = file.camera;
  camera.width = grey.cols;
  camera.height = grey.rows;
  Rigid<double> T_camera_imu = from_velodyne.pose() * from_imu.pose();
  if (has_size(cameras.numbers("S_rect_" + number, 2), grey.size())) {
    const std::vector<double> P = cameras.numbers("P_rect_" + number, 12);
    camera.fx = P[0];
    camera.fy = P[5];
    camera.cx = P[2];
    camera.cy = P[6];
    const Rigid<double> rectify{
        cameras.rotation("R_rect_00"),
        {(P[3] - P[2] * P[11]) / P[0], (P[7] - P[6] * P[11]) / P[5], P[11]}};
    T_camera_imu = rectify * T_camera_imu;
    file.format = "rectified";
  } else if (index == 0 && has_size(cameras.numbers("S_00", 2), grey.size())) {
    const Matrix3<double> K = cameras.matrix("K_00");
    const std::vector<double> D = cameras.numbers("D_00", 5);
    camera.fx = K(0, 0);
    camera.fy = K(1, 1);
    camera.cx = K(0, 2);
    camera.cy = K(1, 2);
    camera.k1 = D[0];
    camera.k2 = D[1];
    camera.p1 = D[2];
    camera.p2 = D[3];
    camera.k3 = D[4];
    file.format = "unrectified";
  } else {
    throw InputError(first_picture,
                     fmt::format("expected the size that {} states as S_rect_{}{}, found {}x{}",
                                 cameras.path().string(), number, index == 0 ? " or S_00" : "",
                                 grey.cols, grey.rows));
  }
  check_camera(camera, cameras.path());
  file.T_body_camera = T_camera_imu.inverse();
  return file;
}

/// What oxts says of the car: times, poses of the IMU and the motion.
struct Oxts {
  std::vector<TimedPose> poses;
  std::vector<OdometrySample> samples;
};

double within(double value, double largest, const char* what, const fs::path& path) {
  if (std::abs(value) <= largest) return value;
  throw InputError(path, fmt::format("expected {} of at most {} either way, found {:.6g}", what,
                                     largest, value));
}

Oxts read_oxts(const fs::path& folder) {
  const std::vector<std::int64_t> times = read_stamps(folder / "timestamps.txt");
  const std::vector<NumberedFile> files = list_numbered_files(folder / "data", "", {".txt"});
  Oxts oxts;
  double scale = 0.0;
  Vector3<double> origin = Vector3<double>::Zero();
  for (const NumberedFile& file : files) {
    if (static_cast<std::size_t>(file.number) >= times.size()) {
      throw InputError(folder / "timestamps.txt",
                       fmt::format("expected a line for {}, found {} lines",
                                   file.path.filename().string(), times.size()));
    }
    LineReader lines(file.path);
    TextLine line;
    if (!lines.next(line)) throw InputError(file.path, "expected a line of 30 numbers");
    const std::vector<double> v = parse_numbers(line, kOxtsFields, file.path, "an oxts record");
    within(v[0], 89.0, "a latitude in degrees", file.path);
    const double to_rad = CV_PI / 180.0;
    if (scale == 0.0) scale = std::cos(v[0] * to_rad);
    TimedPose timed;
    timed.t_us = times[static_cast<std::size_t>(file.number)];
    timed.pose.translation = {
        scale * kEarthRadius_m * v[1] * to_rad,
        scale * kEarthRadius_m * std::log(std::tan(0.5 * (90.0 + v[0]) * to_rad)), v[2]};
    if (oxts.poses.empty()) origin = timed.pose.translation;
    timed.pose.translation -= origin;
    timed.pose.rotation = rotation_exp(Vector3<double>(0.0, 0.0, v[5])) *
                          rotation_exp(Vector3<double>(0.0, v[4], 0.0)) *
                          rotation_exp(Vector3<double>(v[3], 0.0, 0.0));
    OdometrySample sample;
    sample.t_us = timed.t_us;
    sample.kind = OdometrySample::Kind::kTwist;
    sample.speed_mps = static_cast<float>(
        within(v[8], kLargestSpeed_mps, "a forward speed (field 9) in m/s", file.path));
    sample.turn = static_cast<float>(
        within(v[22], kLargestYawRate_radps, "a yaw rate (field 23) in rad/s", file.path));
    oxts.poses.push_back(timed);
    oxts.samples.push_back(sample);
  }
  return oxts;
}

/// Between the poses before and after; none over a gap or outside of the recording.
std::optional<Rigid<double>> pose_at(const std::vector<TimedPose>& poses, std::int64_t t_us) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), t_us,
                       [](const TimedPose& p, std::int64_t t) { return p.t_us < t; });
  if (after == poses.end()) {
    return t_us - poses.back().t_us <= kOutside_us ? std::optional(poses.back().pose)
                                                   : std::nullopt;
  }
  if (after == poses.begin()) {
    return after->t_us - t_us <= kOutside_us ? std::optional(after->pose) : std::nullopt;
  }
  const TimedPose& before = *(after - 1);
  if (after->t_us - before.t_us > kLargestGap_us) return std::nullopt;
  const double part =
      static_cast<double>(t_us - before.t_us) / static_cast<double>(after->t_us - before.t_us);
  return Rigid<double>{before.pose.rotation.slerp(part, after->pose.rotation),
                       (1.0 - part) * before.pose.translation + part * after->pose.translation};
}

SourceInfo describe(const CameraFile& camera) {
  const Rigid<double> T_vehicle_imu{Quaternion<double>::Identity(), {0.0, 0.0, kImuHeight_m}};
  SourceInfo info;
  info.name = "kitti";
  info.camera = camera.camera;
  info.T_vehicle_camera = T_vehicle_imu * *camera.T_body_camera;
  info.frame_rate_hz = 10.0;
  info.odometry =
      OdometryModel{OdometrySample::Kind::kTwist, kSpeedSigma_mps, kYawRateSigma_radps, 0.0, 0.1};
  info.tilt = TiltParameters<double>::car();
  info.note = fmt::format("KITTI raw, {} pictures; odometry and truth from oxts", camera.format);
  return info;
}

}  // namespace

bool is_kitti_raw(const fs::path& folder) {
  return fs::is_directory(folder / "oxts") || fs::is_directory(folder / "image_00");
}

std::unique_ptr<FrameSource> make_kitti_raw_source(const fs::path& folder,
                                                   const FrameRange& range) {
  const int index = fs::is_directory(folder / "image_00") ? 0 : 2;
  const fs::path pictures = folder / fmt::format("image_{:02d}", index);
  const std::vector<NumberedFile> files = list_numbered_files(pictures / "data", "", {".png"});
  const std::vector<std::int64_t> times = read_stamps(pictures / "timestamps.txt");
  check_frame_times(pictures / "timestamps.txt", times);
  if (static_cast<std::size_t>(files.back().number) >= times.size()) {
    throw InputError(pictures / "timestamps.txt",
                     fmt::format("expected a line for {}, found {} lines",
                                 files.back().path.filename().string(), times.size()));
  }
  SourceInfo calibrated;
  const CameraFile camera = read_calibration(folder, index, files.front().path, calibrated);
  SourceInfo info = describe(camera);
  info.inputs = calibrated.inputs;
  const Oxts oxts = read_oxts(folder / "oxts");
  if (oxts.poses.size() > 1) {
    info.odometry->period_s =
        1e-6 * static_cast<double>(oxts.poses.back().t_us - oxts.poses.front().t_us) /
        static_cast<double>(oxts.poses.size() - 1);
  }
  const Rigid<double> T_camera_vehicle = info.T_vehicle_camera.inverse();
  std::vector<std::int64_t> oxts_times;
  for (const TimedPose& pose : oxts.poses) oxts_times.push_back(pose.t_us);
  constexpr std::int64_t kLeastStep_us = 100;
  constexpr std::int64_t kMostStep_us = 1000000;
  const TimeSpan span{times[static_cast<std::size_t>(files.front().number)],
                      times[static_cast<std::size_t>(files.back().number)]};
  const auto warning = check_overlap(folder / "oxts" / "timestamps.txt", "oxts", oxts_times, span,
                                     kLeastStep_us, kMostStep_us);
  if (warning) info.warnings.push_back(*warning);
  std::vector<SequenceFrame> frames;
  std::size_t next_sample = 0;
  for (const NumberedFile& file : files) {
    SequenceFrame frame;
    frame.image = file.path;
    frame.known.number = file.number;
    frame.known.t_us = times[static_cast<std::size_t>(file.number)];
    if (const auto imu = pose_at(oxts.poses, frame.known.t_us)) {
      frame.known.true_T_world_camera = *imu * *camera.T_body_camera;
      frame.known.true_T_world_vehicle = *frame.known.true_T_world_camera * T_camera_vehicle;
    }
    take_samples(oxts.samples, frames.empty(), next_sample, frame.known);
    frames.push_back(std::move(frame));
  }
  return make_image_sequence(std::move(info), std::move(frames), range, folder);
}

}  // namespace cairn::host
