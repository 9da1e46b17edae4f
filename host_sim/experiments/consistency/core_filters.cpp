#include "host_sim/experiments/consistency/core_filters.hpp"

#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

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
 public:
  explicit SimulatedCoreFilter(const More&... more)
      : filter_(std::make_unique<Filter>()), more_(more...) {
    parameters_.gate = 1e30;
    parameters_.reacquire_after = 0;
  }

  void initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) override {
    const auto start = [&](const More&... more) {
      return filter_->initialise(pose, covariance, parameters_, more...);
    };
    check(std::apply(start, more_), "initialise");
  }
  void predict(const Increment& step) override { check(filter_->predict(step), "predict"); }

  void update(const std::vector<PointSighting>& sightings, double sigma_m) override {
    const Eigen::Matrix2d noise = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
    observations_.clear();
    for (const auto& s : sightings) {
      PointObservation<double> observation;
      observation.id = to_id(s.landmark);
      observation.y = s.point;
      observation.R = noise;
      observations_.push_back(observation);
    }
    UpdateReport report;
    const int count = static_cast<int>(observations_.size());
    check(filter_->update_points({observations_.data(), count}, report), "update_points");
    for (const auto& s : sightings) {
      if (filter_->find(to_id(s.landmark)) >= 0) continue;
      check(filter_->add_landmark(to_id(s.landmark), s.point, noise), "add_landmark");
    }
  }

  PoseEstimate pose() const override { return {filter_->pose(), filter_->pose_covariance()}; }
  bool landmark(int landmark, LandmarkEstimate& estimate) const override {
    const int slot = filter_->find(to_id(landmark));
    if (slot < 0) return false;
    estimate = {filter_->landmark_position(slot), filter_->landmark_covariance(slot)};
    return true;
  }
  int dimension() const override { return filter_->state_size(); }

 private:
  std::unique_ptr<Filter> filter_;
  PlanarParameters<double> parameters_;
  std::tuple<More...> more_;
  std::vector<PointObservation<double>> observations_;
};

}  // namespace

std::unique_ptr<FilterUnderTest> make_core_ekf() {
  return std::make_unique<SimulatedCoreFilter<EkfSlam<double, kSimulatedCapacity>>>();
}

std::unique_ptr<FilterUnderTest> make_core_group_iekf() {
  return std::make_unique<SimulatedCoreFilter<GroupIekfSlam<double, kSimulatedCapacity>>>();
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
