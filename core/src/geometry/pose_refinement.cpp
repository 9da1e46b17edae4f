#include "cairn/geometry/pose_refinement.hpp"

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn {
namespace {

// A point without a pixel costs as much as one this many sigmas off: finite, so that one wrong
// match behind the camera cannot veto every step.
constexpr int kHiddenPointSigmas = 50;
constexpr int kCellsPerSide = 4;
constexpr int kCellsForFullQuality = 6;

template <class T>
struct NormalEquations {
  Matrix<T, 6, 6> information = Matrix<T, 6, 6>::Zero();
  Vector<T, 6> gradient = Vector<T, 6>::Zero();
  T cost = T(0);
};

template <class T>
struct Problem {
  const PinholeCamera<T>& camera;
  const PoseObservation<T>* observations;
  int count;
  const PoseRefinementOptions<T>& options;
  const Rigid<T>& prior;

  bool used(int i) const { return options.use_only == nullptr || options.use_only[i] != 0; }
};

template <class T>
Rigid<T> perturb(const Rigid<T>& pose, const Vector<T, 6>& step) {
  Rigid<T> result;
  result.translation = pose.translation + pose.rotation * Vector3<T>(step[0], step[1], step[2]);
  result.rotation = pose.rotation * rotation_exp(Vector3<T>(step[3], step[4], step[5]));
  const T norm = sqrt(result.rotation.squaredNorm());
  result.rotation.coeffs() *= T(1) / norm;
  return result;
}

template <class T>
bool finite3(const Vector3<T>& v) {
  return is_finite(v.x()) && is_finite(v.y()) && is_finite(v.z());
}

template <class T>
Status check(const Problem<T>& problem) {
  if (problem.observations == nullptr) return Status::kInvalidArgument;
  const int least = problem.options.use_prior ? 1 : 3;
  if (problem.count < least || problem.count > kMaxPoseObservations) {
    return Status::kInvalidArgument;
  }
  if (!finite3(problem.prior.translation) || !finite3(Vector3<T>(problem.prior.rotation.vec())) ||
      !is_finite(problem.prior.rotation.w())) {
    return Status::kNonFiniteInput;
  }
  for (int i = 0; i < problem.count; ++i) {
    const PoseObservation<T>& o = problem.observations[i];
    const T sum = o.covariance.sum() + o.pixel.sum() + o.sigma_px;
    if (!finite3(o.p_world) || !is_finite(sum)) return Status::kNonFiniteInput;
    if (!(o.sigma_px > T(0))) return Status::kInvalidArgument;
  }
  return problem.camera.check_numbers();
}

/// Inverse of the pixel noise of an observation: measurement noise plus the projected covariance.
template <class T>
bool pixel_information(const PoseObservation<T>& o, const Matrix3<T>& R_camera_world,
                       const Matrix<T, 2, 3>& projection, Matrix2<T>& information) {
  const Matrix<T, 2, 3> by_world = projection * R_camera_world;
  const Matrix2<T> s = by_world * o.covariance * by_world.transpose();
  const T r = o.sigma_px * o.sigma_px;
  T ia = T(0);
  T ib = T(0);
  T ic = T(0);
  if (!invert_spd2(s(0, 0) + r, T(0.5) * (s(0, 1) + s(1, 0)), s(1, 1) + r, ia, ib, ic)) {
    return false;
  }
  information << ia, ib, ib, ic;
  return true;
}

/// d p_camera / d (rho, phi) = [-I, [p_camera]x], through the projection.
template <class T>
Matrix<T, 2, 6> chain(const Matrix<T, 2, 3>& projection, const Vector3<T>& p_camera) {
  Matrix<T, 2, 6> jacobian;
  jacobian.template leftCols<3>() = -projection;
  for (int row = 0; row < 2; ++row) {  // a^T [p]x = (a x p)^T
    const Vector3<T> a = projection.row(row).transpose();
    jacobian.template block<1, 3>(row, 3) = a.cross(p_camera).transpose();
  }
  return jacobian;
}

template <class T>
T huber_cost(T distance_squared, T threshold) {
  if (distance_squared <= threshold * threshold) return T(0.5) * distance_squared;
  return threshold * (sqrt(distance_squared) - T(0.5) * threshold);
}

/// Inverse of the right Jacobian of SO(3), to the fourth order in the angle.
template <class T>
Matrix3<T> right_jacobian_inverse(const Vector3<T>& phi) {
  const Matrix3<T> s = skew(phi);
  return Matrix3<T>::Identity() + T(0.5) * s + (T(1) / T(12) + phi.dot(phi) / T(720)) * (s * s);
}

template <class T>
void add_prior(const Problem<T>& problem, const Rigid<T>& pose, NormalEquations<T>& normal) {
  const Quaternion<T> back = problem.prior.rotation.conjugate();
  const Quaternion<T> turn = back * pose.rotation;
  const Vector3<T> phi = rotation_log(turn);
  const Vector3<T> rho = back * Vector3<T>(pose.translation - problem.prior.translation);
  Vector<T, 6> error;
  error << rho, phi;
  Matrix<T, 6, 6> jacobian = Matrix<T, 6, 6>::Zero();
  jacobian.template topLeftCorner<3, 3>() = turn.toRotationMatrix();
  jacobian.template bottomRightCorner<3, 3>() = right_jacobian_inverse(phi);
  const Matrix<T, 6, 6>& information = problem.options.prior_information;
  const Matrix<T, 6, 6> weighted = jacobian.transpose() * information;
  normal.information += weighted * jacobian;
  normal.gradient -= weighted * error;
  normal.cost += T(0.5) * error.dot(information * error);
}

/// Normal equations and cost of the robust problem at `pose`.
template <class T>
NormalEquations<T> linearise(const Problem<T>& problem, const Rigid<T>& pose, bool cut_off) {
  NormalEquations<T> normal;
  const T huber = problem.options.huber_sigma;
  const T gate = problem.options.inlier_gate;
  const T largest_cost =
      cut_off ? huber_cost(gate, huber) : huber_cost(square(T(kHiddenPointSigmas)), huber);
  const Matrix3<T> R_camera_world = pose.rotation.conjugate().toRotationMatrix();
  for (int i = 0; i < problem.count; ++i) {
    if (!problem.used(i)) continue;
    const PoseObservation<T>& o = problem.observations[i];
    const Vector3<T> p_camera = R_camera_world * (o.p_world - pose.translation);
    Vector2<T> pixel;
    Matrix<T, 2, 3> projection;
    Matrix2<T> information;
    if (!ok(problem.camera.project(p_camera, pixel, projection)) ||
        !pixel_information(o, R_camera_world, projection, information)) {
      normal.cost += largest_cost;
      continue;
    }
    const Vector2<T> residual = o.pixel - pixel;
    const T d2 = residual.dot(information * residual);
    if (cut_off && !(d2 <= gate)) {
      normal.cost += largest_cost;
      continue;
    }
    normal.cost += huber_cost(d2, huber);
    const T weight = d2 <= huber * huber ? T(1) : huber / sqrt(d2);
    const Matrix<T, 2, 6> jacobian = chain(projection, p_camera);
    const Matrix<T, 2, 6> weighted = weight * (information * jacobian);
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c <= r; ++c) {
        normal.information(r, c) +=
            jacobian(0, r) * weighted(0, c) + jacobian(1, r) * weighted(1, c);
      }
      normal.gradient[r] += weighted(0, r) * residual[0] + weighted(1, r) * residual[1];
    }
  }
  for (int r = 0; r < 6; ++r) {
    for (int c = r + 1; c < 6; ++c) normal.information(r, c) = normal.information(c, r);
  }
  if (problem.options.use_prior) add_prior(problem, pose, normal);
  return normal;
}

