#include "cairn/tracking/epipolar_pair.hpp"

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/numeric/float_bits.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kBits = 26;
constexpr std::int32_t kLongestTangent =
    static_cast<std::int32_t>((std::int64_t{39} << kBits) / 10);  // of squared rays: below 32
constexpr std::int64_t kLargestResidual = std::int64_t{1} << kBits;
constexpr std::int32_t kLeastDepth = (1 << kBits) / 10;
// Views at two pixels of five hundred from the direction of travel have a line that noise turns.
constexpr std::int64_t kLeastSquaredLine = std::int64_t{1} << (2 * kBits - 16);
constexpr std::int32_t kMostDerivative = 1 << 28;  // 8 fraction bits: sums of products fit 64 bits
constexpr float kMostFocal = 16000.0F;
constexpr float kLeastMotion_m = 1e-4F;

std::int32_t raw_of(float value, int bits) {
  std::uint32_t saturations = 0;
  return wide::narrow(detail::fixed_from_float(value, bits, saturations), saturations);
}

std::int32_t reduced(std::int64_t product) {
  return static_cast<std::int32_t>(wide::round_shift_far(product, kBits));
}

}  // namespace

/// Of one point: its rays, its epipolar lines in both pictures, and the length of the gradient of
/// e = second . (t x R first) by the four tangents.
struct EpipolarPair::Lines {
  Vector first;
  Vector second;
  Vector turned;             ///< R first
  Vector normal;             ///< second x t
  Vector line;               ///< t x turned
  Vector line_first;         ///< R^T normal
  std::int64_t inverse = 0;  ///< 1 / gradient 2^(60 - shift)
  int shift = 0;
  std::int64_t residual = 0;  ///< e / gradient, kBits fraction bits

  /// value / gradient, `fewer` fraction bits less.
  std::int64_t normalised(std::int64_t value, int fewer) const {
    return wide::round_shift_far(value * inverse, shift + fewer);
  }
  /// Derivative of the residual by what changes e (52 fraction bits) and both lines: 18 fraction
  /// bits.
  __attribute__((noinline)) std::int64_t derivative(std::int64_t d_e, const Vector& d_line,
                                                    const Vector& d_line_first) const {
    const std::int64_t along = std::int64_t{line.x} * d_line.x + std::int64_t{line.y} * d_line.y +
                               std::int64_t{line_first.x} * d_line_first.x +
                               std::int64_t{line_first.y} * d_line_first.y;
    const std::int64_t relative = normalised(normalised(along >> 29, 0), 5);
    return normalised(d_e >> 28, 24 - 18) - wide::round_shift_far(residual * relative, kBits);
  }
};

/// 8 fraction bits by radians, 12 of the residual; in standard deviations of a view.
struct EpipolarPair::Row {
  std::int64_t residual = 0;
  std::int32_t by[kAll] = {};  ///< the camera's parts first

  bool set(int part, std::int64_t derivative, std::int32_t focal) {
    const std::int64_t value = wide::round_shift_far(derivative * focal, 18);
    by[part] = static_cast<std::int32_t>(value);
    return value < kMostDerivative && value > -kMostDerivative;
  }
};

