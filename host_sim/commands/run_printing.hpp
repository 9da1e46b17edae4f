#pragma once

#include <optional>

#include <nlohmann/json.hpp>

#include "cairn/tracking/handheld_gyro.hpp"

#include "host_sim/running/mount_run.hpp"

namespace cairn::host {

/// What a run prints at its end: the five stages beside the paper's Table 1, the figures of
/// `summary` (summary.json), and the verdict's points that are not good.
void print_summary(const nlohmann::json& summary);

/// In the order in which they are printed.
inline constexpr MountOffset::Part kMountParts[] = {MountOffset::kYaw, MountOffset::kPitch,
                                                    MountOffset::kRoll, MountOffset::kFocal};

/// A line for each part of mount and camera that the pictures contradict.
void print_suspicions(const std::optional<MountOffset>& offset);
/// A line where speed or camera height do not fit the ground.
void print_suspicion(const std::optional<GroundCheck>& ground);
/// A line where odometry turns otherwise than the pictures.
void print_suspicion(const std::optional<YawCheck>& yaw);
/// What a gyroscope was worth, where there was one.
void print_gyro(const std::optional<GyroReport>& gyro);

}  // namespace cairn::host
