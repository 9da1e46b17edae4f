#pragma once

#include "cairn/base/health.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn::detail {

/// Watches that a model's covariance stays positive semi-definite, and mends it where the rounding
/// noise of WhitenedUpdate was not enough: the last resort. Every intervention is counted.
///
/// After each update it looks at the variances of all states, and at the joint covariance of the
/// vehicle and two landmarks for kPairs pairs, others each time: all of them in turn.
/// Cost: n comparisons and about 200 multiply-adds for each pair.
template <class Model>
class CovarianceGuard {
  using T = typename Model::Scalar;
  static constexpr int kLandmark = Model::kLandmarkStates;
  static constexpr int kMostJoint = Model::kVehicleStates + 2 * kLandmark;
  static constexpr int kPairs = 4;

 public:
  void clear() {
    first_ = 0;
    second_ = 0;
  }

  /// Checks and mends after an update. `singular`: an innovation covariance was not positive
  /// definite, which a sound covariance cannot give.
  void check(Model& model, bool singular, Health& health) {
    bool sound = !singular && variances_sound(model);
    const int count = model.landmark_count();
    for (int k = 0; k < kPairs && sound && count > 1; ++k) {
      next_pair(count);
      if (pair_sound(model)) continue;
      ++health.covariance_repairs;
      raise_variances(model);
      sound = pair_sound(model);
    }
    if (sound) return;
    reset(model);
    ++health.resets;
  }

 private:
  /// What counts as zero, as a share of a state's variance: what rounding leaves of it.
  static constexpr T kZero = T(64.0 * kEpsilonInDouble<T>);
  /// Share of its variance that a broken landmark gets on top.
  static constexpr T kRepair = T(1.0 / 1024.0);

  static bool variances_sound(const Model& model) {
    const auto& P = model.covariance();
    bool sound = true;
    for (int i = 0; i < P.size(); ++i) {
      const T variance = P.row(i)[i];
      sound = sound && variance >= T(0) && is_finite(variance);
    }
    return sound;
  }

  void next_pair(int count) {
    if (++second_ >= count) {
      if (++first_ >= count - 1) first_ = 0;
      second_ = first_ + 1;
    }
    if (first_ >= second_) {
      first_ = 0;
      second_ = 1;
    }
  }

  static int joint_states(const Model& model) { return model.vehicle_states() + 2 * kLandmark; }
  int state(const Model& model, int k) const {
    if (k < model.vehicle_states()) return k;
    const int l = k - model.vehicle_states();
    return l < kLandmark ? model.state_of(first_) + l : model.state_of(second_) + l - kLandmark;
  }

  /// L D L^T of the joint covariance; directions that rounding cannot tell from zero are left out.
  bool pair_sound(const Model& model) const {
    const auto& P = model.covariance();
    T A[kMostJoint][kMostJoint];
    T variance[kMostJoint];
    const int joint = joint_states(model);
    for (int i = 0; i < joint; ++i) {
      for (int j = 0; j <= i; ++j) A[i][j] = P(state(model, i), state(model, j));
      variance[i] = A[i][i];
    }
    for (int k = 0; k < joint; ++k) {
      const T pivot = A[k][k];
      if (!(pivot >= -kZero * variance[k])) return false;
      if (pivot <= kZero * variance[k]) continue;
      const T inverse = T(1) / pivot;
      for (int i = k + 1; i < joint; ++i) {
        const T factor = A[i][k] * inverse;
        for (int j = k + 1; j <= i; ++j) A[i][j] -= factor * A[j][k];
      }
    }
    return true;
  }

  void raise_variances(Model& model) {
    auto& P = model.covariance();
    for (int k = model.vehicle_states(); k < joint_states(model); ++k) {
      T& variance = P.row(state(model, k))[state(model, k)];
      variance += kRepair * variance;
    }
  }

  /// Forgets all correlations and keeps the variances, 1 where there is none: less sure than
  /// before, and sound.
  static void reset(Model& model) {
    auto& P = model.covariance();
    for (int i = 0; i < P.size(); ++i) {
      T* row = P.row(i);
      for (int j = 0; j < i; ++j) row[j] = T(0);
      const T size = abs(row[i]);
      row[i] = is_finite(size) && size > T(0) ? size : T(1);
    }
  }

  int first_ = 0;
  int second_ = 0;
};

}  // namespace cairn::detail
