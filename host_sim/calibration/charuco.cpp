#include "host_sim/calibration/charuco.hpp"

#include <opencv2/core/version.hpp>

#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 7)
#define CAIRN_NEW_ARUCO 1
#include <opencv2/objdetect/charuco_detector.hpp>
#else
#define CAIRN_NEW_ARUCO 0
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#endif

namespace cairn::host {

#if CAIRN_NEW_ARUCO

struct CharucoPattern::Board {
  Board(const cv::Size& squares, double marker_ratio, int dictionary)
      : board(squares, 1.0F, static_cast<float>(marker_ratio),
              cv::aruco::getPredefinedDictionary(dictionary)),
        detector(board) {}

  cv::aruco::CharucoBoard board;
  cv::aruco::CharucoDetector detector;
};

void CharucoPattern::find(const cv::Mat& grey, std::vector<cv::Point2f>& pixels,
                          std::vector<int>& corners) const {
  pixels.clear();
  corners.clear();
  board_->detector.detectBoard(grey, pixels, corners);
}

cv::Mat CharucoPattern::draw(const cv::Size& size) const {
  cv::Mat picture;
  board_->board.generateImage(size, picture, 0, 1);
  return picture;
}

int CharucoPattern::markers_of(int dictionary) {
  return cv::aruco::getPredefinedDictionary(dictionary).bytesList.rows;
}

#else

struct CharucoPattern::Board {
  Board(const cv::Size& squares, double marker_ratio, int dictionary)
      : board(cv::aruco::CharucoBoard::create(squares.width, squares.height, 1.0F,
                                              static_cast<float>(marker_ratio),
                                              cv::aruco::getPredefinedDictionary(dictionary))) {}

  cv::Ptr<cv::aruco::CharucoBoard> board;
};

void CharucoPattern::find(const cv::Mat& grey, std::vector<cv::Point2f>& pixels,
                          std::vector<int>& corners) const {
  pixels.clear();
  corners.clear();
  std::vector<std::vector<cv::Point2f> > markers;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, board_->board->dictionary, markers, ids,
                           cv::aruco::DetectorParameters::create());
  if (ids.empty()) return;
  cv::aruco::interpolateCornersCharuco(markers, ids, grey, board_->board, pixels, corners);
}

cv::Mat CharucoPattern::draw(const cv::Size& size) const {
  cv::Mat picture;
  board_->board->draw(size, picture, 0, 1);
  return picture;
}

int CharucoPattern::markers_of(int dictionary) {
  return cv::aruco::getPredefinedDictionary(dictionary)->bytesList.rows;
}

#endif

CharucoPattern::CharucoPattern(const cv::Size& squares, double marker_ratio, int dictionary)
    : board_(std::make_unique<Board>(squares, marker_ratio, dictionary)) {}
CharucoPattern::~CharucoPattern() = default;
CharucoPattern::CharucoPattern(CharucoPattern&&) noexcept = default;
CharucoPattern& CharucoPattern::operator=(CharucoPattern&&) noexcept = default;

}  // namespace cairn::host
