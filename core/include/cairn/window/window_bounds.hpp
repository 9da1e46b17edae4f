#pragma once

namespace cairn {

/// Capacities of a KeyframeWindow, and of the tracker around it.
struct WindowBounds {
  static constexpr int kKeyframes = 7;    ///< whose poses are estimated together
  static constexpr int kLandmarks = 128;  ///< followed, or held by two keyframes at least
  static constexpr int kPoses = 32;       ///< of keyframes, and of hosts that left the window
  static constexpr int kFeatures = 64;    ///< followed from frame to frame
};

}  // namespace cairn
