#pragma once

#include <chrono>
#include <memory>
#include <stdexcept>
#include <vector>

#include "host_sim/experiments/turntable/turntable_score.hpp"

namespace cairn::host {

/// One monocular filter led through the frames of a turntable's run, timed and scored; what it
/// measures comes from a class derived.
template <class Filter>
class TurntableRun {
 public:
  using T = typename Filter::Scalar;

  TurntableRun(const TurntableRun&) = delete;
  TurntableRun& operator=(const TurntableRun&) = delete;
  virtual ~TurntableRun() = default;

  /// Ends early where the filter is lost.
  PointsResult run(const std::vector<TurntablePose>& poses) {
    const double dt = 1.0 / scenario_.motion.fps;
    for (std::size_t k = 0; k < poses.size() && !result_.lost; ++k) {
      PointsFrame frame;
      frame.t_s = static_cast<double>(k) / scenario_.motion.fps;
      if (k > 0) {
        timed([&] { (void)filter_->predict(static_cast<T>(dt)); });
        matches_.clear();
        search(k);
        timed([&] { update(frame); });
      }
      timed([&] { (void)filter_->prune(FeaturePolicy{}, 1); });
      add_features(k);
      compare_with_truth(*filter_, poses.front(), poses[k], frame, result_);
      result_.frames.push_back(frame);
    }
    summarise_run(*filter_, scenario_.focal_px, result_);
    return result_;
  }

 protected:
  /// Throws std::invalid_argument where the filter refuses its parameters.
  TurntableRun(const PointsScenario& scenario, const MonoParameters<T>& parameters)
      : scenario_(scenario),
        filter_(std::make_unique<Filter>()),
        random_(scenario.seed * 77U + 5U) {
    if (!ok(filter_->initialise(believed_camera<T>(scenario), parameters))) {
      throw std::invalid_argument("turntable: impossible filter parameters");
    }
  }

  /// Fills matches_ with what frame `k` shows of the filter's features.
  virtual void search(std::size_t k) = 0;
  virtual void add_features(std::size_t k) = 0;

  /// Features that frame `k` is short of.
  int wanted() const { return scenario_.wanted_features - measured_; }
  /// Counts as the filter's time.
  template <class Work>
  void timed(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const auto end = std::chrono::steady_clock::now();
    result_.mean_filter_us += std::chrono::duration<double, std::micro>(end - begin).count();
  }

  PointsScenario scenario_;
  std::unique_ptr<Filter> filter_;
  std::vector<PixelMatch<T>> matches_;
  PointsResult result_;

 private:
  void update(PointsFrame& frame) {
    UpdateReport report;
    const Status status =
        filter_->update(matches_.data(), static_cast<int>(matches_.size()), random_, report);
    if (!ok(status)) ++result_.no_consensus;
    result_.mean_hypotheses += report.hypotheses;
    frame.inliers = report.low_innovation + report.high_innovation;
    frame.nis = static_cast<double>(report.nis);
    frame.nis_dof = report.nis_dof;
    measured_ = frame.inliers;
  }

  Random random_;
  int measured_ = 0;
};

}  // namespace cairn::host
