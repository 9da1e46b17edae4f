#pragma once

#include <cstdint>
#include <memory>

#include "cairn/base/config.hpp"
#include "cairn/runtime/replay.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/experiments/faults/fault_scene.hpp"
#include "host_sim/replay/core_trackers.hpp"
#include "host_sim/trackers/input_log_file.hpp"
#include "host_sim/trackers/state_hash.hpp"

namespace cairn::host {

template <class Config>
using FaultVehicle = VehicleTracker<Config, GroupIekfSlam<float, Config::kMaxLandmarks, 3>>;

/// A core tracker on a scene's frames, without the host between.
template <class Core>
class CoreRun {
 public:
  /// `core` is the caller's, in whatever state.
  CoreRun(const FaultScene& scene, Core& core) : scene_(scene), core_(core) {}

  Status start() {
    TrackerOptions options = scene_.options();
    options.filter = scene_.vehicle() ? kDefaultVehicleFilter : kMonoFilter;
    return start_replay(to_log_header(options, scene_.info(), scene_.frames().front().t_us), core_);
  }

  Status step(int frame, const TickSource& ticks = TickSource()) {
    const Frame& input = scene_.frames()[static_cast<std::size_t>(frame)];
    return step(input, input.grey, ticks);
  }

  Status step(const Frame& input, const cv::Mat& picture, const TickSource& ticks) {
    for (const OdometrySample& sample : input.odometry) {
      static_cast<void>(replay_odometry(sample, core_));
    }
    const Status status = core_.process_frame(to_view(picture), input.t_us, ticks, report_);
    report_.status = status;
    return status;
  }

  std::uint64_t hash() const { return frame_hash(core_, report_); }
  const FrameReport& report() const { return report_; }

 private:
  const FaultScene& scene_;
  Core& core_;
  FrameReport report_;
};

template <class Core>
struct CoreType {
  using Type = Core;
};

/// Calls `visit(CoreType)` with the tracker of the scene's mode and the capacities of Config.
template <class Config, class Visit>
auto with_core(const FaultScene& scene, Visit visit) {
  if (scene.vehicle()) return visit(CoreType<FaultVehicle<Config>>());
  return visit(CoreType<HandheldTracker<Config>>());
}

}  // namespace cairn::host
