#include "cairn/tracking/image_rotation.hpp"

#include <cstring>

#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kColumns = ImageRotation::kColumns;
constexpr int kRows = ImageRotation::kRows;
constexpr int kRowStep = 8;  ///< rows of the picture from one that is read to the next
constexpr float kLevels = 16.0F;
constexpr int kMostShift = 6;  ///< cells
constexpr int kEquationRowStep = 2;
constexpr int kLeastOverlap = kColumns * kRows / 2 / kEquationRowStep;  ///< cells
constexpr float kMostResidual = 12.0F;  ///< grey levels; more counts as so much
constexpr float kLeastCorrelation = 0.8F;
constexpr float kNoOverlap = 1e30F;
constexpr float kConverged = 1e-3F;       ///< rad
constexpr float kClearly = 0.7F;          ///< squared misfit, relative to the expected one's
constexpr float kMostStep = 0.2F;         ///< rad
constexpr float kCorrelatedCells = 4.0F;  ///< errors of neighbours are alike
constexpr float kLeastSigma = 0.05F;      ///< cells

/// Of `count` pixels, four at a time. Domain: fewer than 512.
std::int32_t sum_of(const std::uint8_t* p, int count) {
  std::uint32_t pairs = 0;  // two sums of 16 bits
  int x = 0;
  for (; x + 4 <= count; x += 4) {
    std::uint32_t word = 0;
    std::memcpy(&word, p + x, sizeof word);
    pairs += (word & 0x00FF00FFU) + ((word >> 8) & 0x00FF00FFU);
  }
  auto sum = static_cast<std::int32_t>((pairs & 0xFFFFU) + (pairs >> 16));
  for (; x < count; ++x) sum += p[x];
  return sum;
}

/// Difference of two cells in a quarter of a grey level: its squares add up in 32 bits.
std::int32_t quarters(std::int32_t present, std::int32_t previous) {
  return (present - previous) / 4;
}

}  // namespace

/// The camera of the coarse picture: cells from the principal point, and cells for each radian.
struct ImageRotation::Optics {
  float fx, fy, cx, cy;

  Vector3<float> ray(int column, int row) const {
    return {(static_cast<float>(column) - cx) / fx, (static_cast<float>(row) - cy) / fy, 1.0F};
  }
};

/// Normal equations of a rotation, and the sums for the correlation.
struct ImageRotation::Sums {
  float hxx = 0.0F, hxy = 0.0F, hxz = 0.0F, hyy = 0.0F, hyz = 0.0F, hzz = 0.0F;
  float bx = 0.0F, by = 0.0F, bz = 0.0F;
  float sx = 0.0F, sy = 0.0F, sz = 0.0F;
  float e = 0.0F, ee = 0.0F;
  float a = 0.0F, p = 0.0F, aa = 0.0F, pp = 0.0F, ap = 0.0F;
  float count = 0.0F;

  void add(float jx, float jy, float jz, float residual, float present, float previous) {
    hxx += jx * jx;
    hxy += jx * jy;
    hxz += jx * jz;
    hyy += jy * jy;
    hyz += jy * jz;
    hzz += jz * jz;
    bx += jx * residual;
    by += jy * residual;
    bz += jz * residual;
    sx += jx;
    sy += jy;
    sz += jz;
    e += residual;
    ee += residual * residual;
    a += present;
    p += previous;
    aa += present * present;
    pp += previous * previous;
    ap += present * previous;
    count += 1.0F;
  }
  /// The equations without a common difference in brightness; H and b.
  void without_mean(Matrix3<float>& h, Vector3<float>& b) const {
    const Vector3<float> j(sx, sy, sz);
    h << hxx, hxy, hxz, hxy, hyy, hyz, hxz, hyz, hzz;
    h -= j * j.transpose() / count;
    b = Vector3<float>(bx, by, bz) - j * (e / count);
  }
  float squared_residuals() const { return ee - e * e / count; }
  float correlation() const {
    const float va = aa - a * a / count;
    const float vp = pp - p * p / count;
    return va > 0.0F && vp > 0.0F ? (ap - a * p / count) / sqrt(va * vp) : 0.0F;
  }
};

