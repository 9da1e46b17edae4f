#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/picture_folder.hpp"
#include "host_sim/sources/media.hpp"

namespace cairn::host {
namespace {

constexpr double kAssumedRate_hz = 30.0;

/// The frames of a range, with times from the names or at the assumed rate.
std::vector<MediaFrame> frames_of(const PictureFolder& folder) {
  std::vector<MediaFrame> frames;
  for (std::size_t i = 0; i < folder.files.size(); ++i) {
    const int number = folder.files[i].number;
    frames.push_back({number, folder.t_us.empty() ? std::llround(1e6 * number / kAssumedRate_hz)
                                                  : folder.t_us[i]});
  }
  return frames;
}

/// Of a picture as it is decoded: a JPEG may be turned.
cv::Size shown_size(const std::filesystem::path& path) {
  cv::Mat grey;
  read_grey_image(path, {}, grey, GreyLevels{});
  return grey.size();
}

class PictureMedia final : public Media {
 public:
  PictureMedia(const std::filesystem::path& path, const cv::Size& size, const FrameRange& range)
      : size_(size) {
    const PictureFolder folder = list_pictures(path);
    const std::vector<MediaFrame> all = frames_of(folder);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].number < range.first.value_or(0)) continue;
      if (range.count.has_value() && frames_.size() == static_cast<std::size_t>(*range.count))
        break;
      frames_.push_back(all[i]);
      info_.inputs.push_back(folder.files[i].path);
    }
    if (frames_.empty()) {
      throw InputError(path, fmt::format("expected frames from number {} on, found none",
                                         range.first.value_or(0)));
    }
    if (size_.empty()) size_ = shown_size(info_.inputs.front());
    info_.size = size_;
    info_.frame_count = static_cast<int>(frames_.size());
    info_.span = TimeSpan{frames_.front().t_us, frames_.back().t_us};
    info_.note = folder.note;
    if (!folder.t_us.empty()) {
      check_frame_times(path, folder.t_us);
      if (folder.t_us.size() > 1)
        info_.rate_hz = 1e6 / static_cast<double>(median_step_us(folder.t_us));
    } else {
      info_.note += fmt::format("{}times from the frame numbers at {} Hz",
                                info_.note.empty() ? "" : "; ", kAssumedRate_hz);
    }
    check_headers();
  }

  const MediaInfo& info() const override { return info_; }
  const std::vector<MediaFrame>& frames() const override { return frames_; }

  bool next(MediaFrame& frame, cv::Mat& grey) override {
    if (position_ == frames_.size()) return false;
    frame = frames_[position_];
    read_grey_image(info_.inputs[position_], size_, grey, levels_);
    ++position_;
    return true;
  }

  cv::Mat colour() const override {
    if (levels_.has_value() || position_ == 0) return {};
    return read_colour_image(info_.inputs[position_ - 1], size_);
  }

  std::string missing() const override { return {}; }
  bool is_damaged() const override { return false; }

 private:
  /// Sizes and bits before anything is decoded, and the levels of 16-bit pictures.
  void check_headers() {
    const int bits = read_picture_header_of(info_.inputs.front()).bits;
    for (const std::filesystem::path& path : info_.inputs) {
      const PictureHeader header = read_picture_header_of(path);
      const cv::Size stored(header.width, header.height);
      // A JPEG may be turned by a quarter when it is decoded.
      if (stored != size_ && stored != cv::Size(size_.height, size_.width)) {
        throw InputError(path, fmt::format("expected {}x{} pixels as the calibration is of, found "
                                           "{}x{}",
                                           size_.width, size_.height, stored.width, stored.height));
      }
      if ((header.bits == 16) != (bits == 16)) {
        throw InputError(path, fmt::format("expected {} bits as the pictures before it have, found "
                                           "{}",
                                           bits, header.bits));
      }
    }
    if (bits != 16) return;
    levels_ = find_grey_levels(info_.inputs);
    info_.note += fmt::format("; 16-bit pictures: values {} to {} are shown as 0 to 255",
                              levels_->black, levels_->white);
  }

  cv::Size size_;
  MediaInfo info_;
  std::vector<MediaFrame> frames_;
  std::optional<GreyLevels> levels_;
  std::size_t position_ = 0;
};

}  // namespace

std::unique_ptr<Media> open_pictures(const std::filesystem::path& folder, const cv::Size& size,
                                     const FrameRange& range) {
  return std::make_unique<PictureMedia>(folder, size, range);
}

}  // namespace cairn::host
