#pragma once

#include <CLI/CLI.hpp>

#include "host_sim/options/run_options.hpp"

namespace cairn::host {

/// --first-frame and --max-frames.
void add_range_options(CLI::App& command, RunOptions& options);

/// How a source's pictures are read, in every command that takes one: camera file or guess, times,
/// truth, crop and scale.
void add_picture_options(CLI::App& command, RunOptions& options);

/// --gyro and what is said of it, in the commands that track hand-held.
void add_gyro_options(CLI::App& command, RunOptions& options);

/// --odometry of a video and its noise, in the commands that have a vehicle mode.
void add_odometry_options(CLI::App& command, RunOptions& options);

}  // namespace cairn::host
