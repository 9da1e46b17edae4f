#pragma once

#include <string>

#include "host_sim/experiments/consistency/simulation.hpp"

namespace cairn::host {

/// Floating-point operations of one call, averaged over the second loop of run 0: what a filter
/// costs whatever it runs on.
struct OperationCount {
  double per_predict = 0.0;
  double per_update = 0.0;  ///< as many sightings as the world shows, 7.5 on average
};

/// Counts by running the core's template on a scalar that counts. Not a number for the reference
/// filters, which are dense and not written for speed, and for maps beyond kSimulatedCapacity.
OperationCount count_operations(const std::string& filter, const SimulationConfig& simulation);

}  // namespace cairn::host
