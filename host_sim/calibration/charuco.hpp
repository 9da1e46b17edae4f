#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

namespace cairn::host {

/// A ChArUco board by OpenCV, whose interface to them changed with 4.7. Sides in squares.
class CharucoPattern {
 public:
  /// `dictionary`: OpenCV's number of it (cv::aruco::DICT_...).
  CharucoPattern(const cv::Size& squares, double marker_ratio, int dictionary);
  ~CharucoPattern();
  CharucoPattern(CharucoPattern&&) noexcept;
  CharucoPattern& operator=(CharucoPattern&&) noexcept;

  /// Inner corners that are seen, and their numbers, row by row; empty where there are none.
  void find(const cv::Mat& grey, std::vector<cv::Point2f>& pixels, std::vector<int>& corners) const;
  /// The board without a margin.
  cv::Mat draw(const cv::Size& size) const;

  /// Markers that a dictionary holds.
  static int markers_of(int dictionary);

 private:
  struct Board;
  std::unique_ptr<Board> board_;
};

}  // namespace cairn::host
