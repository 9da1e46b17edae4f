#include "cairn/window/window_pose.hpp"

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/window/inverse_depth_view.hpp"

namespace cairn {
namespace {

/// A sighting at a pose: residual, its inverse covariance and squared distance.
template <class T>
struct Linearised {
  InverseDepthView<T> view;
  Vector3<T> from_host = Vector3<T>::Zero();
  Vector2<T> residual = Vector2<T>::Zero();
  T w00 = T(0);
  T w01 = T(0);
  T w11 = T(0);
  T distance = T(0);  ///< squared

  /// False where the point is not in front of the camera.
  bool at(const WindowSighting<T>& s, const Matrix3<T>& rotation, const Vector3<T>& translation,
          T variance) {
    view.p = rotation * s.direction + s.rho * translation;
    if (!(view.p.z() >= InverseDepthView<T>::kLeastDepth)) return false;
    const T inverse = T(1) / view.p.z();
    view.seen = Vector2<T>(view.p.x() * inverse, view.p.y() * inverse);
    from_host = translation + rotation * s.host;
    residual = s.seen - view.seen;
    const T du = s.sigma * inverse * (from_host.x() - view.seen.x() * from_host.z());
    const T dv = s.sigma * inverse * (from_host.y() - view.seen.y() * from_host.z());
    if (!invert_spd2(variance + du * du, du * dv, variance + dv * dv, w00, w01, w11)) return false;
    const T x = residual.x();
    const T y = residual.y();
    distance = w00 * x * x + T(2) * w01 * x * y + w11 * y * y;
    return true;
  }
};

template <class T>
struct Normal {
  Matrix<T, 6, 6> information = Matrix<T, 6, 6>::Zero();  ///< lower triangle
  Vector<T, 6> gradient = Vector<T, 6>::Zero();

  void add(const Linearised<T>& at, T rho, T weight) {
    const InverseDepthJacobian<T> j(at.view, at.from_host, rho);
    const T x = at.residual.x();
    const T y = at.residual.y();
    for (int r = 0; r < 6; ++r) {
      const T u = weight * (at.w00 * j.by_pose[0][r] + at.w01 * j.by_pose[1][r]);
      const T v = weight * (at.w01 * j.by_pose[0][r] + at.w11 * j.by_pose[1][r]);
      for (int c = 0; c <= r; ++c) information(r, c) += u * j.by_pose[0][c] + v * j.by_pose[1][c];
      gradient(r) += u * x + v * y;
    }
  }
  void add_attitude(const Quaternion<T>& expected, const Quaternion<T>& present, T weight) {
    const Vector3<T> left = rotation_log(expected * present.conjugate());
    for (int r = 0; r < 3; ++r) {
      information(r, r) += weight;
      gradient(r) += weight * left(r);
    }
  }
  void add_centre(const WindowPoseOptions<T>& options, const Rigid<T>& present) {
    const Vector3<T> left =
        present.rotation * Vector3<T>(present.inverse().translation - options.centre);
    T weight = options.centre_information;
    const T distance = sqrt(weight * left.squaredNorm());
    if (distance > options.centre_huber_sigma) weight *= options.centre_huber_sigma / distance;
    for (int r = 0; r < 3; ++r) {
      information(3 + r, 3 + r) += weight;
      gradient(3 + r) += weight * left(r);
    }
  }
  bool inverse(Matrix<T, 6, 6>& result) {
    // Turn and translation are nearly the same where little depth is known: a little of Levenberg's
    // damping keeps the step finite.
    constexpr T kDamping = T(1e-5);
    for (int r = 0; r < 6; ++r) information(r, r) *= T(1) + kDamping;
    return detail::invert_spd(information, T(0.1) * kDamping, result);
  }
};

}  // namespace

template <class T>
int estimate_window_pose(WindowSighting<T>* sightings, int count,
                         const WindowPoseOptions<T>& options, Rigid<T>& T_camera_world,
                         Matrix<T, 6, 6>& covariance) {
  constexpr T kSmallStep = T(1e-6);
  const T variance = options.sigma * options.sigma;
  const int most = clamp(options.max_iterations, 1, WindowPoseOptions<T>::kMaxIterations);
  Rigid<T> pose = T_camera_world;
  Matrix<T, 6, 6> inverse;
  Linearised<T> at;
  for (int iteration = 0; iteration < most; ++iteration) {
    const Matrix3<T> rotation = pose.rotation.toRotationMatrix();
    Normal<T> normal;
    for (int i = 0; i < count; ++i) {
      if (!at.at(sightings[i], rotation, pose.translation, variance)) continue;
      if (iteration >= most / 2 && at.distance > options.cut_sigma * options.cut_sigma) continue;
      const T distance = sqrt(at.distance);
      const T weight = distance < options.huber_sigma ? T(1) : options.huber_sigma / distance;
      normal.add(at, sightings[i].rho, weight);
    }
    if (options.attitude_information > T(0)) {
      normal.add_attitude(options.attitude, pose.rotation, options.attitude_information);
    }
    if (options.centre_information > T(0)) normal.add_centre(options, pose);
    if (!normal.inverse(inverse)) return -1;
    const Vector<T, 6> step = inverse * normal.gradient;
    if (!is_finite(step.squaredNorm())) return -1;
    pose = perturbed(pose, step.data());
    if (step.squaredNorm() < kSmallStep * kSmallStep) break;
  }
  const Matrix3<T> rotation = pose.rotation.toRotationMatrix();
  int inliers = 0;
  for (int i = 0; i < count; ++i) {
    WindowSighting<T>& s = sightings[i];
    s.inlier = at.at(s, rotation, pose.translation, variance) && at.distance < options.inlier_gate;
    inliers += s.inlier ? 1 : 0;
  }
  T_camera_world = pose;
  covariance = inverse;
  return inliers;
}

template int estimate_window_pose(WindowSighting<float>*, int, const WindowPoseOptions<float>&,
                                  Rigid<float>&, Matrix<float, 6, 6>&);
template int estimate_window_pose(WindowSighting<double>*, int, const WindowPoseOptions<double>&,
                                  Rigid<double>&, Matrix<double, 6, 6>&);

}  // namespace cairn
