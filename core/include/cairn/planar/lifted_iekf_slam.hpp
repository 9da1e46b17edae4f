#pragma once

#include "cairn/planar/detail/lifted_equations.hpp"
#include "cairn/planar/detail/planar_filter.hpp"

namespace cairn {

/// Paper A's IEKF-SLAM: the state lifted to second-order polynomials, 11 for the vehicle and 6 for
/// each landmark (one more for a height), in which prediction and observation are linear; equations
/// (5) to (28) with the errata corrected and the cross blocks that the paper leaves out
/// (docs/explanation/errata-paper-a.md). Noise by the printed Jacobians, or by exact trigonometric
/// moments (PlanarParameters::exact_moments).
///
/// It is here to be compared with: 9 to 15 times the cost of GroupIekfSlam, which is the same idea
/// reduced, and overconfident from a known start (docs/explanation/iekf-slam.md).
///
/// T is float or double; LandmarkDim 2 or 3. All storage is inside; copies are independent.
/// Interface: detail/planar_filter.hpp and below. Cost: prediction 8 N^2, N = 11 + 6 n.
template <class T, int MaxLandmarks, int LandmarkDim = 2>
class LiftedIekfSlam
    : public detail::PlanarFilter<LiftedIekfSlam<T, MaxLandmarks, LandmarkDim>, T, MaxLandmarks,
                                  LandmarkDim, detail::kLiftedVehicle,
                                  detail::kLiftedLandmark + LandmarkDim - 2> {
  static constexpr int kVehicle = detail::kLiftedVehicle;
  static constexpr int kLandmark = detail::kLiftedLandmark + LandmarkDim - 2;
  using Base =
      detail::PlanarFilter<LiftedIekfSlam, T, MaxLandmarks, LandmarkDim, kVehicle, kLandmark>;
  friend Base;

 public:
  /// Its state holds relative vectors alone: nothing known in the world can be added.
  static constexpr bool kHasWorldLandmarks = false;

  /// Starts an empty map at `pose` with `covariance` over (x, y, heading) in m^2, m rad, rad^2.
  /// Errors: kNonFiniteInput, kInvalidArgument (not symmetric or not positive semi-definite),
  /// kBadConfig.
  Status initialise(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                    const PlanarParameters<T>& parameters = PlanarParameters<T>{});

  PlanarPose<T> pose() const;
  /// Covariance of pose() over (x, y, heading): d heading = (c ds - s dc) / (s^2 + c^2).
  Matrix3<T> pose_covariance() const;
  PlanarPose<T> mean_pose() const { return pose(); }
  Vector<T, LandmarkDim> landmark_position(int slot) const;
  Matrix<T, LandmarkDim, LandmarkDim> landmark_covariance(int slot) const;
  Vector<T, LandmarkDim> mean_landmark(int slot) const { return landmark_position(slot); }

  /// As in WorldFrameFilter.
  Status add_position(LandmarkId id);
  /// As in WorldFrameFilter, but the way's error enters as independent noise: a lifted landmark is
  /// no linear function of it.
  Status add_landmark_on_path(LandmarkId id, const Vector<T, LandmarkDim>& y_vehicle,
                              const Matrix<T, LandmarkDim, LandmarkDim>& R, LandmarkId past,
                              const Matrix<T, LandmarkDim, 2>& by_path,
                              LandmarkId* replaced = nullptr);

  /// Lifted state i (0 .. state_size() - 1), vehicle first.
  T lifted(int i) const { return z_[i]; }
  /// Element of the lifted covariance.
  T lifted_covariance(int i, int j) const { return this->P_(i, j); }

  /// Fingerprint of mean and covariance.
  void hash(Hash64& hash) const;

 private:
  struct Trial {};

  detail::RelativeFrame<T> frame() const { return {}; }
  void relative(int slot, T* out) const { relative_of(slot, z_, out); }
  void relative_of(int slot, const T* v, T* out) const;
  void relative_covariance(int slot, detail::RelativeCovariance<T>& out) const;
  void relative_columns(int slot, T* c0, T* c1, T* c2) const;
  void begin_update() {}
  const T* pending() const { return nullptr; }
  void pending_done() {}
  const T* pending_column(const typename Base::Pair&, T*, T*, T&, T&, T&, T&, T&) const {
    return nullptr;
  }
  Trial begin_trial(const T*) const { return {}; }
  void relative_after(int slot, const T* d, const Trial&, T* out) const;
  void correct(const T* d);

  void propagate(const PlanarIncrement<T>& increment);
  void propagate_moments(const PlanarIncrement<T>& increment);
  void widen_pose_by(T position_variance, T heading_variance);
  void widen_landmark_by(int slot, T variance);
  void append_landmark(const Vector<T, LandmarkDim>& y,
                       const Matrix<T, LandmarkDim, LandmarkDim>& R);
  void remove_slot(int slot);

  void initial_jacobian(const PlanarPose<T>& pose, const Matrix3<T>& covariance);
  void initial_moments(const PlanarPose<T>& pose, const Matrix3<T>& covariance);
  int block_size(int block) const { return block == 0 ? kVehicle : kLandmark; }
  int block_start(int block) const { return block == 0 ? 0 : Base::state_of(block - 1); }
  void transition(const detail::Monomials<T>& m, int block, const T* in, T* out) const;
  void transition_all(const detail::Monomials<T>& m, const T* in, T* out) const;
  void transition_block(const detail::Monomials<T>& m, int row_block, int column_block,
                        const T (&in)[kVehicle][kVehicle], T (&out)[kVehicle][kVehicle]) const;
  void transform_covariance(const detail::Monomials<T>& mean, const detail::Monomials<T>* noise,
                            int noise_count);

  T z_[Base::kStates] = {};
};

}  // namespace cairn

#include "cairn/planar/detail/lifted_iekf_slam_impl.hpp"
#include "cairn/planar/detail/lifted_landmarks_impl.hpp"
