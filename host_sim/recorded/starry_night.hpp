#pragma once

#include <string>

#include "host_sim/options/exit_code.hpp"
#include "host_sim/options/run_options.hpp"

namespace cairn::host {

/// `cairn_sim run starry-night:DIR`: the monocular filter on point tracks without images. DIR holds
/// obs.csv (pixels of up to 20 landmarks, of a stereo head; the left ones are used) and gt_imu.csv
/// (true poses). Identities are known, so nothing is searched. Writes trajectory.tum, truth.tum,
/// summary.json and manifest.json; positions are compared after Sim(3) alignment.
ExitCode run_starry_night(const RunOptions& options, const std::string& folder);

}  // namespace cairn::host
