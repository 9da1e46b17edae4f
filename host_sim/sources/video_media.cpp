#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/media.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr double kRateWithoutAny_hz = 30.0;
constexpr double kMostFrames = 1e9;
constexpr int kMostFailedFrames = 300;           // one after the other
constexpr int kMostReordered = 16;               // frames of H.264 and HEVC that wait for others
constexpr double kConstantRate = 0.1;            // largest deviation from it, in frames
constexpr double kFramesMissingInSilence = 2.0;  // containers round their durations
constexpr double kShareMissingInSilence = 0.01;

/// OpenCV 4.6 turns upright videos by a quarter the wrong way round (opencv/opencv#22088).
constexpr bool kQuarterTurnsAreReversed = CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR == 6;

/// Numbers and times of a video's frames, from the container's times.
class ContainerClock {
 public:
  explicit ContainerClock(double rate_hz) : rate_hz_(rate_hz) {}

  /// Frame number `count` (all that were decoded) stands at `container_us`. False where the time
  /// does not increase.
  bool take(int count, std::int64_t container_us, MediaFrame& frame) {
    if (count == 1 && container_us == 0 && last_.t_us == 0) has_times_ = false;
    if (!has_times_) {
      last_ = {count, std::llround(1e6 * count / rate_hz_)};
    } else if (count > 0 && container_us == 0 && untimed_ < kMostReordered) {
      ++untimed_;
      last_ = {last_.number + 1, last_.t_us + step_us_};
    } else if (count > 0 && container_us <= last_.t_us) {
      return false;
    } else {
      if (count > 0) step_us_ = container_us - last_.t_us;
      last_ = {number_at(count, container_us), container_us};
    }
    frame = last_;
    return true;
  }

  const MediaFrame& last() const { return last_; }
  bool has_times() const { return has_times_; }
  /// Frames so far whose time OpenCV did not give, taken as a step after the frame before.
  int untimed() const { return untimed_; }

 private:
  /// While every frame stands at a multiple of the rate's step, gaps are frames that are missing.
  int number_at(int count, std::int64_t container_us) {
    const int next = count == 0 ? 0 : last_.number + 1;
    const double steps = 1e-6 * rate_hz_ * static_cast<double>(container_us);
    is_constant_ = is_constant_ && std::abs(steps - std::round(steps)) < kConstantRate;
    return is_constant_ ? std::max(next, static_cast<int>(std::round(steps))) : next;
  }

  double rate_hz_;
  bool has_times_ = true;
  bool is_constant_ = true;
  int untimed_ = 0;
  std::int64_t step_us_ = 0;
  MediaFrame last_;
};

class VideoMedia final : public Media {
 public:
  VideoMedia(const fs::path& path, const cv::Size& size, const FrameRange& range)
      : path_(path), size_(size), range_(range), clock_(open()) {
    const double announced = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (announced >= 1.0 && announced < kMostFrames) announced_ = static_cast<int>(announced);
    info_.inputs = {path};
    note_times("times from the video");
    const int first = range.first.value_or(0);
    if (!announced_.has_value() || *announced_ <= first) return;
    info_.frame_count = std::min(*announced_ - first, range.count.value_or(*announced_));
    info_.span = TimeSpan{std::llround(1e6 * first / info_.rate_hz),
                          std::llround(1e6 * (first + *info_.frame_count - 1) / info_.rate_hz)};
  }

  const MediaInfo& info() const override { return info_; }
  const std::vector<MediaFrame>& frames() const override { return none_; }

  bool next(MediaFrame& frame, cv::Mat& grey) override {
    do {
      if (range_.count.has_value() && given_ == *range_.count) return false;
      if (!grab(frame)) return false;
    } while (frame.number < range_.first.value_or(0));
    ++given_;
    if (!capture_.retrieve(colour_) || colour_.empty()) {
      throw InputError(path_, fmt::format("expected frame {} to decode", frame.number));
    }
    if (colour_.channels() == 1) {
      colour_.copyTo(grey);
    } else {
      cv::cvtColor(colour_, grey, cv::COLOR_BGR2GRAY);
    }
    if (turned_wrongly_) {
      cv::rotate(grey, grey, cv::ROTATE_180);
      turned_ = false;
    }
    if (grey.size() != size_) refuse_size(grey.size());
    return true;
  }

  cv::Mat colour() const override {
    if (colour_.channels() != 3) return {};
    if (turned_wrongly_ && !turned_) {
      cv::rotate(colour_, colour_, cv::ROTATE_180);
      turned_ = true;
    }
    return colour_;
  }

  std::string missing() const override {
    if (!ended_ || !announced_.has_value() || count_ >= *announced_) return {};
    return fmt::format(
        "{}: gave {} of the {} frames that it announces; the last one is at {:.3f} s "
        "of {:.3f} s",
        path_.string(), count_, *announced_, 1e-6 * static_cast<double>(clock_.last().t_us),
        duration_s());
  }

