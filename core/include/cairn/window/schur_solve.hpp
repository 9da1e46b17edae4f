#pragma once

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/numeric/solve_positive_definite.hpp"

namespace cairn {

/// A landmark's part of the normal equations: one unknown, its inverse depth, coupled to the poses.
template <class T, int MaxStates>
struct LandmarkEquation {
  T by_pose[MaxStates];
  T information;
  T gradient;
  bool used;

  void clear(int states) {
    for (int i = 0; i < states; ++i) by_pose[i] = T(0);
    information = gradient = T(0);
    used = false;
  }
  /// Step of the landmark for a step of the poses.
  T step(const T* poses, int states, T damping) const {
    T left = gradient;
    for (int i = 0; i < states; ++i) left -= by_pose[i] * poses[i];
    return left / (information * (T(1) + damping));
  }
};

/// Step of the poses of Levenberg and Marquardt (all diagonal elements grow by the share
/// `damping`), with the landmarks eliminated: Schur complement. `system`: normal matrix of the
/// poses; `reduced` is scratch and holds the factors L D L^T afterwards. False where the equations
/// are singular. Cost: n^2 / 2 multiply-adds a landmark, n^3 / 6 more.
template <class T, int MaxStates>
bool solve_with_landmarks(const PackedSymmetric<T, MaxStates>& system, const T* gradient,
                          const LandmarkEquation<T, MaxStates>* landmarks, int count, T damping,
                          PackedSymmetric<T, MaxStates>& reduced, T* step) {
  constexpr int kBlock = 4;
  constexpr T kLeast = T(1e-9);
  const int states = system.size();
  reduced = system;
  for (int i = 0; i < states; ++i) {
    T& d = reduced.row(i)[i];
    d += damping * d + kLeast;
    step[i] = gradient[i];
  }
  T block[kBlock * MaxStates] = {};
  int filled = 0;
  for (int k = 0; k < count; ++k) {
    const LandmarkEquation<T, MaxStates>& landmark = landmarks[k];
    if (!landmark.used) continue;
    const T root = T(1) / sqrt(landmark.information * (T(1) + damping));
    T* const row = block + filled * MaxStates;
    const T along = landmark.gradient * root;
    for (int i = 0; i < states; ++i) {
      row[i] = landmark.by_pose[i] * root;
      step[i] -= row[i] * along;
    }
    if (++filled < kBlock) continue;
    reduced.template downdate<kBlock, MaxStates>(block);
    filled = 0;
  }
  if (filled > 0) {
    for (int i = filled * MaxStates; i < kBlock * MaxStates; ++i) block[i] = T(0);
    reduced.template downdate<kBlock, MaxStates>(block);
  }
  return states == 0 || solve_positive_definite(reduced, step);
}

}  // namespace cairn
