#pragma once

#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn::detail {

/// p[j] -= sum_r f[r] v_r[j] for j = 0 .. count-1; `Rank` vectors at a time, so that p is read and
/// written once for all of them.
template <int Rank, class T>
inline void subtract_row(T* __restrict p, int count, const T (&f)[Rank], const T* __restrict v0,
                         const T* __restrict v1, const T* __restrict v2, const T* __restrict v3,
                         const T* __restrict v4) {
  for (int j = 0; j < count; ++j) {
    T sum = f[0] * v0[j];
    if constexpr (Rank > 1) sum += f[1] * v1[j];
    if constexpr (Rank > 2) sum += f[2] * v2[j];
    if constexpr (Rank > 3) sum += f[3] * v3[j];
    if constexpr (Rank > 4) sum += f[4] * v4[j];
    p[j] -= sum;
  }
}

/// P -= sum_r a_r b_r^T over the lower triangle, a_r = rows[r], b_r = columns[r]; the sum is
/// symmetric where a_r and b_r are parallel. One pass over P. Cost: Rank n (n + 1) / 2
/// multiply-adds.
template <int Rank, class T, int Capacity>
void downdate(PackedSymmetric<T, Capacity>& P, const T* const* rows, const T* const* columns) {
  const int n = P.size();
  T* p = P.data();
  for (int i = 0; i < n; ++i) {
    T f[Rank];
    for (int r = 0; r < Rank; ++r) f[r] = rows[r][i];
    subtract_row<Rank>(p, i + 1, f, columns[0], columns[Rank > 1 ? 1 : 0],
                       columns[Rank > 2 ? 2 : 0], columns[Rank > 3 ? 3 : 0],
                       columns[Rank > 4 ? 4 : 0]);
    p += i + 1;
  }
}

/// Turns two raw columns into two whitened ones, and adds their correction:
///   a = (g0 - sum_r f0[r] e_r) i00,  b = (g1 - sum_r f1[r] e_r - l10 a) i11,  d += a y0 + b y1.
template <class T>
struct Whitening {
  T i00 = T(0);
  T i11 = T(0);
  T l10 = T(0);
  T y0 = T(0);
  T y1 = T(0);
};
template <int Count, class T>
void whiten_columns(T* __restrict g0, T* __restrict g1, T* __restrict d, int n,
                    const Whitening<T>& w, const T* const* e, const T* f0, const T* f1) {
  const T* __restrict e0 = e[0];
  const T* __restrict e1 = e[Count > 1 ? 1 : 0];
  const T* __restrict e2 = e[Count > 2 ? 2 : 0];
  const Whitening<T> k = w;
  for (int i = 0; i < n; ++i) {
    T a = g0[i];
    T b = g1[i];
    if constexpr (Count > 0) {
      a -= f0[0] * e0[i];
      b -= f1[0] * e0[i];
    }
    if constexpr (Count > 1) {
      a -= f0[1] * e1[i];
      b -= f1[1] * e1[i];
    }
    if constexpr (Count > 2) {
      a -= f0[2] * e2[i];
      b -= f1[2] * e2[i];
    }
    a *= k.i00;
    b = (b - k.l10 * a) * k.i11;
    g0[i] = a;
    g1[i] = b;
    d[i] += a * k.y0 + b * k.y1;
  }
}

template <class T>
void whiten_columns(T* g0, T* g1, T* d, int n, const Whitening<T>& w, int count, const T* const* e,
                    const T* f0, const T* f1) {
  switch (count) {
    case 0:
      return whiten_columns<0>(g0, g1, d, n, w, e, f0, f1);
    case 1:
      return whiten_columns<1>(g0, g1, d, n, w, e, f0, f1);
    case 2:
      return whiten_columns<2>(g0, g1, d, n, w, e, f0, f1);
    default:
      return whiten_columns<3>(g0, g1, d, n, w, e, f0, f1);
  }
}

template <class T, int Capacity>
void downdate(PackedSymmetric<T, Capacity>& P, int rank, const T* const* rows,
              const T* const* columns) {
  switch (rank) {
    case 1:
      return downdate<1>(P, rows, columns);
    case 2:
      return downdate<2>(P, rows, columns);
    case 3:
      return downdate<3>(P, rows, columns);
    case 4:
      return downdate<4>(P, rows, columns);
    case 5:
      return downdate<5>(P, rows, columns);
    default:
      return;
  }
}

}  // namespace cairn::detail