  /// A container may round its count of frames; it is damaged where it also ends early.
  bool is_damaged() const override {
    if (missing().empty()) return false;
    const double end_s = 1e-6 * static_cast<double>(clock_.last().t_us) + 1.0 / info_.rate_hz;
    return duration_s() - end_s >
           std::max(kFramesMissingInSilence / info_.rate_hz, kShareMissingInSilence * duration_s());
  }

 private:
  ContainerClock open() {
    require_file(path_, "a video file or a folder of numbered images");
    if (cv::haveImageReader(path_.string())) {
      throw InputError(path_, "expected a video or a folder of pictures, found one picture");
    }
    // Other back ends than FFmpeg report on standard error what they cannot open.
    const auto level = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    const bool opened =
        capture_.open(path_.string(), cv::CAP_FFMPEG) || capture_.open(path_.string());
    cv::utils::logging::setLogLevel(level);
    if (!opened) throw InputError(path_, "expected a video that OpenCV can decode");
    const cv::Size stated(static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
                          static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT)));
    if (size_.empty() && stated.empty()) throw InputError(path_, "expected a video of known size");
    if (size_.empty()) size_ = stated;
    turn_ = static_cast<int>(capture_.get(cv::CAP_PROP_ORIENTATION_META));
    is_turned_ = turn_ != 0;
    if (stated != size_ && !stated.empty()) refuse_size(stated);
    info_.size = size_;
    turned_wrongly_ = kQuarterTurnsAreReversed && (turn_ == 90 || turn_ == 270);
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    info_.rate_hz = rate >= 0.1 && rate <= 1000.0 ? rate : kRateWithoutAny_hz;
    return ContainerClock(info_.rate_hz);
  }

  void note_times(const std::string& times) {
    info_.note = times;
    if (is_turned_) info_.note += fmt::format("; turned by {} degrees, as the video says", turn_);
  }

  bool grab(MediaFrame& frame) {
    if (!grab_past_holes()) {
      ended_ = true;
      if (given_ == 0) {
        throw InputError(path_, fmt::format("expected frames from number {} on, found none",
                                            range_.first.value_or(0)));
      }
      return false;
    }
    const double told_ms = capture_.get(cv::CAP_PROP_POS_MSEC);
    const double container_ms = std::isfinite(told_ms) ? told_ms : 0.0;
    if (!clock_.take(count_, std::llround(1e3 * container_ms), frame)) {
      throw InputError(path_, fmt::format("expected times that increase, found {:.3f} s for frame "
                                          "{} after {:.3f} s: give them by --times",
                                          1e-3 * container_ms, count_,
                                          1e-6 * static_cast<double>(clock_.last().t_us)));
    }
    ++count_;
    if (clock_.untimed() > 0) {
      note_times(
          fmt::format("times from the video, but for the last {}, a step each: OpenCV has none",
                      clock_.untimed()));
    }
    if (!clock_.has_times()) note_times("times from the video's rate: it has none of frames");
    return true;
  }

  /// A frame that does not decode looks like the end; behind it there may be more of those
  /// announced.
  bool grab_past_holes() {
    const int tries = std::clamp(announced_.value_or(0) - count_, 1, kMostFailedFrames);
    for (int i = 0; i < tries; ++i) {
      if (capture_.grab()) return true;
    }
    return false;
  }

  double duration_s() const { return announced_.value_or(0) / info_.rate_hz; }

  [[noreturn]] void refuse_size(const cv::Size& found) const {
    const bool turned = found == cv::Size(size_.height, size_.width);
    throw InputError(
        path_,
        fmt::format("expected {}x{} pixels as the calibration is of, found {}x{}{}", size_.width,
                    size_.height, found.width, found.height,
                    !turned      ? ""
                    : is_turned_ ? ": the calibration is of the picture before it is turned"
                                 : ": the camera was held the other way when it was calibrated"));
  }

  fs::path path_;
  cv::Size size_;
  FrameRange range_;
  MediaInfo info_;
  int turn_ = 0;            ///< degrees, as the video says
  bool is_turned_ = false;  ///< by its metadata
  bool turned_wrongly_ = false;
  cv::VideoCapture capture_;
  ContainerClock clock_;
  std::optional<int> announced_;
  mutable cv::Mat colour_;  ///< as decoded; turned when it is asked for
  mutable bool turned_ = false;
  int count_ = 0;  ///< frames decoded
  int given_ = 0;
  bool ended_ = false;
  std::vector<MediaFrame> none_;
};

}  // namespace

std::unique_ptr<Media> open_video(const fs::path& file, const cv::Size& size,
                                  const FrameRange& range) {
  return std::make_unique<VideoMedia>(file, size, range);
}

}  // namespace cairn::host
