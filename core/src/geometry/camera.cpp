#include "cairn/geometry/camera.hpp"

#include "cairn/numeric/math.hpp"

#include "fisheye_lens.hpp"
#include "rational_lens.hpp"

namespace cairn {
namespace {

constexpr int kRadialSteps = 16;     // the most that random lenses take is 12
constexpr int kTangentialSteps = 4;  // Newton: tangential terms are small beside the radial ones
constexpr int kBorderPoints = 8;     // corners and middles of the sides
template <class T>
constexpr T kLargestResidual_px = T(0.05);

/// The radial part of the lens, d = r (1 + k1 r^2 + k2 r^4 + k3 r^6), out to its fold: the radius
/// at which d begins to fall. Beyond it a pixel stands for two rays.
template <class T>
class RadialModel {
 public:
  explicit RadialModel(const PinholeCamera<T>& camera)
      : k1_(camera.k1), k2_(camera.k2), k3_(camera.k3) {
    // The slope dips lowest where its derivative by r^2 vanishes.
    const T a = T(21) * k3_, b = T(10) * k2_, c = T(3) * k1_;
    const T discriminant = b * b - T(4) * a * c;
    if (!(discriminant >= T(0))) return;
    const T sum = T(-0.5) * (b + (b < T(0) ? -sqrt(discriminant) : sqrt(discriminant)));
    note_dip(c, sum);
    note_dip(sum, a);
  }

  T factor(T r2) const { return T(1) + r2 * (k1_ + r2 * (k2_ + r2 * k3_)); }
  T slope(T r2) const { return T(1) + r2 * (T(3) * k1_ + r2 * (T(5) * k2_ + r2 * T(7) * k3_)); }
  bool is_before_fold(T r2) const { return r2 < fold_after_r2_ && slope(r2) > T(0); }

  /// Radius with d(r) = `distorted`; false where the lens folds before it. Newton's method inside
  /// a bracket that at most doubles.
  bool invert(T distorted, T& r) const {
    T low = T(0);
    T high = fold_after_r2_ < kNoFold ? sqrt(fold_after_r2_) : T(0);
    bool bracketed = high > T(0);
    r = bracketed && distorted >= high ? T(0.5) * high : distorted;
    for (int i = 0; i < kRadialSteps; ++i) {
      const T r2 = r * r;
      T next = high;
      if (is_before_fold(r2)) {
        const T excess = r * factor(r2) - distorted;
        next = r - excess / slope(r2);
        if (abs(next - r) <= kPrecision * r) {
          r = next;
          return true;
        }
        (excess > T(0) ? high : low) = r;
        bracketed = bracketed || excess > T(0);
        if (next > T(2) * r) next = T(2) * r;
      } else {
        high = r;
        bracketed = true;
      }
      const bool inside = next > low && (!bracketed || next < high);
      r = inside ? next : T(0.5) * (low + high);
    }
    return false;
  }

 private:
  static constexpr T kNoFold = T(1e6);  // rays beyond this r^2 are sideways
  /// Of a step; the error after it is about its square.
  static constexpr T kPrecision = sizeof(T) == sizeof(float) ? T(1e-5) : T(1e-9);

  void note_dip(T numerator, T denominator) {
    if (denominator == T(0)) return;
    const T r2 = numerator / denominator;
    if (r2 > T(0) && r2 < fold_after_r2_ && !(slope(r2) > T(0))) fold_after_r2_ = r2;
  }

