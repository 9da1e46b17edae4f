#include "host_sim/io/camera_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/config_document.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/suspension.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastFocal = 0.1;  // of the longer side: a field of view of 157 degrees
constexpr double kLargestFocal = 100.0;
constexpr double kLargestRatio = 3.0;  // of fx and fy: pixels may be oblong
constexpr double kLargestTangential = 0.02;

const CameraFormat& format_of(const CameraSection& root) {
  const CameraFormat* found = nullptr;
  std::string known;
  for (const CameraFormat* format :
       {&kOpenCvFormat, &kKalibrFormat, &kOrbSlamFormat, &kPlainFormat, &kVinsFormat,
        &kBasaltFormat, &kMonoSlamFormat, &kVispFormat}) {
    known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", format->told_by, format->name);
    if (!format->matches(root)) continue;
    if (found != nullptr) {
      root.fail(format->told_by, fmt::format("expected one calibration, found this one of {} "
                                             "beside {} of {}",
                                             format->name, found->told_by, found->name));
    }
    found = format;
  }
  if (found == nullptr) {
    root.fail("camera_matrix", "missing; expected the focal lengths as one of " + known);
  }
  return *found;
}

std::optional<Rigid<double>> read_body_mounting(const CameraSection& root) {
  const CameraSection camera = root.has("cam0") ? root.child("cam0") : root;
  const std::string key = camera.one_of({"T_BS", "T_cam_imu", "T_imu_cam"});
  if (key.empty()) return std::nullopt;
  const std::optional<Rigid<double>> pose = camera.find_pose(key);
  return key == "T_cam_imu" ? pose->inverse() : *pose;
}

std::optional<TiltParameters<double>> read_suspension(const CameraSection& root) {
  if (!root.has("suspension")) return std::nullopt;
  const NamedSuspension* known = find_suspension(root.text("suspension", "flat, car or rover"));
  if (known == nullptr) {
    root.fail("suspension",
              fmt::format("expected flat, car or rover, found {}", root.shown("suspension")));
  }
  return known->tilt;
}

std::optional<double> read_focal_sigma(const CameraSection& root) {
  constexpr double kLimit = 0.5;
  if (!root.has("focal_sigma")) return std::nullopt;
  const double sigma =
      root.number("focal_sigma", "the relative standard deviation of the focal length");
  if (!(sigma >= 0.0 && sigma <= kLimit)) {
    root.fail("focal_sigma", fmt::format("expected a share of the focal length, 0 to {}, found {}",
                                         kLimit, sigma));
  }
  return sigma;
}

/// Time from a row, or column, to the next, of a picture with so many of them.
float read_pixel_time(const CameraSection& root, const std::string& key, int count) {
  if (!root.has(key)) return 0.0F;
  const double time_s = root.number(key, "the time from one row or column to the next, s");
  const double whole_s = std::abs(time_s) * count;
  if (!(whole_s <= static_cast<double>(ReadoutTimes::kLongest_s))) {
    root.fail(key, fmt::format("expected seconds from one row or column to the next, at most {} s "
                               "for the whole picture, found {}, which makes {:.3g} s",
                               ReadoutTimes::kLongest_s, time_s, whole_s));
  }
  return static_cast<float>(time_s);
}

ReadoutTimes read_readout(const CameraSection& root, const PinholeCamera<double>& camera) {
  if (root.has("row_time") && root.has("line_delay")) {
    root.fail("line_delay", "expected row_time or line_delay, found both");
  }
  const std::string rows = root.has("line_delay") ? "line_delay" : "row_time";
  ReadoutTimes readout;
  readout.row_time_s = read_pixel_time(root, rows, camera.height);
  readout.column_time_s = read_pixel_time(root, "column_time", camera.width);
  return readout;
}

/// The pixel nearest to the principal point on the way to a corner that has no ray, if there is
/// one.
std::optional<Vector2<double>> first_pixel_without_ray(const PinholeCamera<double>& camera) {
  const Vector2<double> centre(camera.cx, camera.cy);
  const double right = camera.width - 1;
  const double bottom = camera.height - 1;
  std::optional<Vector2<double>> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const Vector2<double>& corner :
       std::vector<Vector2<double>>{{0.0, 0.0}, {right, 0.0}, {0.0, bottom}, {right, bottom}}) {
    const double length = (corner - centre).norm();
    for (double r = 0.0; r <= length && r < least; r += 1.0) {
      const Vector2<double> pixel = centre + (r / length) * (corner - centre);
      Vector3<double> ray;
      if (ok(camera.unproject(pixel, ray))) continue;
      nearest = pixel;
      least = r;
    }
  }
  return nearest;
}

std::string coefficients_of(const PinholeCamera<double>& camera) {
  if (camera.lens == Lens::kFisheye) {
    return fmt::format("k1 {} k2 {} k3 {} k4 {}", camera.k1, camera.k2, camera.k3, camera.k4);
  }
  std::string text = fmt::format("k1 {} k2 {} k3 {}", camera.k1, camera.k2, camera.k3);
  if (!camera.is_rational()) return text;
  return text + fmt::format(" k4 {} k5 {} k6 {}", camera.k4, camera.k5, camera.k6);
}

/// The largest part of the image around the principal point, of its shape, whose pixels have rays;
/// empty where it is less than a third. As --crop takes it.
std::string largest_crop(const PinholeCamera<double>& camera) {
  constexpr double kLeastShare = 1.0 / 3.0;
  const Vector2<double> centre(camera.cx, camera.cy);
  const Vector2<double> last(camera.width - 1, camera.height - 1);
  for (double share = 0.99; share > kLeastShare; share -= 0.01) {
    const Vector2<double> low = ((1.0 - share) * centre).array().ceil();
    const Vector2<double> high = (centre + share * (last - centre)).array().floor();
    bool good = true;
    for (const Vector2<double>& corner :
         std::vector<Vector2<double>>{low, high, {low.x(), high.y()}, {high.x(), low.y()}}) {
      Vector3<double> ray;
      good = good && ok(camera.unproject(corner, ray));
    }
    if (good) {
      return fmt::format("{:.0f}x{:.0f}+{:.0f}+{:.0f}", high.x() - low.x() + 1.0,
                         high.y() - low.y() + 1.0, low.x(), low.y());
    }
  }
  return {};
}

