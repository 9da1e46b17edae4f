#include "host_sim/sources/scaled_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

constexpr int kLeastSide = 16;

class ScaledSource final : public FrameSource {
 public:
  ScaledSource(std::unique_ptr<FrameSource> source, double factor)
      : source_(std::move(source)), info_(source_->info()) {
    PinholeCamera<double>& camera = info_.camera;
    const int width = static_cast<int>(std::lround(factor * camera.width));
    const int height = static_cast<int>(std::lround(factor * camera.height));
    if (width < kLeastSide || height < kLeastSide) {
      throw InputError(info_.name, fmt::format("expected pictures of at least {} pixels a side "
                                               "after scaling, found {}x{}",
                                               kLeastSide, width, height));
    }
    scale_ = {static_cast<double>(width) / camera.width,
              static_cast<double>(height) / camera.height};
    info_.note +=
        fmt::format("{}pictures scaled from {}x{} to {}x{}", info_.note.empty() ? "" : "; ",
                    camera.width, camera.height, width, height);
    const Vector2<double> centre = scaled({camera.cx, camera.cy});
    camera.fx *= scale_.x();
    camera.fy *= scale_.y();
    camera.cx = centre.x();
    camera.cy = centre.y();
    camera.width = width;
    camera.height = height;
    info_.readout.column_time_s /= static_cast<float>(scale_.x());
    info_.readout.row_time_s /= static_cast<float>(scale_.y());
  }

  const SourceInfo& info() const override { return info_; }
  std::optional<TimeSpan> span() const override { return source_->span(); }

  bool next(Frame& frame) override {
    const bool more = source_->next(frame);
    info_.warnings = source_->info().warnings;
    info_.damaged = source_->info().damaged;
    if (!more) return false;
    cv::Mat small;
    cv::resize(frame.grey, small, {info_.camera.width, info_.camera.height}, 0.0, 0.0,
               cv::INTER_AREA);
    frame.grey = small;
    if (!frame.colour.empty()) {
      cv::Mat colour;
      cv::resize(frame.colour, colour, small.size(), 0.0, 0.0, cv::INTER_AREA);
      frame.colour = colour;
    }
    for (ScenePointView& point : frame.scene_points) point.pixel = scaled(point.pixel);
    return true;
  }

 private:
  /// Pixel (0, 0) is the centre of the first pixel.
  Vector2<double> scaled(const Vector2<double>& pixel) const {
    const Vector2<double> half(0.5, 0.5);
    return (pixel + half).cwiseProduct(scale_) - half;
  }

  std::unique_ptr<FrameSource> source_;
  SourceInfo info_;
  Vector2<double> scale_ = Vector2<double>::Ones();
};

}  // namespace

std::unique_ptr<FrameSource> scale_source(std::unique_ptr<FrameSource> source, double factor) {
  return std::make_unique<ScaledSource>(std::move(source), factor);
}

double fitting_factor(const PinholeCamera<double>& camera, int max_width, int max_height) {
  const double across = static_cast<double>(max_width) / camera.width;
  const double down = static_cast<double>(max_height) / camera.height;
  return std::min({1.0, across, down});
}

}  // namespace cairn::host
