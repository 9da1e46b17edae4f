#include "host_sim/io/camera_formats/lens_model.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

namespace cairn::host {
namespace {

constexpr const char* kExpectedModels =
    "a pinhole camera with radial-tangential distortion (radtan, plumb_bob, rational_polynomial), "
    "a "
    "Kannala-Brandt fisheye (equidistant, KannalaBrandt8) or none";

/// Lower case letters and digits alone: radial-tangential, RadialTangential and radial_tangential
/// are one name.
std::string plain(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) result += static_cast<char>(std::tolower(byte));
  }
  return result;
}

template <std::size_t N>
bool is_one_of(const std::string& name, const std::array<const char*, N>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

constexpr std::array<const char*, 13> kModelKeys = {
    "distortionmodel", "cameramodel", "model", "modeltype",      "cameratype", "camtype", "type",
    "projectionmodel", "lensmodel",   "lens",  "distortiontype", "projection", "lenstype"};

constexpr std::array<const char*, 10> kCoefficientKeys = {"distortioncoefficients",
                                                          "distortioncoeffs",
                                                          "distortioncoeff",
                                                          "distortionparameters",
                                                          "distcoeffs",
                                                          "distcoeff",
                                                          "distcoefs",
                                                          "distortion",
                                                          "dist",
                                                          "d"};

/// k1 ... k9, p1 ..., s1 ... (thin prism), d1 ..., r1 ... and t1 ... (radial, tangential), b1 ...
/// (affinity)
bool is_numbered_coefficient(const std::string& name) {
  return name.size() == 2 && std::string("kpsdrtb").find(name[0]) != std::string::npos &&
         std::isdigit(static_cast<unsigned char>(name[1])) != 0;
}

bool speaks_of_the_lens(const std::string& name) {
  static constexpr std::array<const char*, 13> kWords = {
      "xi",   "alpha", "beta",  "lambda", "omega",  "skew", "tau",
      "taux", "tauy",  "rpmax", "shear",  "alphac", "kc"};
  for (const char* part :
       {"dist", "fisheye", "mirror", "radial", "tangential", "prism", "binning", "coef", "kappa"}) {
    if (name.find(part) != std::string::npos) return true;
  }
  return is_numbered_coefficient(name) || is_one_of(name, kWords) || is_one_of(name, kModelKeys) ||
         is_one_of(name, kCoefficientKeys);
}

}  // namespace

LensModel lens_model_named(const CameraSection& section, const std::string& key,
                           const std::string& name) {
  static constexpr std::array<const char*, 4> kPinhole = {"pinhole", "perspective", "opencv", ""};
  static constexpr std::array<const char*, 5> kNone = {
      "none", "nodistortion", "rectified", "undistorted", "perspectiveprojwithoutdistortion"};
  static constexpr std::array<const char*, 9> kRadialTangential = {
      "radtan", "radialtangential", "plumbbob", "pinholeradtan",          "brownconrady",
      "brown",  "radtan5",          "radial",   "pinholeradialtangential"};
  static constexpr std::array<const char*, 6> kRational = {
      "rationalpolynomial", "rational", "radtan8", "pinholeradtan8", "fullopencv", "pinholefull"};
  static constexpr std::array<const char*, 11> kFisheye = {
      "equidistant",       "equi", "pinholeequi",    "fisheye",        "opencvfisheye",
      "kannalabrandt",     "kb4",  "kannalabrandt4", "kannalabrandt8", "kb8",
      "pinholeequidistant"};
  const std::string model = plain(name);
  if (is_one_of(model, kFisheye)) return LensModel::kFisheye;
  if (is_one_of(model, kPinhole)) return LensModel::kUnstated;
  if (is_one_of(model, kNone)) return LensModel::kNone;
  if (is_one_of(model, kRadialTangential)) return LensModel::kRadialTangential;
  if (is_one_of(model, kRational)) return LensModel::kRational;
  section.fail(key, fmt::format("expected {}, found '{}'", kExpectedModels, name));
}

