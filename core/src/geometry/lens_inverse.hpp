#pragma once

#include "cairn/numeric/math.hpp"

namespace cairn::detail {

constexpr int kMostPieceLevels = 8;
constexpr int kMostPieces = 64;
constexpr int kInverseSteps = 24;  // the most that random lenses take is 17

/// Whether c[0] + c[1] t + ... is above 0 for all t in [0, 1]: where all coefficients of a piece in
/// Bernstein's basis are, the piece is; other pieces are halved. A polynomial that touches 0, and
/// one that kMostPieces pieces do not decide, is not.
template <class T, int Count>
bool is_positive_on_unit_interval(const T (&c)[Count]) {
  constexpr int kDegree = Count - 1;
  int level = 0;
  int piece = 0;  // [piece, piece + 1] / 2^level, from left to right
  for (int step = 0; step < kMostPieces; ++step) {
    const T length = T(1) / static_cast<T>(1 << level);
    const T start = static_cast<T>(piece) * length;
    T b[Count];
    for (int i = 0; i < Count; ++i) b[i] = c[i];
    for (int i = 0; i < kDegree; ++i) {
      for (int k = kDegree - 1; k >= i; --k) b[k] += start * b[k + 1];
    }
    T scale = T(1);  // length^i / binomial(degree, i)
    for (int i = 0; i < Count; ++i) {
      b[i] *= scale;
      scale *=
          length * static_cast<T>(i + 1) / static_cast<T>(Count - 1 - i > 0 ? Count - 1 - i : 1);
    }
    for (int i = 1; i < Count; ++i) {
      for (int k = kDegree; k >= i; --k) b[k] += b[k - 1];
    }
    bool positive = true;
    for (const T value : b) positive = positive && value > T(0);
    if (positive) {
      ++piece;
      for (int i = 0; i < kMostPieceLevels && level > 0 && piece % 2 == 0; ++i) {
        piece /= 2;
        --level;
      }
      if (level == 0) return true;
    } else {
      if (!(b[0] > T(0)) || !(b[kDegree] > T(0)) || level == kMostPieceLevels) return false;
      piece *= 2;
      ++level;
    }
  }
  return false;
}

/// s in (0, largest] with model.value(s) = `target` > 0, by Newton's method inside a bracket that
/// at most doubles. False, with the outermost s that was tried, where there is none before the
/// model's fold. Model: value(s), which rises from 0 while is_before_fold(s), and its slope(s).
template <class T, class Model>
bool invert(const Model& model, T target, T largest, T& s) {
  constexpr T kPrecision = sizeof(T) == sizeof(float) ? T(1e-5) : T(1e-9);
  T low = T(0);
  T high = largest;
  bool bracketed = false;
  s = target < largest ? target : largest;
  for (int i = 0; i < kInverseSteps; ++i) {
    T next = high;
    if (model.is_before_fold(s)) {
      const T excess = model.value(s) - target;
      next = s - excess / model.slope(s);
      if (abs(next - s) <= kPrecision * s) {
        if (!(next <= largest) || !model.is_before_fold(next)) return false;
        s = next;
        return true;
      }
      (excess > T(0) ? high : low) = s;
      bracketed = bracketed || excess > T(0);
      if (next > T(2) * s) next = T(2) * s;
    } else {
      high = s;
      bracketed = true;
    }
    if (next > low && next < high) {
      s = next;
    } else {
      s = bracketed || T(2) * s > high ? T(0.5) * (low + high) : T(2) * s;
    }
  }
  return false;
}

}  // namespace cairn::detail
