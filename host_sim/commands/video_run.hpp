#pragma once

#include <memory>

#include "host_sim/options/exit_code.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// `cairn_sim run` on a source of pictures: tracks, writes the files of a run
/// (docs/reference/outputs.md) into `options.out`, prints the stages' table.
ExitCode run_source(std::unique_ptr<FrameSource> opened, const RunOptions& options);

}  // namespace cairn::host
