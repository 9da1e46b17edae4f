#include "host_sim/running/overlay_video.hpp"

#include <opencv2/imgproc.hpp>

#include "host_sim/io/output_file.hpp"

namespace cairn::host {
namespace {

struct Encoder {
  const char* file;
  char code[5];
};

constexpr Encoder kEncoders[] = {
    {"overlay.mp4", "avc1"}, {"overlay.mp4", "mp4v"}, {"overlay.avi", "MJPG"}};

}  // namespace

OverlayVideo::OverlayVideo(const std::filesystem::path& folder, double frame_rate_hz,
                           const cv::Size& size) {
  for (const Encoder& encoder : kEncoders) {
    const std::filesystem::path path = folder / encoder.file;
    std::filesystem::path part = path;
    part.replace_extension(".part" + path.extension().string());
    const int code =
        cv::VideoWriter::fourcc(encoder.code[0], encoder.code[1], encoder.code[2], encoder.code[3]);
    // Encoders want even sides.
    if (writer_.open(part.string(), code, frame_rate_hz, {size.width & ~1, size.height & ~1})) {
      path_ = path;
      part_ = part;
      return;
    }
    std::filesystem::remove(part);
  }
}

cv::Mat OverlayVideo::compose(const cv::Mat& grey, const cv::Mat& drawn, const cv::Mat& colour) {
  cv::Mat picture;
  if (colour.empty()) {
    cv::cvtColor(drawn, picture, cv::COLOR_GRAY2BGR);
  } else {
    picture = colour.clone();
  }
  for (int y = 0; y < grey.rows; ++y) {
    const std::uint8_t* before = grey.ptr<std::uint8_t>(y);
    const std::uint8_t* after = drawn.ptr<std::uint8_t>(y);
    cv::Vec3b* out = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < grey.cols; ++x) {
      if (before[x] == after[x]) continue;
      const int level = after[x];
      out[x] = {static_cast<std::uint8_t>(level / 6), static_cast<std::uint8_t>(level * 2 / 3),
                static_cast<std::uint8_t>(std::min(255, 60 + level))};
    }
  }
  return picture;
}

cv::Mat OverlayVideo::captioned(const cv::Mat& colour, const std::string& caption) {
  cv::Mat picture = colour;
  const cv::Point at(8, picture.rows - 10);
  const double size = picture.cols >= 480 ? 0.45 : 0.3;
  cv::putText(picture, caption, at, cv::FONT_HERSHEY_SIMPLEX, size, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(picture, caption, at, cv::FONT_HERSHEY_SIMPLEX, size, {255, 255, 255}, 1,
              cv::LINE_AA);
  return picture;
}

OverlayVideo::~OverlayVideo() {
  if (part_.empty()) return;
  writer_.release();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void OverlayVideo::finish() {
  if (part_.empty()) return;
  writer_.release();
  // The encoder does not say that the disk was full.
  if (!cv::VideoCapture(part_.string()).isOpened()) {
    throw OutputError(path_, "cannot be written: what the disk took is no video");
  }
  std::error_code error;
  std::filesystem::rename(part_, path_, error);
  if (error) throw OutputError(path_, "cannot be written: " + error.message());
  part_.clear();
}

void OverlayVideo::write(const cv::Mat& picture) {
  if (path_.empty()) return;
  writer_.write(picture({0, 0, picture.cols & ~1, picture.rows & ~1}));
}

}  // namespace cairn::host
