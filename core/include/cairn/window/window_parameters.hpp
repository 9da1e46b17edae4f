#pragma once

#include "cairn/base/status.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// Of a KeyframeWindow.
template <class T>
struct WindowParameters {
  T sigma = T(0.0015);  ///< of a measured direction, each axis: pixels / focal length
  T huber_sigma = T(1.5);
  T outlier_sigma = T(4);          ///< observations farther off are forgotten
  T first_inverse_depth = T(1);    ///< of landmarks while no depth is known
  T depth_prior_sigma = T(0.5);    ///< of a new landmark, relative to its inverse depth
  T sigma_factor = T(1.5);         ///< of an inverse depth, over what its own observations give
  int iterations = 6;              ///< after a keyframe
  int start_keyframes = 8;         ///< with parallax, up to which the start is checked,
  T start_gain = T(0.85);          ///< and corrected where another motion costs less than this
  T start_margin = T(3);           ///< share of the window's, less this
  T focal_sigma = T(0.1);          ///< of the focal length, relative; 0: it is not estimated
  T focal_factor = T(8);           ///< of its sigma, over what a window's pixels alone give
  T focal_window_sigma = T(0.03);  ///< relative, of what one window says of it, at least

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good = is_positive(sigma) && is_positive(huber_sigma) &&
                      is_positive(outlier_sigma) && is_positive(first_inverse_depth) &&
                      is_positive(depth_prior_sigma) && is_positive(sigma_factor) &&
                      iterations >= 1 && iterations <= 100 && start_keyframes >= 0 &&
                      start_gain >= T(0) && start_gain <= T(1) && is_finite(start_margin) &&
                      start_margin >= T(0) && is_finite(focal_sigma) && focal_sigma >= T(0) &&
                      focal_sigma <= T(1) && is_positive(focal_factor) &&
                      is_finite(focal_window_sigma) && focal_window_sigma >= T(0);
    return good ? Status::kOk : Status::kBadConfig;
  }
};

}  // namespace cairn
