#pragma once

#include <memory>
#include <vector>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// `source` with a gyroscope's samples: each frame gets those since the frame before, the first one
/// those of the tenth of a second before it. `path` is for messages. Throws InputError where no
/// sample lies within the frames' times, if those are known when they come to their end.
std::unique_ptr<FrameSource> add_gyro(std::unique_ptr<FrameSource> source,
                                      std::vector<AngularRateSample> samples,
                                      const GyroParameters& parameters,
                                      const std::filesystem::path& path);

}  // namespace cairn::host
