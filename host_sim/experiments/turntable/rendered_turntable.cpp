#include "host_sim/experiments/turntable/rendered_turntable.hpp"

#include <cmath>
#include <map>
#include <mutex>
#include <tuple>

#include <opencv2/core.hpp>

#include "cairn/mono/mono_ekf.hpp"
#include "cairn/tracking/active_search.hpp"
#include "cairn/tracking/feature_supply.hpp"
#include "cairn/tracking/patch_search.hpp"

#include "host_sim/base/parallel_for.hpp"
#include "host_sim/experiments/turntable/mono_bank.hpp"
#include "host_sim/experiments/turntable/turntable_room.hpp"
#include "host_sim/experiments/turntable/turntable_run.hpp"
#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

constexpr int kMaxFeatures = 40;
constexpr int kMaxAnchors = 10;
constexpr double kUsualOutlierShare = 0.05;
constexpr int kPatchMargin = 14;  // px; FREAK needs more

/// A filter on a video.
template <class Filter>
class VideoRun : public TurntableRun<Filter> {
  using Run = TurntableRun<Filter>;

 public:
  /// `video` outlives the run.
  VideoRun(const PointsScenario& scenario, const MonoParameters<float>& parameters,
           Measurement measurement, const std::vector<cv::Mat>& video)
      : Run(scenario, parameters),
        measurement_(measurement),
        video_(video),
        outliers_(scenario.seed) {
    if (measurement == Measurement::kPatch) supply_parameters_.min_margin_px = kPatchMargin;
  }

 private:
  using Run::filter_;
  using Run::matches_;
  using Run::scenario_;

  ImageView image_of(std::size_t k) const {
    const cv::Mat& image = video_[k];
    return {image.data, image.cols, image.rows, static_cast<int>(image.step)};
  }

  void search(std::size_t k) override {
    const ImageView image = image_of(k);
    for (int slot = 0; slot < filter_->feature_count(); ++slot) {
      PixelPrediction<float> prediction;
      if (!ok(filter_->predict_feature(slot, prediction))) continue;
      PixelMatch<float> match;
      match.id = prediction.id;
      match.slot = slot;
      if (!found(image, prediction, match.pixel)) continue;
      if (scenario_.outlier_share > kUsualOutlierShare &&
          outliers_.uniform() < scenario_.outlier_share) {
        for (int i = 0; i < 2; ++i) {
          const double reach = 2.45 * std::sqrt(static_cast<double>(prediction.covariance(i, i)));
          match.pixel(i) =
              prediction.pixel(i) + static_cast<float>(outliers_.uniform(-reach, reach));
        }
      }
      matches_.push_back(match);
    }
  }

  bool found(const ImageView& image, const PixelPrediction<float>& prediction,
             Vector2<float>& pixel) {
    const Appearance& appearance = appearances_.at(prediction.id);
    Matrix2<float> warp;
    if (!ok(predict_warp(filter_->camera(), appearance.T_world_reference, filter_->T_world_camera(),
                         prediction.p_camera, warp))) {
      return false;
    }
    if (measurement_ == Measurement::kPatch) {
      PatchWarp patch_warp;
      return to_patch_warp(warp, patch_warp) &&
             ok(search_patch(image, prediction, appearance.patch, patch_warp, {}, pixel));
    }
    SearchReport report;
    return ok(
        search_landmark(image, prediction, appearance, warp, {}, search_scratch_, pixel, report));
  }

  void add_features(std::size_t k) override {
    const ImageView image = image_of(k);
    supply_.begin(image.width, image.height);
    for (int slot = 0; slot < filter_->feature_count(); ++slot) {
      PixelPrediction<float> prediction;
      if (ok(filter_->predict_feature(slot, prediction))) {
        supply_.occupy(prediction.pixel.x(), prediction.pixel.y());
      }
    }
    const int wanted = Run::wanted();
    if (wanted <= 0) return;
    Corner corners[Supply::kCells];
    Supply::Report report;
    WorkBudget unlimited;
    const int found = supply_.find(image, supply_parameters_, wanted, supply_scratch_, corners,
                                   report, unlimited);
    for (int i = 0; i < found; ++i) {
      Appearance appearance;
      if (!take(image, corners[i], appearance)) continue;
      const Vector2<float> pixel(static_cast<float>(corners[i].x),
                                 static_cast<float>(corners[i].y));
      if (ok(filter_->add_feature(next_id_, pixel))) appearances_[next_id_++] = appearance;
    }
  }

