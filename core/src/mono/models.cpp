#include "cairn/mono/models.hpp"

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn::mono {
namespace {

/// Matrix of p -> q * p.
template <class T>
Matrix<T, 4, 4> left_product(const Vector<T, 4>& q) {
  Matrix<T, 4, 4> m;
  m << q(0), -q(1), -q(2), -q(3), q(1), q(0), -q(3), q(2), q(2), q(3), q(0), -q(1), q(3), -q(2),
      q(1), q(0);
  return m;
}

/// Matrix of p -> p * q.
template <class T>
Matrix<T, 4, 4> right_product(const Vector<T, 4>& q) {
  Matrix<T, 4, 4> m;
  m << q(0), -q(1), -q(2), -q(3), q(1), q(0), q(3), -q(2), q(2), -q(3), q(0), q(1), q(3), q(2),
      -q(1), q(0);
  return m;
}

}  // namespace

template <class T>
Matrix3<T> rotation_matrix(const Vector<T, 4>& q) {
  const T w = q(0), x = q(1), y = q(2), z = q(3);
  Matrix3<T> r;
  r << w * w + x * x - y * y - z * z, T(2) * (x * y - w * z), T(2) * (z * x + w * y),
      T(2) * (x * y + w * z), w * w - x * x + y * y - z * z, T(2) * (y * z - w * x),
      T(2) * (z * x - w * y), T(2) * (y * z + w * x), w * w - x * x - y * y + z * z;
  return r;
}

template <class T>
Matrix<T, 3, 4> rotated_wrt_quaternion(const Vector<T, 4>& q, const Vector3<T>& v) {
  const T w = q(0), x = q(1), y = q(2), z = q(3);
  const T a = v(0), b = v(1), c = v(2);
  const T s0 = w * a - z * b + y * c;
  const T s1 = z * a + w * b - x * c;
  const T s2 = -y * a + x * b + w * c;
  const T s3 = x * a + y * b + z * c;
  Matrix<T, 3, 4> j;
  j << s0, s3, s2, -s1, s1, -s2, s3, s0, s2, s1, -s0, s3;
  return T(2) * j;
}

template <class T>
Matrix<T, 3, 4> unrotated_wrt_quaternion(const Vector<T, 4>& q, const Vector3<T>& v) {
  Matrix<T, 3, 4> j = rotated_wrt_quaternion<T>(Vector<T, 4>(q(0), -q(1), -q(2), -q(3)), v);
  j.template rightCols<3>() = -j.template rightCols<3>().eval();
  return j;
}

template <class T>
RotationStep<T> rotation_step(const Vector<T, 4>& q, const Vector3<T>& rate_radps, T dt_s) {
  const Vector3<T> phi = rate_radps * dt_s;
  const T angle = sqrt(phi.dot(phi));
  Vector<T, 4> step;
  Matrix<T, 4, 3> step_wrt_phi = Matrix<T, 4, 3>::Zero();
  if (angle < T(1e-5)) {
    step << T(1), T(0.5) * phi(0), T(0.5) * phi(1), T(0.5) * phi(2);
    for (int i = 0; i < 3; ++i) {
      step_wrt_phi(0, i) = T(-0.25) * phi(i);
      step_wrt_phi(i + 1, i) = T(0.5);
    }
  } else {
    T sine = T(0);
    T cosine = T(1);
    sin_cos(T(0.5) * angle, sine, cosine);
    const Vector3<T> u = phi / angle;
    step << cosine, sine * u(0), sine * u(1), sine * u(2);
    const T along = T(0.5) * cosine;
    const T across = sine / angle;
    for (int c = 0; c < 3; ++c) {
      step_wrt_phi(0, c) = T(-0.5) * sine * u(c);
      for (int r = 0; r < 3; ++r) {
        step_wrt_phi(r + 1, c) = (along - across) * u(r) * u(c) + (r == c ? across : T(0));
      }
    }
  }
  const Matrix<T, 4, 4> left = left_product<T>(q);
  RotationStep<T> out;
  out.q = left * step;
  out.wrt_q = right_product<T>(step);
  out.wrt_rate = left * step_wrt_phi * dt_s;
  return out;
}

template <class T>
Matrix<T, 4, 4> normalisation_jacobian(const Vector<T, 4>& q) {
  const T squared = q.dot(q);
  const T cube = squared * sqrt(squared);
  Matrix<T, 4, 4> j;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) j(r, c) = ((r == c ? squared : T(0)) - q(r) * q(c)) / cube;
  }
  return j;
}

