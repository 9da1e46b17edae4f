#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace cairn::host {

/// A plane pattern whose corners are known: a chessboard, or one with ArUco markers in its white
/// squares (ChArUco), which may be seen in part.
struct BoardOptions {
  bool charuco = false;
  cv::Size squares{10, 7};             ///< across and down
  double marker_ratio = 0.75;          ///< ChArUco: side of a marker over that of a square
  std::string dictionary = "5X5_100";  ///< ChArUco: OpenCV's name without DICT_
};

/// Names of the dictionaries of markers.
std::vector<std::string> board_dictionaries();

/// One sight of the board: pixels of corners and the corners' places on the board, in squares.
struct BoardView {
  std::string name;  ///< of the picture
  std::vector<cv::Point2f> pixels;
  std::vector<cv::Point3f> points;
};

/// Finds the board in grey pictures of any size. Throws UsageError for a board that cannot be:
/// fewer than 3 squares a side, a dictionary with too few markers, a marker that does not fit its
/// square.
class BoardDetector {
 public:
  explicit BoardDetector(const BoardOptions& options);

  /// Fills pixels and points; false where there is no board. A chessboard counts when all of it is
  /// seen, ChArUco from 8 corners on that are not on one line. Cost: about 0.1 s.
  bool find(const cv::Mat& grey, BoardView& view) const;
  /// Corners of the whole board.
  int corner_count() const { return inner_.area(); }
  /// The board for printing, `square_px` a square, with a white border of half a square or more.
  cv::Mat picture(int square_px) const;

 private:
  bool find_chessboard(const cv::Mat& grey, BoardView& view) const;
  bool find_charuco(const cv::Mat& grey, BoardView& view) const;

  BoardOptions options_;
  cv::Size inner_;  ///< corners between squares
};

}  // namespace cairn::host
