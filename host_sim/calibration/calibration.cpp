#include "host_sim/calibration/calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

constexpr std::size_t kLeastBoards = 4;
constexpr int kRejections = 3;
constexpr double kRejectedOverMedian = 3.0;
constexpr double kNeverRejected_px = 0.3;  // below it a board is good, however good the others are
constexpr double kSigmasOfCoefficient = 3.0;  // a smaller k3 is not told from 0
constexpr double kSameRms = 1.02;             // of a fit with fewer coefficients
constexpr int kK3 = 8;                        // its place in OpenCV's list of deviations

using Points2 = std::vector<std::vector<cv::Point2f>>;
using Points3 = std::vector<std::vector<cv::Point3f>>;

/// What the solvers give.
struct Fit {
  cv::Matx33d K;
  cv::Mat coefficients;
  double rms_px = 0.0;
  std::vector<double> view_rms_px;
  std::optional<double> focal_sigma;
};

PinholeCamera<double> camera_of(const cv::Size& size, CalibratedModel model, const cv::Matx33d& K,
                                const std::vector<double>& d) {
  PinholeCamera<double> camera;
  camera.fx = K(0, 0);
  camera.fy = K(1, 1);
  camera.cx = K(0, 2);
  camera.cy = K(1, 2);
  camera.width = size.width;
  camera.height = size.height;
  camera.k1 = d[0];
  camera.k2 = d[1];
  if (model == CalibratedModel::kFisheye) {
    camera.lens = Lens::kFisheye;
    camera.k3 = d[2];
    camera.k4 = d[3];
    return camera;
  }
  camera.p1 = d[2];
  camera.p2 = d[3];
  camera.k3 = d[4];
  if (model == CalibratedModel::kRational) {
    camera.k4 = d[5];
    camera.k5 = d[6];
    camera.k6 = d[7];
  }
  return camera;
}

Fit solve_pinhole(const Points3& points, const Points2& pixels, const cv::Size& size, int flags) {
  Fit fit;
  cv::Mat K, rotations, translations, intrinsic_sigma, extrinsic_sigma, view_errors;
  fit.rms_px =
      cv::calibrateCamera(points, pixels, size, K, fit.coefficients, rotations, translations,
                          intrinsic_sigma, extrinsic_sigma, view_errors, flags);
  fit.K = K;
  fit.focal_sigma = intrinsic_sigma.at<double>(0) / fit.K(0, 0);
  for (int i = 0; i < view_errors.rows; ++i) fit.view_rms_px.push_back(view_errors.at<double>(i));
  const bool k3_is_open = (flags & (cv::CALIB_FIX_K3 | cv::CALIB_RATIONAL_MODEL)) == 0;
  const double k3 = fit.coefficients.at<double>(4);
  if (k3_is_open && std::abs(k3) < kSigmasOfCoefficient * intrinsic_sigma.at<double>(kK3)) {
    return solve_pinhole(points, pixels, size, flags | cv::CALIB_FIX_K3);
  }
  return fit;
}

bool is_one_to_one(const Fit& fit, const cv::Size& size, CalibratedModel model) {
  const std::vector<double> d(fit.coefficients.begin<double>(), fit.coefficients.end<double>());
  return ok(camera_of(size, model, fit.K, d).validate());
}

/// Coefficients that hold where corners were seen may fold the picture behind them: then with fewer
/// of them, where these do not.
Fit fit_radial_tangential(const Points3& points, const Points2& pixels, const cv::Size& size) {
  const Fit full = solve_pinhole(points, pixels, size, 0);
  if (is_one_to_one(full, size, CalibratedModel::kRadialTangential)) return full;
  for (const int fixed :
       {static_cast<int>(cv::CALIB_FIX_K3), cv::CALIB_FIX_K3 | cv::CALIB_FIX_K2}) {
    Fit fewer = solve_pinhole(points, pixels, size, fixed);
    if (is_one_to_one(fewer, size, CalibratedModel::kRadialTangential)) return fewer;
  }
  return full;
}

