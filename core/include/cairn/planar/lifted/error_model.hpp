#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/planar/lifted/equations.hpp"
#include "cairn/planar/observation/linearised_observation.hpp"
#include "cairn/planar/types.hpp"

namespace cairn {

/// Settings of the lifted filter alone.
struct LiftedParameters {
  /// Exact trigonometric moments of the noise instead of the printed Jacobians.
  bool exact_moments = false;
  /// Bits of `Misprint` put back into the equations, for the errata tests.
  unsigned misprints = 0;
};

/// Paper A's lifted state as an error model: 11 states for the vehicle and 6 for each landmark (one
/// more for a height), in which prediction and observation are linear. Relative vectors have the
/// vehicle's axes. Interface: PlanarSlam.
template <class T, int MaxLandmarks, int LandmarkDim>
class LiftedErrorModel {
 public:
  using Scalar = T;
  static constexpr int kMaxLandmarks = MaxLandmarks;
  static constexpr int kLandmarkDim = LandmarkDim;
  static constexpr int kVehicleStates = detail::kLiftedVehicle;
  static constexpr int kTiltStates = 0;
  static constexpr int kLandmarkStates = detail::kLiftedLandmark + LandmarkDim - 2;
  static constexpr int kStates = kVehicleStates + MaxLandmarks * kLandmarkStates;
  /// Its state holds relative vectors alone: nothing known in the world can be added.
  static constexpr bool kHasWorldLandmarks = false;
  static constexpr bool kDefersNoise = false;
  static constexpr bool kTurnsAboutAnchor = false;
  using Covariance = PackedSymmetric<T, kStates>;
  using LandmarkVector = Vector<T, LandmarkDim>;
  using LandmarkMatrix = Matrix<T, LandmarkDim, LandmarkDim>;

  void set_parameters(const LiftedParameters& parameters) { parameters_ = parameters; }

  static int state_of(int slot) { return kVehicleStates + slot * kLandmarkStates; }
  int height_state(int slot) const { return state_of(slot) + kLandmarkStates - 1; }
  Covariance& covariance() { return P_; }
  const Covariance& covariance() const { return P_; }
  T lifted(int i) const { return z_[i]; }

  void start(const PlanarPose<T>& pose, const Matrix3<T>& covariance);
  void propagate(const PlanarIncrement<T>& increment);
  void widen_pose(T position_variance, T heading_variance);
  void slip_laterally(T variance);

  PlanarPose<T> mean_pose() const;
  LandmarkVector mean_landmark(int slot) const;
  DirectionOfTravel<T> travel() const { return {}; }
  PlanarPose<T> pose() const { return mean_pose(); }
  /// d heading = (c ds - s dc) / (s^2 + c^2).
  Matrix3<T> pose_covariance() const;
  LandmarkVector landmark_position(int slot) const { return mean_landmark(slot); }
  LandmarkMatrix landmark_covariance(int slot) const;
  T error_covariance(int i, int j) const { return P_(i, j); }
  void hash_mean(Hash64& hash) const {
    for (int i = 0; i < P_.size(); ++i) hash.add(z_[i]);
  }

  RelativeFrame<T> frame() const { return {}; }
  void relative(int slot, T* out) const { relative_of(slot, z_, out); }
  void relative_of(int slot, const T* v, T* out) const;
  void relative_covariance(int slot, RelativeCovariance<T>& out) const;
  /// Variances whose difference the relative covariance is, per coordinate.
  void relative_scale(int slot, T* out) const {
    const int l = state_of(slot);
    out[0] = P_(7, 7) + P_(8, 8) + P_(l + 3, l + 3) + P_(l + 4, l + 4);
    out[1] = P_(6, 6) + P_(9, 9) + P_(l + 2, l + 2) + P_(l + 5, l + 5);
    if constexpr (LandmarkDim > 2) out[2] = P_(l + kLandmark - 1, l + kLandmark - 1);
  }
  void relative_columns(int slot, T* c0, T* c1) const;

  struct Retraction {};
  Retraction retraction(const T*) const { return {}; }
  void relative_after(int slot, const T* d, const Retraction&, T* out) const;
  void correct(const T* d) {
    for (int i = 0; i < P_.size(); ++i) z_[i] += d[i];
  }

  void append_landmark(const LandmarkVector& y, const LandmarkMatrix& R);
  void append_position();
  /// The path's error enters as independent noise: a lifted landmark is no linear function of it.
  void append_landmark_on_path(const LandmarkVector& y, const LandmarkMatrix& R, int past,
                               const Matrix<T, LandmarkDim, 2>& by_path);
  void remove_landmark(int slot);
  void widen_landmark(int slot, T variance);

 private:
  static constexpr int kVehicle = kVehicleStates;
  static constexpr int kLandmark = kLandmarkStates;

  void initial_jacobian(const PlanarPose<T>& pose, const Matrix3<T>& covariance);
  void initial_moments(const PlanarPose<T>& pose, const Matrix3<T>& covariance);
  void propagate_moments(const PlanarIncrement<T>& increment);
  int block_size(int block) const { return block == 0 ? kVehicle : kLandmark; }
  int block_start(int block) const { return block == 0 ? 0 : state_of(block - 1); }
  void transition(const detail::Monomials<T>& m, int block, const T* in, T* out) const;
  void transition_all(const detail::Monomials<T>& m, const T* in, T* out) const;
  void transition_block(const detail::Monomials<T>& m, int row_block, int column_block,
                        const T (&in)[kVehicle][kVehicle], T (&out)[kVehicle][kVehicle]) const;
  void transform_covariance(const detail::Monomials<T>& mean, const detail::Monomials<T>* noise,
                            int noise_count);

  LiftedParameters parameters_;
  int landmarks_ = 0;
  Covariance P_;
  T z_[kStates] = {};
  T scratch_[3][kStates] = {};
};

}  // namespace cairn

#include "cairn/planar/lifted/error_model_landmarks.hpp"
#include "cairn/planar/lifted/error_model_motion.hpp"