  T k1_, k2_, k3_;
  T fold_after_r2_ = kNoFold;  ///< the slope is not above zero here
};

/// Distorts (x, y) at depth 1 by a radial-tangential lens, with the derivative. Says nothing about
/// folds.
template <class T>
Vector2<T> distort(const PinholeCamera<T>& camera, T x, T y, Matrix2<T>& derivative) {
  const T p1 = camera.p1, p2 = camera.p2;
  const T r2 = x * x + y * y;
  T radial = T(1) + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3));
  T slope = camera.k1 + r2 * (T(2) * camera.k2 + r2 * T(3) * camera.k3);  // d radial / d r2
  if (camera.is_rational()) {
    const detail::RationalLens<T> lens(camera);
    radial = lens.factor(r2);
    slope = lens.factor_slope(r2);
  }
  const T cross = T(2) * x * y * slope + T(2) * p1 * x + T(2) * p2 * y;
  derivative(0, 0) = radial + T(2) * x * x * slope + T(2) * p1 * y + T(6) * p2 * x;
  derivative(0, 1) = cross;
  derivative(1, 0) = cross;
  derivative(1, 1) = radial + T(2) * y * y * slope + T(6) * p1 * y + T(2) * p2 * x;
  return {x * radial + T(2) * p1 * x * y + p2 * (r2 + T(2) * x * x),
          y * radial + p1 * (r2 + T(2) * y * y) + T(2) * p2 * x * y};
}

/// Whether (x, y) with x^2 + y^2 = r2 lies inside the lens's fold. Most points do by far.
template <class T>
bool is_before_fold(const PinholeCamera<T>& camera, T r2) {
  if (camera.is_rational()) return detail::RationalLens<T>(camera).is_before_fold(sqrt(r2));
  const T most =
      r2 * (T(3) * abs(camera.k1) + r2 * (T(5) * abs(camera.k2) + r2 * T(7) * abs(camera.k3)));
  return most < T(1) || RadialModel<T>(camera).is_before_fold(r2);
}

/// Whether the lens rises all the way to a ray with its tangential terms twice as large, as between
/// the directions that are tried, and so that few steps find each ray.
template <class T>
bool rises_to(PinholeCamera<T> camera, const Vector3<T>& ray) {
  constexpr int kSteps = 24;
  constexpr T kBetweenDirections = T(2);
  camera.p1 *= kBetweenDirections;
  camera.p2 *= kBetweenDirections;
  for (int i = 1; i <= kSteps; ++i) {
    const T share = static_cast<T>(i) / static_cast<T>(kSteps);
    Matrix2<T> slope;
    distort(camera, share * ray.x(), share * ray.y(), slope);
    const T determinant = slope(0, 0) * slope(1, 1) - slope(0, 1) * slope(1, 0);
    if (!(slope(0, 0) > T(0) && determinant > T(0))) return false;
  }
  return true;
}

/// Newton's method on both coordinates, from the ray of the radial part alone. False where it does
/// not come within kLargestResidual_px.
template <class T>
bool add_tangential(const PinholeCamera<T>& camera, const Vector2<T>& distorted, Vector2<T>& ray) {
  Matrix2<T> derivative;
  for (int i = 0; i < kTangentialSteps; ++i) {
    const Vector2<T> off = distorted - distort(camera, ray.x(), ray.y(), derivative);
    const T determinant = derivative(0, 0) * derivative(1, 1) - derivative(0, 1) * derivative(1, 0);
    if (!(determinant > T(0))) return false;
    const T scale = T(1) / determinant;
    ray.x() += scale * (derivative(1, 1) * off.x() - derivative(0, 1) * off.y());
    ray.y() += scale * (derivative(0, 0) * off.y() - derivative(1, 0) * off.x());
  }
  const Vector2<T> off = distorted - distort(camera, ray.x(), ray.y(), derivative);
  return abs(off.x()) * camera.fx <= kLargestResidual_px<T> &&
         abs(off.y()) * camera.fy <= kLargestResidual_px<T> &&
         is_before_fold(camera, ray.squaredNorm());
}

}  // namespace

