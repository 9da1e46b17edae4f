#pragma once

#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn::detail {

/// Inverse of the symmetric positive definite `a` by Cholesky with Jacobi scaling: rows and columns
/// are first scaled to a unit diagonal, so that the pivots do not depend on units. False (output
/// untouched) when a diagonal element is not positive or a scaled pivot is at most `min_pivot`.
/// Reads the lower triangle. Cost: about N^3 multiply-adds, N <= 6.
template <class T, int N>
bool invert_spd(const Matrix<T, N, N>& a, T min_pivot, Matrix<T, N, N>& inverse) {
  static_assert(N <= 6, "larger systems use the packed kernels");
  T scale[N];
  for (int i = 0; i < N; ++i) {
    if (!(a(i, i) > T(0)) || !is_finite(a(i, i))) return false;
    scale[i] = T(1) / sqrt(a(i, i));
  }
  T lower[N][N];
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      T sum = a(i, j) * scale[i] * scale[j];
      for (int k = 0; k < j; ++k) sum -= lower[i][k] * lower[j][k];
      if (i == j) {
        if (!(sum > min_pivot)) return false;
        lower[i][i] = sqrt(sum);
      } else {
        lower[i][j] = sum / lower[j][j];
      }
    }
  }
  T lower_inverse[N][N];
  for (int j = 0; j < N; ++j) {
    lower_inverse[j][j] = T(1) / lower[j][j];
    for (int i = j + 1; i < N; ++i) {
      T sum = T(0);
      for (int k = j; k < i; ++k) sum += lower[i][k] * lower_inverse[k][j];
      lower_inverse[i][j] = -sum / lower[i][i];
    }
  }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      T sum = T(0);
      for (int k = i; k < N; ++k) sum += lower_inverse[k][i] * lower_inverse[k][j];
      inverse(i, j) = sum * scale[i] * scale[j];
      inverse(j, i) = inverse(i, j);
    }
  }
  return true;
}

/// Smallest scaled pivot that still counts as regular.
template <class T>
constexpr T min_regular_pivot() {
  return sizeof(T) == sizeof(float) ? T(1e-5) : T(1e-11);
}

}  // namespace cairn::detail
