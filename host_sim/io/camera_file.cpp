#include "host_sim/io/camera_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

/// OpenCV writes the directive `%YAML:1.0`, which is not YAML; directives carry nothing we need.
std::string without_directives(const fs::path& path) {
  require_file(path, "a camera file");
  std::ifstream file(path);
  std::ostringstream text;
  std::string line;
  while (std::getline(file, line)) text << (line.rfind('%', 0) == 0 ? std::string() : line) << '\n';
  return text.str();
}

/// Reads keys of one map and keeps the path to it for messages.
class Section {
 public:
  Section(const fs::path& file, YAML::Node node, std::string prefix)
      : file_(file), node_(std::move(node)), prefix_(std::move(prefix)) {}

  bool has(const std::string& key) const { return node_.IsMap() && node_[key].IsDefined(); }

  /// First of `keys` that is there, or empty.
  std::string first_of(std::initializer_list<const char*> keys) const {
    for (const char* key : keys) {
      if (has(key)) return key;
    }
    return {};
  }

  [[noreturn]] void fail(const std::string& key, const std::string& problem) const {
    throw InputError(file_, prefix_ + key, problem);
  }

  double number(const std::string& key, const std::string& what) const {
    if (!has(key)) fail(key, fmt::format("missing; expected {}", what));
    return to_number(node_[key], key, what);
  }
  double number_or(const std::string& key, double otherwise) const {
    return has(key) ? to_number(node_[key], key, "a number") : otherwise;
  }
  int extent(const std::string& key, const std::string& what) const {
    return to_extent(number(key, what), key);
  }

  /// A list, or a matrix written as {rows, cols, data}.
  std::vector<double> numbers(const std::string& key, const std::string& what) const {
    if (!has(key)) fail(key, fmt::format("missing; expected {}", what));
    YAML::Node list = node_[key];
    if (list.IsMap()) list = list["data"];
    if (!list.IsDefined() || !list.IsSequence()) fail(key, fmt::format("expected {}", what));
    std::vector<double> values;
    collect(list, key, what, values);
    return values;
  }

  int to_extent(double value, const std::string& key) const {
    if (!(value >= 16.0 && value <= 4096.0) || value != std::floor(value)) {
      fail(key, fmt::format("expected an image side of 16 to 4096 pixels, found {}", value));
    }
    return static_cast<int>(value);
  }

  Section child(const std::string& key) const { return {file_, node_[key], prefix_ + key + "."}; }
  const YAML::Node& node() const { return node_; }

 private:
  double to_number(const YAML::Node& node, const std::string& key, const std::string& what) const {
    const std::string text = node.IsScalar() ? node.Scalar() : std::string();
    double value = 0.0;
    const char* begin = text.data() + (!text.empty() && text[0] == '+' ? 1 : 0);
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(begin, end, value);
    if (text.empty() || parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(value)) {
      fail(key, fmt::format("expected {}, found '{}'", what, text));
    }
    return value;
  }

  void collect(const YAML::Node& list, const std::string& key, const std::string& what,
               std::vector<double>& values) const {
    for (const YAML::Node& item : list) {
      if (!item.IsSequence()) {
        values.push_back(to_number(item, key, what));
        continue;
      }
      for (const YAML::Node& inner : item) values.push_back(to_number(inner, key, what));
    }
  }

  fs::path file_;
  YAML::Node node_;
  std::string prefix_;
};

void set_matrix(const Section& section, const std::string& key, PinholeCamera<double>& camera) {
  const std::vector<double> k = section.numbers(key, "the 9 numbers of the camera matrix");
  if (k.size() != 9) {
    section.fail(key,
                 fmt::format("expected the 9 numbers of the camera matrix, found {}", k.size()));
  }
  if (!(k[0] > 0.0) || !(k[4] > 0.0)) {
    section.fail(key, "expected focal lengths above zero at elements (0,0) and (1,1)");
  }
  camera.fx = k[0];
  camera.fy = k[4];
  camera.cx = k[2];
  camera.cy = k[5];
}

void set_distortion(const Section& section, const std::string& key, PinholeCamera<double>& camera) {
  std::vector<double> d = section.numbers(key, "4 or 5 distortion coefficients");
  if (d.size() > 5) {
    for (std::size_t i = 5; i < d.size(); ++i) {
      if (d[i] != 0.0) section.fail(key, "expected k1 k2 p1 p2 k3; higher coefficients must be 0");
    }
  } else if (!d.empty() && d.size() < 4) {
    section.fail(key, fmt::format("expected 4 or 5 distortion coefficients, found {}", d.size()));
  }
  d.resize(5, 0.0);
  camera.k1 = d[0];
  camera.k2 = d[1];
  camera.p1 = d[2];
  camera.p2 = d[3];
  camera.k3 = d[4];
}

