#pragma once

#include <string>

#include "host_sim/planar/simulation.hpp"

namespace cairn::host {

struct OperationCount {
  double per_predict = 0.0;
  double per_update = 0.0;
};
OperationCount count_operations(const std::string& filter, const SimulationConfig& simulation);

}  // namespace cairn::host