LensModel read_lens_model(const CameraSection& section) {
  LensModel model = LensModel::kUnstated;
  // Of OpenCV's program for calibration: 0 or 1.
  if (section.has("fisheye_model") && !section.is_zero("fisheye_model")) {
    if (section.number("fisheye_model", "0 or 1") != 1.0) {
      section.fail("fisheye_model", "expected 0 or 1, found " + section.shown("fisheye_model"));
    }
    model = LensModel::kFisheye;
  }
  for (const std::string& key : section.keys()) {
    const std::string name = plain(key.substr(key.rfind('.') + 1));
    const bool of_camera = key.find('.') == std::string::npos || key.rfind("Camera.", 0) == 0 ||
                           key.rfind("Camera1.", 0) == 0;
    if (!of_camera || !is_one_of(name, kModelKeys)) continue;
    const std::string value = section.text(key, "the name of a camera model");
    const LensModel stated = lens_model_named(section, key, value);
    if (stated == LensModel::kUnstated) continue;
    if (model != LensModel::kUnstated && model != stated) {
      section.fail(key, fmt::format("found '{}' where another key names another lens", value));
    }
    model = stated;
  }
  return model;
}

void set_distortion(const CameraSection& section, const std::string& key, LensModel model,
                    const std::vector<double>& coefficients, PinholeCamera<double>& camera) {
  const std::size_t count = coefficients.size();
  if (model == LensModel::kFisheye) {
    if (count != 0 && count != 4) {
      section.fail(key, fmt::format("expected k1 k2 k3 k4 of a fisheye, found {} numbers", count));
    }
    camera.lens = Lens::kFisheye;
    if (count == 0) return;
    camera.k1 = coefficients[0];
    camera.k2 = coefficients[1];
    camera.k3 = coefficients[2];
    camera.k4 = coefficients[3];
    return;
  }
  static constexpr std::array<std::size_t, 6> kCounts = {0, 4, 5, 8, 12, 14};
  if (std::find(kCounts.begin(), kCounts.end(), count) == kCounts.end()) {
    section.fail(key, fmt::format("expected k1 k2 p1 p2 [k3 [k4 k5 k6]], found {} numbers", count));
  }
  const auto is_not_zero = [](double c) { return c != 0.0; };
  if (model == LensModel::kNone &&
      std::any_of(coefficients.begin(), coefficients.end(), is_not_zero)) {
    section.fail(key, "expected no coefficients, as the lens model says; found some");
  }
  if (model == LensModel::kRadialTangential && count > 5 &&
      std::any_of(coefficients.begin() + 5, coefficients.end(), is_not_zero)) {
    section.fail(key,
                 "expected k1 k2 p1 p2 k3 alone, as the lens model says: coefficients behind "
                 "them must be 0");
  }
  if (count > 8 && std::any_of(coefficients.begin() + 8, coefficients.end(), is_not_zero)) {
    section.fail(key,
                 "expected k1 k2 p1 p2 k3 k4 k5 k6 alone: coefficients behind them (thin "
                 "prism, tilt) must be 0");
  }
  std::vector<double> d = coefficients;
  d.resize(8, 0.0);
  camera.k1 = d[0];
  camera.k2 = d[1];
  camera.p1 = d[2];
  camera.p2 = d[3];
  camera.k3 = d[4];
  camera.k4 = d[5];
  camera.k5 = d[6];
  camera.k6 = d[7];
}

void read_distortion_list(const CameraSection& section, LensModel model,
                          PinholeCamera<double>& camera) {
  std::string found;
  for (const std::string& key : section.keys()) {
    if (!is_one_of(plain(key), kCoefficientKeys)) continue;
    if (!found.empty()) {
      section.fail(key, fmt::format("expected coefficients here or in '{}', found both", found));
    }
    found = key;
  }
  if (!found.empty()) {
    set_distortion(section, found, model, section.numbers(found, "distortion coefficients"),
                   camera);
  } else if (model != LensModel::kUnstated && model != LensModel::kNone) {
    section.fail(
        "distortion_coefficients",
        fmt::format("missing; expected {}, as the lens model says",
                    model == LensModel::kFisheye ? "k1 k2 k3 k4" : "k1 k2 p1 p2 [k3 ...]"));
  }
}

bool has_distortion_keys(const CameraSection& section, const std::string& prefix) {
  for (const char* name : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}) {
    if (section.has(prefix + name)) return true;
  }
  return false;
}

void read_distortion_keys(const CameraSection& section, const std::string& prefix, LensModel model,
                          PinholeCamera<double>& camera) {
  std::vector<std::string> names = {"k1", "k2", "p1", "p2", "k3"};
  const bool has_rational =
      section.has(prefix + "k4") && section.has(prefix + "k5") && section.has(prefix + "k6");
  if (model == LensModel::kFisheye) {
    names = {"k1", "k2", "k3", "k4"};
  } else if (model == LensModel::kRational || (model == LensModel::kUnstated && has_rational)) {
    names.insert(names.end(), {"k4", "k5", "k6"});
  }
  std::vector<double> d;
  for (const std::string& name : names) {
    const std::string key = prefix + name;
    // Of a fisheye all four belong together; those of other lenses are 0 where they are not told.
    if (model == LensModel::kFisheye && !section.has(key)) {
      section.fail(key, "missing; expected k1 k2 k3 k4 of a fisheye");
    }
    d.push_back(section.has(key) ? section.number(key, "a distortion coefficient") : 0.0);
  }
  set_distortion(section, prefix + "k1", model, d, camera);
}

