#pragma once

#include "cairn/mono/parameters.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn::mono {

/// The memory of the filter that fades: P <- S P, by a fixed factor, or by as much as the
/// innovations show to be missing.
template <class T>
class FadingMemory {
 public:
  /// What a frame's low-innovation inliers leave, summed over `used` of them: the squared
  /// innovation, and the traces of H Q H^T and H P H^T, px^2.
  struct Residuals {
    T nu_squared = T(0);
    T driven = T(0);
    T whole = T(0);
    int used = 0;
  };

  void reset() { *this = FadingMemory(); }

  /// Factor of the last fading.
  T last_factor() const { return last_factor_; }

  /// Strong tracking (Zhou and Frank 1996): the factor lambda by which H F P F' H' falls short of
  /// what the residuals show. V <- (rho V + nu nu') / (1 + rho), N = V - H Q H' - beta R, M = H F P
  /// F' H', lambda = max(1, tr N / tr M). Domain: used > 0.
  T factor_for(const Residuals& residuals, const MonoParameters<T>& parameters);

  void note_factor(T factor) { last_factor_ = factor; }
  /// P <- S P, capped: a state at its limit is scaled by less, as a congruence, so that P stays
  /// positive semidefinite. `scale`: the largest variance of each state; overwritten. `kept`: noise
  /// of the first states that is left out, or null.
  template <int N, int M>
  static void fade(T factor, PackedSymmetric<T, N>& p, T* scale, const PackedSymmetric<T, M>* kept);

 private:
  T innovation_ = T(-1);  ///< V, px^2 per coordinate; negative: none yet
  T last_factor_ = T(1);
};

template <class T>
T FadingMemory<T>::factor_for(const Residuals& residuals, const MonoParameters<T>& parameters) {
  const T coordinates = static_cast<T>(2 * residuals.used);
  const T fresh = residuals.nu_squared / coordinates;
  const T rho = parameters.adaptive_memory;
  innovation_ = innovation_ < T(0) ? fresh : (rho * innovation_ + fresh) / (T(1) + rho);
  const T excess = innovation_ - residuals.driven / coordinates -
                   parameters.adaptive_softening * square(parameters.sigma_px);
  const T explained = (residuals.whole - residuals.driven) / coordinates;
  const T factor = explained > T(1e-9) ? excess / explained : T(1);
  return clamp(factor, T(1), parameters.adaptive_max_factor);
}

template <class T>
template <int N, int M>
void FadingMemory<T>::fade(T factor, PackedSymmetric<T, N>& p, T* scale,
                           const PackedSymmetric<T, M>* kept) {
  const int n = p.size();
  bool free[N];
  const T root = sqrt(factor);
  for (int i = 0; i < n; ++i) {
    const T variance = p.row(i)[i];
    const T limit = scale[i];
    free[i] = variance * factor <= limit;
    scale[i] = free[i] ? root : (variance < limit ? sqrt(limit / variance) : T(1));
  }
  for (int i = 0; i < n; ++i) {
    T* row = p.row(i);
    for (int j = 0; j <= i; ++j) {
      const T both = free[i] && free[j] ? factor : scale[i] * scale[j];
      row[j] *= both;
      if (kept != nullptr && i < kept->size()) {
        row[j] -= (both - T(1)) * kept->row(i)[j];
      }
    }
  }
}

}  // namespace cairn::mono
