#include "host_sim/trackers/handheld_adapter.hpp"

#include "host_sim/replay/core_trackers.hpp"
#include "host_sim/trackers/core_adapter.hpp"
#include "host_sim/trackers/fading.hpp"
#include "host_sim/trackers/landmark_list.hpp"

namespace cairn::host {
namespace {

template <class Config>
class HandheldAdapter : public HandheldCoreAdapter<HandheldTracker<Config>> {
 public:
  using Core = HandheldTracker<Config>;

  HandheldAdapter(const TrackerOptions& options, const SourceInfo& source) {
    typename Core::Parameters parameters = this->parameters_of(options);
    set_fading(options.fading, parameters.filter);
    apply(options.handheld, parameters);
    fading_ = options.fading.empty() ? "1" : options.fading;
    const bool patch = parameters.measurement.search.method == SearchMethod::kPatch;
    measurement_ = patch ? "patch" : "freak";
    this->start(options, source, parameters);
  }

  Status process(const Frame& frame, cv::Mat& overlay, FrameReport& report) override {
    return this->process_frame(frame, overlay, report);
  }

  std::unique_ptr<Tracker> clone() const override {
    return std::make_unique<HandheldAdapter>(*this);
  }

  std::vector<MapLandmark> landmarks() const override {
    std::vector<MapLandmark> all;
    const auto& filter = this->core().filter();
    for (int slot = 0; slot < filter.feature_count(); ++slot) {
      Vector3<float> p;
      Matrix3<float> covariance;
      if (!ok(filter.feature_position(slot, p, covariance))) continue;
      all.push_back({filter.feature_id(slot), p.cast<double>(), covariance.cast<double>(), true});
    }
    add_library(
        this->core().library(), [&](LandmarkId id) { return filter.find(id) >= 0; }, all);
    return all;
  }

  std::vector<LandmarkId> measured() const override {
    std::vector<LandmarkId> ids;
    const auto& filter = this->core().filter();
    for (int slot = 0; slot < filter.feature_count(); ++slot) {
      const FeatureStatistics& record = filter.feature_statistics(slot);
      const bool used = record.measured > 0 && record.consecutive_misses == 0;
      if (used && record.out_of_view == 0) ids.push_back(filter.feature_id(slot));
    }
    return ids;
  }

  std::optional<Matrix3<double>> attitude_covariance() const override {
    return this->core()
        .filter()
        .pose_covariance()
        .template bottomRightCorner<3, 3>()
        .template cast<double>();
  }

  std::optional<Matrix3<double>> position_covariance() const override {
    return this->core()
        .filter()
        .pose_covariance()
        .template topLeftCorner<3, 3>()
        .template cast<double>();
  }

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
  static void apply(const HandheldOptions& options, typename Core::Parameters& parameters) {
    if (options.measurement == "patch") parameters.measurement.search.method = SearchMethod::kPatch;
    if (options.measurement == "freak") {
      parameters.measurement.search.method = SearchMethod::kDescriptor;
      parameters.filter.sigma_px = 1.0F;
    }
    if (options.corner_score) parameters.local_map.supply.min_score = *options.corner_score;
    if (options.sigma_px) parameters.filter.sigma_px = static_cast<float>(*options.sigma_px);
    parameters.filter.estimate_focal_length = options.estimate_focal_length;
  }

  std::string fading_;
  std::string measurement_;
};

}  // namespace

std::unique_ptr<Tracker> make_handheld_tracker(const TrackerOptions& options,
                                               const SourceInfo& source) {
  return with_config_for(source, [&](auto config) -> std::unique_ptr<Tracker> {
    return std::make_unique<HandheldAdapter<decltype(config)>>(options, source);
  });
}

}  // namespace cairn::host