void check_intrinsics(const PinholeCamera<double>& camera, const fs::path& path) {
  const double side = std::max(camera.width, camera.height);
  for (const double focal : {camera.fx, camera.fy}) {
    if (focal >= kLeastFocal * side && focal <= kLargestFocal * side) continue;
    throw InputError(path, fmt::format("expected focal lengths in pixels, {:.0f} to {:.0f} for an "
                                       "image of {}x{}, found fx {} fy {}",
                                       kLeastFocal * side, kLargestFocal * side, camera.width,
                                       camera.height, camera.fx, camera.fy));
  }
  const double ratio = camera.fx / camera.fy;
  if (ratio > kLargestRatio || ratio < 1.0 / kLargestRatio) {
    throw InputError(path,
                     fmt::format("expected focal lengths within a factor of {} of one another, "
                                 "found fx {} fy {}",
                                 kLargestRatio, camera.fx, camera.fy));
  }
  if (!(camera.cx >= 0.0 && camera.cy >= 0.0 && camera.cx < camera.width &&
        camera.cy < camera.height)) {
    throw InputError(path, fmt::format("expected the principal point inside the image of {}x{} "
                                       "pixels, found cx {} cy {}",
                                       camera.width, camera.height, camera.cx, camera.cy));
  }
  if (std::abs(camera.p1) > kLargestTangential || std::abs(camera.p2) > kLargestTangential) {
    throw InputError(path,
                     fmt::format("expected tangential coefficients of at most {}, found p1 {} "
                                 "p2 {}: are they of a fisheye model?",
                                 kLargestTangential, camera.p1, camera.p2));
  }
}

/// What a file of the whole picture cannot mean: a centre in shares of the picture, and that of a
/// picture turned by 90 degrees.
void check_centre(const PinholeCamera<double>& camera, const fs::path& path) {
  if (camera.cx <= 1.0 && camera.cy <= 1.0) {
    throw InputError(path, fmt::format("expected the principal point in pixels, found cx {} cy {}, "
                                       "which look like shares of the picture",
                                       camera.cx, camera.cy));
  }
  constexpr double kFar = 0.1;
  constexpr double kNear = 0.02;
  const double side = std::max(camera.width, camera.height);
  const auto off = [&](double width, double height) {
    return std::max(std::abs(camera.cx - 0.5 * width), std::abs(camera.cy - 0.5 * height)) / side;
  };
  if (off(camera.width, camera.height) > kFar && off(camera.height, camera.width) < kNear) {
    throw InputError(path, fmt::format("expected the principal point of a picture of {}x{} pixels, "
                                       "found cx {} cy {}, as one of {}x{} has it",
                                       camera.width, camera.height, camera.cx, camera.cy,
                                       camera.height, camera.width));
  }
}

}  // namespace

void check_lens(const PinholeCamera<double>& camera, const fs::path& path) {
  if (ok(camera.validate())) return;
  const std::optional<Vector2<double>> pixel = first_pixel_without_ray(camera);
  if (!pixel) {
    throw InputError(path,
                     fmt::format("expected a distortion that rises all the way to the "
                                 "image's border, also with its tangential part, and "
                                 "enlarges it to at most {} times its area, found another: "
                                 "{}",
                                 PinholeCamera<double>::kMostEnlarged, coefficients_of(camera)));
  }
  const std::string crop = largest_crop(camera);
  const bool fisheye = camera.lens == Lens::kFisheye;
  throw InputError(
      path,
      fmt::format("expected a distortion that is one to one inside the image{}, found one that "
                  "folds back at pixel ({:.0f}, {:.0f}){}: {}{}",
                  fisheye ? ", and rays of at most 80 degrees off the axis" : "", pixel->x(),
                  pixel->y(), fisheye ? " or a wider ray" : "", coefficients_of(camera),
                  crop.empty() ? "" : fmt::format("; --crop {} uses the part before it", crop)));
}

void check_camera(const PinholeCamera<double>& camera, const fs::path& path) {
  check_intrinsics(camera, path);
  check_lens(camera, path);
}

CameraFile read_camera_file(const fs::path& path, LensCheck lens) {
  require_file(path, "a camera file");
  CameraFile file;
  const std::string text = read_config_text(path, "a calibration");
  if (is_colmap_text(text)) {
    file.camera = read_colmap(path);
    file.format = "COLMAP";
  } else {
    const nlohmann::json document = parse_config_document(path, text);
    if (!document.is_object()) {
      throw InputError(path,
                       "expected keys and values of a camera calibration, such as 'fx: 525', "
                       "found none");
    }
    const CameraSection root(path, document);
    const CameraFormat& format = format_of(root);
    file.format = format.name;
    file.camera = format.read(root);
    file.T_vehicle_camera = root.find_pose("T_vehicle_camera");
    file.T_body_camera = read_body_mounting(root);
    file.tilt = read_suspension(root);
    file.focal_sigma = read_focal_sigma(root);
    file.readout = read_readout(root, file.camera);
  }
  check_intrinsics(file.camera, path);
  check_centre(file.camera, path);
  if (lens == LensCheck::kWholePicture) check_lens(file.camera, path);
  return file;
}

}  // namespace cairn::host
