#include "host_sim/trackers/handheld_adapter.hpp"

#include <fmt/format.h>

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/replay/core_trackers.hpp"
#include "host_sim/replay/scene_objects.hpp"
#include "host_sim/trackers/fading.hpp"
#include "host_sim/trackers/host_ticks.hpp"
#include "host_sim/trackers/state_hash.hpp"

namespace cairn::host {
namespace {

template <class Config>
class HandheldAdapter : public Tracker {
 public:
  using Core = HandheldTracker<Config>;

  HandheldAdapter(const TrackerOptions& options, const SourceInfo& source)
      : core_(std::make_unique<Core>()) {
    typename Core::Parameters parameters;
    parameters.seed = options.seed;
    if (options.work_limit) parameters.work_limit = *options.work_limit;
    set_fading(options.fading, parameters.filter);
    const PinholeCamera<float> camera = apply(options.handheld, source.camera, parameters);
    fading_ = options.fading.empty() ? "1" : options.fading;
    const bool patch = parameters.measurement.search.method == SearchMethod::kPatch;
    measurement_ = patch ? "patch" : "freak";
    const Status status = core_->initialise(camera, parameters);
    if (!ok(status)) {
      throw InputError(source.name, fmt::format("camera refused: {}", to_string(status)));
    }
  }

  HandheldAdapter(const HandheldAdapter& other)
      : Tracker(other),
        core_(std::make_unique<Core>(*other.core_)),
        objects_(other.objects_),
        fading_(other.fading_),
        measurement_(other.measurement_) {}
  HandheldAdapter& operator=(const HandheldAdapter&) = delete;

  Status process(const Frame& frame, cv::Mat& overlay, FrameReport& report) override {
    const Status status =
        core_->process_frame(to_view(frame.grey), frame.t_us, host_ticks(), report);
    report.status = status;
    if (report.t_us == frame.t_us) {
      objects_.draw(*core_, to_mutable_view(overlay), host_ticks(), report);
    }
    return status;
  }

  Status set_work_limit(int units) override { return core_->set_work_limit(units); }
  std::unique_ptr<Tracker> clone() const override {
    return std::make_unique<HandheldAdapter>(*this);
  }
  std::uint64_t state_hash() const override { return hash_of_state(*core_); }

  std::vector<MapLandmark> landmarks() const override {
    std::vector<MapLandmark> all;
    const auto& filter = core_->filter();
    for (int slot = 0; slot < filter.feature_count(); ++slot) {
      Vector3<float> p;
      Matrix3<float> covariance;
      if (!ok(filter.feature_position(slot, p, covariance))) continue;
      all.push_back({filter.feature_id(slot), p.cast<double>(), covariance.cast<double>(), true});
    }
    const auto& library = core_->library();
    for (int slot = 0; slot < library.size(); ++slot) {
      if (filter.find(library[slot].id) >= 0) continue;
      all.push_back({library[slot].id, library[slot].p_map.template cast<double>(),
                     library[slot].covariance.template cast<double>(), false});
    }
    return all;
  }

  std::vector<LandmarkId> measured() const override {
    std::vector<LandmarkId> ids;
    const auto& filter = core_->filter();
    for (int slot = 0; slot < filter.feature_count(); ++slot) {
      const FeatureStatistics& record = filter.feature_statistics(slot);
      const bool used = record.measured > 0 && record.consecutive_misses == 0;
      if (used && record.out_of_view == 0) ids.push_back(filter.feature_id(slot));
    }
    return ids;
  }

  std::optional<Matrix3<double>> attitude_covariance() const override {
    return core_->filter()
        .pose_covariance()
        .template bottomRightCorner<3, 3>()
        .template cast<double>();
  }

  std::optional<Matrix3<double>> position_covariance() const override {
    return core_->filter().pose_covariance().template topLeftCorner<3, 3>().template cast<double>();
  }

  int library_size() const override { return core_->library().size(); }
  int landmark_capacity() const override { return Core::kMaxFeatures; }
  Health health() const override { return core_->health(); }
  const Augmenter* objects() const override { return &objects_.augmenter(); }

  nlohmann::json description() const override {
    return {{"mode", "handheld"},
            {"filter", "mono"},
            {"fading", fading_},
            {"measurement", measurement_},
            {"max_features", Core::kMaxFeatures},
            {"tracker_bytes", sizeof(Core)},
            {"filter_bytes", sizeof(typename Core::Filter)}};
  }

 private:
  static PinholeCamera<float> apply(const HandheldOptions& options,
                                    const PinholeCamera<double>& true_camera,
                                    typename Core::Parameters& parameters) {
    if (options.measurement == "patch") parameters.measurement.search.method = SearchMethod::kPatch;
    if (options.measurement == "freak") {
      parameters.measurement.search.method = SearchMethod::kDescriptor;
      parameters.filter.sigma_px = 1.0F;
    }
    if (options.corner_score) parameters.local_map.supply.min_score = *options.corner_score;
    if (options.sigma_px) parameters.filter.sigma_px = static_cast<float>(*options.sigma_px);
    parameters.filter.estimate_focal_length = options.estimate_focal_length;
    PinholeCamera<double> camera = true_camera;
    camera.fx *= 1.0 + options.focal_error;
    camera.fy *= 1.0 + options.focal_error;
    return to_float(camera);
  }

  std::unique_ptr<Core> core_;
  SceneObjects objects_{kHandheldObjectHeight};
  std::string fading_;
  std::string measurement_;
};

}  // namespace

std::unique_ptr<Tracker> make_handheld_tracker(const TrackerOptions& options,
                                               const SourceInfo& source) {
  const PinholeCamera<double>& camera = source.camera;
  if (camera.width <= DefaultConfig::kMaxImageWidth &&
      camera.height <= DefaultConfig::kMaxImageHeight) {
    return std::make_unique<HandheldAdapter<DefaultConfig>>(options, source);
  }
  return std::make_unique<HandheldAdapter<LargeConfig>>(options, source);
}

}  // namespace cairn::host
