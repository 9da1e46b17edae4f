#pragma once

#include "cairn/base/ticks.hpp"
#include "cairn/tracking/frame_report.hpp"

namespace cairn {

/// Writes the ticks of a frame's stages, which follow one another, into its report.
class StageTimer {
 public:
  StageTimer(const TickSource& ticks, FrameReport& report)
      : ticks_(ticks), report_(report), start_(ticks.now()) {}

  /// The stage ends here, and the next one begins.
  void end(Stage stage) {
    const std::uint32_t now = ticks_.now();
    report_.stage_ticks[static_cast<int>(stage)] += now - start_;
    start_ = now;
  }

 private:
  const TickSource& ticks_;
  FrameReport& report_;
  std::uint32_t start_;
};

}  // namespace cairn
