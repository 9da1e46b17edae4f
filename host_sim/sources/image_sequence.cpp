#include "host_sim/sources/image_sequence.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

class ImageSequence final : public FrameSource {
 public:
  ImageSequence(SourceInfo info, std::vector<SequenceFrame> frames, bool in_colour)
      : info_(std::move(info)), frames_(std::move(frames)), in_colour_(in_colour) {
    info_.frame_count = static_cast<int>(frames_.size());
    std::vector<std::filesystem::path> images;
    for (const SequenceFrame& frame : frames_) images.push_back(frame.image);
    info_.inputs.insert(info_.inputs.end(), images.begin(), images.end());
    if (!std::filesystem::exists(images.front()) ||
        read_picture_header_of(images.front()).bits != 16)
      return;
    levels_ = find_grey_levels(images);
    info_.note += fmt::format("{}16-bit pictures: values {} to {} are shown as 0 to 255",
                              info_.note.empty() ? "" : "; ", levels_->black, levels_->white);
  }

  const SourceInfo& info() const override { return info_; }
  std::optional<TimeSpan> span() const override {
    return TimeSpan{frames_.front().known.t_us, frames_.back().known.t_us};
  }

  bool next(Frame& frame) override {
    if (position_ == frames_.size()) return false;
    const SequenceFrame& entry = frames_[position_++];
    cv::Mat storage = frame.grey;
    frame = entry.known;
    frame.grey = storage;
    read_grey_image(entry.image, {info_.camera.width, info_.camera.height}, frame.grey, levels_);
    if (in_colour_ && !levels_) frame.colour = read_colour_image(entry.image, frame.grey.size());
    return true;
  }

 private:
  SourceInfo info_;
  std::vector<SequenceFrame> frames_;
  bool in_colour_;
  std::optional<GreyLevels> levels_;
  std::size_t position_ = 0;
};

}  // namespace

void keep_range(const FrameRange& range, const std::filesystem::path& where,
                std::vector<SequenceFrame>& frames) {
  const auto before_range = [&](const SequenceFrame& frame) {
    return range.first.has_value() && frame.known.number < *range.first;
  };
  frames.erase(std::remove_if(frames.begin(), frames.end(), before_range), frames.end());
  if (frames.empty()) {
    throw InputError(where, fmt::format("expected frames from number {} on, found none",
                                        range.first.value_or(0)));
  }
  if (range.count.has_value() && static_cast<std::size_t>(*range.count) < frames.size()) {
    frames.erase(frames.begin() + *range.count, frames.end());
  }
  frames.front().known.odometry.clear();
}

std::unique_ptr<FrameSource> make_image_sequence(SourceInfo info, std::vector<SequenceFrame> frames,
                                                 bool in_colour) {
  return std::make_unique<ImageSequence>(std::move(info), std::move(frames), in_colour);
}

std::unique_ptr<FrameSource> make_image_sequence(SourceInfo info, std::vector<SequenceFrame> frames,
                                                 const FrameRange& range,
                                                 const std::filesystem::path& where) {
  keep_range(range, where, frames);
  return make_image_sequence(std::move(info), std::move(frames), range.in_colour);
}

}  // namespace cairn::host