EpipolarPair::Vector EpipolarPair::vector_of(const Vector3<float>& v) {
  return {raw_of(v.x(), kBits), raw_of(v.y(), kBits), raw_of(v.z(), kBits)};
}
EpipolarPair::Vector EpipolarPair::cross(const Vector& a, const Vector& b) {
  return {reduced(std::int64_t{a.y} * b.z - std::int64_t{a.z} * b.y),
          reduced(std::int64_t{a.z} * b.x - std::int64_t{a.x} * b.z),
          reduced(std::int64_t{a.x} * b.y - std::int64_t{a.y} * b.x)};
}
std::int64_t EpipolarPair::dot(const Vector& a, const Vector& b) {
  return std::int64_t{a.x} * b.x + std::int64_t{a.y} * b.y + std::int64_t{a.z} * b.z;
}
EpipolarPair::Vector EpipolarPair::sum(const Vector& a, const Vector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
EpipolarPair::Vector EpipolarPair::difference(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
EpipolarPair::Vector EpipolarPair::turn(const Vector (&rows)[3], const Vector& v) {
  return {reduced(dot(rows[0], v)), reduced(dot(rows[1], v)), reduced(dot(rows[2], v))};
}

EpipolarPair::EpipolarPair(const Camera& camera, const Rigid<float>& T_second_first,
                           const float (&sigma_motion)[kMotions])
    : rotation_vehicle_camera_(camera.rotation_vehicle_camera),
      focal_px_(camera.focal_px / camera.view_scale) {
  const Matrix3<float> R_second_first = T_second_first.rotation.toRotationMatrix();
  const Matrix3<float> to_camera = rotation_vehicle_camera_.transpose();
  R_ = to_camera * R_second_first * rotation_vehicle_camera_;
  const Vector3<float> t =
      to_camera * (R_second_first * camera.origin_m + T_second_first.translation - camera.origin_m);
  const float length_m = t.norm();
  moved_ = length_m > kLeastMotion_m;
  if (moved_) t_ = vector_of((1.0F / length_m) * t);
  for (int i = 0; i < kMotions; ++i) {
    prior_[i] = 1.0F / square(sigma_motion[i]);
    sigma_[i] = raw_of(sigma_motion[i], 28);
    axes_[i] = vector_of(rotation_vehicle_camera_.row(i).transpose());
  }
  scale_ = raw_of(camera.view_scale, 28);
  focal_ = raw_of(clamp(focal_px_ / camera.sigma_px, 0.0F, kMostFocal), 8);
  take_rotation();
}

void EpipolarPair::take_rotation() {
  for (int i = 0; i < 3; ++i) {
    rows_[i] = vector_of(R_.row(i).transpose());
    columns_[i] = vector_of(R_.col(i));
  }
}

bool EpipolarPair::ray(const FixedTangent (&view)[2], Vector& out) const {
  const auto scaled = [&](FixedTangent tangent) {
    return wide::round_shift_far(std::int64_t{tangent.raw()} * scale_, 28 + 28 - kBits);
  };
  const std::int64_t x = scaled(view[0]);
  const std::int64_t y = scaled(view[1]);
  if (wide::magnitude(x) > kLongestTangent || wide::magnitude(y) > kLongestTangent) return false;
  out = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), 1 << kBits};
  return true;
}

float EpipolarPair::flow_px(const TwoViews& views) const {
  Vector first;
  Vector second;
  if (!ray(views.first, first) || !ray(views.second, second)) return 0.0F;
  const Vector turned = turn(rows_, first);
  if (turned.z < kLeastDepth) return 0.0F;
  const auto moved = [&](std::int32_t from, std::int32_t to) {
    const std::int64_t tangent = std::int64_t{from} * (1 << kBits) / turned.z;
    return static_cast<float>(tangent - to);
  };
  const float x = moved(turned.x, second.x);
  const float y = moved(turned.y, second.y);
  return focal_px_ / (1 << kBits) * sqrt(x * x + y * y);
}

bool EpipolarPair::lines_of(const TwoViews& views, Lines& out) const {
  if (!moved_ || !ray(views.first, out.first) || !ray(views.second, out.second)) return false;
  out.turned = turn(rows_, out.first);
  out.normal = cross(out.second, t_);
  out.line = cross(t_, out.turned);
  out.line_first = turn(columns_, out.normal);
  const auto squared_slope = [](const Vector& line) {
    return std::int64_t{line.x} * line.x + std::int64_t{line.y} * line.y;
  };
  const std::int64_t squared = squared_slope(out.line) + squared_slope(out.line_first);
  if (squared < kLeastSquaredLine) return false;
  const FixedRoot gradient = square_root(squared, 2 * kBits);
  out.inverse = (std::int64_t{1} << 60) / gradient.mantissa;
  out.shift = 60 - gradient.bits;
  out.residual = out.normalised(reduced(dot(out.turned, out.normal)), 0);
  return true;
}

bool EpipolarPair::derive_by_motion(const Lines& lines, Row& row) const {
  bool fits = true;
  for (int i = 0; i < kMotions; ++i) {
    const Vector d_turned = cross(axes_[i], lines.turned);
    const Vector d_line_first = turn(columns_, cross(lines.normal, axes_[i]));
    fits = row.set(kParts + i,
                   lines.derivative(dot(d_turned, lines.normal), cross(t_, d_turned), d_line_first),
                   focal_) &&
           fits;
  }
  return fits;
}

