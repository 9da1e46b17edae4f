#include "cairn/geometry/camera.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {

template <class T>
Status PinholeCamera<T>::validate() const {
  const T values[] = {fx, fy, cx, cy, k1, k2, p1, p2, k3};
  for (const T v : values) {
    if (!is_finite(v)) return Status::kBadConfig;
  }
  const bool good = fx > T(0) && fy > T(0) && width > 0 && height > 0 && cx >= T(0) && cy >= T(0) &&
                    cx < static_cast<T>(width) && cy < static_cast<T>(height);
  return good ? Status::kOk : Status::kBadConfig;
}

template <class T>
Status PinholeCamera<T>::project(const Vector3<T>& p_camera, Vector2<T>& pixel) const {
  Matrix<T, 2, 3> unused;
  return project(p_camera, pixel, unused);
}

template <class T>
Status PinholeCamera<T>::project(const Vector3<T>& p_camera, Vector2<T>& pixel,
                                 Matrix<T, 2, 3>& jacobian) const {
  const T z = p_camera.z();
  if (!(z >= kMinDepth)) return Status::kOutOfView;
  const T inverse_z = T(1) / z;
  const T x = p_camera.x() * inverse_z;
  const T y = p_camera.y() * inverse_z;
  Matrix2<T> distortion = Matrix2<T>::Identity();  // d distorted / d (x, y)
  T xd = x;
  T yd = y;
  if (has_distortion()) {
    const T r2 = x * x + y * y;
    const T radial = T(1) + r2 * (k1 + r2 * (k2 + r2 * k3));
    const T slope = k1 + r2 * (T(2) * k2 + r2 * T(3) * k3);  // d radial / d r2
    if (!(radial + T(2) * r2 * slope > T(0)) || !(radial > T(0))) return Status::kOutOfView;
    xd = x * radial + T(2) * p1 * x * y + p2 * (r2 + T(2) * x * x);
    yd = y * radial + p1 * (r2 + T(2) * y * y) + T(2) * p2 * x * y;
    const T cross = T(2) * x * y * slope + T(2) * p1 * x + T(2) * p2 * y;
    distortion(0, 0) = radial + T(2) * x * x * slope + T(2) * p1 * y + T(6) * p2 * x;
    distortion(0, 1) = cross;
    distortion(1, 0) = cross;
    distortion(1, 1) = radial + T(2) * y * y * slope + T(6) * p1 * y + T(2) * p2 * x;
  }
  pixel = Vector2<T>(fx * xd + cx, fy * yd + cy);
  for (int c = 0; c < 2; ++c) {
    const T focal = c == 0 ? fx : fy;
    const T dx = focal * distortion(c, 0) * inverse_z;
    const T dy = focal * distortion(c, 1) * inverse_z;
    jacobian(c, 0) = dx;
    jacobian(c, 1) = dy;
    jacobian(c, 2) = -(dx * x + dy * y);
  }
  return Status::kOk;
}

template <class T>
Vector3<T> PinholeCamera<T>::unproject(const Vector2<T>& pixel) const {
  const T xd = (pixel.x() - cx) / fx;
  const T yd = (pixel.y() - cy) / fy;
  T x = xd;
  T y = yd;
  if (has_distortion()) {
    for (int i = 0; i < kUndistortSteps; ++i) {
      const T r2 = x * x + y * y;
      const T radial = T(1) + r2 * (k1 + r2 * (k2 + r2 * k3));
      const T inverse = radial > T(0.1) ? T(1) / radial : T(10);
      const T dx = T(2) * p1 * x * y + p2 * (r2 + T(2) * x * x);
      const T dy = p1 * (r2 + T(2) * y * y) + T(2) * p2 * x * y;
      x = (xd - dx) * inverse;
      y = (yd - dy) * inverse;
    }
  }
  return {x, y, T(1)};
}

template struct PinholeCamera<float>;
template struct PinholeCamera<double>;

}  // namespace cairn
