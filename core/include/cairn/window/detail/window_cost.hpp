#pragma once

namespace cairn::detail {

/// Huber's cost of a residual of `distance` sigmas.
template <class T>
T window_cost(T distance, T huber) {
  return distance < huber ? T(0.5) * distance * distance : huber * (distance - T(0.5) * huber);
}

/// Cost of an observation that has no direction in its keyframe.
template <class T>
inline constexpr T kHiddenCost = T(50);

}  // namespace cairn::detail
