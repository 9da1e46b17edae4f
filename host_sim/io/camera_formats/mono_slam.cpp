// Open EKF Mono SLAM's config.yml: CameraCalibration with one or more named calibrations.
#include <cmath>

#include <fmt/format.h>

#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

/// The format's K1 and K2 undistort on the sensor: r_u = r_d (1 + K1 r_d^2 + K2 r_d^4), r in mm.
/// OpenCV's distort at depth 1; the pair that agrees best over the image is found by least squares.
void set_sensor_distortion(const CameraSection& section, PinholeCamera<double>& camera) {
  const double k1_mm = section.has("K1") ? section.number("K1", "a coefficient, mm^-2") : 0.0;
  const double k2_mm = section.has("K2") ? section.number("K2", "a coefficient, mm^-4") : 0.0;
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

std::string calibration_name(const CameraSection& root, const CameraSection& calibrations) {
  if (root.has("RunConfiguration")) {
    const CameraSection run = root.child("RunConfiguration");
    if (run.has("CameraCalibration")) return run.text("CameraCalibration", "a calibration's name");
  }
  const std::vector<std::string> names = calibrations.keys();
  return names.size() == 1 ? names.front() : std::string();
}

PinholeCamera<double> read_mono_slam(const CameraSection& root) {
  const CameraSection calibrations = root.child("CameraCalibration");
  const std::string name = calibration_name(root, calibrations);
  if (!calibrations.has(name)) {
    root.fail("CameraCalibration", fmt::format("expected the calibration '{}'", name));
  }
  const CameraSection section = calibrations.child(name);
  PinholeCamera<double> camera;
  camera.fx = section.number("FX", "the focal length, px");
  camera.fy = section.number("FY", "the focal length, px");
  camera.cx = section.number("CX", "the principal point, px");
  camera.cy = section.number("CY", "the principal point, px");
  camera.width = section.extent("PixelsX", "the image width, px");
  camera.height = section.extent("PixelsY", "the image height, px");
  set_sensor_distortion(section, camera);
  refuse_unread_lens_keys(section);
  return camera;
}

}  // namespace

const CameraFormat kMonoSlamFormat{
    "Open EKF Mono SLAM", "CameraCalibration",
    [](const CameraSection& root) { return root.has("CameraCalibration"); }, read_mono_slam};

}  // namespace cairn::host
