#include "host_sim/mono/points_simulation.hpp"

#include <chrono>
#include <cmath>
#include <memory>
#include <set>

#include <Eigen/Dense>

#include "cairn/mono/mono_bank.hpp"
#include "cairn/mono/mono_ekf.hpp"

#include "host_sim/mono/points_world.hpp"
#include "host_sim/mono/turntable_score.hpp"

namespace cairn::host {
namespace {

constexpr int kMaxFeatures = 40;
constexpr int kMaxAnchors = 10;

/// Filter, world and truth of one run.
template <class Filter>
class PointsRun {
  using T = typename Filter::Scalar;

 public:
  PointsRun(const PointsScenario& scenario, const MonoParameters<T>& parameters)
      : scenario_(scenario),
        world_(scenario),
        poses_(turntable_poses(scenario.motion)),
        filter_(std::make_unique<Filter>()),
        random_(scenario.seed * 77U + 5U) {
    if (!ok(filter_->initialise(believed_camera<T>(scenario), parameters))) {
      throw std::invalid_argument("points simulation: impossible filter parameters");
    }
  }

  PointsResult run() {
    const T dt = static_cast<T>(1.0 / scenario_.motion.fps);
    for (std::size_t k = 0; k < poses_.size() && !result_.lost; ++k) {
      PointsFrame frame;
      frame.t_s = static_cast<double>(k) / scenario_.motion.fps;
      if (k > 0) {
        timed([&] { (void)filter_->predict(dt); });
        search(poses_[k]);
        timed([&] { update(frame); });
      }
      timed([&] { (void)filter_->prune(FeaturePolicy{}, 1); });
      add_features(poses_[k]);
      compare_with_truth(*filter_, poses_.front(), poses_[k], frame, result_);
      result_.frames.push_back(frame);
    }
    summarise_run(*filter_, scenario_.focal_px, used_, result_);
    return result_;
  }

 private:
  template <class Work>
  void timed(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const auto end = std::chrono::steady_clock::now();
    result_.mean_filter_us += std::chrono::duration<double, std::micro>(end - begin).count();
  }

  /// Matches inside the 99 % ellipses: true ones, wrong ones, and now and then one of a point that
  /// is hidden.
  void search(const TurntablePose& pose) {
    matches_.clear();
    wrong_.clear();
    timed([&] {
      predictions_.clear();
      for (int slot = 0; slot < filter_->feature_count(); ++slot) {
        PixelPrediction<T> prediction;
        if (ok(filter_->predict_feature(slot, prediction))) predictions_.push_back(prediction);
      }
    });
    for (const PixelPrediction<T>& p : predictions_) {
      const Eigen::Matrix2d s = p.covariance.template cast<double>();
      const Eigen::Vector2d expected = p.pixel.template cast<double>();
      const int index = static_cast<int>(p.id) - 1;
      Eigen::Vector2d pixel;
      const bool visible = world_.see(index, pose, pixel);
      const bool wrong = world_.uniform() < scenario_.outlier_share;
      if (!visible && world_.uniform() < 0.7) continue;
      if (wrong || !visible) {
        for (int i = 0; i < 2; ++i) {
          pixel(i) = expected(i) + (2.0 * world_.uniform() - 1.0) * 2.45 * std::sqrt(s(i, i));
        }
      } else {
        pixel = world_.measure(index, pixel);
      }
      const Eigen::Vector2d nu = pixel - expected;
      if (nu.dot(s.inverse() * nu) > kChi2Dof2Level99) continue;
      PixelMatch<T> match;
      match.id = p.id;
      match.slot = p.slot;
      match.pixel = pixel.cast<T>();
      matches_.push_back(match);
      wrong_.push_back(wrong || !visible);
    }
  }

  void update(PointsFrame& frame) {
    UpdateReport report;
    const Status status =
        filter_->update(matches_.data(), static_cast<int>(matches_.size()), random_, report);
    if (!ok(status)) ++result_.no_consensus;
    result_.mean_hypotheses += report.hypotheses;
    frame.inliers = report.low_innovation + report.high_innovation;
    frame.nis = report.nis;
    frame.nis_dof = report.nis_dof;
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      if (matches_[i].inlier) ++used_;
      if (matches_[i].inlier && wrong_[i]) result_.wrong_inliers += 1.0;
    }
    measured_ = frame.inliers;
  }

  /// Births in empty parts of the image until the wanted number is measured.
  void add_features(const TurntablePose& pose) {
    constexpr double kHalfWidth = 22.0;
    constexpr double kHalfHeight = 18.0;
    std::set<int> used;
    std::vector<Eigen::Vector2d> occupied;
    for (int slot = 0; slot < filter_->feature_count(); ++slot) {
      used.insert(static_cast<int>(filter_->feature_id(slot)) - 1);
      PixelPrediction<T> prediction;
      if (ok(filter_->predict_feature(slot, prediction))) {
        occupied.push_back(prediction.pixel.template cast<double>());
      }
    }
    const auto inside = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return std::abs(a.x() - b.x()) < kHalfWidth && std::abs(a.y() - b.y()) < kHalfHeight;
    };
    int wanted = scenario_.wanted_features - measured_;
    for (int attempt = 0; attempt < 60 && wanted > 0; ++attempt) {
      const double y = 30.0 + world_.uniform() * (scenario_.height - 60);
      const Eigen::Vector2d box(30.0 + world_.uniform() * (scenario_.width - 60), y);
      bool taken = false;
      for (const Eigen::Vector2d& pixel : occupied) taken = taken || inside(pixel, box);
      if (taken) continue;
      const int start = static_cast<int>(world_.uniform() * world_.point_count());
      for (int i = 0; i < world_.point_count(); ++i) {
        const int index = (start + i) % world_.point_count();
        Eigen::Vector2d pixel;
        if (used.count(index) != 0U || !world_.see(index, pose, pixel) || !inside(pixel, box)) {
          continue;
        }
        world_.forget_drift(index);
        pixel = world_.measure(index, pixel);
        bool added = false;
        timed([&] {
          added = ok(filter_->add_feature(static_cast<LandmarkId>(index + 1), pixel.cast<T>()));
        });
        if (added) {
          used.insert(index);
          occupied.push_back(pixel);
          --wanted;
        }
        break;
      }
    }
  }

  PointsScenario scenario_;
  PointsWorld world_;
  std::vector<TurntablePose> poses_;
  std::unique_ptr<Filter> filter_;
  Random random_;
  std::vector<PixelPrediction<T>> predictions_;
  std::vector<PixelMatch<T>> matches_;
  std::vector<bool> wrong_;
  int measured_ = 0;
  int used_ = 0;
  PointsResult result_;
};

}  // namespace

template <class T>
PointsResult run_points(const PointsScenario& scenario, const MonoParameters<T>& parameters,
                        bool bank) {
  if (bank) {
    return PointsRun<MonoBank<T, kMaxFeatures, kMaxAnchors>>(scenario, parameters).run();
  }
  return PointsRun<MonoEkf<T, kMaxFeatures, kMaxAnchors>>(scenario, parameters).run();
}

template PointsResult run_points<float>(const PointsScenario&, const MonoParameters<float>&, bool);
template PointsResult run_points<double>(const PointsScenario&, const MonoParameters<double>&,
                                         bool);

}  // namespace cairn::host
