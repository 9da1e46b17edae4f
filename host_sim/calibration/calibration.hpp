#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cairn/geometry/camera.hpp"

#include "host_sim/calibration/board.hpp"

namespace cairn::host {

/// Which lens model is fitted. Names in camera files: plumb_bob, rational_polynomial, equidistant.
enum class CalibratedModel {
  /// k1 k2 p1 p2 k3; k3 stays 0 where the pictures do not determine it, k3, or k2 and k3, where the
  /// lens would fold back inside the picture.
  kRadialTangential,
  /// k1 k2 p1 p2 k3 k4 k5 k6; of k3 to k6 the last ones stay 0 where they lower the rms by less
  /// than 2 %.
  kRational,
  /// Kannala-Brandt, k1 k2 k3 k4; k4, or k3 and k4, stay 0 where they lower the rms by less than 2
  /// %.
  kFisheye,
};

/// How one board fits the calibration.
struct CalibratedView {
  std::string name;
  double rms_px = 0.0;
  bool used = true;  ///< false: it did not fit the others
};

struct Calibration {
  cv::Size size;
  CalibratedModel model = CalibratedModel::kRadialTangential;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
  std::vector<double> coefficients;  ///< in the model's order
  double rms_px = 0.0;               ///< of the used boards' corners
  /// Standard deviation of fx over fx, for independent errors of corners; none for kFisheye. It is
  /// too small where their errors are alike, see focal_sigma_to_tell().
  std::optional<double> focal_sigma;
  std::vector<CalibratedView> views;  ///< the chosen ones
};

PinholeCamera<double> camera_of(const Calibration& calibration);

/// Share of the cells of a picture in which a corner was seen, row by row.
struct Coverage {
  static constexpr int kAcross = 12;
  static constexpr int kDown = 8;
  bool seen[kDown][kAcross] = {};

  double share() const;
};

Coverage coverage_of(const std::vector<BoardView>& views, const cv::Size& size);

/// Indices of at most `count` views that differ most in place, size and tilt of the board: the
/// largest board, then always the view that is furthest from those taken.
std::vector<std::size_t> choose_views(const std::vector<BoardView>& views, const cv::Size& size,
                                      std::size_t count);

/// Fits the camera to boards by least squares over their corners (Zhang 2000; OpenCV's
/// calibrateCamera and fisheye::calibrate). A board whose rms is above three times the median of
/// the boards is left out, three times in turn at most. Throws InputError naming `media` where
/// fewer than 4 boards are there or left, or where the fit fails.
Calibration calibrate(const std::string& media, const std::vector<BoardView>& views,
                      const cv::Size& size, CalibratedModel model);

}  // namespace cairn::host