void refuse_unread_lens_keys(const CameraSection& section, const std::string& prefix) {
  for (const std::string& key : section.unread_keys()) {
    std::string name = key;
    if (!prefix.empty() && key.rfind(prefix, 0) == 0) {
      name = key.substr(prefix.size());
    } else if (key.rfind("Camera.", 0) == 0) {
      name = key.substr(7);
    } else if (key.find('.') != std::string::npos) {
      continue;  // of another camera or program
    }
    if (!speaks_of_the_lens(plain(name)) || section.is_zero(key)) continue;
    section.fail(key, fmt::format("found {}, which is not read; expected {}, and no coefficient "
                                  "beside those of the model",
                                  section.shown(key), kExpectedModels));
  }
}

void read_picture_size(const CameraSection& section, const std::string& prefix,
                       PinholeCamera<double>& camera) {
  std::string width;
  std::string height;
  std::string both;
  const auto find = [&](std::string& found, std::initializer_list<const char*> names) {
    for (const char* name : names) {
      const std::string key = prefix + name;
      if (!section.has(key)) continue;
      if (!found.empty()) section.fail(key, "expected this key or '" + found + "', found both");
      found = key;
    }
  };
  find(width, {"width", "image_width", "image_Width", "imageWidth", "cols"});
  find(height, {"height", "image_height", "image_Height", "imageHeight", "rows"});
  find(both, {"resolution", "image_size", "imageSize"});
  if (both.empty() || !width.empty() || !height.empty()) {
    const std::string name = prefix.empty() ? "image_" : prefix;
    camera.width = section.extent(width.empty() ? name + "width" : width, "the image width, px");
    camera.height =
        section.extent(height.empty() ? name + "height" : height, "the image height, px");
    return;
  }
  const std::vector<double> sides = section.numbers(both, "width, height");
  if (sides.size() != 2) section.fail(both, "expected width, height");
  camera.width = section.to_extent(sides[0], both);
  camera.height = section.to_extent(sides[1], both);
}

void read_camera_matrix(const CameraSection& section, const std::string& key,
                        PinholeCamera<double>& camera) {
  const std::string what = "the camera matrix fx 0 cx, 0 fy cy, 0 0 1";
  const std::vector<double> k = section.matrix(key, 3, 3, what);
  if (k[2] == 0.0 && k[5] == 0.0 && (k[6] != 0.0 || k[7] != 0.0)) {
    section.fail(key, fmt::format("expected {}, row by row; this looks column by column", what));
  }
  if (!(k[0] > 0.0) || !(k[4] > 0.0)) {
    section.fail(key, fmt::format("expected focal lengths above zero at elements (0,0) and (1,1), "
                                  "found {} and {}",
                                  k[0], k[4]));
  }
  constexpr double kRounding = 1e-6;  // of what programs write for 0 and 1
  if (std::abs(k[1]) > kRounding * k[0]) {
    section.fail(key,
                 fmt::format("expected 0 at element (0,1): skew is not modelled; found {}", k[1]));
  }
  if (std::abs(k[3]) > kRounding * k[4] || std::abs(k[6]) > kRounding ||
      std::abs(k[7]) > kRounding || std::abs(k[8] - 1.0) > kRounding) {
    section.fail(key, fmt::format("expected {}; found {} at (1,0) and {} {} {} in the last row",
                                  what, k[3], k[6], k[7], k[8]));
  }
  camera.fx = k[0];
  camera.fy = k[4];
  camera.cx = k[2];
  camera.cy = k[5];
}

void read_intrinsics_list(const CameraSection& section, const std::string& key,
                          PinholeCamera<double>& camera) {
  const std::vector<double> values = section.numbers(key, "fx, fy, cx, cy");
  if (values.size() != 4) {
    section.fail(key, fmt::format("expected fx, fy, cx, cy, found {} numbers", values.size()));
  }
  camera.fx = values[0];
  camera.fy = values[1];
  camera.cx = values[2];
  camera.cy = values[3];
}

}  // namespace cairn::host
