#pragma once

#include <filesystem>
#include <string>

#include <opencv2/videoio.hpp>

namespace cairn::host {

/// The overlay video: what the core drew, in colour on the grey frame, with a caption. Tries H.264
/// and MPEG-4 in overlay.mp4, then Motion JPEG in overlay.avi.
class OverlayVideo {
 public:
  OverlayVideo(const std::filesystem::path& folder, double frame_rate_hz, const cv::Size& size);

  /// The picture of a frame: `drawn` is `grey` with the virtual object drawn into it, which is laid
  /// over `colour` where that is not empty.
  static cv::Mat compose(const cv::Mat& grey, const cv::Mat& drawn, const cv::Mat& colour);
  /// A picture in colour with a line of text in its lower left corner, drawn into it.
  static cv::Mat captioned(const cv::Mat& colour, const std::string& caption);

  ~OverlayVideo();
  OverlayVideo(const OverlayVideo&) = delete;
  OverlayVideo& operator=(const OverlayVideo&) = delete;

  void write(const cv::Mat& picture);
  /// Gives the video its name; until then it is written as overlay.part.mp4 or .avi, and without
  /// it nothing is left. Throws OutputError where what was written is no video: the disk is full.
  void finish();
  /// Empty when no encoder was found.
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::filesystem::path part_;
  cv::VideoWriter writer_;
};

}  // namespace cairn::host
