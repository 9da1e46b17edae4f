#include "host_sim/recorded/recorded_filter.hpp"

#include <cmath>

#include <fmt/format.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

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

constexpr int kSmallMap = 32;
constexpr int kLargeMap = 768;
constexpr int kLargeLiftedMap = 192;  ///< six states a landmark and a transition over all of them

}  // namespace

std::unique_ptr<RecordedFilter> make_recorded_filter(const std::string& name, bool large) {
  if (name == "group-iekf") {
    if (large) return std::make_unique<CoreFilter<GroupIekfSlam<double, kLargeMap>>>();
    return std::make_unique<CoreFilter<GroupIekfSlam<double, kSmallMap>>>();
  }
  if (name == "ekf") {
    if (large) return std::make_unique<CoreFilter<EkfSlam<double, kLargeMap>>>();
    return std::make_unique<CoreFilter<EkfSlam<double, kSmallMap>>>();
  }
  if (name == "lifted-iekf") {
    if (large) return std::make_unique<CoreFilter<LiftedIekfSlam<double, kLargeLiftedMap>>>();
    return std::make_unique<CoreFilter<LiftedIekfSlam<double, kSmallMap>>>();
  }
  throw UsageError(fmt::format(
      "--filter '{}': expected group-iekf, lifted-iekf or ekf for a landmark recording", name));
}

}  // namespace cairn::host