/// One phase of damped Gauss-Newton from `pose`; false when the normal matrix is singular.
template <class T>
bool descend(const Problem<T>& problem, bool cut_off, int steps, Rigid<T>& pose,
             NormalEquations<T>& normal, int& iterations) {
  normal = linearise(problem, pose, cut_off);
  T damping = T(0);
  for (int i = 0; i < steps; ++i) {
    Matrix<T, 6, 6> damped = normal.information;
    for (int k = 0; k < 6; ++k) damped(k, k) *= T(1) + damping;
    Matrix<T, 6, 6> inverse;
    if (!detail::invert_spd(damped, detail::min_regular_pivot<T>(), inverse)) return false;
    const Vector<T, 6> step = inverse * normal.gradient;
    const Rigid<T> trial = perturb(pose, step);
    const NormalEquations<T> at_trial = linearise(problem, trial, cut_off);
    ++iterations;
    if (!(at_trial.cost <= normal.cost)) {
      damping = damping > T(0) ? T(10) * damping : T(1e-2);
      continue;
    }
    pose = trial;
    normal = at_trial;
    damping *= T(0.1);
    const T gain = step.dot(damped * step);  // squared length of the step in its own sigmas
    if (gain < T(1e-6)) break;
  }
  return true;
}

template <class T>
void assess(const Problem<T>& problem, const Rigid<T>& pose, PoseEstimate<T>& estimate,
            std::uint8_t* flags) {
  T sum = T(0);
  std::uint32_t cells = 0;
  estimate.inliers = 0;
  for (int i = 0; i < problem.count; ++i) {
    Vector2<T> residual;
    T d2 = T(0);
    const PoseObservation<T>& o = problem.observations[i];
    const bool inlier = problem.used(i) &&
                        ok(reprojection_error(problem.camera, o, pose, residual, d2)) &&
                        d2 <= problem.options.inlier_gate;
    flags[i] = inlier ? 1 : 0;
    if (!inlier) continue;
    ++estimate.inliers;
    sum += residual.dot(residual);
    const T cell_width = static_cast<T>(problem.camera.width) / T(kCellsPerSide);
    const T cell_height = static_cast<T>(problem.camera.height) / T(kCellsPerSide);
    const int column = clamp(round_to_int(floor(o.pixel.x() / cell_width)), 0, kCellsPerSide - 1);
    const int row = clamp(round_to_int(floor(o.pixel.y() / cell_height)), 0, kCellsPerSide - 1);
    cells |= 1U << static_cast<unsigned>(row * kCellsPerSide + column);
  }
  int occupied = 0;
  for (int k = 0; k < kCellsPerSide * kCellsPerSide; ++k) {
    occupied += static_cast<int>((cells >> static_cast<unsigned>(k)) & 1U);
  }
  const T share = static_cast<T>(estimate.inliers) / static_cast<T>(problem.count);
  const T coverage = static_cast<T>(occupied) / static_cast<T>(kCellsForFullQuality);
  estimate.rms_px = estimate.inliers > 0 ? sqrt(sum / static_cast<T>(estimate.inliers)) : T(0);
  estimate.quality = share * (coverage < T(1) ? coverage : T(1));
}

}  // namespace

