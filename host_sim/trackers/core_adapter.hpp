#pragma once

#include <cstdint>
#include <memory>

#include <fmt/format.h>

#include "cairn/base/config.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/replay/scene_objects.hpp"
#include "host_sim/trackers/host_ticks.hpp"
#include "host_sim/trackers/state_hash.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// What the adapters of all the core's trackers share.
template <class Core>
class CoreAdapter : public Tracker {
 public:
  CoreAdapter& operator=(const CoreAdapter&) = delete;

  Status set_work_limit(int units) override { return core_->set_work_limit(units); }
  std::uint64_t state_hash() const override { return hash_of_state(*core_); }
  int library_size() const override { return core_->library().size(); }
  Health health() const override { return core_->health(); }
  const Augmenter* objects() const override { return &objects_.augmenter(); }

 protected:
  explicit CoreAdapter(float object_height_m)
      : core_(std::make_unique<Core>()), objects_{object_height_m} {}
  CoreAdapter(const CoreAdapter& other)
      : Tracker(other), core_(std::make_unique<Core>(*other.core_)), objects_(other.objects_) {}

  Core& core() { return *core_; }
  const Core& core() const { return *core_; }

  /// Tracks a frame, and draws the objects where it was accepted.
  Status process_frame(const Frame& frame, cv::Mat& overlay, FrameReport& report) {
    const Status status =
        core_->process_frame(to_view(frame.grey), frame.t_us, host_ticks(), report);
    report.status = status;
    if (report.t_us == frame.t_us) {
      objects_.draw(*core_, to_mutable_view(overlay), host_ticks(), report);
    }
    return status;
  }

 private:
  std::unique_ptr<Core> core_;
  SceneObjects objects_;
};

/// The same of trackers that see by a hand-held camera alone.
template <class Core>
class HandheldCoreAdapter : public CoreAdapter<Core> {
 public:
  int landmark_capacity() const override { return Core::kMaxFeatures; }

 protected:
  using Parameters = typename Core::Parameters;

  HandheldCoreAdapter() : CoreAdapter<Core>(kHandheldObjectHeight) {}

  static Parameters parameters_of(const TrackerOptions& options) {
    Parameters parameters;
    parameters.seed = options.seed;
    if (options.work_limit) parameters.work_limit = *options.work_limit;
    return parameters;
  }
  /// With the camera's focal length as far off as the options ask for. InputError for one that is
  /// refused.
  void start(const TrackerOptions& options, const SourceInfo& source,
             const Parameters& parameters) {
    PinholeCamera<double> camera = source.camera;
    camera.fx *= 1.0 + options.handheld.focal_error;
    camera.fy *= 1.0 + options.handheld.focal_error;
    const Status status = this->core().initialise(to_float(camera), parameters);
    if (!ok(status)) {
      throw InputError(source.name, fmt::format("camera refused: {}", to_string(status)));
    }
  }
};

/// Calls `make` with the smallest configuration that holds the source's pictures.
template <class Make>
std::unique_ptr<Tracker> with_config_for(const SourceInfo& source, const Make& make) {
  const PinholeCamera<double>& camera = source.camera;
  const bool small = camera.width <= DefaultConfig::kMaxImageWidth &&
                     camera.height <= DefaultConfig::kMaxImageHeight;
  return small ? make(DefaultConfig()) : make(LargeConfig());
}

}  // namespace cairn::host
