#pragma once

#include "cairn/planar/detail/world_frame_filter.hpp"

namespace cairn {

/// The default planar filter: paper A's lifted filter reduced exactly and kept on its constraint
/// surface, which makes it the right-invariant EKF (docs/explanation/iekf-slam.md). Error (e, xi_x,
/// xi_i): heading e, xi = x - R(e) x^; so
/// - the rows of a measurement act on landmark minus vehicle alone, the transition is the identity:
///   no information enters the directions that nothing measures;
/// - odometry noise is gathered in a 3x3 matrix, O(1) per odometry step and exact, and reaches the
///   landmarks in the first pass of the next update;
/// - a correction moves pose and landmarks by one exponential of the group;
/// - pose() and pose_covariance() are the exact trigonometric moments of the Gaussian error (paper
///   A's idea of reading the lifted state out), in a frame anchored at the first estimate.
///
/// T is float or double; LandmarkDim 2 (points on the plane) or 3 (with height, for the camera).
/// All storage is inside; copies are independent. Interface: detail/planar_filter.hpp and below.
template <class T, int MaxLandmarks, int LandmarkDim = 2>
class GroupIekfSlam : public detail::WorldFrameFilter<GroupIekfSlam<T, MaxLandmarks, LandmarkDim>,
                                                      T, MaxLandmarks, LandmarkDim> {
  using World = detail::WorldFrameFilter<GroupIekfSlam, T, MaxLandmarks, LandmarkDim>;
  using Base = typename World::Base;
  friend World;
  friend Base;

 public:
  /// Starts an empty map at `pose` with `covariance` over (x, y, heading) in m^2, m rad, rad^2.
  /// Errors: kNonFiniteInput, kInvalidArgument (not symmetric or not positive semi-definite),
  /// kBadConfig.
  Status initialise(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                    const PlanarParameters<T>& parameters = PlanarParameters<T>{});

  /// Expected pose given the Gaussian error. Its position lies nearer to the anchor than
  /// mean_pose()'s by the factor exp(-heading variance / 2).
  PlanarPose<T> pose() const;
  /// Covariance of pose() over (x, y, heading).
  Matrix3<T> pose_covariance() const;
  /// Expected landmark, the partner of pose(), m; and its covariance, m^2.
  Vector<T, LandmarkDim> landmark_position(int slot) const;
  Matrix<T, LandmarkDim, LandmarkDim> landmark_covariance(int slot) const;

 private:
  struct Trial {
    T v00;
    T v01;
  };
  /// Exact first two moments of R(e) mean + xi.
  struct Moments {
    T mean[2];
    T cov[3];  ///< 00, 10, 11
    T with_heading[2];
  };

  void propagate(const PlanarIncrement<T>& increment);
  void widen_pose_by(T position_variance, T heading_variance);
  static constexpr int kPositionState = 1;
  void rows_with_vehicle(int slot, typename World::LandmarkRows& rows) const;
  void rows_in_world(int slot, typename World::LandmarkRows& rows, T weight) const;
  void relative_of(int slot, const T* v, T* out) const;
  void relative_covariance(int slot, detail::RelativeCovariance<T>& out) const;
  void relative_columns(int slot, T* c0, T* c1, T* c2) const;
  void begin_update();
  const T* pending() const { return pending_ ? b_ : nullptr; }
  void pending_done();
  const T* pending_column(const typename Base::Pair& pair, T* g0, T* g1, T& f0, T& f1, T& s00,
                          T& s01, T& s11) const;
  void hash_pending(Hash64& hash) const;
  T pending_covariance(int i, int j) const;
  Trial begin_trial(const T* d) const;
  void relative_after(int slot, const T* d, const Trial& trial, T* out) const;
  void correct(const T* d);
  void add_pending_now();
  T heading_variance() const { return this->P_(0, 0) + W_(0, 0); }
  Moments moments(const T* mean, const T* c, const T* xi) const;

  Matrix3<T> W_ = Matrix3<T>::Zero();  ///< odometry noise since the last pass over P
  bool pending_ = false;
  /// W = b b^T + [0, 0; 0, rest_] with b = W e_0 / sqrt(W_00): of begin_update(), B b.
  T b_[Base::kStates] = {};
  T rest_[3] = {};  ///< 00, 10, 11
};

}  // namespace cairn

#include "cairn/planar/detail/group_iekf_slam_impl.hpp"
#include "cairn/planar/detail/group_read_out_impl.hpp"
