#include "host_sim/trackers/window_adapter.hpp"

#include <cmath>

#include <fmt/format.h>

#include "cairn/runtime/window_augmentation.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/replay/core_trackers.hpp"
#include "host_sim/replay/scene_objects.hpp"
#include "host_sim/trackers/host_ticks.hpp"
#include "host_sim/trackers/state_hash.hpp"

namespace cairn::host {
namespace {

template <class Config>
class WindowAdapter : public Tracker {
 public:
  using Core = WindowTracker<Config>;

  WindowAdapter(const TrackerOptions& options, const SourceInfo& source)
      : core_(std::make_unique<Core>()) {
    typename Core::Parameters parameters;
    parameters.seed = options.seed;
    if (options.work_limit) parameters.work_limit = *options.work_limit;
    if (options.handheld.sigma_px) {
      parameters.sigma_px = static_cast<float>(*options.handheld.sigma_px);
    }
    parameters.window.focal_sigma =
        static_cast<float>(window_focal_sigma_e4(options.handheld, source)) / 10000.0F;
    if (source.gyro) parameters.gyro = *source.gyro;
    parameters.readout = window_readout(options.handheld, source);
    PinholeCamera<double> camera = source.camera;
    camera.fx *= 1.0 + options.handheld.focal_error;
    camera.fy *= 1.0 + options.handheld.focal_error;
    const Status status = core_->initialise(to_float(camera), parameters);
    if (!ok(status)) {
      throw InputError(source.name, fmt::format("camera refused: {}", to_string(status)));
    }
  }

  WindowAdapter(const WindowAdapter& other)
      : Tracker(other), core_(std::make_unique<Core>(*other.core_)), objects_(other.objects_) {}
  WindowAdapter& operator=(const WindowAdapter&) = delete;

  Status process(const Frame& frame, cv::Mat& overlay, FrameReport& report) override {
    for (const AngularRateSample& sample : frame.gyro) {
      static_cast<void>(core_->add_angular_rate(sample));  // what is refused is counted
    }
    const Status status =
        core_->process_frame(to_view(frame.grey), frame.t_us, host_ticks(), report);
    report.status = status;
    if (report.t_us == frame.t_us) {
      objects_.draw(*core_, to_mutable_view(overlay), host_ticks(), report);
    }
    return status;
  }

  Status set_work_limit(int units) override { return core_->set_work_limit(units); }
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<WindowAdapter>(*this); }
  std::uint64_t state_hash() const override { return hash_of_state(*core_); }

  std::vector<MapLandmark> landmarks() const override {
    std::vector<MapLandmark> all;
    for (int i = 0; i < core_->feature_count(); ++i) {
      Vector3<float> p;
      Matrix3<float> covariance;
      if (!ok(core_->feature_position(i, p, covariance))) continue;
      all.push_back({core_->feature_id(i), p.template cast<double>(),
                     covariance.template cast<double>(), true});
    }
    const auto& library = core_->library();
    for (int slot = 0; slot < library.size(); ++slot) {
      if (core_->follows(library[slot].id)) continue;
      all.push_back({library[slot].id, library[slot].p_map.template cast<double>(),
                     library[slot].covariance.template cast<double>(), false});
    }
    return all;
  }

  std::optional<Matrix3<double>> attitude_covariance() const override {
    return core_->pose_covariance().template bottomRightCorner<3, 3>().template cast<double>();
  }

  std::optional<Matrix3<double>> position_covariance() const override {
    const Matrix3<double> R_world_camera =
        core_->T_world_camera().rotation.toRotationMatrix().template cast<double>();
    return R_world_camera *
           core_->pose_covariance().template topLeftCorner<3, 3>().template cast<double>() *
           R_world_camera.transpose();
  }

  std::optional<FocalScale> focal_scale() const override { return core_->focal_scale(); }
  std::optional<GyroReport> gyro() const override {
    const HandheldGyro& gyro = core_->gyro();
    if (gyro.integrator().taken() + gyro.integrator().refused() == 0) return std::nullopt;
    return gyro.report();
  }
  int library_size() const override { return core_->library().size(); }
  int landmark_capacity() const override { return Core::kMaxFeatures; }
  Health health() const override { return core_->health(); }
  const Augmenter* objects() const override { return &objects_.augmenter(); }

  nlohmann::json description() const override {
    return {{"mode", "handheld"},
            {"filter", "window"},
            {"max_features", Core::kMaxFeatures},
            {"keyframes", Core::Window::kKeyframes},
            {"tracker_bytes", sizeof(Core)},
            {"filter_bytes", sizeof(typename Core::Window)}};
  }

 private:
  std::unique_ptr<Core> core_;
  SceneObjects objects_{kHandheldObjectHeight};
};

}  // namespace

std::uint16_t window_focal_sigma_e4(const HandheldOptions& options, const SourceInfo& source) {
  const auto own =
      static_cast<double>(WindowTracker<DefaultConfig>::Parameters().window.focal_sigma);
  const double sigma = options.focal_sigma.value_or(source.focal_sigma.value_or(own));
  return static_cast<std::uint16_t>(std::lround(1e4 * sigma));
}

ReadoutTimes window_readout(const HandheldOptions& options, const SourceInfo& source) {
  ReadoutTimes readout = source.readout;
  if (options.row_time_s) readout.row_time_s = static_cast<float>(*options.row_time_s);
  const PinholeCamera<double>& camera = source.camera;
  if (!ok(readout.validate(camera.width, camera.height))) {
    throw UsageError(
        fmt::format("--row-time {}: expected seconds from one row to the next, at "
                    "most {} s for all {} rows",
                    readout.row_time_s, ReadoutTimes::kLongest_s, camera.height));
  }
  return readout;
}

std::unique_ptr<Tracker> make_window_tracker(const TrackerOptions& options,
                                             const SourceInfo& source) {
  const PinholeCamera<double>& camera = source.camera;
  if (camera.width <= DefaultConfig::kMaxImageWidth &&
      camera.height <= DefaultConfig::kMaxImageHeight) {
    return std::make_unique<WindowAdapter<DefaultConfig>>(options, source);
  }
  return std::make_unique<WindowAdapter<LargeConfig>>(options, source);
}

}  // namespace cairn::host