/// With as few coefficients as the pictures need: numerator and denominator of a rational lens can
/// cancel each other, and where the pictures do not tell them apart they are as large as you like.
Fit fit_rational(const Points3& points, const Points2& pixels, const cv::Size& size) {
  const Fit full = solve_pinhole(points, pixels, size, cv::CALIB_RATIONAL_MODEL);
  constexpr int kNoDenominator = cv::CALIB_FIX_K4 | cv::CALIB_FIX_K5 | cv::CALIB_FIX_K6;
  for (const int fixed :
       {kNoDenominator | cv::CALIB_FIX_K3, kNoDenominator, cv::CALIB_FIX_K5 | cv::CALIB_FIX_K6,
        static_cast<int>(cv::CALIB_FIX_K6)}) {
    Fit fewer = solve_pinhole(points, pixels, size, cv::CALIB_RATIONAL_MODEL | fixed);
    const bool same = fewer.rms_px <= kSameRms * full.rms_px;
    if (same && is_one_to_one(fewer, size, CalibratedModel::kRational)) return fewer;
  }
  return full;
}

double rms_of(const std::vector<cv::Point2f>& a, const std::vector<cv::Point2f>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const cv::Point2f d = a[i] - b[i];
    sum += static_cast<double>(d.dot(d));
  }
  return std::sqrt(sum / static_cast<double>(a.size()));
}

Fit fit_fisheye(const Points3& points, const Points2& pixels, const cv::Size& size, int fixed) {
  Fit fit;
  std::vector<cv::Mat> rotations, translations;
  cv::Mat K;
  fit.rms_px = cv::fisheye::calibrate(
      points, pixels, size, K, fit.coefficients, rotations, translations,
      cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW | fixed,
      {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-9});
  fit.K = K;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<cv::Point2f> projected;
    cv::fisheye::projectPoints(points[i], projected, rotations[i], translations[i], K,
                               fit.coefficients);
    fit.view_rms_px.push_back(rms_of(projected, pixels[i]));
  }
  return fit;
}

/// With as few coefficients as the pictures need: those that they do not determine bend the lens
/// where no board was.
Fit fit_fisheye(const Points3& points, const Points2& pixels, const cv::Size& size) {
  Fit full = fit_fisheye(points, pixels, size, 0);
  for (const int fixed : {cv::fisheye::CALIB_FIX_K3 | cv::fisheye::CALIB_FIX_K4,
                          static_cast<int>(cv::fisheye::CALIB_FIX_K4)}) {
    Fit fewer = fit_fisheye(points, pixels, size, fixed);
    if (fewer.rms_px <= kSameRms * full.rms_px) return fewer;
  }
  return full;
}

Fit fit_model(const std::string& media, const std::vector<const BoardView*>& views,
              const cv::Size& size, CalibratedModel model) {
  if (views.size() < kLeastBoards) {
    throw InputError(media, fmt::format("expected {} or more boards that fit one another, found {}",
                                        kLeastBoards, views.size()));
  }
  Points2 pixels;
  Points3 points;
  for (const BoardView* view : views) {
    pixels.push_back(view->pixels);
    points.push_back(view->points);
  }
  try {
    if (model == CalibratedModel::kFisheye) return fit_fisheye(points, pixels, size);
    return model == CalibratedModel::kRational ? fit_rational(points, pixels, size)
                                               : fit_radial_tangential(points, pixels, size);
  } catch (const cv::Exception& error) {
    throw InputError(media, fmt::format("expected boards that determine the camera, in different "
                                        "places and tilts; the fit failed: {}",
                                        error.err));
  }
}

/// Place, size and tilt of a board, each about 0 to 1.
using ViewPlace = std::array<double, 6>;

ViewPlace place_of(const BoardView& view, const cv::Size& size) {
  cv::Point2d mean(0.0, 0.0);
  for (const cv::Point2f& p : view.pixels) mean += cv::Point2d(p);
  mean *= 1.0 / static_cast<double>(view.pixels.size());
  // The tilt by the perspective of the plane: what the homography divides by.
  std::vector<cv::Point2f> flat;
  for (const cv::Point3f& p : view.points) flat.emplace_back(p.x, p.y);
  const cv::Mat H = cv::findHomography(flat, view.pixels);
  const cv::Rect2d box = cv::boundingRect(flat);
  double across = 0.0, down = 0.0;
  if (!H.empty() && H.at<double>(2, 2) != 0.0) {
    across = H.at<double>(2, 0) / H.at<double>(2, 2) * box.width;
    down = H.at<double>(2, 1) / H.at<double>(2, 2) * box.height;
  }
  const cv::RotatedRect outline = cv::minAreaRect(view.pixels);
  const double extent = std::sqrt(static_cast<double>(outline.size.area()) / size.area());
  const double turn = outline.angle * CV_PI / 180.0;
  return {mean.x / size.width,
          mean.y / size.height,
          extent,
          std::clamp(across, -1.0, 1.0),
          std::clamp(down, -1.0, 1.0),
          0.25 * std::abs(std::sin(2.0 * turn))};
}

