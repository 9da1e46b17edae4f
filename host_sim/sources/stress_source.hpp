#pragma once

#include <memory>

#include "host_sim/sources/frame_source.hpp"
#include "host_sim/world/stress_scene.hpp"

namespace cairn::host {

/// The scene that `text` describes: fields as NAME=VALUE with commas between, or nothing for the
/// default. Throws UsageError, listing the fields, for anything else.
StressScene parse_stress_scene(const std::string& text);

/// Frames of a synthetic input made to be expensive, with exact odometry in vehicle mode. No truth.
std::unique_ptr<FrameSource> make_stress_source(const StressScene& scene);

}  // namespace cairn::host