template <class T>
Status PinholeCamera<T>::check_numbers() const {
  // Of the longer side: beyond these a pixel's ray is no number.
  constexpr T kLeastFocalShare = T(1e-3);
  constexpr T kMostFocalShare = T(1e4);
  const T values[] = {fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6};
  for (const T v : values) {
    if (!is_finite(v)) return Status::kBadConfig;
  }
  const bool of_fisheye = p1 == T(0) && p2 == T(0) && k5 == T(0) && k6 == T(0);
  if (lens != Lens::kRadialTangential && !(lens == Lens::kFisheye && of_fisheye)) {
    return Status::kBadConfig;
  }
  const auto side = static_cast<T>(width > height ? width : height);
  const auto is_focal_length = [side](T f) {
    return f >= side * kLeastFocalShare && f <= side * kMostFocalShare;
  };
  const bool good = width > 0 && height > 0 && is_focal_length(fx) && is_focal_length(fy) &&
                    cx >= T(0) && cy >= T(0) && cx < static_cast<T>(width) &&
                    cy < static_cast<T>(height);
  return good ? Status::kOk : Status::kBadConfig;
}

template <class T>
Status PinholeCamera<T>::validate() const {
  const Status status = check_numbers();
  if (!ok(status) || !has_distortion()) return status;
  const T right = static_cast<T>(width - 1);
  const T bottom = static_cast<T>(height - 1);
  const Vector2<T> border[kBorderPoints] = {{T(0), T(0)},    {right, T(0)}, {T(0), bottom},
                                            {right, bottom}, {cx, T(0)},    {cx, bottom},
                                            {T(0), cy},      {right, cy}};
  for (const Vector2<T>& pixel : border) {
    Vector3<T> ray;
    Vector2<T> back;
    Matrix<T, 2, 3> slope;
    if (!ok(unproject(pixel, ray)) || !ok(project(ray, back, slope))) return Status::kBadConfig;
    const T area = slope(0, 0) * slope(1, 1) - slope(0, 1) * slope(1, 0);
    if (!(area <= kMostEnlarged * fx * fy)) return Status::kBadConfig;
    if ((p1 != T(0) || p2 != T(0)) && !rises_to(*this, ray)) return Status::kBadConfig;
  }
  return Status::kOk;
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
  Vector2<T> distorted(x, y);
  if (lens == Lens::kFisheye) {
    if (!detail::FisheyeLens<T>(*this).distort(x, y, distorted, distortion)) {
      return Status::kOutOfView;
    }
  } else if (has_distortion()) {
    if (!is_before_fold(*this, x * x + y * y)) return Status::kOutOfView;
    distorted = distort(*this, x, y, distortion);
  }
  pixel = Vector2<T>(fx * distorted.x() + cx, fy * distorted.y() + cy);
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
Status PinholeCamera<T>::unproject(const Vector2<T>& pixel, Vector3<T>& ray) const {
  const Vector2<T> distorted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  ray = {distorted.x(), distorted.y(), T(1)};
  if (!has_distortion()) return Status::kOk;
  const T radius = sqrt(distorted.squaredNorm());
  if (radius == T(0)) return Status::kOk;
  T r = radius;
  bool found = false;
  if (lens == Lens::kFisheye) {
    found = detail::FisheyeLens<T>(*this).undistort(radius, r);
  } else if (is_rational()) {
    found = detail::invert(detail::RationalLens<T>(*this), radius, kWidestFisheyeRay, r);
  } else {
    found = RadialModel<T>(*this).invert(radius, r);
  }
  Vector2<T> flat = distorted * (r / radius);
  if (found && (p1 != T(0) || p2 != T(0))) found = add_tangential(*this, distorted, flat);
  ray = {flat.x(), flat.y(), T(1)};
  return found ? Status::kOk : Status::kOutOfView;
}

template <class T>
Vector3<T> PinholeCamera<T>::unproject(const Vector2<T>& pixel) const {
  Vector3<T> ray;
  static_cast<void>(unproject(pixel, ray));
  return ray;
}

template struct PinholeCamera<float>;
template struct PinholeCamera<double>;

}  // namespace cairn
