#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// Most observations that one pose is estimated from.
inline constexpr int kMaxPoseObservations = 256;

/// A known point and where it was seen.
template <class T>
struct PoseObservation {
  Vector3<T> p_world = Vector3<T>::Zero();     ///< m
  Matrix3<T> covariance = Matrix3<T>::Zero();  ///< of p_world, m^2; zero: known exactly
  Vector2<T> pixel = Vector2<T>::Zero();       ///< measured
  T sigma_px = T(1);                           ///< measurement noise per axis
};

template <class T>
struct PoseRefinementOptions {
  static constexpr int kMaxIterations = 12;

  int max_iterations = 6;  ///< clamped to [1, kMaxIterations]
  /// Huber's threshold on the Mahalanobis distance of an observation, in sigmas.
  T huber_sigma = T(2);
  /// Squared Mahalanobis distance up to which an observation is an inlier. In the second half of
  /// the iterations observations outside of it have no weight at all.
  T inlier_gate = static_cast<T>(kChi2Dof2Level99);
  int min_inliers = 4;
  /// One byte an observation, 0 leaves it out; null takes all. Those left out count in the share
  /// of inliers all the same.
  const std::uint8_t* use_only = nullptr;
  /// Information (inverse covariance) of the pose handed in, in the tangent space described at
  /// refine_pose. Used when `use_prior` is set.
  bool use_prior = false;
  Matrix<T, 6, 6> prior_information = Matrix<T, 6, 6>::Zero();
};

template <class T>
struct PoseEstimate {
  Matrix<T, 6, 6> covariance = Matrix<T, 6, 6>::Zero();  ///< tangent (translation m, rotation rad)
  int inliers = 0;
  int iterations = 0;
  T rms_px = T(0);  ///< root mean square length of the inliers' reprojection errors
  /// 0..1: share of inliers among the observations, times min(1, c / 6) with c of 16 image cells
  /// (4 x 4) holding an inlier: low when matches are wrong or crowd in a corner.
  T quality = T(0);
};

/// Motion-only estimation: the camera pose that minimises the robust reprojection error of known
/// points. `T_world_camera` comes in as the first guess (and prior) and leaves as the estimate.
///
/// Right perturbation: T <- T * (Exp(phi), rho), that is R <- R Exp(phi), t <- t + R rho. All 6x6
/// matrices are in the order (rho, phi): metres and radians in the camera frame.
///
/// Gauss-Newton with Levenberg's damping where a step does not lower the cost (Hartley and
/// Zisserman 2004, appendix 6), Huber weights (Huber 1964) and, in the second half, the same cost
/// cut off at the inlier gate. A point's own covariance widens the noise of its pixel;
/// cross-correlations between points are not known here, so the covariance is optimistic for points
/// with correlated errors.
///
/// kInvalidArgument: null, count outside [3, kMaxPoseObservations] ([1, ...] with a prior), a sigma
/// that is not positive. kNonFiniteInput. kDegenerate: the points do not determine the pose
/// (collinear, coincident, behind the camera). kNoConsensus: fewer than min_inliers inliers. On an
/// error pose and estimate are unchanged. `inlier_flags`, when given, receives 1 or 0 for each
/// observation on kOk.
///
/// Cost: at most max_iterations + 3 passes over the observations, about 350 multiply-adds each.
template <class T>
Status refine_pose(const PinholeCamera<T>& camera, const PoseObservation<T>* observations,
                   int count, const PoseRefinementOptions<T>& options, Rigid<T>& T_world_camera,
                   PoseEstimate<T>& estimate, std::uint8_t* inlier_flags = nullptr);

/// Reprojection error of one observation at a pose: residual = measured - predicted pixel and its
/// squared Mahalanobis distance. kOutOfView, outputs untouched, where the point has no pixel;
/// kSingular when the noise is not positive definite.
template <class T>
Status reprojection_error(const PinholeCamera<T>& camera, const PoseObservation<T>& observation,
                          const Rigid<T>& T_world_camera, Vector2<T>& residual_px,
                          T& mahalanobis_squared);

/// Jacobian d pixel / d (rho, phi) of the predicted pixel of `p_world`, right perturbation.
/// kOutOfView, outputs untouched, where the point has no pixel.
template <class T>
Status pose_jacobian(const PinholeCamera<T>& camera, const Vector3<T>& p_world,
                     const Rigid<T>& T_world_camera, Vector2<T>& pixel, Matrix<T, 2, 6>& jacobian);

extern template Status refine_pose(const PinholeCamera<float>&, const PoseObservation<float>*, int,
                                   const PoseRefinementOptions<float>&, Rigid<float>&,
                                   PoseEstimate<float>&, std::uint8_t*);
extern template Status refine_pose(const PinholeCamera<double>&, const PoseObservation<double>*,
                                   int, const PoseRefinementOptions<double>&, Rigid<double>&,
                                   PoseEstimate<double>&, std::uint8_t*);
extern template Status reprojection_error(const PinholeCamera<float>&,
                                          const PoseObservation<float>&, const Rigid<float>&,
                                          Vector2<float>&, float&);
extern template Status reprojection_error(const PinholeCamera<double>&,
                                          const PoseObservation<double>&, const Rigid<double>&,
                                          Vector2<double>&, double&);
extern template Status pose_jacobian(const PinholeCamera<float>&, const Vector3<float>&,
                                     const Rigid<float>&, Vector2<float>&, Matrix<float, 2, 6>&);
extern template Status pose_jacobian(const PinholeCamera<double>&, const Vector3<double>&,
                                     const Rigid<double>&, Vector2<double>&, Matrix<double, 2, 6>&);

}  // namespace cairn
