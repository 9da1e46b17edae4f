#include "host_sim/experiments/consistency/operation_count.hpp"

#include <limits>
#include <memory>
#include <vector>

#include "host_sim/experiments/consistency/counted.hpp"
// The counting scalar must be known before the filters' templates are read.
#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "host_sim/experiments/consistency/core_filters.hpp"

namespace cairn {

template <>
Displacement<host::Counted> displacement(const PlanarIncrement<host::Counted>& increment) {
  Displacement<host::Counted> d;
  d.by_distance = {host::Counted(1), host::Counted(0)};
  d.u = {increment.distance_m, host::Counted(0)};
  return d;
}

template <>
Status validate(const PlanarIncrement<host::Counted>&) {
  return Status::kOk;
}

}  // namespace cairn

namespace cairn::host {
namespace {

PlanarIncrement<Counted> counted(const Increment& step) {
  PlanarIncrement<Counted> result;
  result.distance_m = step.distance_m;
  result.turn_rad = step.turn_rad;
  result.covariance = step.covariance.cast<Counted>();
  return result;
}

template <class Filter>
void update(Filter& filter, const SimulatedStep& step, double sigma) {
  const Matrix2<Counted> noise =
      Eigen::Matrix2d(sigma * sigma * Eigen::Matrix2d::Identity()).cast<Counted>();
  std::vector<PointObservation<Counted>> observations;
  for (const auto& s : step.sightings) {
    PointObservation<Counted> observation;
    observation.id = static_cast<LandmarkId>(s.landmark + 1);
    observation.y = s.point.cast<Counted>();
    observation.R = noise;
    observations.push_back(observation);
  }
  UpdateReport report;
  (void)filter.update_points({observations.data(), static_cast<int>(observations.size())}, report);
  for (const auto& o : observations) {
    if (filter.find(o.id) < 0) (void)filter.add_landmark(o.id, o.y, noise);
  }
}

/// `more`: further settings of the filter's initialise().
template <class Filter, class... More>
OperationCount count(const SimulationConfig& config, const More&... more) {
  const SimulatedRun run = simulate_run(config, 1, 0);
  const auto filter = std::make_unique<Filter>();
  PlanarParameters<Counted> parameters;
  parameters.gate = 1e30;
  parameters.reacquire_after = 0;
  cairn::PlanarPose<Counted> start;
  start.position = run.estimated_start.position.cast<Counted>();
  start.heading = run.estimated_start.heading;
  (void)filter->initialise(start, run.start_covariance.cast<Counted>(), parameters, more...);

  double predict = 0.0;
  double update_sum = 0.0;
  int predictions = 0;
  int updates = 0;
  const bool last_loop_only = config.loops > 1;
  for (int k = 0; k < config.steps(); ++k) {
    const SimulatedStep& step = run.steps[static_cast<std::size_t>(k)];
    const bool counts = !last_loop_only || k >= config.steps() - config.steps_per_loop();
    Counted::reset();
    (void)filter->predict(counted(step.odometry));
    if (counts) {
      predict += static_cast<double>(Counted::operations());
      ++predictions;
    }
    if (!step.has_update) continue;
    Counted::reset();
    update(*filter, step, config.observation_sigma_m);
    if (counts) {
      update_sum += static_cast<double>(Counted::operations());
      ++updates;
    }
  }
  return {predict / predictions, update_sum / updates};
}

}  // namespace

OperationCount count_operations(const std::string& filter, const SimulationConfig& simulation) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  if (simulation.landmarks > kSimulatedCapacity) return {kUnknown, kUnknown};
  if (filter == "ekf") return count<EkfSlam<Counted, kSimulatedCapacity>>(simulation);
  if (filter == "group-iekf") return count<GroupIekfSlam<Counted, kSimulatedCapacity>>(simulation);
  if (filter == "lifted-iekf") {
    return count<LiftedIekfSlam<Counted, kSimulatedCapacity>>(simulation);
  }
  if (filter == "lifted-iekf-moments") {
    LiftedParameters lifted;
    lifted.exact_moments = true;
    return count<LiftedIekfSlam<Counted, kSimulatedCapacity>>(simulation, lifted);
  }
  return {kUnknown, kUnknown};
}

}  // namespace cairn::host
