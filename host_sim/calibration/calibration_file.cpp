#include "host_sim/calibration/calibration_file.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace cairn::host {
namespace {

constexpr int kEnoughBoards = 10;
constexpr double kEnoughCoverage = 0.5;
constexpr double kGoodRms_px = 1.0;
constexpr double kGoodRmsOfSide = 0.0008;
constexpr double kGoodFocalSigma = 0.005;
constexpr double kUnseenFocalSigma = 0.005;

const char* ros_name(CalibratedModel model) {
  switch (model) {
    case CalibratedModel::kRational:
      return "rational_polynomial";
    case CalibratedModel::kFisheye:
      return "equidistant";
    case CalibratedModel::kRadialTangential:
      break;
  }
  return "plumb_bob";
}

int used_boards(const Calibration& calibration) {
  return static_cast<int>(std::count_if(calibration.views.begin(), calibration.views.end(),
                                        [](const CalibratedView& view) { return view.used; }));
}

}  // namespace

std::vector<std::string> doubts_about(const Calibration& calibration, const Coverage& coverage) {
  std::vector<std::string> doubts;
  const int boards = used_boards(calibration);
  if (boards < kEnoughBoards) {
    doubts.push_back(fmt::format("{} boards are few: show it in {} or more places and tilts",
                                 boards, kEnoughBoards));
  }
  if (coverage.share() < kEnoughCoverage) {
    doubts.push_back(
        fmt::format("corners cover {:.0f} % of the picture: hold the board into the "
                    "cells marked '.', the borders most of all",
                    100.0 * coverage.share()));
  }
  const double limit = std::max(
      kGoodRms_px, kGoodRmsOfSide * std::max(calibration.size.width, calibration.size.height));
  if (calibration.rms_px > limit) {
    doubts.push_back(
        fmt::format("the rms of {:.2f} px is large (up to {:.2f} px is good): the "
                    "board is not flat, the pictures are blurred, or the lens needs "
                    "another --model",
                    calibration.rms_px, limit));
  }
  if (calibration.focal_sigma.value_or(0.0) > kGoodFocalSigma) {
    doubts.push_back(
        fmt::format("the focal length is uncertain by {:.1f} %: tilt the board by 30 "
                    "to 45 degrees, each way",
                    100.0 * *calibration.focal_sigma));
  }
  return doubts;
}

std::optional<double> focal_sigma_to_tell(const Calibration& calibration) {
  if (!calibration.focal_sigma) return std::nullopt;
  return std::hypot(*calibration.focal_sigma, kUnseenFocalSigma);
}

std::string camera_file_text(const Calibration& calibration, const Coverage& coverage,
                             const std::string& how) {
  std::string text =
      fmt::format("# {}\n# {} boards, rms {:.3f} px, corners in {:.0f} % of the picture\n", how,
                  used_boards(calibration), calibration.rms_px, 100.0 * coverage.share());
  text += fmt::format("image_width: {}\nimage_height: {}\ncamera_name: camera\n",
                      calibration.size.width, calibration.size.height);
  text += fmt::format(
      "camera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [{:.6f}, 0, {:.6f}, 0, {:.6f}, {:.6f}, 0, 0, 1]\n",
      calibration.fx, calibration.cx, calibration.fy, calibration.cy);
  text += fmt::format("distortion_model: {}\ndistortion_coefficients:\n  rows: 1\n  cols: {}\n",
                      ros_name(calibration.model), calibration.coefficients.size());
  text += fmt::format("  data: [{:.9g}]\n", fmt::join(calibration.coefficients, ", "));
  if (const std::optional<double> sigma = focal_sigma_to_tell(calibration)) {
    text += fmt::format("focal_sigma: {:.4f}\n", *sigma);
  }
  return text;
}

std::string drawn(const Coverage& coverage) {
  std::string text;
  for (const auto& row : coverage.seen) {
    for (const bool seen : row) text += seen ? '#' : '.';
    text += '\n';
  }
  return text;
}

}  // namespace cairn::host