template <class T>
Status pose_jacobian(const PinholeCamera<T>& camera, const Vector3<T>& p_world,
                     const Rigid<T>& T_world_camera, Vector2<T>& pixel, Matrix<T, 2, 6>& jacobian) {
  const Vector3<T> p_camera = T_world_camera.inverse() * p_world;
  Matrix<T, 2, 3> projection;
  const Status status = camera.project(p_camera, pixel, projection);
  if (ok(status)) jacobian = chain(projection, p_camera);
  return status;
}

template <class T>
Status reprojection_error(const PinholeCamera<T>& camera, const PoseObservation<T>& observation,
                          const Rigid<T>& T_world_camera, Vector2<T>& residual_px,
                          T& mahalanobis_squared) {
  Vector2<T> pixel;
  Matrix<T, 2, 3> projection;
  const Matrix3<T> R_camera_world = T_world_camera.rotation.conjugate().toRotationMatrix();
  const Vector3<T> p_camera = R_camera_world * (observation.p_world - T_world_camera.translation);
  const Status status = camera.project(p_camera, pixel, projection);
  if (!ok(status)) return status;
  Matrix2<T> information;
  if (!pixel_information(observation, R_camera_world, projection, information)) {
    return Status::kSingular;
  }
  residual_px = observation.pixel - pixel;
  mahalanobis_squared = residual_px.dot(information * residual_px);
  return Status::kOk;
}

template <class T>
Status refine_pose(const PinholeCamera<T>& camera, const PoseObservation<T>* observations,
                   int count, const PoseRefinementOptions<T>& options, Rigid<T>& T_world_camera,
                   PoseEstimate<T>& estimate, std::uint8_t* inlier_flags) {
  const Problem<T> problem{camera, observations, count, options, T_world_camera};
  const Status status = check(problem);
  if (!ok(status)) return status;

  const int steps = clamp(options.max_iterations, 1, PoseRefinementOptions<T>::kMaxIterations);
  Rigid<T> pose = T_world_camera;
  NormalEquations<T> normal;
  PoseEstimate<T> result;
  const int coarse_steps = (steps + 1) / 2;
  if (!descend(problem, false, coarse_steps, pose, normal, result.iterations)) {
    return Status::kDegenerate;
  }
  std::uint8_t flags[kMaxPoseObservations];
  assess(problem, pose, result, flags);
  if (result.inliers < options.min_inliers) return Status::kNoConsensus;
  if (!descend(problem, true, steps - coarse_steps, pose, normal, result.iterations) ||
      !detail::invert_spd(normal.information, detail::min_regular_pivot<T>(), result.covariance)) {
    return Status::kDegenerate;
  }
  assess(problem, pose, result, flags);
  if (result.inliers < options.min_inliers) return Status::kNoConsensus;
  T_world_camera = pose;
  estimate = result;
  if (inlier_flags != nullptr) {
    for (int i = 0; i < count; ++i) inlier_flags[i] = flags[i];
  }
  return Status::kOk;
}

template Status refine_pose(const PinholeCamera<float>&, const PoseObservation<float>*, int,
                            const PoseRefinementOptions<float>&, Rigid<float>&,
                            PoseEstimate<float>&, std::uint8_t*);
template Status refine_pose(const PinholeCamera<double>&, const PoseObservation<double>*, int,
                            const PoseRefinementOptions<double>&, Rigid<double>&,
                            PoseEstimate<double>&, std::uint8_t*);
template Status reprojection_error(const PinholeCamera<float>&, const PoseObservation<float>&,
                                   const Rigid<float>&, Vector2<float>&, float&);
template Status reprojection_error(const PinholeCamera<double>&, const PoseObservation<double>&,
                                   const Rigid<double>&, Vector2<double>&, double&);
template Status pose_jacobian(const PinholeCamera<float>&, const Vector3<float>&,
                              const Rigid<float>&, Vector2<float>&, Matrix<float, 2, 6>&);
template Status pose_jacobian(const PinholeCamera<double>&, const Vector3<double>&,
                              const Rigid<double>&, Vector2<double>&, Matrix<double, 2, 6>&);

}  // namespace cairn
