#pragma once

#include <memory>
#include <vector>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// `source` with a gyroscope's samples: each frame gets those since the frame before, the first one
/// those of the tenth of a second before it. `path` is for messages. Throws InputError where
/// samples follow one another in other steps than 0.1 ms to the gap that parts them
/// (GyroParameters::max_gap_us): their unit is another; and, naming both spans, where they cover
/// less than a tenth of the frames' time. A source that does not know its frames' time is damaged
/// at its end when no frame had a sample.
std::unique_ptr<FrameSource> add_gyro(std::unique_ptr<FrameSource> source,
                                      std::vector<AngularRateSample> samples,
                                      const GyroParameters& parameters,
                                      const std::filesystem::path& path);

}  // namespace cairn::host
