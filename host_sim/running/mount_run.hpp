#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cairn/tracking/ground_check.hpp"
#include "cairn/tracking/mount_evidence.hpp"

#include "host_sim/sources/frame_source.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// What a drive says of the camera's mount.
struct MountRun {
  MountOffset offset;
  std::optional<GroundCheck> ground;
  std::optional<YawCheck> yaw;
  int frames = 0;
  int tracked = 0;
  std::uint32_t suspect_frames = 0;  ///< frames in which a part was suspect, now or for a time
};

/// Drives `tracker` over `first` and the rest of `source`. Domain: a tracker of Mode::kVehicle.
MountRun run_for_mount(FrameSource& source, Frame& first, Tracker& tracker);

/// A part of the offset in words, a line without its end: "yaw +4.1 +- 0.3 deg  suspect". Degrees,
/// or percent of the focal length.
std::string describe(const MountOffset& offset, MountOffset::Part part);

/// What being off in this part means, and what else looks the same.
const char* meaning_of(MountOffset::Part part);

}  // namespace cairn::host
