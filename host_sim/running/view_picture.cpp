#include "host_sim/running/view_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "cairn/base/config.hpp"
#include "cairn/vision/fast.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/base/names.hpp"

namespace cairn::host {
namespace {

constexpr int kLeastWidth = 480;
constexpr int kRow_px = 18;
constexpr int kRows = kStageCount + 3;  // the stages, the frame, the state, the keys
constexpr int kNameWidth_px = 235;
constexpr int kFigureWidth_px = 135;
constexpr int kMostCorners = 400;
constexpr int kFastThreshold = 20;
constexpr double kMostEllipse_px = 200.0;

const cv::Scalar kGrey(150, 150, 150), kWhite(235, 235, 235), kGreen(90, 200, 90),
    kAmber(60, 160, 240), kRed(70, 70, 230);

void write(cv::Mat& picture, const std::string& text, const cv::Point& at,
           const cv::Scalar& color) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.42, color, 1, cv::LINE_AA);
}

void draw_corners(const cv::Mat& grey, cv::Mat& picture) {
  using Scratch = FastScratch<LargeConfig::kMaxImageWidth>;
  const auto scratch = std::make_unique<Scratch>();
  std::array<Corner, kMostCorners> corners;
  FastReport report;
  const Rect whole{0, 0, grey.cols, grey.rows};
  if (!ok(detect_fast(to_view(grey), whole, kFastThreshold, *scratch, corners.data(), kMostCorners,
                      report))) {
    return;
  }
  for (int i = 0; i < report.found - report.dropped; ++i) {
    const Corner& c = corners[static_cast<std::size_t>(i)];
    cv::circle(picture, {c.x, c.y}, 1, kGrey, cv::FILLED);
  }
}

void draw_landmark(const MapLandmark& landmark, const Rigid<double>& T_camera_map,
                   const PinholeCamera<double>& camera, bool measured, cv::Mat& picture) {
  Vector2<double> pixel;
  Matrix<double, 2, 3> jacobian;
  if (!ok(camera.project(T_camera_map * landmark.p_map, pixel, jacobian))) return;
  if (!camera.contains(pixel)) return;
  const cv::Scalar& color = measured ? kGreen : kAmber;
  const cv::Point at(static_cast<int>(std::lround(pixel.x())),
                     static_cast<int>(std::lround(pixel.y())));
  cv::drawMarker(picture, at, color, cv::MARKER_CROSS, 7, 1);
  const Matrix<double, 2, 3> to_pixel = jacobian * T_camera_map.rotation.toRotationMatrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(to_pixel * landmark.covariance *
                                                            to_pixel.transpose());
  const Eigen::Vector2d half = 3.0 * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (!half.allFinite()) return;
  const Eigen::Vector2d longest = axes.eigenvectors().col(1);
  const auto length = [](double px) {
    return static_cast<int>(std::lround(std::clamp(px, 2.0, kMostEllipse_px)));
  };
  cv::ellipse(picture, at, {length(half.y()), length(half.x())},
              std::atan2(longest.y(), longest.x()) * 180.0 / kPi<double>, 0.0, 360.0, color, 1,
              cv::LINE_AA);
}

/// A row of the panel: a name, a bar whose middle is the budget, and the time.
void draw_bar(cv::Mat& panel, int row, const char* name, double ms, double budget_ms) {
  const int bottom = (row + 1) * kRow_px;
  write(panel, name, {6, bottom - 5}, kWhite);
  const int left = kNameWidth_px, right = panel.cols - kFigureWidth_px;
  const int middle = (left + right) / 2;
  const double share = budget_ms > 0.0 ? ms / budget_ms : 0.0;
  const int end = left + static_cast<int>(std::lround(std::min(share, 2.0) * (middle - left)));
  cv::rectangle(panel, {left, bottom - 14}, {right, bottom - 4}, cv::Scalar(60, 60, 60),
                cv::FILLED);
  cv::rectangle(panel, {left, bottom - 14}, {std::max(end, left + 1), bottom - 4},
                share > 1.0 ? kRed : kGreen, cv::FILLED);
  cv::line(panel, {middle, bottom - 16}, {middle, bottom - 2}, kWhite, 1);
  write(panel, fmt::format("{:.2f} / {:.2f} ms", ms, budget_ms), {right + 6, bottom - 5}, kWhite);
}

void draw_panel(cv::Mat& panel, const FrameRecord& entry, double budget_ms) {
  for (int i = 0; i < kStageCount; ++i) {
    draw_bar(panel, i, kStageRows[i].name, entry.stage_ms[i], kStageRows[i].paper_iekf_ms);
  }
  draw_bar(panel, kStageCount, "whole frame", entry.total_ms, budget_ms);
  const FrameReport& report = entry.report;
  const bool good = report.state == TrackingState::kTracking;
  write(panel,
        fmt::format("frame {}  {}  matches {}  inliers {}  landmarks {}", entry.number,
                    to_string(report.state), report.matches, report.inliers, report.landmarks),
        {6, (kStageCount + 2) * kRow_px - 5}, good ? kGreen : kRed);
  write(panel, "space: pause   . or s: step   q or Esc: end", {6, kRows * kRow_px - 5}, kGrey);
}

}  // namespace

cv::Mat view_picture(const cv::Mat& picture, const cv::Mat& grey, const FrameRecord& entry,
                     const std::vector<MapLandmark>& landmarks, const PinholeCamera<double>& camera,
                     double budget_ms) {
  cv::Mat view(picture.rows + kRows * kRow_px, std::max(picture.cols, kLeastWidth), CV_8UC3,
               cv::Scalar::all(25));
  cv::Mat scene = view({0, 0, picture.cols, picture.rows});
  picture.copyTo(scene);
  draw_corners(grey, scene);
  if (entry.has_pose()) {
    const Rigid<double> T_camera_map = to_double(entry.report.T_map_camera).inverse();
    for (const MapLandmark& landmark : landmarks) {
      if (!landmark.active) continue;
      const bool measured = std::find(entry.measured.begin(), entry.measured.end(), landmark.id) !=
                            entry.measured.end();
      draw_landmark(landmark, T_camera_map, camera, measured, scene);
    }
  }
  cv::Mat panel = view({0, picture.rows, view.cols, kRows * kRow_px});
  draw_panel(panel, entry, budget_ms);
  return view;
}

}  // namespace cairn::host