double distance(const ViewPlace& a, const ViewPlace& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double Coverage::share() const {
  int count = 0;
  for (const auto& row : seen) count += static_cast<int>(std::count(row, row + kAcross, true));
  return static_cast<double>(count) / (kAcross * kDown);
}

Coverage coverage_of(const std::vector<BoardView>& views, const cv::Size& size) {
  Coverage coverage;
  for (const BoardView& view : views) {
    for (const cv::Point2f& p : view.pixels) {
      const int x = static_cast<int>(p.x * Coverage::kAcross / static_cast<float>(size.width));
      const int y = static_cast<int>(p.y * Coverage::kDown / static_cast<float>(size.height));
      if (x < 0 || y < 0 || x >= Coverage::kAcross || y >= Coverage::kDown) continue;
      coverage.seen[y][x] = true;
    }
  }
  return coverage;
}

std::vector<std::size_t> choose_views(const std::vector<BoardView>& views, const cv::Size& size,
                                      std::size_t count) {
  std::vector<ViewPlace> places;
  for (const BoardView& view : views) places.push_back(place_of(view, size));
  std::vector<std::size_t> chosen;
  std::vector<double> apart(views.size(), std::numeric_limits<double>::infinity());
  for (std::size_t n = 0; n < std::min(count, views.size()); ++n) {
    std::size_t best = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const bool further = n == 0 ? places[i][2] > places[best][2] : apart[i] > apart[best];
      if (further) best = i;
    }
    chosen.push_back(best);
    for (std::size_t i = 0; i < views.size(); ++i) {
      apart[i] = std::min(apart[i], i == best ? -1.0 : distance(places[i], places[best]));
    }
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

PinholeCamera<double> camera_of(const Calibration& calibration) {
  const cv::Matx33d K(calibration.fx, 0.0, calibration.cx, 0.0, calibration.fy, calibration.cy, 0.0,
                      0.0, 1.0);
  return camera_of(calibration.size, calibration.model, K, calibration.coefficients);
}

Calibration calibrate(const std::string& media, const std::vector<BoardView>& views,
                      const cv::Size& size, CalibratedModel model) {
  Calibration calibration;
  calibration.size = size;
  calibration.model = model;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < views.size(); ++i) {
    calibration.views.push_back({views[i].name});
    left.push_back(i);
  }
  Fit fit;
  for (int round = 0; round <= kRejections; ++round) {
    std::vector<const BoardView*> used;
    for (const std::size_t i : left) used.push_back(&views[i]);
    fit = fit_model(media, used, size, model);
    const double limit = std::max(kNeverRejected_px, kRejectedOverMedian * median(fit.view_rms_px));
    std::vector<std::size_t> good;
    for (std::size_t i = 0; i < left.size(); ++i) {
      CalibratedView& view = calibration.views[left[i]];
      view.rms_px = fit.view_rms_px[i];
      view.used = round == kRejections || view.rms_px <= limit;
      if (view.used) good.push_back(left[i]);
    }
    if (good.size() == left.size()) break;
    left = good;
  }
  calibration.fx = fit.K(0, 0);
  calibration.fy = fit.K(1, 1);
  calibration.cx = fit.K(0, 2);
  calibration.cy = fit.K(1, 2);
  calibration.rms_px = fit.rms_px;
  calibration.focal_sigma = fit.focal_sigma;
  const std::size_t count = model == CalibratedModel::kRadialTangential ? 5
                            : model == CalibratedModel::kRational       ? 8
                                                                        : 4;
  for (std::size_t i = 0; i < count; ++i) {
    calibration.coefficients.push_back(fit.coefficients.at<double>(static_cast<int>(i)));
  }
  return calibration;
}

}  // namespace cairn::host