template <class T>
Direction<T> direction(T theta, T phi) {
  T st = T(0), ct = T(1), sp = T(0), cp = T(1);
  sin_cos(theta, st, ct);
  sin_cos(phi, sp, cp);
  Direction<T> out;
  out.m << cp * st, -sp, cp * ct;
  out.wrt_angles << cp * ct, -sp * st, T(0), -cp, -cp * st, -sp * ct;
  return out;
}

template <class T>
Angles<T> angles_of(const Vector3<T>& v) {
  const T flat_squared = v(0) * v(0) + v(2) * v(2);
  const T flat = sqrt(flat_squared);
  const T squared = flat_squared + v(1) * v(1);
  Angles<T> out;
  out.theta = atan2(v(0), v(2));
  out.phi = atan2(-v(1), flat);
  out.wrt_v << v(2) / flat_squared, T(0), -v(0) / flat_squared, v(0) * v(1) / (squared * flat),
      -flat / squared, v(2) * v(1) / (squared * flat);
  return out;
}

template <class T>
Status project_ray(const PinholeCamera<T>& camera, T focal_factor, const Vector<T, 4>& q,
                   const Vector3<T>& ray, RayPixel<T>& out) {
  const Matrix3<T> R_world_camera = rotation_matrix<T>(q);
  const Vector3<T> ray_camera = R_world_camera.transpose() * ray;
  Matrix<T, 2, 3> wrt_camera;
  const Status status = camera.project(ray_camera, out.pixel, wrt_camera);
  if (!ok(status)) return status;
  out.ray_camera = ray_camera;
  out.wrt_ray = wrt_camera * R_world_camera.transpose();
  out.wrt_q = wrt_camera * unrotated_wrt_quaternion<T>(q, ray);
  out.wrt_focal << (out.pixel.x() - camera.cx) / focal_factor,
      (out.pixel.y() - camera.cy) / focal_factor;
  return Status::kOk;
}

template <class T>
Status pixel_ray(const PinholeCamera<T>& camera, T focal_factor, const Vector2<T>& pixel,
                 PixelRay<T>& out) {
  const Vector3<T> ray = camera.unproject(pixel);
  Vector2<T> back;
  Matrix<T, 2, 3> forward;
  if (!ok(camera.project(ray, back, forward))) return Status::kDegenerate;
  const T determinant = forward(0, 0) * forward(1, 1) - forward(0, 1) * forward(1, 0);
  if (!(abs(determinant) > T(1e-6) * camera.fx * camera.fy)) return Status::kDegenerate;
  const T scale = T(1) / determinant;
  out.ray_camera = ray;
  out.wrt_pixel << forward(1, 1) * scale, -forward(0, 1) * scale, -forward(1, 0) * scale,
      forward(0, 0) * scale, T(0), T(0);
  const Vector2<T> by_focal((pixel.x() - camera.cx) / focal_factor,
                            (pixel.y() - camera.cy) / focal_factor);
  out.wrt_focal = -(out.wrt_pixel * by_focal);
  return Status::kOk;
}

#define CAIRN_MONO_INSTANTIATE(T)                                                               \
  template Matrix3<T> rotation_matrix<T>(const Vector<T, 4>&);                                  \
  template Matrix<T, 3, 4> rotated_wrt_quaternion<T>(const Vector<T, 4>&, const Vector3<T>&);   \
  template Matrix<T, 3, 4> unrotated_wrt_quaternion<T>(const Vector<T, 4>&, const Vector3<T>&); \
  template RotationStep<T> rotation_step<T>(const Vector<T, 4>&, const Vector3<T>&, T);         \
  template Matrix<T, 4, 4> normalisation_jacobian<T>(const Vector<T, 4>&);                      \
  template Direction<T> direction<T>(T, T);                                                     \
  template Angles<T> angles_of<T>(const Vector3<T>&);                                           \
  template Status project_ray<T>(const PinholeCamera<T>&, T, const Vector<T, 4>&,               \
                                 const Vector3<T>&, RayPixel<T>&);                              \
  template Status pixel_ray<T>(const PinholeCamera<T>&, T, const Vector2<T>&, PixelRay<T>&);

CAIRN_MONO_INSTANTIATE(float)
CAIRN_MONO_INSTANTIATE(double)
#undef CAIRN_MONO_INSTANTIATE

}  // namespace cairn::mono
