#include "host_sim/mono/points_simulation.hpp"

#include <chrono>
#include <cmath>
#include <memory>
#include <set>

#include <Eigen/Dense>

#include "cairn/mono/mono_bank.hpp"
#include "cairn/mono/mono_ekf.hpp"

#include "host_sim/mono/points_world.hpp"

namespace cairn::host {
namespace {

constexpr int kMaxFeatures = 40;
constexpr int kMaxAnchors = 10;
constexpr double kLostDeg = 20.0;

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
    PinholeCamera<T> camera;
    camera.fx = camera.fy = static_cast<T>(scenario.focal_px * (1.0 + scenario.focal_error));
    camera.cx = static_cast<T>(0.5 * (scenario.width - 1) + scenario.principal_error_px);
    camera.cy = static_cast<T>(0.5 * (scenario.height - 1));
    camera.width = scenario.width;
    camera.height = scenario.height;
    if (!ok(filter_->initialise(camera, parameters))) {
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
      compare(poses_[k], frame);
      result_.frames.push_back(frame);
    }
    summarise();
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
      const Eigen::Vector2d box(30.0 + world_.uniform() * (scenario_.width - 60),
                                30.0 + world_.uniform() * (scenario_.height - 60));
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

  void compare(const TurntablePose& pose, PointsFrame& frame) {
    const TurntablePose& first = poses_.front();
    const Rigid<T> estimate = filter_->T_world_camera();
    const Eigen::Matrix3d relative = estimate.rotation.toRotationMatrix().template cast<double>();
    const Eigen::Matrix3d rotation = first.rotation * relative;
    frame.true_yaw_deg = pose.yaw_deg;
    frame.yaw_error_deg = std::remainder(yaw_deg(rotation) - yaw_deg(pose.rotation), 360.0);
    frame.pitch_error_deg = pitch_deg(rotation) - pitch_deg(pose.rotation);
    const Eigen::AngleAxisd error(rotation.transpose() * pose.rotation);
    frame.attitude_error_deg = rotation_angle_deg(error.toRotationMatrix());
    const Eigen::Matrix3d covariance =
        filter_->pose_covariance().template cast<double>().template bottomRightCorner<3, 3>();
    const Eigen::Vector3d phi = error.angle() * error.axis();
    frame.attitude_nees =
        phi.dot((covariance + 1e-16 * Eigen::Matrix3d::Identity()).inverse() * phi);
    frame.features = filter_->feature_count();
    frame.fading_factor = static_cast<double>(filter_->last_fading_factor());
    result_.mean_features += frame.features;
    result_.lost = !std::isfinite(frame.attitude_error_deg) || frame.attitude_error_deg > kLostDeg;

    const Eigen::Vector3d moved = estimate.translation.template cast<double>();
    const Eigen::Vector3d truth = first.rotation.transpose() * (pose.position - first.position);
    result_.final_distance_m = moved.norm();
    if (truth.norm() > 0.01) result_.displacement_ratio = moved.dot(truth) / truth.squaredNorm();
  }

  void summarise() {
    PointsResult& r = result_;
    const auto n = static_cast<double>(r.frames.size());
    double nis = 0.0;
    double dof = 0.0;
    for (const PointsFrame& f : r.frames) {
      const double yaw = std::abs(f.yaw_error_deg);
      r.max_yaw_error_deg = std::max(r.max_yaw_error_deg, yaw);
      r.mean_yaw_error_deg += yaw / n;
      r.mse_yaw_error_deg2 += yaw * yaw / n;
      r.mean_pitch_error_deg += std::abs(f.pitch_error_deg) / n;
      r.mean_attitude_error_deg += f.attitude_error_deg / n;
      r.max_attitude_error_deg = std::max(r.max_attitude_error_deg, f.attitude_error_deg);
      r.mean_nees += (&f == r.frames.data() ? 0.0 : f.attitude_nees) / n;
      nis += f.nis;
      dof += f.nis_dof;
    }
    r.final_yaw_error_deg = r.frames.back().yaw_error_deg;
    r.mean_nis = dof > 0.0 ? nis / dof : 0.0;
    r.focal_factor = static_cast<double>(filter_->camera().fx) / scenario_.focal_px;
    r.mean_hypotheses /= n;
    r.mean_features /= n;
    r.mean_filter_us /= n;
    r.wrong_inliers /= std::max(1, used_);
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
