#pragma once

#include "cairn/base/status.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/vision/image.hpp"
#include "cairn/vision/patch.hpp"

namespace cairn {

struct PatchSearchParameters {
  static constexpr int kMaxHalfWindow = 80;  ///< px
  static constexpr int kMaxPlaces = 640;     ///< at most so many are tried, every second pixel
  int max_half_window_px = 24;               ///< larger ellipses are cut to it
  int min_correlation_q10 = 768;             ///< zero-mean NCC at the best whole pixel, 0.75
  int min_aligned_q10 = 717;                 ///< the same after alignment, 0.70
  float gate = 9.21F;                        ///< chi-square, 2 degrees of freedom, 99 %

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good = max_half_window_px >= 2 && max_half_window_px <= kMaxHalfWindow &&
                      min_correlation_q10 >= 0 && min_correlation_q10 <= 1024 &&
                      min_aligned_q10 >= 0 && min_aligned_q10 <= 1024 && is_positive(gate);
    return good ? Status::kOk : Status::kBadConfig;
  }
};

/// Where search_patch() looks: the ellipse of a prediction, within the largest window. An ellipse
/// that is long, as that of a point of unknown depth along its epipolar line, costs its area only.
struct PatchWindow {
  Vector2<float> centre;
  float i00 = 0.0F;  ///< inverse covariance
  float i01 = 0.0F;
  float i11 = 0.0F;
  float gate = 0.0F;  ///< smaller than the parameters' where the area would be too large
  int half_x = 0;
  int half_y = 0;
  int places = 0;  ///< most that are tried

  bool contains(float u, float v) const {
    const float du = u - centre.x();
    const float dv = v - centre.y();
    return du * du * i00 + 2.0F * du * dv * i01 + dv * dv * i11 <= gate;
  }
};

/// False where the covariance is not positive definite. Cost: three square roots.
bool make_patch_window(const PixelPrediction<float>& prediction,
                       const PatchSearchParameters& parameters, PatchWindow& window);

/// Units of WorkBudget that search_patch() takes at most.
int patch_search_work(const PixelPrediction<float>& prediction,
                      const PatchSearchParameters& parameters);

/// Looks for one feature in the ellipse of its prediction by the normalised correlation of its
/// warped patch: every second pixel of every second row by half of the patch's rows, then all
/// neighbours of the best by all of them, then sub-pixel alignment (align_patch). It needs no
/// corner at the feature, and finds a quarter more of them than descriptors at FAST corners
/// (docs/results/handheld-mono.md).
///
/// kSingular: the covariance is not positive definite; kDegenerate: the warp cannot be inverted or
/// the patch has no texture; kNotFound; `pixel` untouched on each. Integers but for the ellipse.
/// Cost: at most kMaxPlaces correlations of 66 pixels, 9 of 121, one alignment.
Status search_patch(const ImageView& image, const PixelPrediction<float>& prediction,
                    const Patch& patch, const PatchWarp& warp,
                    const PatchSearchParameters& parameters, Vector2<float>& pixel);

}  // namespace cairn
