#pragma once

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn {

/// Variance that a filter's update adds to each state, as a share of the state's own: process noise
/// for the arithmetic. Rounding changes each element of P by up to half an epsilon of its row's and
/// column's deviations in each of the update's passes; without noise of that size, directions that
/// are measured for ever fall below what P can resolve beside those that are not, and P becomes
/// indefinite. Measured: 2 epsilon are too few for 60 landmarks, 4 enough, twice that is taken.
template <class T>
inline constexpr T kRoundingNoise = T(8.0 * kEpsilonInDouble<T>);

/// Whether `a`, of which the factors L D L^T take the place, is positive semi-definite. Directions
/// that rounding cannot tell from zero are left out. Cost: n^3 / 6 multiply-adds.
template <class T, int Capacity>
bool factor_semidefinite(PackedSymmetric<T, Capacity>& a) {
  constexpr T kZero = T(64.0 * kEpsilonInDouble<T>);  // of a state's variance
  const int n = a.size();
  T variance[Capacity] = {};
  for (int i = 0; i < n; ++i) variance[i] = a.row(i)[i];
  for (int k = 0; k < n; ++k) {
    const T pivot = a.row(k)[k];
    if (!(pivot >= -kZero * variance[k])) return false;
    if (pivot <= kZero * variance[k]) {
      // What has no variance varies with nothing.
      for (int i = k + 1; i < n; ++i) {
        if (!(square(a.row(i)[k]) <= T(4) * kZero * variance[k] * variance[i])) return false;
      }
      continue;
    }
    const T inverse = T(1) / pivot;
    for (int i = k + 1; i < n; ++i) {
      const T factor = a.row(i)[k] * inverse;
      for (int j = k + 1; j <= i; ++j) a.row(i)[j] -= factor * a.row(j)[k];
    }
  }
  return true;
}

/// A variance beyond this says nothing, and its products come near the end of float.
template <class T>
inline constexpr T kMostVariance = T(1e16);

/// Whether every variance is neither negative nor beyond kMostVariance.
template <class T, int Capacity>
bool variances_sound(const PackedSymmetric<T, Capacity>& p) {
  bool sound = true;
  for (int i = 0; i < p.size(); ++i) {
    const T variance = p.row(i)[i];
    sound = sound && variance >= T(0) && variance <= kMostVariance<T>;
  }
  return sound;
}

/// Forgets all correlations and keeps the variances up to kMostVariance, 1 where there is none:
/// less sure than before, and sound.
template <class T, int Capacity>
void forget_correlations(PackedSymmetric<T, Capacity>& p) {
  for (int i = 0; i < p.size(); ++i) {
    T* row = p.row(i);
    for (int j = 0; j < i; ++j) row[j] = T(0);
    const T size = abs(row[i]);
    row[i] = size > T(0) ? (size < kMostVariance<T> ? size : kMostVariance<T>) : T(1);
  }
}

/// Whether all elements of a fixed-size matrix are finite.
template <class Matrix>
bool all_finite(const Matrix& m) {
  bool finite = true;
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) finite = finite && is_finite(m(i, j));
  }
  return finite;
}

/// Whether a 2x2 or 3x3 matrix is symmetric to the bit and all its leading minors are positive.
template <class Matrix>
bool positive_definite(const Matrix& m) {
  static_assert(Matrix::RowsAtCompileTime == Matrix::ColsAtCompileTime, "a square matrix");
  static_assert(Matrix::RowsAtCompileTime == 2 || Matrix::RowsAtCompileTime == 3, "2x2 or 3x3");
  using T = typename Matrix::Scalar;
  const T corner = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1);
  if (!(m(0, 0) > T(0) && m(1, 1) > T(0) && m(0, 1) == m(1, 0) && corner > T(0))) return false;
  if constexpr (Matrix::RowsAtCompileTime == 3) {
    const T determinant = corner * m(2, 2) + T(2) * m(0, 1) * m(1, 2) * m(0, 2) -
                          m(0, 0) * m(1, 2) * m(1, 2) - m(1, 1) * m(0, 2) * m(0, 2);
    return m(2, 2) > T(0) && m(0, 2) == m(2, 0) && m(1, 2) == m(2, 1) && determinant > T(0);
  }
  return true;
}

}  // namespace cairn
