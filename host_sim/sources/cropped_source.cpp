#include "host_sim/sources/cropped_source.hpp"

#include <charconv>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

constexpr int kLeastSide = 16;

class CroppedSource final : public FrameSource {
 public:
  CroppedSource(std::unique_ptr<FrameSource> source, const PictureCrop& crop)
      : source_(std::move(source)), info_(source_->info()) {
    PinholeCamera<double>& camera = info_.camera;
    const cv::Size whole(camera.width, camera.height);
    area_ = {crop.left.value_or((whole.width - crop.width) / 2),
             crop.top.value_or((whole.height - crop.height) / 2), crop.width, crop.height};
    if ((area_ & cv::Rect({0, 0}, whole)) != area_) {
      throw UsageError(fmt::format(
          "--crop {}x{}{}: expected a part of the picture, which has {}x{} pixels", crop.width,
          crop.height, crop.left ? fmt::format("+{}+{}", *crop.left, *crop.top) : std::string(),
          whole.width, whole.height));
    }
    camera.cx -= area_.x;
    camera.cy -= area_.y;
    camera.width = area_.width;
    camera.height = area_.height;
    if (!(camera.cx >= 0.0 && camera.cy >= 0.0 && camera.cx < camera.width &&
          camera.cy < camera.height)) {
      throw UsageError(
          fmt::format("--crop {}: expected a part that holds the principal point, "
                      "({:.0f}, {:.0f})",
                      shown(), camera.cx + area_.x, camera.cy + area_.y));
    }
    info_.note += fmt::format("{}pictures of {}x{} cropped to {}", info_.note.empty() ? "" : "; ",
                              whole.width, whole.height, shown());
  }

  const SourceInfo& info() const override { return info_; }
  std::optional<TimeSpan> span() const override { return source_->span(); }

  bool next(Frame& frame) override {
    const bool more = source_->next(frame);
    info_.warnings = source_->info().warnings;
    info_.damaged = source_->info().damaged;
    if (!more) return false;
    frame.grey = frame.grey(area_).clone();
    if (!frame.colour.empty()) frame.colour = frame.colour(area_).clone();
    const Vector2<double> corner(area_.x, area_.y);
    for (ScenePointView& point : frame.scene_points) point.pixel -= corner;
    return true;
  }

 private:
  std::string shown() const {
    return fmt::format("{}x{}+{}+{}", area_.width, area_.height, area_.x, area_.y);
  }

  std::unique_ptr<FrameSource> source_;
  SourceInfo info_;
  cv::Rect area_;
};

/// A whole number at the front of `text`, taken from it.
std::optional<int> take_number(std::string_view& text) {
  int value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || value < 0) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(parsed.ptr - text.data()));
  return value;
}

std::optional<int> take_number_after(char mark, std::string_view& text) {
  if (text.empty() || text.front() != mark) return std::nullopt;
  text.remove_prefix(1);
  return take_number(text);
}

}  // namespace

PictureCrop parse_crop(const std::string& text) {
  std::string_view rest = text;
  PictureCrop crop;
  crop.width = take_number(rest).value_or(0);
  crop.height = take_number_after('x', rest).value_or(0);
  if (!rest.empty()) {
    crop.left = take_number_after('+', rest);
    crop.top = take_number_after('+', rest);
  }
  const bool complete = rest.empty() && crop.left.has_value() == crop.top.has_value();
  if (complete && crop.width >= kLeastSide && crop.height >= kLeastSide) return crop;
  throw UsageError(
      fmt::format("--crop '{}': expected WIDTHxHEIGHT or WIDTHxHEIGHT+LEFT+TOP, sides "
                  "of {} pixels or more",
                  text, kLeastSide));
}

std::unique_ptr<FrameSource> crop_source(std::unique_ptr<FrameSource> source,
                                         const PictureCrop& crop) {
  return std::make_unique<CroppedSource>(std::move(source), crop);
}

}  // namespace cairn::host
