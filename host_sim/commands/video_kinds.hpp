#pragma once

#include <string>

#include "host_sim/options/exit_code.hpp"
#include "host_sim/options/run_options.hpp"

namespace cairn::host {

/// `cairn_sim run` on sources that give pictures. Each opens its source and hands it to
/// run_source().
ExitCode run_hall(const RunOptions& options, const std::string& argument);
ExitCode run_hall_small(const RunOptions& options, const std::string& argument);
ExitCode run_hall_hand(const RunOptions& options, const std::string& argument);
/// `fields`: of the StressScene, NAME=VALUE,...
ExitCode run_stress(const RunOptions& options, const std::string& fields);
ExitCode run_seven_scenes(const RunOptions& options, const std::string& folder);
ExitCode run_tag_board(const RunOptions& options, const std::string& folder);
ExitCode run_kitti(const RunOptions& options, const std::string& folder);
ExitCode run_tum_rgbd(const RunOptions& options, const std::string& folder);
ExitCode run_euroc(const RunOptions& options, const std::string& folder);
ExitCode run_video(const RunOptions& options, const std::string& media);
/// `device`: a number, a device's file or an address.
ExitCode run_camera(const RunOptions& options, const std::string& device);

}  // namespace cairn::host
