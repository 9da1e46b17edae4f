#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// Something wrong that a vehicle's tracker is told of its camera, mount or odometry.
struct Miscalibration {
  std::string name;
  std::function<void(SourceInfo& told)> tell;  ///< changes what is true
  double speed_factor = 1.0;                   ///< of the odometry's speed
};

/// Nothing wrong, then focal length 5 %, principal point 20 px, camera height 20 %, pitch 2 deg and
/// yaw 5 deg off to both sides, and speeds 20 % too small and too large.
const std::vector<Miscalibration>& miscalibrations();

/// What a tracker that was told so did over one drive.
struct MiscalibrationResult {
  std::string told;
  int frames = 0;
  int tracked = 0;         ///< called tracking
  int wrong = 0;           ///< of these, the true pose lies outside 99.99 %
  int suspect_frames = 0;  ///< in which a calibration was called wrong
  double first_s = -1.0;   ///< of these the first one, since the start; < 0: none
  std::string said;        ///< of what was suspect first: what it is, as estimated at the end
};

/// Drives a tracker for each of `wrong` over the same pictures of `source`, as long as it has any
/// or a signal comes (InterruptionGuard). InputError where the source has no odometry or no truth.
std::vector<MiscalibrationResult> tell_wrongly(FrameSource& source,
                                               const std::vector<Miscalibration>& wrong,
                                               std::uint64_t seed);

}  // namespace cairn::host
