#pragma once

#include <nlohmann/json.hpp>

#include "host_sim/reports/run_trajectory.hpp"
#include "host_sim/running/runner.hpp"

namespace cairn::host {

/// summary.json; docs/reference/outputs.md describes each field.
nlohmann::json summarise(const RunRecord& record, const RunTrajectory& trajectory,
                         const RegistrationResult& registration, double budget_ms,
                         const SourceInfo& source);

/// Every counter by its name.
nlohmann::json to_json(const Health& health);

}  // namespace cairn::host