void require_model(const Section& section, const std::string& key,
                   std::initializer_list<const char*> allowed) {
  if (!section.has(key)) return;
  const std::string model = section.node()[key].as<std::string>("");
  std::string known;
  for (const char* name : allowed) {
    if (model == name) return;
    known += std::string(known.empty() ? "" : " or ") + name;
  }
  section.fail(key, fmt::format("expected {}, found '{}'", known, model));
}

PinholeCamera<double> read_opencv_or_ros(const Section& root, const std::string& matrix_key) {
  PinholeCamera<double> camera;
  require_model(root, "distortion_model", {"plumb_bob", "radtan"});
  set_matrix(root, matrix_key, camera);
  const std::string width = root.first_of({"image_width", "width", "image_Width"});
  const std::string height = root.first_of({"image_height", "height", "image_Height"});
  camera.width = root.extent(width.empty() ? "image_width" : width, "the image width, px");
  camera.height = root.extent(height.empty() ? "image_height" : height, "the image height, px");
  const std::string distortion =
      root.first_of({"distortion_coefficients", "Distortion_Coefficients", "distCoeffs",
                     "dist_coeffs", "D", "d"});
  if (!distortion.empty()) set_distortion(root, distortion, camera);
  return camera;
}

PinholeCamera<double> read_kalibr(const Section& section) {
  PinholeCamera<double> camera;
  require_model(section, "camera_model", {"pinhole"});
  require_model(section, "distortion_model", {"radtan", "none"});
  const std::vector<double> intrinsics = section.numbers("intrinsics", "fx, fy, cx, cy");
  if (intrinsics.size() != 4) {
    section.fail("intrinsics",
                 fmt::format("expected fx, fy, cx, cy, found {} numbers", intrinsics.size()));
  }
  camera.fx = intrinsics[0];
  camera.fy = intrinsics[1];
  camera.cx = intrinsics[2];
  camera.cy = intrinsics[3];
  const std::vector<double> resolution = section.numbers("resolution", "width, height");
  if (resolution.size() != 2) section.fail("resolution", "expected width, height");
  camera.width = section.to_extent(resolution[0], "resolution");
  camera.height = section.to_extent(resolution[1], "resolution");
  if (section.has("distortion_coeffs")) set_distortion(section, "distortion_coeffs", camera);
  return camera;
}

/// Flat keys: fx or, with the prefix of ORB-SLAM, Camera.fx.
PinholeCamera<double> read_flat(const Section& root, const std::string& prefix) {
  PinholeCamera<double> camera;
  camera.fx = root.number(prefix + "fx", "the focal length, px");
  camera.fy = root.number(prefix + "fy", "the focal length, px");
  camera.cx = root.number(prefix + "cx", "the principal point, px");
  camera.cy = root.number(prefix + "cy", "the principal point, px");
  camera.k1 = root.number_or(prefix + "k1", 0.0);
  camera.k2 = root.number_or(prefix + "k2", 0.0);
  camera.p1 = root.number_or(prefix + "p1", 0.0);
  camera.p2 = root.number_or(prefix + "p2", 0.0);
  camera.k3 = root.number_or(prefix + "k3", 0.0);
  camera.width = root.extent(prefix + "width", "the image width, px");
  camera.height = root.extent(prefix + "height", "the image height, px");
  return camera;
}

PinholeCamera<double> read_visp(const Section& root) {
  PinholeCamera<double> camera;
  require_model(root, "model", {"perspectiveProjWithoutDistortion"});
  camera.fx = root.number("px", "the focal length, px");
  camera.fy = root.number("py", "the focal length, px");
  camera.cx = root.number("u0", "the principal point, px");
  camera.cy = root.number("v0", "the principal point, px");
  camera.width = root.extent("w", "the image width, px");
  camera.height = root.extent("h", "the image height, px");
  return camera;
}

/// The dialect's K1 and K2 undistort on the sensor: r_u = r_d (1 + K1 r_d^2 + K2 r_d^4), r in mm.
/// OpenCV's distort at depth 1; the pair that agrees best over the image is found by least squares.
void set_sensor_distortion(const Section& section, PinholeCamera<double>& camera) {
  const double k1_mm = section.number_or("K1", 0.0);
  const double k2_mm = section.number_or("K2", 0.0);
  if (k1_mm == 0.0 && k2_mm == 0.0) return;
  const double pixel_mm = section.number("DX", "the pixel pitch, mm, because K1 or K2 is given");
  if (!(pixel_mm > 0.0)) section.fail("DX", "expected a pixel pitch above zero");
  const double focal_mm = camera.fx * pixel_mm;
  const double r_max = pixel_mm * 0.5 * std::hypot(camera.width, camera.height);
  double a11 = 0.0, a12 = 0.0, a22 = 0.0, b1 = 0.0, b2 = 0.0;
  constexpr int kSamples = 100;
  for (int i = 1; i <= kSamples; ++i) {
    const double rd = r_max * i / kSamples;
    const double ru = rd * (1.0 + k1_mm * rd * rd + k2_mm * rd * rd * rd * rd);
    const double u = ru / focal_mm;
    const double c1 = u * u * u;  // of k1 in r_d - r_u
    const double c2 = c1 * u * u;
    const double rest = (rd - ru) / focal_mm;
    a11 += c1 * c1;
    a12 += c1 * c2;
    a22 += c2 * c2;
    b1 += c1 * rest;
    b2 += c2 * rest;
  }
  const double determinant = a11 * a22 - a12 * a12;
  camera.k1 = (b1 * a22 - b2 * a12) / determinant;
  camera.k2 = (a11 * b2 - a12 * b1) / determinant;
}

