#pragma once

#include <memory>

#include "host_sim/options/run_options.hpp"
#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// The source with the gyroscope's samples that --gyro asks for, its noise and mounting by the
/// options, else by the file of its IMU, else by the camera file and the tracker's defaults. Throws
/// UsageError where the mounting is not known, InputError for files that cannot be read.
std::unique_ptr<FrameSource> with_gyro(std::unique_ptr<FrameSource> source,
                                       const RunOptions& options);

}  // namespace cairn::host
