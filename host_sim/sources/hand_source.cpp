#include "host_sim/sources/hand_source.hpp"

#include <cmath>

#include <fmt/format.h>

#include "host_sim/world/hall.hpp"
#include "host_sim/world/hand_motion.hpp"
#include "host_sim/world/renderer.hpp"
#include "host_sim/world/sensor.hpp"

namespace cairn::host {
namespace {

constexpr int kHandFrames = 600;
constexpr double kHandFrameRate = 30.0;
constexpr int kStripRows = 4;
constexpr int kStripMargin = 1;  // rows above and below it, which the renderer does not smooth

PinholeCamera<double> hand_camera() {
  PinholeCamera<double> camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

/// What a strip's renderer sees: a few rows.
PinholeCamera<double> strip_camera() {
  PinholeCamera<double> camera = hand_camera();
  camera.height = kStripRows + 2 * kStripMargin;
  return camera;
}

class HandSource final : public FrameSource {
 public:
  explicit HandSource(const HandOptions& options)
      : readout_s_(options.readout_s),
        hall_(build_hall(options.seed)),
        motion_(options.seed),
        camera_(hand_camera()),
        sensor_(Sensor::Settings::with_seed(options.seed)),
        next_(options.first_frame),
        end_(options.first_frame + options.frame_count.value_or(kHandFrames)) {
    info_.name = "hall-hand";
    info_.camera = camera_;
    info_.focal_sigma = 0.0;
    info_.frame_rate_hz = kHandFrameRate;
    info_.frame_count = end_ - next_;
    info_.seed = options.seed;
    if (readout_s_ > 0.0) {
      info_.readout.row_time_s = static_cast<float>(readout_s_ / (camera_.height - 1));
      info_.note = fmt::format("rolling shutter, {:.1f} ms a picture", 1e3 * readout_s_);
    }
  }

  const SourceInfo& info() const override { return info_; }

  bool next(Frame& frame) override {
    if (next_ >= end_) return false;
    const double t_s = static_cast<double>(next_) / kHandFrameRate;
    frame.number = next_;
    frame.t_us = std::llround(1e6 * t_s);
    frame.true_T_world_camera = motion_.pose_at_time(t_s);
    frame.odometry.clear();
    render(t_s);
    sensor_.expose(ideal_, next_, t_s, frame.grey);
    ++next_;
    return true;
  }

 private:
  void render(double t_s) {
    if (readout_s_ == 0.0) {
      Renderer(camera_).render(hall_.scene, motion_.pose_at_time(t_s), ideal_);
      return;
    }
    ideal_.create(camera_.height, camera_.width, CV_16UC1);
    PinholeCamera<double> strip = strip_camera();
    for (int top = 0; top < camera_.height; top += kStripRows) {
      strip.cy = camera_.cy - (top - kStripMargin);
      const double middle = top + 0.5 * (kStripRows - 1);
      const double late_s = (middle / (camera_.height - 1) - 0.5) * readout_s_;
      Renderer(strip).render(hall_.scene, motion_.pose_at_time(t_s + late_s), strip_);
      strip_.rowRange(kStripMargin, kStripMargin + kStripRows)
          .copyTo(ideal_.rowRange(top, top + kStripRows));
    }
  }

  double readout_s_;
  Hall hall_;
  HandMotion motion_;
  PinholeCamera<double> camera_;
  Sensor sensor_;
  SourceInfo info_;
  cv::Mat ideal_;
  cv::Mat strip_;
  int next_;
  int end_;
};

}  // namespace

std::unique_ptr<FrameSource> make_hand_source(const HandOptions& options) {
  return std::make_unique<HandSource>(options);
}

}  // namespace cairn::host