void ImageRotation::take(const ImageView& image) {
  if (image.width < kColumns || image.height < kRows) return reset();
  present_ = 1 - present_;
  if (taken_ < 2) ++taken_;
  Coarse& out = images_[present_];
  const int width = image.width / kColumns;
  const int height = image.height / kRows;
  const int rows = 1 + (height - 1) / kRowStep;
  for (int row = 0; row < kRows; ++row) {
    std::int32_t sums[kColumns] = {};
    for (int y = 0; y < height; y += kRowStep) {
      const std::uint8_t* p =
          image.data + static_cast<std::int64_t>(row * height + y) * image.stride;
      for (int column = 0; column < kColumns; ++column) {
        sums[column] += sum_of(p, width);
        p += width;
      }
    }
    for (int column = 0; column < kColumns; ++column) {
      out.values[row][column] = static_cast<std::int16_t>(16 * sums[column] / (rows * width));
    }
  }
}

ImageRotation::Optics ImageRotation::optics_of(const PinholeCamera<float>& camera) const {
  const int whole_width = camera.width / kColumns;
  const int whole_height = camera.height / kRows;
  const float width = static_cast<float>(whole_width);
  const float height = static_cast<float>(whole_height);
  return {camera.fx / width, camera.fy / height, (camera.cx + 0.5F) / width - 0.5F,
          (camera.cy + 0.5F) / height - 0.5F};
}

/// Mean squared difference of every second cell of every second row, means apart, with the present
/// picture at whole cells; huge where the pictures overlap too little.
float ImageRotation::misfit(const Optics& optics, const Vector3<float>& rotation) const {
  const Matrix3<float> R = rotation_exp(Vector3<float>(-rotation)).toRotationMatrix();
  std::int32_t count = 0, sum = 0, squares = 0;
  for (int row = 1; row < kRows; row += 2) {
    for (int column = 1; column < kColumns; column += 2) {
      const Vector3<float> r = R * optics.ray(column, row);
      if (!(r.z() > 0.1F)) continue;
      const float x = r.x() / r.z() * optics.fx + optics.cx;
      const float y = r.y() / r.z() * optics.fy + optics.cy;
      if (!(x >= 0.0F) || !(y >= 0.0F) || x > kColumns - 1 || y > kRows - 1) continue;
      const std::int32_t difference = quarters(present().values[round_to_int(y)][round_to_int(x)],
                                               previous().values[row][column]);
      sum += difference;
      squares += difference * difference;
      ++count;
    }
  }
  if (2 * count < kLeastOverlap) return kNoOverlap;
  const float n = static_cast<float>(count);
  const float mean = static_cast<float>(sum) / n;
  return static_cast<float>(squares) / n - mean * mean;
}

/// The same with the present picture moved by whole cells, that many at most.
float ImageRotation::shifted_misfit(int dx, int dy) const {
  std::int32_t count = 0, sum = 0, squares = 0;
  for (int row = 1; row < kRows; row += 2) {
    if (row + dy < 0 || row + dy >= kRows) continue;
    const std::int16_t* a = present().values[row + dy];
    const std::int16_t* p = previous().values[row];
    const int first = dx < -1 ? -dx | 1 : 1;
    const int end = dx > 0 ? kColumns - dx : kColumns;
    for (int column = first; column < end; column += 2) {
      const std::int32_t difference = quarters(a[column + dx], p[column]);
      sum += difference;
      squares += difference * difference;
      ++count;
    }
  }
  const float n = static_cast<float>(count);
  const float mean = static_cast<float>(sum) / n;
  return static_cast<float>(squares) / n - mean * mean;
}

/// The rotation that moves the picture by the whole cells that fit best: every second shift, then
/// the neighbours of the best.
Vector3<float> ImageRotation::best_shift(const Optics& optics) const {
  float best = kNoOverlap;
  int best_x = 0, best_y = 0;
  const auto try_at = [&](int dx, int dy) {
    const float value = shifted_misfit(dx, dy);
    if (!(value < best)) return;
    best = value;
    best_x = dx;
    best_y = dy;
  };
  for (int dy = -kMostShift; dy <= kMostShift; dy += 2) {
    for (int dx = -kMostShift; dx <= kMostShift; dx += 2) try_at(dx, dy);
  }
  const int x = best_x;
  const int y = best_y;
  for (int dy = y - 1; dy <= y + 1; ++dy) {
    for (int dx = x - 1; dx <= x + 1; ++dx) {
      if (dx != x || dy != y) try_at(dx, dy);
    }
  }
  return {static_cast<float>(best_y) / optics.fy, -static_cast<float>(best_x) / optics.fx, 0.0F};
}

