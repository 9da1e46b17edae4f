#include "host_sim/experiments/consistency/core_filters.hpp"

#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "host_sim/base/fixed_planar.hpp"

namespace cairn::host {
namespace {

void check(Status status, const char* what) {
  if (!ok(status)) throw std::runtime_error(fmt::format("{}: {}", what, to_string(status)));
}

LandmarkId to_id(int landmark) {
  return static_cast<LandmarkId>(landmark + 1);
}

/// `More`: further settings of the filter's initialise().
template <class Filter, class... More>
class SimulatedCoreFilter final : public FilterUnderTest {
  using T = typename Filter::Scalar;

 public:
  explicit SimulatedCoreFilter(const More&... more)
      : filter_(std::make_unique<Filter>()), more_(more...) {
    parameters_.gate = T(1e30);
    parameters_.reacquire_after = 0;
  }

  void initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) override {
    const auto start = [&](const More&... more) {
      PlanarPose<T> start_pose;
      start_pose.position = pose.position.cast<T>();
      start_pose.heading = static_cast<T>(pose.heading);
      return filter_->initialise(start_pose, covariance.cast<T>(), parameters_, more...);
    };
    check(std::apply(start, more_), "initialise");
  }
  void predict(const Increment& step) override {
    PlanarIncrement<T> increment;
    increment.distance_m = static_cast<T>(step.distance_m);
    increment.turn_rad = static_cast<T>(step.turn_rad);
    increment.covariance = step.covariance.cast<T>();
    increment.model = step.model;
    check(filter_->predict(increment), "predict");
  }

  void update(const std::vector<PointSighting>& sightings, double sigma_m) override {
    const Matrix2<T> noise =
        Eigen::Matrix2d(sigma_m * sigma_m * Eigen::Matrix2d::Identity()).cast<T>();
    observations_.clear();
    for (const auto& s : sightings) {
      PointObservation<T> observation;
      observation.id = to_id(s.landmark);
      observation.y = s.point.cast<T>();
      observation.R = noise;
      observations_.push_back(observation);
    }
    UpdateReport report;
    const int count = static_cast<int>(observations_.size());
    check(filter_->update_points({observations_.data(), count}, report), "update_points");
    for (const auto& s : sightings) {
      if (filter_->find(to_id(s.landmark)) >= 0) continue;
      check(filter_->add_landmark(to_id(s.landmark), s.point.cast<T>(), noise), "add_landmark");
    }
  }

  PoseEstimate pose() const override {
    const auto mean = filter_->pose();
    PoseEstimate estimate;
    estimate.pose.position = mean.position.template cast<double>();
    estimate.pose.heading = static_cast<double>(mean.heading);
    estimate.covariance = filter_->pose_covariance().template cast<double>();
    return estimate;
  }
  bool landmark(int landmark, LandmarkEstimate& estimate) const override {
    const int slot = filter_->find(to_id(landmark));
    if (slot < 0) return false;
    estimate = {filter_->landmark_position(slot).template cast<double>(),
                filter_->landmark_covariance(slot).template cast<double>()};
    return true;
  }
  int dimension() const override { return filter_->state_size(); }

 private:
  std::unique_ptr<Filter> filter_;
  PlanarParameters<T> parameters_;
  std::tuple<More...> more_;
  std::vector<PointObservation<T>> observations_;
};

/// A filter without floating point: what it gets is rounded to its formats.
template <class Filter>
class SimulatedFixedFilter final : public FilterUnderTest {
 public:
  SimulatedFixedFilter() : filter_(std::make_unique<Filter>()) {
    parameters_.gate = FixedScore::most();
    parameters_.reacquire_after = 0;
  }

  void initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) override {
    check(filter_->initialise(to_fixed(pose), to_fixed(covariance), parameters_), "initialise");
  }
  void predict(const Increment& step) override {
    check(filter_->predict(to_fixed(step)), "predict");
  }
  void update(const std::vector<PointSighting>& sightings, double sigma_m) override {
    const Eigen::Matrix2d noise = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
    observations_.clear();
    for (const auto& s : sightings) {
      FixedPointObservation observation;
      observation.id = to_id(s.landmark);
      observation.x = FixedLength::nearest(s.point.x());
      observation.y = FixedLength::nearest(s.point.y());
      observation.noise = to_fixed(noise);
      observations_.push_back(observation);
    }
    FixedUpdateReport report;
    const int count = static_cast<int>(observations_.size());
    check(filter_->update_points({observations_.data(), count}, report), "update_points");
    for (const auto& o : observations_) {
      if (filter_->find(o.id) >= 0) continue;
      check(filter_->add_landmark(o.id, o.x, o.y, o.noise), "add_landmark");
    }
  }

  PoseEstimate pose() const override {
    FixedPose mean;
    FixedPoseCovariance covariance;
    filter_->pose(mean, covariance);
    return {to_double(mean), to_double(covariance)};
  }
  bool landmark(int landmark, LandmarkEstimate& estimate) const override {
    const int slot = filter_->find(to_id(landmark));
    if (slot < 0) return false;
    const FixedLandmark found = filter_->landmark(slot);
    estimate = {position_of(found), to_double(found.covariance)};
    return true;
  }
  int dimension() const override { return filter_->state_size(); }
  std::int64_t saturations() const override { return filter_->saturations(); }

 private:
  std::unique_ptr<Filter> filter_;
  FixedPlanarParameters parameters_;
  std::vector<FixedPointObservation> observations_;
};

}  // namespace

std::unique_ptr<FilterUnderTest> make_core_ekf() {
  return std::make_unique<SimulatedCoreFilter<EkfSlam<double, kSimulatedCapacity>>>();
}

std::unique_ptr<FilterUnderTest> make_core_group_iekf() {
  return std::make_unique<SimulatedCoreFilter<GroupIekfSlam<double, kSimulatedCapacity>>>();
}

std::unique_ptr<FilterUnderTest> make_core_ekf_float() {
  return std::make_unique<SimulatedCoreFilter<EkfSlam<float, kSimulatedCapacity>>>();
}

std::unique_ptr<FilterUnderTest> make_core_group_iekf_float() {
  return std::make_unique<SimulatedCoreFilter<GroupIekfSlam<float, kSimulatedCapacity>>>();
}

std::unique_ptr<FilterUnderTest> make_core_group_iekf_fixed() {
  return std::make_unique<SimulatedFixedFilter<FixedGroupSlam<kSimulatedCapacity>>>();
}

std::unique_ptr<FilterUnderTest> make_core_ekf_fixed() {
  return std::make_unique<SimulatedFixedFilter<FixedEkfSlam<kSimulatedCapacity>>>();
}

std::unique_ptr<FilterUnderTest> make_core_lifted_iekf() {
  return std::make_unique<SimulatedCoreFilter<LiftedIekfSlam<double, kSimulatedCapacity>>>();
}

std::unique_ptr<FilterUnderTest> make_core_lifted_iekf_moments() {
  LiftedParameters lifted;
  lifted.exact_moments = true;
  using Filter = LiftedIekfSlam<double, kSimulatedCapacity>;
  return std::make_unique<SimulatedCoreFilter<Filter, LiftedParameters>>(lifted);
}

}  // namespace cairn::host
