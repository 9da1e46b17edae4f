#pragma once

#include "cairn/base/status.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/vision/image.hpp"
#include "cairn/vision/patch.hpp"

namespace cairn {

struct PatchSearchParameters {
  static constexpr int kMaxHalfWindow = 24;  ///< px
  int min_correlation_q10 = 768;             ///< zero-mean NCC at the best whole pixel, 0.75
  int min_aligned_q10 = 717;                 ///< the same after alignment, 0.70
  float gate = 9.21F;                        ///< chi-square, 2 degrees of freedom, 99 %

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good = min_correlation_q10 >= 0 && min_correlation_q10 <= 1024 &&
                      min_aligned_q10 >= 0 && min_aligned_q10 <= 1024 && is_positive(gate);
    return good ? Status::kOk : Status::kBadConfig;
  }
};

/// Looks for one feature in the 99 % ellipse of its prediction by the normalised correlation of its
/// warped patch: every second pixel of every second row by half of the patch's rows, then all
/// neighbours of the best by all of them, then
/// sub-pixel alignment (align_patch). It needs no corner at the feature, and finds a quarter more
/// of them than descriptors at FAST corners (docs/results/handheld.md).
///
/// kSingular: the covariance is not positive definite; kDegenerate: the warp cannot be inverted or
/// the patch has no texture; kNotFound; `pixel` untouched on each. Integers but for the ellipse.
/// Cost: at most (kMaxHalfWindow + 1)^2 + 9 correlations of 66 and 121 pixels, one alignment.
Status search_patch(const ImageView& image, const PixelPrediction<float>& prediction,
                    const Patch& patch, const PatchWarp& warp,
                    const PatchSearchParameters& parameters, Vector2<float>& pixel);

}  // namespace cairn
