#pragma once

#include <utility>

#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn::detail {

/// Most vectors that one pass over a covariance takes away.
inline constexpr int kMostRank = 8;

#if defined(__SSE2__) || defined(__ARM_NEON)
inline constexpr bool kHasVectors = true;
#else
inline constexpr bool kHasVectors = false;
#endif

/// What one pass over a covariance changes: it takes sum_r w[r] w[r]^T over r < rank away, and adds
/// extra extra^T where `extra` is given.
template <class T, int Stride>
struct LowRank {
  const T (*w)[Stride] = nullptr;
  int rank = 0;
  const T* extra = nullptr;
};

/// Two neighbouring rows of P at a time, so that each element of w is loaded once for both: `count`
/// elements of p0, one more of p1. The sums are written out by the pack: compilers for small cores
/// keep an array that a loop indexes in memory.
template <bool Extra, class T, int Stride, int... R>
inline void subtract_rows(T* __restrict p0, T* __restrict p1, int count, int i,
                          [[maybe_unused]] const T (*__restrict w)[Stride],
                          [[maybe_unused]] const T* __restrict extra,
                          std::integer_sequence<int, R...>) {
  const T f0[sizeof...(R) + 1] = {w[R][i]..., Extra ? -extra[i] : T(0)};
  const T f1[sizeof...(R) + 1] = {w[R][i + 1]..., Extra ? -extra[i + 1] : T(0)};
  constexpr int kLast = sizeof...(R);
  for (int j = 0; j < count; ++j) {
    if constexpr (Extra) {
      p0[j] -= ((f0[kLast] * extra[j]) + ... + (f0[R] * w[R][j]));
      p1[j] -= ((f1[kLast] * extra[j]) + ... + (f1[R] * w[R][j]));
    } else {
      p0[j] -= (... + (f0[R] * w[R][j]));
      p1[j] -= (... + (f1[R] * w[R][j]));
    }
  }
  T sum = Extra ? f1[kLast] * extra[count] : T(0);
  ((sum += f1[R] * w[R][count]), ...);
  p1[count] -= sum;
}

template <int Rank, bool Extra, class T, int Capacity, int Stride>
void downdate(PackedSymmetric<T, Capacity>& P, const LowRank<T, Stride>& by) {
  using Terms = std::make_integer_sequence<int, Rank>;
  // The same sums: tiles suit cores without vectors, whole rows those with them.
  if constexpr (!kHasVectors && Rank > 0 && !Extra) {
    P.template downdate<Rank, Stride>(&by.w[0][0]);
    return;
  }
  const int n = P.size();
  T* p = P.data();
  int i = 0;
  for (; i + 1 < n; i += 2) {
    subtract_rows<Extra>(p, p + i + 1, i + 1, i, by.w, by.extra, Terms{});
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

template <bool Extra, class T, int Stride, int... R>
void whiten_columns(T* __restrict g0, T* __restrict g1, T* __restrict d, int n,
                    const Whitening<T>& whitening, [[maybe_unused]] const T (*__restrict w)[Stride],
                    [[maybe_unused]] const T* __restrict extra, std::integer_sequence<int, R...>) {
  const Whitening<T> k = whitening;
  constexpr int kLast = sizeof...(R);
  for (int i = 0; i < n; ++i) {
    T a = (g0[i] - ... - (k.f0[R] * w[R][i]));
    T b = (g1[i] - ... - (k.f1[R] * w[R][i]));
    if constexpr (Extra) {
      a -= k.f0[kLast] * extra[i];
      b -= k.f1[kLast] * extra[i];
    }
    a *= k.i00;
    b = (b - k.l10 * a) * k.i11;
    g0[i] = a;
    g1[i] = b;
    d[i] += a * k.y0 + b * k.y1;
  }
}

template <int Rank, class T, int Stride>
void whiten_columns(T* g0, T* g1, T* d, int n, const Whitening<T>& k, const T (*w)[Stride],
                    const T* extra) {
  using Terms = std::make_integer_sequence<int, Rank>;
  if (extra != nullptr) {
    whiten_columns<true>(g0, g1, d, n, k, w, extra, Terms{});
  } else {
    whiten_columns<false>(g0, g1, d, n, k, w, extra, Terms{});
  }
}

/// The same for a rank known at run time: even, below kMostRank. `extra` may be null.
template <class T, int Stride>
void whiten_columns(T* g0, T* g1, T* d, int n, const Whitening<T>& k, const T (*w)[Stride],
                    int rank, const T* extra) {
  static_assert(kMostRank == 8, "one case for each even rank");
  switch (rank) {
    case 0:
      return whiten_columns<0>(g0, g1, d, n, k, w, extra);
    case 2:
      return whiten_columns<2>(g0, g1, d, n, k, w, extra);
    case 4:
      return whiten_columns<4>(g0, g1, d, n, k, w, extra);
    default:
      return whiten_columns<6>(g0, g1, d, n, k, w, extra);
  }
}

}  // namespace cairn::detail
