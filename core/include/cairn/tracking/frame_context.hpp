#pragma once

#include "cairn/base/health.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/frame_work.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// What a tracker hands to each of its parts for one frame.
struct FrameContext {
  const ImageView& image;
  const PinholeCamera<float>& camera;
  FrameWork& work;
  Random& random;
  FrameReport& report;  ///< output: parts add their counts and never read it
  Health& health;
};

}  // namespace cairn
