#include "host_sim/recorded/recorded_filter.hpp"

#include <cmath>

#include <fmt/format.h>

#include "cairn/numeric/math.hpp"
#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_group_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "host_sim/base/fixed_planar.hpp"
#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

template <class Filter>
class CoreFilter final : public RecordedFilter {
 public:
  CoreFilter() : filter_(std::make_unique<Filter>()) {}

  Status initialise(const Pose2& pose, const Eigen::Matrix3d& covariance,
                    const PlanarParameters<double>& parameters) override {
    return filter_->initialise(pose, covariance, parameters);
  }
  Status predict(const PlanarIncrement<double>& increment) override {
    return filter_->predict(increment);
  }
  Status widen_pose(double position_variance, double heading_variance) override {
    return filter_->widen_pose(position_variance, heading_variance);
  }
  Status update(const std::vector<RangeBearingObservation<double>>& observations,
                double sensor_offset_m, UpdateReport& report) override {
    const int count = static_cast<int>(observations.size());
    return filter_->update_range_bearing({observations.data(), count}, sensor_offset_m, report);
  }
  Status add_landmark(LandmarkId id, const Eigen::Vector2d& y_vehicle,
                      const Eigen::Matrix2d& covariance, LandmarkId* replaced) override {
    return filter_->add_landmark(id, y_vehicle, covariance, replaced);
  }
  Status remove_landmark(LandmarkId id) override {
    return filter_->remove_landmark(filter_->find(id));
  }
  bool knows(LandmarkId id) const override { return filter_->find(id) >= 0; }

  bool distance(const RangeBearingObservation<double>& observation, double sensor_offset_m,
                double& squared, double& log_determinant) const override {
    RangeBearingPrediction<double> prediction;
    if (!ok(filter_->predict_range_bearing(filter_->find(observation.id), sensor_offset_m,
                                           observation.sigma_range, observation.sigma_bearing,
                                           prediction))) {
      return false;
    }
    const Eigen::Vector2d innovation(observation.range - prediction.range,
                                     wrap_angle(observation.bearing - prediction.bearing));
    squared = innovation.dot(prediction.covariance.ldlt().solve(innovation));
    log_determinant = std::log(prediction.covariance.determinant());
    return true;
  }

  Pose2 mean_pose() const override { return filter_->mean_pose(); }
  PoseEstimate estimate() const override {
    const auto pose = filter_->pose();
    return {{pose.position, pose.heading}, filter_->pose_covariance()};
  }
  std::vector<MappedLandmark> landmarks() const override {
    std::vector<MappedLandmark> map;
    map.reserve(static_cast<std::size_t>(filter_->landmark_count()));
    for (int slot = 0; slot < filter_->landmark_count(); ++slot) {
      map.push_back({filter_->landmark_id(slot), filter_->mean_landmark(slot),
                     filter_->landmark_covariance(slot)});
    }
    return map;
  }
  void positions(std::vector<LandmarkPosition>& map) const override {
    map.clear();
    for (int slot = 0; slot < filter_->landmark_count(); ++slot) {
      map.push_back({filter_->landmark_id(slot), filter_->mean_landmark(slot)});
    }
  }
  Health health() const override { return filter_->health(); }
  int landmark_count() const override { return filter_->landmark_count(); }

 private:
  std::unique_ptr<Filter> filter_;
};

/// A filter without floating point: what it gets is rounded to its formats.
template <class Filter>
class FixedFilter final : public RecordedFilter {
 public:
  FixedFilter() : filter_(std::make_unique<Filter>()) {}

  Status initialise(const Pose2& pose, const Eigen::Matrix3d& covariance,
                    const PlanarParameters<double>& parameters) override {
    FixedPlanarParameters fixed;
    fixed.gate = FixedScore::nearest(parameters.gate);
    fixed.reacquire_after = parameters.reacquire_after;
    fixed.reacquire_steps = parameters.reacquire_steps;
    fixed.reacquire_position = FixedLength::nearest(parameters.reacquire_position_m);
    fixed.reacquire_heading = FixedAngle::nearest(parameters.reacquire_heading_rad);
    fixed.reacquire_landmark_after = parameters.reacquire_landmark_after;
    fixed.reacquire_landmark = FixedLength::nearest(parameters.reacquire_landmark_m);
    fixed.replace_after = parameters.replace_after;
    fixed.rest_sigmas = FixedScore::nearest(parameters.rest_sigmas);
    return filter_->initialise(to_fixed(pose), to_fixed(covariance), fixed);
  }
  Status predict(const PlanarIncrement<double>& increment) override {
    return filter_->predict(to_fixed(increment));
  }
  Status widen_pose(double position_variance, double heading_variance) override {
    return filter_->widen_pose(FixedVariance::nearest(position_variance),
                               FixedVariance::nearest(heading_variance));
  }
  Status update(const std::vector<RangeBearingObservation<double>>& observations,
                double sensor_offset_m, UpdateReport& report) override {
    observations_.clear();
    for (const auto& o : observations) {
      observations_.push_back(
          {o.id, FixedLength::nearest(o.range), FixedAngle::nearest(wrap_angle(o.bearing)),
           FixedLength::nearest(o.sigma_range), FixedAngle::nearest(o.sigma_bearing)});
    }
    FixedUpdateReport fixed;
    const Status status = filter_->update_range_bearing(
        {observations_.data(), static_cast<int>(observations_.size())},
        FixedLength::nearest(sensor_offset_m), fixed);
    report.matches = fixed.matches;
    report.gated = fixed.gated;
    report.nis = static_cast<float>(fixed.nis.to_double());
    report.nis_dof = fixed.nis_dof;
    return status;
  }
  Status add_landmark(LandmarkId id, const Eigen::Vector2d& y_vehicle,
                      const Eigen::Matrix2d& covariance, LandmarkId* replaced) override {
    return filter_->add_landmark(id, FixedLength::nearest(y_vehicle.x()),
                                 FixedLength::nearest(y_vehicle.y()), to_fixed(covariance),
                                 replaced);
  }
  Status remove_landmark(LandmarkId id) override {
    return filter_->remove_landmark(filter_->find(id));
  }
  bool knows(LandmarkId id) const override { return filter_->find(id) >= 0; }

