#pragma once

#include "cairn/planar/detail/world_frame_filter.hpp"

namespace cairn {

/// Plain EKF-SLAM in the plane (Smith, Self, Cheeseman 1990; paper A's yardstick): state (x, y,
/// heading, landmarks), linearised at the latest estimate. It gains heading information that no
/// measurement holds, so its covariance becomes too small: the baseline, not the default.
///
/// T is float or double; LandmarkDim 2 (points on the plane) or 3 (with height, for the camera).
/// All storage is inside; copies are independent. Interface: detail/planar_filter.hpp and below.
/// Cost: prediction O(n) each; update see update_points().
template <class T, int MaxLandmarks, int LandmarkDim = 2>
class EkfSlam : public detail::WorldFrameFilter<EkfSlam<T, MaxLandmarks, LandmarkDim>, T,
                                                MaxLandmarks, LandmarkDim> {
  using World = detail::WorldFrameFilter<EkfSlam, T, MaxLandmarks, LandmarkDim>;
  using Base = typename World::Base;
  friend World;
  friend Base;

 public:
  /// Starts an empty map at `pose` with `covariance` over (x, y, heading) in m^2, m rad, rad^2.
  /// Errors: kNonFiniteInput, kInvalidArgument (not symmetric or not positive semi-definite),
  /// kBadConfig.
  Status initialise(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                    const PlanarParameters<T>& parameters = PlanarParameters<T>{});

  PlanarPose<T> pose() const { return this->mean_pose(); }
  /// Covariance of pose() over (x, y, heading).
  Matrix3<T> pose_covariance() const;
  Vector<T, LandmarkDim> landmark_position(int slot) const { return this->mean_landmark(slot); }
  Matrix<T, LandmarkDim, LandmarkDim> landmark_covariance(int slot) const;

 private:
  struct Trial {
    T cosine;
    T sine;
  };

  void propagate(const PlanarIncrement<T>& increment);
  void widen_pose_by(T position_variance, T heading_variance);
  static constexpr int kPositionState = 0;
  void rows_with_vehicle(int slot, typename World::LandmarkRows& rows) const;
  void rows_in_world(int, typename World::LandmarkRows&, T) const {}
  void relative_of(int slot, const T* v, T* out) const;
  void relative_covariance(int slot, detail::RelativeCovariance<T>& out) const;
  void relative_columns(int slot, T* c0, T* c1, T* c2) const;
  void begin_update() {}
  void add_pending_now() {}
  const T* pending() const { return nullptr; }
  void pending_done() {}
  const T* pending_column(const typename Base::Pair&, T*, T*, T&, T&, T&, T&, T&) const {
    return nullptr;
  }
  void hash_pending(Hash64&) const {}
  T pending_covariance(int, int) const { return T(0); }
  Trial begin_trial(const T* d) const;
  void relative_after(int slot, const T* d, const Trial& trial, T* out) const;
  void correct(const T* d);
};

}  // namespace cairn

#include "cairn/planar/detail/ekf_slam_impl.hpp"
