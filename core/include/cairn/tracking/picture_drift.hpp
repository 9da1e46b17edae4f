#pragma once

#include "cairn/numeric/math.hpp"

namespace cairn {

/// Errors of the pictures last from frame to frame, which white noise of pixels does not model: a
/// map that is seen piece after piece bends by more than the filter's covariance says. Measured in
/// the hall over 3 to 20 m.
struct PictureDrift {
  float position_m = 0.01F;     ///< per root metre, and axis
  float heading_rad = 0.0008F;  ///< per root metre

  /// The noise of a way, m, in a planar filter's world.
  template <class Filter>
  void add_to(Filter& filter, float distance_m) const {
    static_cast<void>(
        filter.drift_world(square(position_m) * distance_m, square(heading_rad) * distance_m));
  }
};

}  // namespace cairn