bool EpipolarPair::derive_by_camera(const Lines& lines, Row& row) const {
  bool fits = true;
  constexpr int kAxis[3] = {2, 1, 0};  // of yaw, pitch, roll
  for (int i = 0; i < 3; ++i) {
    const Vector& axis = axes_[kAxis[i]];
    const Vector d_t = cross(t_, axis);
    const Vector d_turned =
        difference(turn(rows_, cross(axis, lines.first)), cross(axis, lines.turned));
    const Vector d_normal = cross(lines.second, d_t);
    const Vector d_line = sum(cross(d_t, lines.turned), cross(t_, d_turned));
    const Vector d_line_first = difference(turn(columns_, sum(cross(axis, lines.normal), d_normal)),
                                           cross(axis, lines.line_first));
    fits = row.set(i,
                   lines.derivative(dot(d_turned, lines.normal) + dot(lines.turned, d_normal),
                                    d_line, d_line_first),
                   focal_) &&
           fits;
  }
  // A longer focal length makes rays narrower and pixels larger.
  const Vector d_turned = turn(rows_, {-lines.first.x, -lines.first.y, 0});
  const Vector d_normal = cross({-lines.second.x, -lines.second.y, 0}, t_);
  const std::int64_t narrower =
      lines.derivative(dot(d_turned, lines.normal) + dot(lines.turned, d_normal),
                       cross(t_, d_turned), turn(columns_, d_normal));
  const std::int64_t larger = wide::round_shift_far(lines.residual, kBits - 18);
  return row.set(MountOffset::kFocal, larger + narrower, focal_) && fits;
}

/// With 24 fraction bits. The motion is unsure until it is refined.
std::int64_t EpipolarPair::variance_of(const Row& row) const {
  std::int64_t variance = std::int64_t{1} << 24;
  for (int i = 0; i < kMotions && !refined_; ++i) {
    const std::int64_t part =
        wide::round_shift_far(std::int64_t{row.by[kParts + i]} * sigma_[i], 24);
    variance += square(clamp(part, -std::int64_t{kMostDerivative}, std::int64_t{kMostDerivative}));
  }
  return variance;
}

void EpipolarPair::add(const TwoViews& views) {
  Lines lines;
  Row row;
  if (!lines_of(views, lines)) return;
  if (wide::magnitude(lines.residual) > kLargestResidual) {
    ++outliers_;
    return;
  }
  if (!derive_by_motion(lines, row)) return;
  if (refined_ && !derive_by_camera(lines, row)) return;
  row.residual = wide::round_shift_far(lines.residual * focal_, kBits + 8 - 12);
  const std::int64_t variance = variance_of(row);
  const std::int64_t squared = row.residual * row.residual;
  if (squared >> 4 >= variance) {  // four standard deviations
    ++outliers_;
    return;
  }
  std::int64_t weight = 1 << 12;  // Huber's, beyond two
  if (squared >> 2 > variance) {
    const FixedRoot sigma = square_root(variance, 24);
    weight = ((std::int64_t{sigma.mantissa} << (1 + 12 + 12)) >> sigma.bits) /
             static_cast<std::int64_t>(wide::magnitude(row.residual));
  }
  int at = 0;
  for (int i = 0; i < kAll; ++i) {
    const std::int64_t weighted = wide::round_shift_far(weight * row.by[i], 12);
    right_[i] += weighted * row.residual;
    for (int k = 0; k <= i; ++k) information_[at++] += weighted * row.by[k];
  }
  squares_ += wide::round_shift_far(weight * squared, 12);
  ++added_;
}

void EpipolarPair::refine_motion() {
  const Equations found = equations();
  Matrix3<float> information = found.motion;
  information.diagonal() += prior_;
  Matrix3<float> inverse;
  if (!detail::invert_spd(information, detail::min_regular_pivot<float>(), inverse)) return;
  const Vector3<float> step = -(inverse * (found.right_motion + prior_.cwiseProduct(correction_)));
  const Vector3<float> turn = rotation_vehicle_camera_.transpose() * step;
  R_ = rotation_exp(turn).toRotationMatrix() * R_;
  correction_ += step;
  take_rotation();
  for (std::int64_t& sum : information_) sum = 0;
  for (std::int64_t& sum : right_) sum = 0;
  squares_ = 0;
  added_ = outliers_ = 0;
  refined_ = true;
}

EpipolarPair::Equations EpipolarPair::equations() const {
  Equations out;
  const auto information = [&](int i, int k) {
    return detail::float_from_fixed(information_[i * (i + 1) / 2 + k], 16);
  };
  const auto right = [&](int i) { return detail::float_from_fixed(right_[i], 20); };
  for (int i = 0; i < kParts; ++i) {
    out.right[i] = right(i);
    for (int k = 0; k <= i; ++k) out.information[i][k] = out.information[k][i] = information(i, k);
    for (int k = 0; k < kMotions; ++k) out.mixed[i][k] = information(kParts + k, i);
  }
  for (int i = 0; i < kMotions; ++i) {
    out.right_motion[i] = right(kParts + i);
    for (int k = 0; k <= i; ++k) {
      out.motion(i, k) = out.motion(k, i) = information(kParts + i, kParts + k);
    }
  }
  out.squares = detail::float_from_fixed(squares_, 24);
  out.rows = static_cast<float>(added_);
  out.outliers = static_cast<float>(outliers_);
  return out;
}

}  // namespace cairn
