#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "host_sim/io/input_error.hpp"
#include "host_sim/sources/media.hpp"

namespace cairn::host {
namespace {

constexpr double kRateWithoutAny_hz = 30.0;

/// A camera's number; nothing for a file or an address.
std::optional<int> number_of(const std::string& device) {
  const bool digits = !device.empty() && device.size() <= 3 &&
                      device.find_first_not_of("0123456789") == std::string::npos;
  return digits ? std::optional<int>(std::stoi(device)) : std::nullopt;
}

class LiveMedia final : public Media {
 public:
  LiveMedia(std::string device, const cv::Size& size, const FrameRange& range)
      : device_(std::move(device)), range_(range) {
    open(size);
    // What a camera states of its size may not be what it sends.
    if (!capture_.read(colour_) || colour_.empty()) {
      throw InputError(device_, "expected a camera that sends pictures, and none came");
    }
    if (!size.empty() && colour_.size() != size) {
      throw InputError(device_, fmt::format("expected {}x{} pixels as the calibration is of, found "
                                            "{}x{}: this camera does not offer the size",
                                            size.width, size.height, colour_.cols, colour_.rows));
    }
    start_ = std::chrono::steady_clock::now();
    info_.size = colour_.size();
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    info_.rate_hz = rate >= 1.0 && rate <= 1000.0 ? rate : kRateWithoutAny_hz;
    info_.frame_count = range.count;
    info_.note = "times of arrival";
  }

  const MediaInfo& info() const override { return info_; }
  const std::vector<MediaFrame>& frames() const override { return none_; }

  bool next(MediaFrame& frame, cv::Mat& grey) override {
    if (range_.count.has_value() && given_ == *range_.count) return false;
    std::int64_t t_us = 0;
    if (given_ > 0) {
      if (!capture_.read(colour_) || colour_.size() != info_.size) {
        stopped_ = true;
        return false;
      }
      t_us = std::chrono::duration_cast<std::chrono::microseconds>(
                 std::chrono::steady_clock::now() - start_)
                 .count();
    }
    if (colour_.channels() == 1) {
      colour_.copyTo(grey);
    } else {
      cv::cvtColor(colour_, grey, cv::COLOR_BGR2GRAY);
    }
    last_us_ = given_ > 0 ? std::max(t_us, last_us_ + 1) : 0;
    frame = {given_++, last_us_};
    return true;
  }

  cv::Mat colour() const override { return colour_.channels() == 3 ? colour_ : cv::Mat(); }

  std::string missing() const override {
    if (!stopped_) return {};
    return fmt::format("camera {}: gave no more pictures after {}, at {:.2f} s", device_, given_,
                       1e-6 * static_cast<double>(last_us_));
  }
  bool is_damaged() const override { return false; }

 private:
  void open(const cv::Size& size) {
    const auto level = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    const std::optional<int> number = number_of(device_);
    const bool opened = number ? capture_.open(*number) : capture_.open(device_);
    cv::utils::logging::setLogLevel(level);
    if (!opened) {
      throw InputError("camera:" + device_, why_not_opened(number));
    }
    if (!size.empty()) {
      capture_.set(cv::CAP_PROP_FRAME_WIDTH, size.width);
      capture_.set(cv::CAP_PROP_FRAME_HEIGHT, size.height);
    }
    capture_.set(cv::CAP_PROP_BUFFERSIZE, 1);  // the newest picture, not an old one
  }

  std::string why_not_opened(const std::optional<int>& number) const {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const std::string file = number ? fmt::format("/dev/video{}", *number) : device_;
    if (device_.find("://") != std::string::npos) {
      return "no stream with pictures can be opened at this address";
    }
    if (number || file.rfind("/dev/", 0) == 0) {
      if (fs::exists(file, ignored)) {
        return fmt::format(
            "{} is there but gives no pictures: another program uses it, it is not "
            "allowed, or it is no camera",
            file);
      }
      return fmt::format("no camera: there is no {}{}", file,
                         fs::exists("/dev/video0", ignored) ? "" : ", nor a /dev/video0");
    }
    return "expected a camera's number, its file such as /dev/video0, or the address of a stream";
  }

  std::string device_;
  FrameRange range_;
  MediaInfo info_;
  cv::VideoCapture capture_;
  cv::Mat colour_;
  std::chrono::steady_clock::time_point start_;
  std::int64_t last_us_ = 0;
  int given_ = 0;
  bool stopped_ = false;
  std::vector<MediaFrame> none_;
};

}  // namespace

std::unique_ptr<Media> open_camera(const std::string& device, const cv::Size& size,
                                   const FrameRange& range) {
  return std::make_unique<LiveMedia>(device, size, range);
}

}  // namespace cairn::host
