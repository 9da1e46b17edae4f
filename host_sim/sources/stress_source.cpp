#include "host_sim/sources/stress_source.hpp"

#include <sstream>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

class StressSource : public FrameSource {
 public:
  explicit StressSource(const StressScene& scene) : scene_(scene), renderer_(scene) {
    const InputLogHeader header = renderer_.header();
    info_.name = "stress";
    info_.camera.fx = static_cast<double>(header.camera.fx);
    info_.camera.fy = static_cast<double>(header.camera.fy);
    info_.camera.cx = static_cast<double>(header.camera.cx);
    info_.camera.cy = static_cast<double>(header.camera.cy);
    info_.camera.width = header.camera.width;
    info_.camera.height = header.camera.height;
    info_.frame_rate_hz = 1e6 / scene.period_us;
    info_.frame_count = scene.frames;
    info_.seed = static_cast<std::uint64_t>(scene.seed);
    info_.note = scene.text();
    if (scene.handheld != 0) return;
    info_.T_vehicle_camera = {header.T_vehicle_camera.rotation.cast<double>(),
                              header.T_vehicle_camera.translation.cast<double>()};
    info_.odometry = OdometryModel{OdometrySample::Kind::kTwist, 1e-3 * scene.speed_sigma,
                                   1e-3 * scene.turn_sigma, 0.0, 1e-6 * scene.period_us};
  }

  const SourceInfo& info() const override { return info_; }

  bool next(Frame& frame) override {
    if (next_ == scene_.frames) return false;
    frame = Frame{};
    frame.number = next_;
    frame.t_us = renderer_.t_us(next_);
    frame.grey.create(kStressHeight, kStressWidth, CV_8UC1);
    renderer_.draw(next_, frame.grey.data);
    if (scene_.handheld == 0) frame.odometry = {renderer_.odometry(next_)};
    ++next_;
    return true;
  }

 private:
  StressScene scene_;
  StressRenderer renderer_;
  SourceInfo info_;
  int next_ = 0;
};

}  // namespace

StressScene parse_stress_scene(const std::string& text) {
  StressScene scene;
  std::istringstream fields(text);
  std::string field;
  while (std::getline(fields, field, ',')) {
    if (scene.set(field)) continue;
    std::string known;
    for (const NamedStressScene& each : named_stress_scenes())
      known += each.name + std::string(", ");
    for (const StressScene::Field& each : StressScene::fields()) {
      known += fmt::format("{}{}={}..{}", each.name == StressScene::fields()[0].name ? "" : ", ",
                           each.name, each.low, each.high);
    }
    throw UsageError(fmt::format("stress field '{}': expected one of {}", field, known));
  }
  return scene;
}

std::unique_ptr<FrameSource> make_stress_source(const StressScene& scene) {
  return std::make_unique<StressSource>(scene);
}

}  // namespace cairn::host
