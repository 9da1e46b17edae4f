#pragma once

#include <cstdint>

#include "cairn/geometry/rigid.hpp"
#include "cairn/geometry/types.hpp"

namespace cairn {

/// A landmark of the window and where a frame sees it.
template <class T>
struct WindowSighting {
  Vector3<T> direction = Vector3<T>::Zero();  ///< point relative to the world's origin, times rho
  Vector3<T> host = Vector3<T>::Zero();       ///< the host camera's centre, world
  T rho = T(0);                               ///< inverse depth in the host
  T sigma = T(0);                             ///< of rho
  Vector2<T> seen = Vector2<T>::Zero();       ///< measured direction (x / z, y / z)
  bool inlier = false;                        ///< output
};

template <class T>
struct WindowPoseOptions {
  static constexpr int kMaxIterations = 16;

  T sigma = T(0.0015);  ///< of a measured direction, each axis
  T huber_sigma = T(1.5);
  T cut_sigma = T(5);       ///< beyond it no weight, in the second half of the iterations
  T inlier_gate = T(11.8);  ///< squared distance, chi-square of 2 degrees of freedom, 99.7 %
  int max_iterations = 10;
  /// Of the camera's attitude, by a gyroscope: R_camera_world and 1 / variance of each axis,
  /// 1/rad^2; 0: nothing is known of it.
  Quaternion<T> attitude = Quaternion<T>(T(1), T(0), T(0), T(0));
  T attitude_information = T(0);
  /// Of the camera's centre, by constant velocity: world, and 1 / variance of each axis; 0: nothing
  /// is known of it. Huber's cost: a hand may jerk.
  Vector3<T> centre = Vector3<T>::Zero();
  T centre_information = T(0);
  T centre_huber_sigma = T(2);
};

/// Pose of a frame from landmarks that it sees, by iterated reweighted least squares. A landmark's
/// depth widens the noise of its direction along its epipolar line. `T_camera_world` comes in as
/// the first guess and leaves as the estimate; `covariance` is the inverse of the normal equations,
/// of a perturbation as in perturbed(), as if the landmarks' errors were independent. Returns the
/// number of inliers, which are marked; -1 where the sightings do not determine a pose (pose and
/// covariance are then unchanged). Cost: max_iterations + 1 passes of some 200 multiply-adds a
/// sighting.
template <class T>
int estimate_window_pose(WindowSighting<T>* sightings, int count,
                         const WindowPoseOptions<T>& options, Rigid<T>& T_camera_world,
                         Matrix<T, 6, 6>& covariance);

extern template int estimate_window_pose(WindowSighting<float>*, int,
                                         const WindowPoseOptions<float>&, Rigid<float>&,
                                         Matrix<float, 6, 6>&);
extern template int estimate_window_pose(WindowSighting<double>*, int,
                                         const WindowPoseOptions<double>&, Rigid<double>&,
                                         Matrix<double, 6, 6>&);

}  // namespace cairn
