#pragma once

#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn::detail {

/// Most vectors that one pass over a covariance takes away.
inline constexpr int kMostRank = 8;

/// What one pass over a covariance changes: it takes sum_r w[r] w[r]^T over r < rank away, and adds
/// extra extra^T where `extra` is given.
template <class T, int Stride>
struct LowRank {
  const T (*w)[Stride] = nullptr;
  int rank = 0;
  const T* extra = nullptr;
};

/// Two neighbouring rows of P at a time, so that each element of w is loaded once for both: `count`
/// elements of p0, one more of p1.
template <int Rank, bool Extra, class T, int Stride>
inline void subtract_rows(T* __restrict p0, T* __restrict p1, int count, int i,
                          const T (*__restrict w)[Stride], const T* __restrict extra) {
  T f0[Rank + 1];
  T f1[Rank + 1];
  for (int r = 0; r < Rank; ++r) {
    f0[r] = w[r][i];
    f1[r] = w[r][i + 1];
  }
  f0[Rank] = Extra ? -extra[i] : T(0);
  f1[Rank] = Extra ? -extra[i + 1] : T(0);
  for (int j = 0; j < count; ++j) {
    T sum0 = T(0);
    T sum1 = T(0);
    if constexpr (Extra) {
      sum0 = f0[Rank] * extra[j];
      sum1 = f1[Rank] * extra[j];
    }
    for (int r = 0; r < Rank; ++r) {
      sum0 = r == 0 && !Extra ? f0[r] * w[r][j] : sum0 + f0[r] * w[r][j];
      sum1 = r == 0 && !Extra ? f1[r] * w[r][j] : sum1 + f1[r] * w[r][j];
    }
    p0[j] -= sum0;
    p1[j] -= sum1;
  }
  T sum = Extra ? f1[Rank] * extra[count] : T(0);
  for (int r = 0; r < Rank; ++r) sum += f1[r] * w[r][count];
  p1[count] -= sum;
}

template <int Rank, bool Extra, class T, int Capacity, int Stride>
void downdate(PackedSymmetric<T, Capacity>& P, const LowRank<T, Stride>& by) {
  const int n = P.size();
  T* p = P.data();
  int i = 0;
  for (; i + 1 < n; i += 2) {
    subtract_rows<Rank, Extra>(p, p + i + 1, i + 1, i, by.w, by.extra);
    p += 2 * i + 3;
  }
  if (i == n) return;
  for (int j = 0; j <= i; ++j) {
    T sum = Extra ? -by.extra[i] * by.extra[j] : T(0);
    for (int r = 0; r < Rank; ++r) sum += by.w[r][i] * by.w[r][j];
    p[j] -= sum;
  }
}

/// Changes P by `by`, over the lower triangle in one pass. Domain: rank even and at most kMostRank.
/// Cost: rank (+ 1) n (n + 1) / 2 multiply-adds.
template <class T, int Capacity, int Stride>
void downdate(PackedSymmetric<T, Capacity>& P, const LowRank<T, Stride>& by) {
  static_assert(kMostRank == 8, "one case for each even rank");
  const bool extra = by.extra != nullptr;
  switch (by.rank) {
    case 0:
      return extra ? downdate<0, true>(P, by) : void();
    case 2:
      return extra ? downdate<2, true>(P, by) : downdate<2, false>(P, by);
    case 4:
      return extra ? downdate<4, true>(P, by) : downdate<4, false>(P, by);
    case 6:
      return extra ? downdate<6, true>(P, by) : downdate<6, false>(P, by);
    default:
      return extra ? downdate<8, true>(P, by) : downdate<8, false>(P, by);
  }
}

/// How two raw columns become whitened ones:
///   a = (g0 - sum_r f0[r] w[r] - f0[rank] extra) i00,
///   b = (g1 - sum_r f1[r] w[r] - f1[rank] extra - l10 a) i11,
/// and their correction d += a y0 + b y1.
template <class T>
struct Whitening {
  T f0[kMostRank + 1] = {};
  T f1[kMostRank + 1] = {};
  T i00 = T(0);
  T i11 = T(0);
  T l10 = T(0);
  T y0 = T(0);
  T y1 = T(0);
};

template <int Rank, bool Extra, class T, int Stride>
void whiten_columns(T* __restrict g0, T* __restrict g1, T* __restrict d, int n,
                    const Whitening<T>& whitening, const T (*__restrict w)[Stride],
                    const T* __restrict extra) {
  const Whitening<T> k = whitening;
  for (int i = 0; i < n; ++i) {
    T a = g0[i];
    T b = g1[i];
    for (int r = 0; r < Rank; ++r) {
      a -= k.f0[r] * w[r][i];
      b -= k.f1[r] * w[r][i];
    }
    if constexpr (Extra) {
      a -= k.f0[Rank] * extra[i];
      b -= k.f1[Rank] * extra[i];
    }
    a *= k.i00;
    b = (b - k.l10 * a) * k.i11;
    g0[i] = a;
    g1[i] = b;
    d[i] += a * k.y0 + b * k.y1;
  }
}

/// The same for a rank known at run time: even, below kMostRank. `extra` may be null.
template <class T, int Stride>
void whiten_columns(T* g0, T* g1, T* d, int n, const Whitening<T>& k, const T (*w)[Stride],
                    int rank, const T* extra) {
  static_assert(kMostRank == 8, "one case for each even rank");
  switch (rank) {
    case 0:
      return extra != nullptr ? whiten_columns<0, true>(g0, g1, d, n, k, w, extra)
                              : whiten_columns<0, false>(g0, g1, d, n, k, w, extra);
    case 2:
      return extra != nullptr ? whiten_columns<2, true>(g0, g1, d, n, k, w, extra)
                              : whiten_columns<2, false>(g0, g1, d, n, k, w, extra);
    case 4:
      return extra != nullptr ? whiten_columns<4, true>(g0, g1, d, n, k, w, extra)
                              : whiten_columns<4, false>(g0, g1, d, n, k, w, extra);
    default:
      return extra != nullptr ? whiten_columns<6, true>(g0, g1, d, n, k, w, extra)
                              : whiten_columns<6, false>(g0, g1, d, n, k, w, extra);
  }
}

}  // namespace cairn::detail
