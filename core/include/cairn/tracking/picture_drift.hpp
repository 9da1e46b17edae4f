#pragma once

#include "cairn/numeric/math.hpp"

namespace cairn {

/// Errors of the pictures last from frame to frame, which white noise of pixels does not model: a
/// map that is seen piece after piece bends by more than the filter's covariance says. Measured in
/// the hall over 3 to 20 m; where few landmarks are seen, or a pixel is wide, it bends the more.
struct PictureDrift {
  float position_m = 0.01F;     ///< per root metre, and axis
  float heading_rad = 0.0008F;  ///< per root metre, at least
  float landmark_px = 1.0F;     ///< per root metre, of one landmark's share of the heading

  /// The noise of a way, m, in a planar filter's world, seen with focal length `focal_px` by so
  /// many `inliers`.
  template <class Filter>
  void add_to(Filter& filter, float distance_m, float focal_px, int inliers) const {
    constexpr int kFewest = 4;
    const auto seen = static_cast<float>(inliers > kFewest ? inliers : kFewest);
    const float by_few = square(landmark_px / focal_px) / seen;
    const float least = square(heading_rad);
    static_cast<void>(filter.drift_world(square(position_m) * distance_m,
                                         (by_few > least ? by_few : least) * distance_m));
  }
};

}  // namespace cairn
