#include "cairn/tracking/fixed_patch_window.hpp"

#include "cairn/numeric/float_bits.hpp"
#include "cairn/numeric/reciprocal.hpp"

#include "patch_finder.hpp"

namespace cairn {
namespace {

constexpr int kBits = FixedPixel::kFractionBits;
constexpr int kRatioBits = FixedRatio::kFractionBits;

/// Root of value / 2^bits with `wanted` fraction bits.
std::int64_t root_of(std::int64_t value, int bits, int wanted) {
  const FixedRoot root = square_root(value, bits);
  std::uint32_t none = 0;
  return wide::scale(root.mantissa, wanted - root.bits, none);
}

/// Pixels from the middle to the end of an axis of the window.
int half_window(std::int64_t squared, int limit) {
  return clamp(static_cast<int>(root_of(squared, kBits, 8) >> 8) + 1, 2, limit);
}

struct FixedPlaces : FixedPatchWindow {
  static bool contains(int /*x*/, int /*y*/) { return true; }
};

}  // namespace

bool FixedPatchWindow::set(const FixedPixelPrediction& prediction,
                           const PatchSearchParameters& parameters) {
  // Deviations beyond 2^15 pixels are no windows; the rest depends on ratios of the deviations.
  constexpr std::int64_t kMost = std::int64_t{1} << (30 + FixedPixelVariance::kFractionBits);
  const std::int64_t xx = prediction.xx.raw();
  const std::int64_t yy = prediction.yy.raw();
  if (xx <= 0 || yy <= 0 || xx >= kMost || yy >= kMost) return false;
  const std::int64_t sigma_x = root_of(xx, FixedPixelVariance::kFractionBits, kBits);
  const std::int64_t sigma_y = root_of(yy, FixedPixelVariance::kFractionBits, kBits);
  if (sigma_x == 0 || sigma_y == 0) return false;
  std::uint32_t lost = 0;
  const std::int64_t correlation =
      wide::divide(prediction.xy.raw(), sigma_x * sigma_y,
                   kRatioBits + 2 * kBits - FixedPixelVariance::kFractionBits, lost);
  constexpr std::int64_t kOne = std::int64_t{1} << kRatioBits;
  if (lost != 0 || correlation >= kOne || correlation <= -kOne) return false;
  const std::int64_t rest = kOne - wide::round_shift(correlation * correlation, kRatioBits);
  if (rest <= 0) return false;
  const std::int64_t across = root_of(rest, kRatioBits, kRatioBits);
  const Reciprocal inverse(static_cast<std::int32_t>(sigma_y));
  const std::int64_t ratio = inverse.times(static_cast<std::int32_t>(sigma_x), kBits);
  slope_ = wide::multiply(ratio, correlation, kRatioBits, lost);
  aspect_ = wide::multiply(ratio, across, kRatioBits, lost);
  centre_x_ = prediction.pixel[0].raw();
  centre_y_ = prediction.pixel[1].raw();

  gate_ = fixed_of<Fixed<std::int32_t, kBits>>(parameters.gate, lost).raw();
  const int limit = parameters.max_half_window_px;
  fit(xx, yy, limit);
  places_ = (half_x_ + 1) * (half_y_ + 1);
  constexpr int kMostPlaces = PatchSearchParameters::kMaxPlaces;
  if (places_ <= kMostPlaces) return true;
  // Places in the ellipse: a quarter of its area, pi / 4 of the product of its axes, and its rim.
  constexpr std::int64_t kQuarterPi = Fixed<std::int64_t, kBits>::nearest(0.25 * kPi<double>).raw();
  const std::int64_t area = wide::multiply(wide::multiply(sigma_x, sigma_y, 2 * kBits - 8, lost),
                                           across, kRatioBits, lost);
  const std::int64_t wanted =
      wide::multiply(wide::multiply(area, gate_, 8, lost), kQuarterPi, 2 * kBits, lost) + half_x_ +
      half_y_;
  if (wanted <= kMostPlaces) {
    places_ = static_cast<int>(wanted);
    return true;
  }
  places_ = kMostPlaces;
  gate_ = gate_ * kMostPlaces / wanted;
  fit(xx, yy, limit);
  return true;
}

void FixedPatchWindow::fit(std::int64_t xx, std::int64_t yy, int limit) {
  std::uint32_t none = 0;
  const auto squared = [&](std::int64_t variance) {
    return wide::multiply(gate_, variance, FixedPixelVariance::kFractionBits, none);
  };
  height_squared_ = squared(yy);
  half_x_ = half_window(squared(xx), limit);
  half_y_ = half_window(height_squared_, limit);
}

/// Middle and half of the ellipse's columns, both from its centre, `from_middle` above its middle.
bool FixedPatchWindow::reach(std::int64_t from_middle, std::int64_t& middle,
                             std::int64_t& reach) const {
  const std::int64_t rest = height_squared_ - wide::round_shift(from_middle * from_middle, kBits);
  if (rest < 0) return false;
  std::uint32_t none = 0;
  middle = wide::multiply(slope_, from_middle, kBits, none);
  reach = wide::multiply(aspect_, root_of(rest, kBits, kBits), kBits, none);
  return true;
}

bool FixedPatchWindow::columns(int y, int& first, int& last) const {
  std::int64_t middle = 0;
  std::int64_t half = 0;
  if (!reach(std::int64_t{y} * (1 << kBits) - centre_y_, middle, half)) return false;
  constexpr std::int64_t kAlmostOne = (1 << kBits) - 1;
  first = static_cast<int>((centre_x_ + middle - half + kAlmostOne) >> kBits);
  last = static_cast<int>((centre_x_ + middle + half) >> kBits);
  return true;
}

bool FixedPatchWindow::contains_q8(int x_q8, int y_q8) const {
  constexpr int kToQ8 = 1 << (kBits - 8);
  std::int64_t middle = 0;
  std::int64_t half = 0;
  if (!reach(std::int64_t{y_q8} * kToQ8 - centre_y_, middle, half)) return false;
  const std::int64_t off = std::int64_t{x_q8} * kToQ8 - centre_x_ - middle;
  return off <= half && off >= -half;
}

int patch_search_work(const FixedPatchWindow& window) {
  return patch_finder::work_of(window.places());
}

Status search_patch(const ImageView& image, const FixedPatchWindow& window, const Patch& patch,
                    const PatchWarp& warp, const PatchSearchParameters& parameters,
                    Vector2<float>& pixel) {
  patch_finder::PlaceQ8 found;
  const Status status =
      patch_finder::find_patch(image, FixedPlaces{window}, patch, warp, parameters, found);
  if (ok(status)) {
    using Q8 = Fixed<std::int32_t, 8>;
    pixel = Vector2<float>(float_of(Q8::from_raw(found.x)), float_of(Q8::from_raw(found.y)));
  }
  return status;
}

}  // namespace cairn
