#pragma once

#include <nlohmann/json.hpp>

#include "host_sim/running/runner.hpp"

namespace cairn::host {

// What a run says of its calibration, for summary.json.

/// What the pictures say of mount and focal length, degrees and percent; null in hand-held mode.
nlohmann::json mount_json(const RunRecord& record);
/// How high the camera is above the ground by the pictures, in heights that were told; null in
/// hand-held mode.
nlohmann::json ground_json(const RunRecord& record);
/// The focal length as a factor on what was told; null where it is not estimated.
nlohmann::json focal_json(const RunRecord& record);
/// Yaw rate of the odometry over that of the pictures; null in hand-held mode.
nlohmann::json yaw_json(const RunRecord& record);
/// How far to the left of the mount's axis the vehicle travels, degrees; null where that is not
/// estimated.
nlohmann::json travel_json(const RunRecord& record);
/// What is known of the gyroscope; null without one.
nlohmann::json gyro_json(const RunRecord& record);

}  // namespace cairn::host
