#pragma once

#include <string>

#include "host_sim/options/exit_code.hpp"
#include "host_sim/options/run_options.hpp"

namespace cairn::host {

/// `cairn_sim run lost-in-the-woods:DIR`, `mrclam:DIR:ROBOT` and `victoria-park:DIR`.
ExitCode run_lost_in_the_woods(const RunOptions& options, const std::string& argument);
ExitCode run_mrclam(const RunOptions& options, const std::string& argument);
ExitCode run_victoria_park(const RunOptions& options, const std::string& argument);

}  // namespace cairn::host
