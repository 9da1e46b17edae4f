#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "host_sim/sources/image_sequence.hpp"
#include "host_sim/sources/time_span.hpp"

namespace cairn::host {

/// What is known of a video or a folder of pictures before its frames are read.
struct MediaInfo {
  cv::Size size;                   ///< of its frames, as they are shown
  double rate_hz = 30.0;           ///< mean
  std::optional<int> frame_count;  ///< frames of the range, where known
  /// Of the frames of the range, where known; a video's end by its duration.
  std::optional<TimeSpan> span;
  std::vector<std::filesystem::path> inputs;
  std::string note;  ///< where the times are from
};

/// A frame's place in its media.
struct MediaFrame {
  int number = 0;
  std::int64_t t_us = 0;  ///< by the media's own clock
};

/// Pictures of a video file or of a folder, one after the other.
class Media {
 public:
  virtual ~Media() = default;
  virtual const MediaInfo& info() const = 0;
  /// Number and time of every frame of the range, where they are known beforehand; else empty.
  virtual const std::vector<MediaFrame>& frames() const = 0;
  /// The next frame as 8-bit grey; false after the last. Throws InputError naming the file.
  virtual bool next(MediaFrame& frame, cv::Mat& grey) = 0;
  /// The frame that next() gave, 8-bit BGR; empty where the media has no colour. Storage of the
  /// media's own.
  virtual cv::Mat colour() const { return {}; }
  /// After the last frame: what is missing of the frames that the media announces; empty: nothing.
  virtual std::string missing() const = 0;
  /// Whether so much is missing that the media must be damaged.
  virtual bool is_damaged() const = 0;

 protected:
  Media() = default;
  Media(const Media&) = default;
  Media& operator=(const Media&) = default;
};

/// A folder of pictures that are named as list_pictures() says; times are from the names, else 30
/// Hz. All pictures must be of `size` (an empty one: of the first one's), and of as many bits as
/// the first one. Throws InputError naming the file.
std::unique_ptr<Media> open_pictures(const std::filesystem::path& folder, const cv::Size& size,
                                     const FrameRange& range);

/// A video of frames of `size` (an empty one: of any). Times are the container's, from 0 on; where
/// it has none, the number over the rate. Numbers count frames; while the rate is constant they
/// also count frames that could not be decoded. Throws InputError naming the file where OpenCV
/// cannot decode it, and where the container's times do not increase.
std::unique_ptr<Media> open_video(const std::filesystem::path& file, const cv::Size& size,
                                  const FrameRange& range);

/// A camera that is watched: the number of a device (0 is the first webcam), its file, or the
/// address of a stream. Asked for pictures of `size` (an empty one: takes those it gives). Times
/// are those at which frames arrive, from 0 on; a range without a count has no end. Throws
/// InputError naming the device where it cannot be opened or gives another size.
std::unique_ptr<Media> open_camera(const std::string& device, const cv::Size& size,
                                   const FrameRange& range);

}  // namespace cairn::host
