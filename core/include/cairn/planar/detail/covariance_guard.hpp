#pragma once

#include "cairn/base/health.hpp"
#include "cairn/numeric/positive_definite.hpp"

namespace cairn::detail {

/// Watches that a model's covariance stays positive semi-definite, and mends it where the rounding
/// noise of WhitenedUpdate was not enough: the last resort. Every intervention is counted.
///
/// After each update it looks at the variances of all states and, where landmarks are points of the
/// world, at the joint covariance of the vehicle and two of them for kPairs pairs, others each
/// time: all of them in turn. Cost: n comparisons and about 200 multiply-adds for each pair.
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
  /// definite, which a sound covariance cannot give where landmarks are points of the world.
  void check(Model& model, bool singular, Health& health) {
    bool sound = variances_sound(model.covariance());
    if constexpr (Model::kHasWorldLandmarks) {
      sound = sound && !singular;
      const int count = model.landmark_count();
      for (int k = 0; k < kPairs && sound && count > 1; ++k) {
        next_pair(count);
        if (pair_sound(model)) continue;
        ++health.covariance_repairs;
        raise_variances(model);
        sound = pair_sound(model);
      }
    }
    if (sound) return;
    forget_correlations(model.covariance());
    ++health.resets;
  }

 private:
  /// Share of its variance that a broken landmark gets on top.
  static constexpr T kRepair = T(1.0 / 1024.0);

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

  bool pair_sound(const Model& model) const {
    const auto& P = model.covariance();
    const int states = joint_states(model);
    PackedSymmetric<T, kMostJoint> joint;
    joint.resize(states);
    for (int i = 0; i < states; ++i) {
      for (int j = 0; j <= i; ++j) joint(i, j) = P(state(model, i), state(model, j));
    }
    return factor_semidefinite(joint);
  }

  void raise_variances(Model& model) {
    auto& P = model.covariance();
    for (int k = model.vehicle_states(); k < joint_states(model); ++k) {
      T& variance = P.row(state(model, k))[state(model, k)];
      variance += kRepair * variance;
    }
  }

  int first_ = 0;
  int second_ = 0;
};

}  // namespace cairn::detail
