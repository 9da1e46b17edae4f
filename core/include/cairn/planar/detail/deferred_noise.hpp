#pragma once

namespace cairn::detail {

/// Noise that an error model holds back until the next pass over its covariance, so that many
/// odometry steps cost one pass: `along along^T` over all states, plus `rest` (00, 10, 11) over the
/// two position states of the vehicle. `along` null: there is none.
template <class T>
struct DeferredNoise {
  const T* along = nullptr;
  T rest[3] = {};
};

}  // namespace cairn::detail
