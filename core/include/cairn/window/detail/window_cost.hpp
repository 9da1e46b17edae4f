#pragma once

namespace cairn::detail {

/// Huber's cost of a residual of `distance` sigmas.
template <class T>
T window_cost(T distance, T huber) {
  return distance < huber ? T(0.5) * distance * distance : huber * (distance - T(0.5) * huber);
}

/// What a match costs at most where motions are compared: farther off it is a mismatch, and says
/// nothing of how far. By Bayes, of right matches with an error of 0.8 px (Gaussian) and one wrong
/// one in twenty, anywhere within 10 px: across an epipolar line, ln (19 * 20 / (sqrt(2 pi) 0.8)),
/// in the picture ln (19 * 20^2 / (2 pi 0.8^2)). Iterations go on by Huber's cost.
template <class T>
inline constexpr T kMismatchAcross = T(5.2);
template <class T>
inline constexpr T kMismatch = T(7.5);

/// Cost of an observation that has no direction in its keyframe.
template <class T>
inline constexpr T kHiddenCost = T(50);

}  // namespace cairn::detail