  bool take(const ImageView& image, const Corner& corner, Appearance& appearance) {
    if (measurement_ == Measurement::kFreak) {
      return ok(make_appearance(image, corner.x, corner.y, filter_->T_world_camera(), appearance));
    }
    appearance.T_world_reference = filter_->T_world_camera();
    return ok(extract_patch(image, corner.x * 256, corner.y * 256, appearance.patch));
  }

  using Supply = FeatureSupply<640>;

  Measurement measurement_;
  const std::vector<cv::Mat>& video_;
  GaussianRandom outliers_;
  std::map<LandmarkId, Appearance> appearances_;
  LandmarkId next_id_ = 1;
  Supply supply_;
  Supply::Parameters supply_parameters_;
  Supply::Scratch supply_scratch_;
  SearchScratch search_scratch_;
};

struct Video {
  std::vector<TurntablePose> poses;
  std::vector<cv::Mat> images;
};

/// What a scenario's images depend on.
struct VideoKey {
  bool lever;
  bool noisy;
  std::uint64_t seed;
  bool operator<(const VideoKey& other) const {
    return std::tie(lever, noisy, seed) < std::tie(other.lever, other.noisy, other.seed);
  }
};

struct Job {
  std::size_t cell = 0;
  std::size_t run = 0;
  PointsScenario scenario;
  TurntableVariant variant;

  VideoKey key() const {
    return {scenario.motion.lever_m.norm() > 0.0, scenario.noise_px > 0.75, scenario.seed};
  }
  PointsResult result(const Video& video, Measurement measurement) const {
    return variant.bank ? result_of<MonoBank<float, kMaxFeatures, kMaxAnchors>>(video, measurement)
                        : result_of<MonoEkf<float, kMaxFeatures, kMaxAnchors>>(video, measurement);
  }

 private:
  template <class Filter>
  PointsResult result_of(const Video& video, Measurement measurement) const {
    return VideoRun<Filter>(scenario, variant.parameters, measurement, video.images)
        .run(video.poses);
  }
};

}  // namespace

std::vector<TurntableCell> run_rendered_turntable(const TurntableConfig& config,
                                                  Measurement measurement,
                                                  const std::function<void(int, int)>& progress) {
  std::vector<TurntableCell> cells;
  std::map<VideoKey, std::vector<Job>> jobs;
  std::size_t number = 0;
  int total = 0;
  for (const TurntableCondition& condition : turntable_conditions(config)) {
    for (const TurntableVariant& variant : turntable_variants(config, condition)) {
      TurntableCell cell{condition.name, variant.name, {}};
      cell.runs.resize(static_cast<std::size_t>(config.seeds));
      for (std::size_t run = 0; run < cell.runs.size(); ++run) {
        Job job{cells.size(), run, condition.scenario, variant};
        job.scenario.seed = config.seed + run;
        if (!config.shard.has(number++)) continue;
        jobs[job.key()].push_back(job);
        ++total;
      }
      cells.push_back(cell);
    }
  }
  int done = 0;
  for (const auto& [key, group] : jobs) {
    Video video;
    video.poses = turntable_poses(group.front().scenario.motion);
    video.images = render_turntable(group.front().scenario, key.noisy ? 6.0 : 2.0);
    std::mutex mutex;
    parallel_for(group.size(), 0, [&, &list = group](std::size_t i) {
      cells[list[i].cell].runs[list[i].run] = list[i].result(video, measurement);
      const std::lock_guard<std::mutex> lock(mutex);
      progress(++done, total);
    });
  }
  return cells;
}

}  // namespace cairn::host