/// Normal equations at `rotation`, with the previous picture's gradient. Rays r of its cells, seen
/// at exp(-rotation) r in the present one; d(x, y) / d rotation of the ray (x, y, 1).
ImageRotation::Sums ImageRotation::equations(const Optics& optics, const Vector3<float>& rotation,
                                             float offset) const {
  Sums sums;
  const Matrix3<float> R = rotation_exp(Vector3<float>(-rotation)).toRotationMatrix();
  const Vector3<float> along_row = R.col(0) / optics.fx;
  const Coarse& from = previous();
  const float to_gx = optics.fx / (2.0F * kLevels);
  const float to_gy = optics.fy / (2.0F * kLevels);
  for (int row = 1; row < kRows - 1; row += kEquationRowStep) {
    Vector3<float> ray = R * optics.ray(0, row);
    const float y = (static_cast<float>(row) - optics.cy) / optics.fy;
    const std::int16_t* values = from.values[row];
    for (int column = 1; column < kColumns - 1; ++column) {
      ray += along_row;
      float present = 0.0F;
      if (!sample(optics, ray, present)) continue;
      const float gx = to_gx * static_cast<float>(values[column + 1] - values[column - 1]);
      const float gy =
          to_gy * static_cast<float>(values[column + kColumns] - values[column - kColumns]);
      const float x = (static_cast<float>(column) - optics.cx) / optics.fx;
      const float turn = gx * x + gy * y;
      const float previous = static_cast<float>(values[column]) * (1.0F / kLevels);
      const float e = clamp(present - previous - offset, -kMostResidual, kMostResidual);
      sums.add(turn * y + gy, -turn * x - gx, gx * y - gy * x, e, present, previous);
    }
  }
  return sums;
}

/// The present picture in the direction of `ray`, bilinear. False outside.
bool ImageRotation::sample(const Optics& optics, const Vector3<float>& ray, float& value) const {
  if (!(ray.z() > 0.1F)) return false;
  const float inverse = 1.0F / ray.z();
  const float u = ray.x() * inverse * optics.fx + optics.cx;
  const float v = ray.y() * inverse * optics.fy + optics.cy;
  if (!(u >= 0.0F && v >= 0.0F && u < kColumns - 1 && v < kRows - 1)) return false;
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const float fu = u - static_cast<float>(column);
  const float fv = v - static_cast<float>(row);
  const std::int16_t* top = present().values[row] + column;
  const std::int16_t* bottom = present().values[row + 1] + column;
  const float above = static_cast<float>(top[0]) + fu * static_cast<float>(top[1] - top[0]);
  const float below =
      static_cast<float>(bottom[0]) + fu * static_cast<float>(bottom[1] - bottom[0]);
  value = (above + fv * (below - above)) * (1.0F / kLevels);
  return true;
}

bool ImageRotation::align(const PinholeCamera<float>& camera, const Vector3<float>& expected,
                          Result& result) const {
  result.iterations = 0;
  if (taken_ < 2) return false;
  const Optics optics = optics_of(camera);
  const Vector3<float> shift = best_shift(optics);
  // Where a texture repeats, many shifts fit nearly as well as the expected one.
  const bool clearly = misfit(optics, shift) < kClearly * misfit(optics, expected);
  Vector3<float> rotation = clearly ? shift : expected;
  float offset = 0.0F;
  Sums sums;
  Matrix3<float> covariance;
  for (int k = 0; k < kMaxIterations; ++k) {
    sums = equations(optics, rotation, offset);
    result.iterations = k + 1;
    if (sums.count < static_cast<float>(kLeastOverlap)) return false;
    offset += sums.e / sums.count;
    Matrix3<float> h;
    Vector3<float> b;
    sums.without_mean(h, b);
    bool invertible = false;
    h.computeInverseWithCheck(covariance, invertible);
    if (!invertible) return false;
    const Vector3<float> step = -(covariance * b);
    if (!(step.squaredNorm() < kMostStep * kMostStep)) return false;
    rotation = rotation_log(Quaternion<float>(rotation_exp(step) * rotation_exp(rotation)));
    if (step.squaredNorm() < kConverged * kConverged) break;
  }
  const float correlation = sums.correlation();
  if (!(correlation > kLeastCorrelation)) return false;
  result.correlation = correlation;
  const float variance = kCorrelatedCells * sums.squared_residuals() / sums.count;
  for (int i = 0; i < 3; ++i) {
    result.sigma_rad(i) = sqrt(variance * covariance(i, i)) + kLeastSigma / optics.fx;
  }
  result.rotation = rotation;
  return true;
}

}  // namespace cairn
