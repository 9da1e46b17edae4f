#include "host_sim/calibration/board.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 7)
#include <opencv2/objdetect/aruco_dictionary.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

#include "host_sim/calibration/charuco.hpp"
#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

constexpr int kLeastSquares = 3;
constexpr int kMostSquares = 60;
constexpr int kLeastCharucoCorners = 8;
constexpr int kSearchedSide_px =
    1280;  // chessboards are searched at this size, and refined at the full one
constexpr double kLeastSpread = 0.5;  // squares: narrower corners lie on one line

const std::vector<std::pair<std::string, int>>& dictionaries() {
  static const std::vector<std::pair<std::string, int>> known = {
      {"4X4_50", cv::aruco::DICT_4X4_50},
      {"4X4_100", cv::aruco::DICT_4X4_100},
      {"4X4_250", cv::aruco::DICT_4X4_250},
      {"4X4_1000", cv::aruco::DICT_4X4_1000},
      {"5X5_50", cv::aruco::DICT_5X5_50},
      {"5X5_100", cv::aruco::DICT_5X5_100},
      {"5X5_250", cv::aruco::DICT_5X5_250},
      {"5X5_1000", cv::aruco::DICT_5X5_1000},
      {"6X6_50", cv::aruco::DICT_6X6_50},
      {"6X6_100", cv::aruco::DICT_6X6_100},
      {"6X6_250", cv::aruco::DICT_6X6_250},
      {"6X6_1000", cv::aruco::DICT_6X6_1000},
      {"7X7_50", cv::aruco::DICT_7X7_50},
      {"7X7_100", cv::aruco::DICT_7X7_100},
      {"7X7_250", cv::aruco::DICT_7X7_250},
      {"7X7_1000", cv::aruco::DICT_7X7_1000},
      {"ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
      {"APRILTAG_16H5", cv::aruco::DICT_APRILTAG_16h5},
      {"APRILTAG_25H9", cv::aruco::DICT_APRILTAG_25h9},
      {"APRILTAG_36H10", cv::aruco::DICT_APRILTAG_36h10},
      {"APRILTAG_36H11", cv::aruco::DICT_APRILTAG_36h11}};
  return known;
}

int dictionary_named(const std::string& name) {
  for (const auto& [known, id] : dictionaries()) {
    if (known == name) return id;
  }
  throw UsageError(fmt::format("--dictionary '{}': expected one of {}", name,
                               fmt::join(board_dictionaries(), ", ")));
}

CharucoPattern charuco_pattern(const BoardOptions& options) {
  return {options.squares, options.marker_ratio, dictionary_named(options.dictionary)};
}

/// Whether the corners span a plane: the narrow side of their ellipse.
bool spans_a_plane(const std::vector<cv::Point3f>& points) {
  std::vector<cv::Point2f> flat;
  for (const cv::Point3f& p : points) flat.emplace_back(p.x, p.y);
  const cv::RotatedRect box = cv::minAreaRect(flat);
  return std::min(box.size.width, box.size.height) >= kLeastSpread;
}

}  // namespace

std::vector<std::string> board_dictionaries() {
  std::vector<std::string> names;
  for (const auto& [name, id] : dictionaries()) names.push_back(name);
  return names;
}

BoardDetector::BoardDetector(const BoardOptions& options)
    : options_(options), inner_(options.squares.width - 1, options.squares.height - 1) {
  for (const int side : {options.squares.width, options.squares.height}) {
    if (side < kLeastSquares || side > kMostSquares) {
      throw UsageError(fmt::format("--squares {}x{}: expected {} to {} squares a side",
                                   options.squares.width, options.squares.height, kLeastSquares,
                                   kMostSquares));
    }
  }
  if (!options.charuco) return;
  if (!(options.marker_ratio > 0.0 && options.marker_ratio < 1.0)) {
    throw UsageError(
        fmt::format("--marker-ratio {}: expected a marker smaller than its square, 0 "
                    "to 1",
                    options.marker_ratio));
  }
  const int needed = options.squares.area() / 2;
  const int there = CharucoPattern::markers_of(dictionary_named(options.dictionary));
  if (needed > there) {
    throw UsageError(fmt::format(
        "--dictionary {}: expected the {} markers that a board of {}x{} "
        "squares has, it holds {}",
        options.dictionary, needed, options.squares.width, options.squares.height, there));
  }
}

bool BoardDetector::find(const cv::Mat& grey, BoardView& view) const {
  view.pixels.clear();
  view.points.clear();
  return options_.charuco ? find_charuco(grey, view) : find_chessboard(grey, view);
}

bool BoardDetector::find_chessboard(const cv::Mat& grey, BoardView& view) const {
  const int side = std::max(grey.cols, grey.rows);
  const double factor = std::min(1.0, static_cast<double>(kSearchedSide_px) / side);
  cv::Mat searched = grey;
  if (factor < 1.0) cv::resize(grey, searched, {}, factor, factor, cv::INTER_AREA);
  if (!cv::findChessboardCornersSB(searched, inner_, view.pixels, cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return false;
  }
  if (factor < 1.0) {
    const auto half = static_cast<float>(0.5 / factor - 0.5);
    for (cv::Point2f& p : view.pixels) {
      p = p * static_cast<float>(1.0 / factor) + cv::Point2f(half, half);
    }
    const int window = 2 + static_cast<int>(std::lround(1.0 / factor));
    cv::cornerSubPix(grey, view.pixels, {window, window}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01});
  }
  for (int y = 0; y < inner_.height; ++y) {
    for (int x = 0; x < inner_.width; ++x) {
      view.points.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0F);
    }
  }
  return true;
}

bool BoardDetector::find_charuco(const cv::Mat& grey, BoardView& view) const {
  std::vector<int> corners;
  charuco_pattern(options_).find(grey, view.pixels, corners);
  if (corners.empty()) return false;
  for (const int corner : corners) {
    const cv::Point place(corner % inner_.width, corner / inner_.width);
    view.points.emplace_back(static_cast<float>(place.x), static_cast<float>(place.y), 0.0F);
  }
  return static_cast<int>(corners.size()) >= std::min(kLeastCharucoCorners, corner_count()) &&
         spans_a_plane(view.points);
}

cv::Mat BoardDetector::picture(int square_px) const {
  const int margin = square_px;
  const cv::Size size(options_.squares.width * square_px, options_.squares.height * square_px);
  cv::Mat board(size, CV_8UC1, cv::Scalar(255));
  if (options_.charuco) {
    board = charuco_pattern(options_).draw(size);
  } else {
    for (int y = 0; y < options_.squares.height; ++y) {
      for (int x = y % 2; x < options_.squares.width; x += 2) {
        board(cv::Rect(x * square_px, y * square_px, square_px, square_px)).setTo(0);
      }
    }
  }
  cv::copyMakeBorder(board, board, margin, margin, margin, margin, cv::BORDER_CONSTANT, 255);
  return board;
}

}  // namespace cairn::host
