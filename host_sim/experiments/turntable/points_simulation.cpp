#include "host_sim/experiments/turntable/points_simulation.hpp"

#include <cmath>
#include <set>

#include <Eigen/Dense>

#include "cairn/mono/mono_ekf.hpp"

#include "host_sim/experiments/turntable/mono_bank.hpp"
#include "host_sim/experiments/turntable/points_world.hpp"
#include "host_sim/experiments/turntable/turntable_run.hpp"

namespace cairn::host {
namespace {

constexpr int kMaxFeatures = 40;
constexpr int kMaxAnchors = 10;

/// A filter in a world of points.
template <class Filter>
class PointsRun : public TurntableRun<Filter> {
  using Run = TurntableRun<Filter>;
  using T = typename Run::T;

 public:
  PointsRun(const PointsScenario& scenario, const MonoParameters<T>& parameters)
      : Run(scenario, parameters), world_(scenario), poses_(turntable_poses(scenario.motion)) {}

  PointsResult run() { return Run::run(poses_); }

 private:
  using Run::filter_;
  using Run::matches_;
  using Run::scenario_;
  using Run::timed;

  /// Matches inside the 99 % ellipses: true ones, wrong ones, and now and then one of a point that
  /// is hidden.
  void search(std::size_t k) override {
    const TurntablePose& pose = poses_[k];
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
    }
  }

  /// Adds features in empty parts of the image until the wanted number is measured.
  void add_features(std::size_t k) override {
    const TurntablePose& pose = poses_[k];
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
    int wanted = Run::wanted();
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

  PointsWorld world_;
  std::vector<TurntablePose> poses_;
  std::vector<PixelPrediction<T>> predictions_;
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