PinholeCamera<double> read_mono_slam(const Section& root) {
  const Section calibrations = root.child("CameraCalibration");
  std::string name;
  if (root.has("RunConfiguration") && root.child("RunConfiguration").has("CameraCalibration")) {
    name = root.node()["RunConfiguration"]["CameraCalibration"].as<std::string>("");
  } else if (calibrations.node().IsMap() && calibrations.node().size() == 1) {
    name = calibrations.node().begin()->first.as<std::string>();
  }
  if (!calibrations.has(name)) {
    root.fail("CameraCalibration", fmt::format("expected the calibration '{}'", name));
  }
  const Section section = calibrations.child(name);
  PinholeCamera<double> camera;
  camera.fx = section.number("FX", "the focal length, px");
  camera.fy = section.number("FY", "the focal length, px");
  camera.cx = section.number("CX", "the principal point, px");
  camera.cy = section.number("CY", "the principal point, px");
  camera.width = section.extent("PixelsX", "the image width, px");
  camera.height = section.extent("PixelsY", "the image height, px");
  set_sensor_distortion(section, camera);
  return camera;
}

PinholeCamera<double> read_dialect(const Section& root) {
  const std::string matrix =
      root.first_of({"camera_matrix", "Camera_Matrix", "cameraMatrix", "K", "k"});
  if (!matrix.empty()) return read_opencv_or_ros(root, matrix);
  if (root.has("cam0")) return read_kalibr(root.child("cam0"));
  if (root.has("intrinsics")) return read_kalibr(root);
  if (root.has("CameraCalibration")) return read_mono_slam(root);
  if (!root.first_of({"Camera.fx", "Camera.fy", "Camera.cx"}).empty()) {
    return read_flat(root, "Camera.");
  }
  if (!root.first_of({"fx", "fy", "cx"}).empty()) return read_flat(root, "");
  if (!root.first_of({"px", "py", "u0"}).empty()) return read_visp(root);
  root.fail(
      "camera_matrix",
      "missing; expected the focal lengths as camera_matrix (OpenCV, ROS), cam0.intrinsics "
      "(Kalibr), fx, Camera.fx (ORB-SLAM), CameraCalibration (Open EKF Mono SLAM) or px (ViSP)");
}

std::optional<Rigid<double>> read_mounting(const Section& root) {
  if (!root.has("T_vehicle_camera")) return std::nullopt;
  const std::string expected = "16 numbers of a 4x4 pose matrix, row by row";
  const std::vector<double> m = root.numbers("T_vehicle_camera", expected);
  if (m.size() != 16) root.fail("T_vehicle_camera", "expected " + expected);
  Matrix3<double> matrix;
  matrix << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  Rigid<double> mounting;
  if (!to_rotation(matrix, mounting.rotation)) {
    root.fail("T_vehicle_camera", "expected a rotation in the left 3x3 block");
  }
  mounting.translation = {m[3], m[7], m[11]};
  return mounting;
}

}  // namespace

CameraFile read_camera_file(const fs::path& path) {
  YAML::Node document;
  try {
    document = YAML::Load(without_directives(path));
  } catch (const YAML::Exception& error) {
    throw InputError(path, error.mark.line + 1,
                     fmt::format("expected YAML or JSON: {}", error.msg));
  }
  if (!document.IsMap()) throw InputError(path, "expected keys and values of a camera calibration");
  const Section root(path, document, "");
  CameraFile file;
  file.camera = read_dialect(root);
  if (!ok(file.camera.validate())) {
    throw InputError(path, fmt::format("expected focal lengths above zero and a principal point "
                                       "inside the image, found fx {} fy {} cx {} cy {} in {}x{}",
                                       file.camera.fx, file.camera.fy, file.camera.cx,
                                       file.camera.cy, file.camera.width, file.camera.height));
  }
  file.T_vehicle_camera = read_mounting(root);
  return file;
}

}  // namespace cairn::host
