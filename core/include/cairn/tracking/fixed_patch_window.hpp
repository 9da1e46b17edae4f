#pragma once

#include "cairn/planar/fixed/camera.hpp"
#include "cairn/tracking/patch_search.hpp"

namespace cairn {

/// PatchWindow without floating point: of each row of pixels it gives the columns within, and so
/// asks nothing of a place.
class FixedPatchWindow {
 public:
  /// False where the covariance is not positive definite.
  bool set(const FixedPixelPrediction& prediction, const PatchSearchParameters& parameters);

  /// The nearest pixel to the middle.
  int middle_x() const { return nearest(centre_x_); }
  int middle_y() const { return nearest(centre_y_); }
  int half_x() const { return half_x_; }
  int half_y() const { return half_y_; }
  /// Most that are tried.
  int places() const { return places_; }

  /// First and last column of the ellipse in row y; false where there is none.
  bool columns(int y, int& first, int& last) const;
  /// Whether a point, in 1/256 pixel, lies in the ellipse.
  bool contains_q8(int x_q8, int y_q8) const;

 private:
  static constexpr int kBits = FixedPixel::kFractionBits;

  static int nearest(std::int32_t at) { return static_cast<int>(wide::round_shift(at, kBits)); }
  bool reach(std::int64_t from_middle, std::int64_t& middle, std::int64_t& reach) const;
  void fit(std::int64_t xx, std::int64_t yy, int limit);

  std::int32_t centre_x_ = 0;  ///< px, kBits
  std::int32_t centre_y_ = 0;
  std::int64_t slope_ = 0;           ///< of the ellipse's middle over the rows, kBits
  std::int64_t aspect_ = 0;          ///< its width over its height, kBits
  std::int64_t height_squared_ = 0;  ///< half of it, px^2, kBits
  std::int64_t gate_ = 0;            ///< kBits
  int half_x_ = 0;
  int half_y_ = 0;
  int places_ = 0;
};

/// As those of a PixelPrediction<float>.
int patch_search_work(const FixedPatchWindow& window);
Status search_patch(const ImageView& image, const FixedPatchWindow& window, const Patch& patch,
                    const PatchWarp& warp, const PatchSearchParameters& parameters,
                    Vector2<float>& pixel);

}  // namespace cairn
