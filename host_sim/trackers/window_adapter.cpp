#include "host_sim/trackers/window_adapter.hpp"

#include <cmath>

#include <fmt/format.h>

#include "cairn/runtime/window_augmentation.hpp"

#include "host_sim/replay/core_trackers.hpp"
#include "host_sim/trackers/core_adapter.hpp"
#include "host_sim/trackers/landmark_list.hpp"

namespace cairn::host {
namespace {

template <class Config>
class WindowAdapter : public HandheldCoreAdapter<WindowTracker<Config>> {
 public:
  using Core = WindowTracker<Config>;

  WindowAdapter(const TrackerOptions& options, const SourceInfo& source) {
    typename Core::Parameters parameters = this->parameters_of(options);
    if (options.handheld.sigma_px) {
      parameters.sigma_px = static_cast<float>(*options.handheld.sigma_px);
    }
    parameters.window.focal_sigma =
        static_cast<float>(window_focal_sigma_e4(options.handheld, source)) / 10000.0F;
    if (source.gyro) parameters.gyro = *source.gyro;
    parameters.readout = window_readout(options.handheld, source);
    this->start(options, source, parameters);
  }

  Status process(const Frame& frame, cv::Mat& overlay, FrameReport& report) override {
    for (const AngularRateSample& sample : frame.gyro) {
      static_cast<void>(this->core().add_angular_rate(sample));  // what is refused is counted
    }
    return this->process_frame(frame, overlay, report);
  }

  std::unique_ptr<Tracker> clone() const override { return std::make_unique<WindowAdapter>(*this); }

  std::vector<MapLandmark> landmarks() const override {
    std::vector<MapLandmark> all;
    const Core& core = this->core();
    for (int i = 0; i < core.feature_count(); ++i) {
      Vector3<float> p;
      Matrix3<float> covariance;
      if (!ok(core.feature_position(i, p, covariance))) continue;
      all.push_back({core.feature_id(i), p.template cast<double>(),
                     covariance.template cast<double>(), true});
    }
    add_library(
        core.library(), [&](LandmarkId id) { return core.follows(id); }, all);
    return all;
  }

  std::optional<Matrix3<double>> attitude_covariance() const override {
    return this->core()
        .pose_covariance()
        .template bottomRightCorner<3, 3>()
        .template cast<double>();
  }

  std::optional<Matrix3<double>> position_covariance() const override {
    const Matrix3<double> R_world_camera =
        this->core().T_world_camera().rotation.toRotationMatrix().template cast<double>();
    return R_world_camera *
           this->core().pose_covariance().template topLeftCorner<3, 3>().template cast<double>() *
           R_world_camera.transpose();
  }

  std::optional<FocalScale> focal_scale() const override { return this->core().focal_scale(); }
  std::optional<GyroReport> gyro() const override {
    const HandheldGyro& gyro = this->core().gyro();
    if (gyro.integrator().taken() + gyro.integrator().refused() == 0) return std::nullopt;
    return gyro.report();
  }

  nlohmann::json description() const override {
    return {{"mode", "handheld"},
            {"filter", "window"},
            {"max_features", Core::kMaxFeatures},
            {"keyframes", Core::Window::kKeyframes},
            {"tracker_bytes", sizeof(Core)},
            {"filter_bytes", sizeof(typename Core::Window)}};
  }
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
  return with_config_for(source, [&](auto config) -> std::unique_ptr<Tracker> {
    return std::make_unique<WindowAdapter<decltype(config)>>(options, source);
  });
}

}  // namespace cairn::host
