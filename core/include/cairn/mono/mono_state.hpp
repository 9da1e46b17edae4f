#pragma once

#include "cairn/mono/camera_block.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/numeric/positive_definite.hpp"

namespace cairn::mono {

/// State and covariance of the monocular filter: the camera block first, then blocks of features
/// and anchors, with memory for rows of it.
template <class T, int N>
struct MonoState {
  static constexpr int kMaxStates = N;
  /// Matches whose part of P is subtracted in one pass.
  static constexpr int kPendingPairs = 4;

  CameraBlock<T> camera;
  T x[N] = {};
  PackedSymmetric<T, N> covariance;
  /// Scratch: V of P - V^T V in an update, H P where a block is added or rewritten.
  T scratch[2 * kPendingPairs][N] = {};

  int size() const { return covariance.size(); }
  const CameraLayout& layout() const { return camera.layout(); }
  Vector<T, 4> quaternion() const { return camera.quaternion(x); }
  Vector3<T> position() const { return camera.position(x); }

  /// Sum of the quaternion's variances.
  T attitude_variance() const {
    T sum = T(0);
    const int q = layout().quaternion;
    for (int i = q; i < q + 4; ++i) sum += covariance.row(i)[i];
    return sum;
  }
  /// Noise for a linear map of the quaternion's errors, whose terms are of the size of `variance`.
  /// A quaternion has no error along itself, where noise in shares of its own variance would be
  /// none.
  void inflate_attitude(T variance) {
    const int q = layout().quaternion;
    for (int i = q; i < q + 4; ++i) covariance.row(i)[i] += kRoundingNoise<T> * variance;
  }
};

}  // namespace cairn::mono