  bool distance(const RangeBearingObservation<double>& observation, double sensor_offset_m,
                double& squared, double& log_determinant) const override {
    FixedRangeBearingPrediction p;
    if (!ok(filter_->predict_range_bearing(filter_->find(observation.id),
                                           FixedLength::nearest(sensor_offset_m),
                                           FixedLength::nearest(observation.sigma_range),
                                           FixedAngle::nearest(observation.sigma_bearing), p))) {
      return false;
    }
    const Eigen::Vector2d innovation(observation.range - p.range.to_double(),
                                     wrap_angle(observation.bearing - p.bearing.to_double()));
    const Eigen::Matrix2d covariance =
        to_double(FixedCovariance2{p.range_variance, p.range_bearing, p.bearing_variance});
    squared = innovation.dot(covariance.ldlt().solve(innovation));
    log_determinant = std::log(covariance.determinant());
    return true;
  }

  Pose2 mean_pose() const override { return to_double(filter_->mean_pose()); }
  PoseEstimate estimate() const override {
    FixedPose mean;
    FixedPoseCovariance covariance;
    filter_->pose(mean, covariance);
    return {to_double(mean), to_double(covariance)};
  }
  std::vector<MappedLandmark> landmarks() const override {
    std::vector<MappedLandmark> map;
    map.reserve(static_cast<std::size_t>(filter_->landmark_count()));
    for (int slot = 0; slot < filter_->landmark_count(); ++slot) {
      map.push_back({filter_->landmark_id(slot), position_of(filter_->mean_landmark(slot)),
                     to_double(filter_->landmark(slot).covariance)});
    }
    return map;
  }
  void positions(std::vector<LandmarkPosition>& map) const override {
    map.clear();
    for (int slot = 0; slot < filter_->landmark_count(); ++slot) {
      map.push_back({filter_->landmark_id(slot), position_of(filter_->mean_landmark(slot))});
    }
  }
  Health health() const override { return filter_->health(); }
  std::uint32_t saturations() const override { return filter_->saturations(); }
  int landmark_count() const override { return filter_->landmark_count(); }

 private:
  std::unique_ptr<Filter> filter_;
  std::vector<FixedRangeBearingObservation> observations_;
};

constexpr int kSmallMap = 32;
constexpr int kLargeMap = 768;
constexpr int kLargeLiftedMap = 192;  ///< six states a landmark and a transition over all of them

}  // namespace

std::unique_ptr<RecordedFilter> make_recorded_filter(const std::string& name, bool large) {
  if (name == "group-iekf") {
    if (large) return std::make_unique<CoreFilter<GroupIekfSlam<double, kLargeMap>>>();
    return std::make_unique<CoreFilter<GroupIekfSlam<double, kSmallMap>>>();
  }
  if (name == "group-iekf-fixed") {
    if (large) return std::make_unique<FixedFilter<FixedGroupSlam<kLargeMap>>>();
    return std::make_unique<FixedFilter<FixedGroupSlam<kSmallMap>>>();
  }
  if (name == "ekf-fixed") {
    if (large) return std::make_unique<FixedFilter<FixedEkfSlam<kLargeMap>>>();
    return std::make_unique<FixedFilter<FixedEkfSlam<kSmallMap>>>();
  }
  if (name == "ekf") {
    if (large) return std::make_unique<CoreFilter<EkfSlam<double, kLargeMap>>>();
    return std::make_unique<CoreFilter<EkfSlam<double, kSmallMap>>>();
  }
  if (name == "lifted-iekf") {
    if (large) return std::make_unique<CoreFilter<LiftedIekfSlam<double, kLargeLiftedMap>>>();
    return std::make_unique<CoreFilter<LiftedIekfSlam<double, kSmallMap>>>();
  }
  throw UsageError(
      fmt::format("--filter '{}': expected group-iekf, lifted-iekf, ekf, group-iekf-fixed or "
                  "ekf-fixed for a landmark recording",
                  name));
}

}  // namespace cairn::host
