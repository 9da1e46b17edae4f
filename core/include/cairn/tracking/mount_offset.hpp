#pragma once

#include <cstdint>

namespace cairn {

/// How far a camera and its mount are from what the tracker was told.
struct MountOffset {
  /// Angles turn the camera about the vehicle's axes, rad: yaw to the left, pitch nose down, roll
  /// to the right. kFocal: natural logarithm of the true focal length over the assumed one.
  enum Part : std::uint8_t { kYaw, kPitch, kRoll, kFocal };
  static constexpr int kParts = 4;

  float value[kParts] = {};
  float sigma[kParts] = {};   ///< standard deviations; what cannot be told from pictures is large
  bool suspect[kParts] = {};  ///< surely off by more than a careful calibration leaves

  bool any_suspect() const {
    return suspect[kYaw] || suspect[kPitch] || suspect[kRoll] || suspect[kFocal];
  }
};

}  // namespace cairn
