#pragma once

#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn {

/// Solves A x = b by A = L D L^T. `x` holds b and then the solution; the factors take the place of
/// A. False where a pivot is not above `least` times its own diagonal element: A is then no
/// positive definite matrix to the precision of T, and both are spoilt. Cost: n^3 / 6
/// multiply-adds.
template <class T, int Capacity>
bool solve_positive_definite(PackedSymmetric<T, Capacity>& a, T* x, T least = T(4) * kEpsilon<T>) {
  const int n = a.size();
  for (int i = 0; i < n; ++i) {
    T* const r = a.row(i);
    T pivot = r[i];
    for (int j = 0; j < i; ++j) {
      const T* const q = a.row(j);
      T sum = r[j];
      for (int k = 0; k < j; ++k) sum -= r[k] * q[k];
      r[j] = sum;  // L_ij D_j
    }
    for (int j = 0; j < i; ++j) {
      const T scaled = r[j] / a.row(j)[j];
      pivot -= scaled * r[j];
      r[j] = scaled;
    }
    if (!(pivot > least * r[i])) return false;
    r[i] = pivot;
    for (int k = 0; k < i; ++k) x[i] -= r[k] * x[k];
  }
  for (int i = 0; i < n; ++i) x[i] /= a.row(i)[i];
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) x[i] -= a.row(k)[i] * x[k];
  }
  return true;
}

}  // namespace cairn
