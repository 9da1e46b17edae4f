#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/patch_search.hpp"
#include "cairn/tracking/work_budget.hpp"
#include "cairn/vision/fast.hpp"

namespace cairn {

/// How a landmark is found in its window.
enum class SearchMethod : std::uint8_t {
  kDescriptor,  ///< FREAK at FAST corners, then alignment of the patch
  kPatch,       ///< correlation of the patch (search_patch): finds more, needs a small window
};

/// Limits and thresholds of the search for one landmark. All counts are bounds on work.
struct SearchParameters {
  static constexpr int kMaxCorners = 8;      ///< corners described in a window
  static constexpr int kMaxHalfWindow = 24;  ///< px
  SearchMethod method = SearchMethod::kDescriptor;
  PatchSearchParameters patch;  ///< of kPatch, which uses none of the following
  int fast_threshold = 20;
  int max_distance = 140;         ///< largest Hamming distance of a match
  int ratio_percent = 90;         ///< best <= ratio * second best, unless both are the same corner
  int min_correlation_q10 = 717;  ///< zero-mean NCC after alignment, 0.70
  int min_direct_correlation_q10 = 819;  ///< same without a descriptor match, 0.80
  float direct_half_window_px = 4.0F;    ///< windows up to this size may skip the descriptor
  float gate = 9.21F;                    ///< chi-square, 2 degrees of freedom, 99 %

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good = ok(patch.validate()) && fast_threshold >= 1 && fast_threshold <= 254 &&
                      max_distance >= 0 && max_distance <= 512 && ratio_percent >= 0 &&
                      ratio_percent <= 100 && min_correlation_q10 >= 0 &&
                      min_correlation_q10 <= 1024 && min_direct_correlation_q10 >= 0 &&
                      min_direct_correlation_q10 <= 1024 && direct_half_window_px >= 0.0F &&
                      direct_half_window_px <= static_cast<float>(kMaxHalfWindow) &&
                      is_positive(gate);
    return good ? Status::kOk : Status::kBadConfig;
  }
};

/// What a search cost and found.
struct SearchReport {
  int corners = 0;
  int descriptors = 0;
  int corners_dropped = 0;
  int distance = 512;
  int correlation_q10 = 0;
  int work = 0;  ///< units of WorkBudget
  bool by_descriptor = false;
};

namespace work {

inline constexpr int kSearchItself = 6;  ///< of search_landmark(), without what it calls

/// The most that search_landmark() takes: the largest window, every corner described, and both
/// alignments. search_patch() over the largest window stays below.
inline constexpr int kLandmarkSearch =
    kSearchItself +
    fast(2 * SearchParameters::kMaxHalfWindow + 1, 2 * SearchParameters::kMaxHalfWindow + 1) +
    SearchParameters::kMaxCorners * kDescriptor + 2 * kAlignment;

}  // namespace work

/// Whether it is search_patch() that looks for a landmark: a point without a descriptor can be
/// found by its patch alone.
inline bool is_searched_by_patch(const Appearance& appearance, const SearchParameters& parameters) {
  const bool wanted = parameters.method == SearchMethod::kPatch || !appearance.has_descriptor;
  return wanted && appearance.has_patch;
}

/// The most that search_landmark() takes for one prediction and its window. Cost: two square roots.
int most_search_work(const PixelPrediction<float>& prediction, const Appearance& appearance,
                     const SearchParameters& parameters);

/// Widest window row, plus the border FAST needs.
using SearchScratch = FastScratch<2 * SearchParameters::kMaxHalfWindow + 8>;

/// Looks for one landmark in its 99 % window: FAST inside the window, corners inside the ellipse
/// described at the predicted roll and scale, best Hamming match, then sub-pixel alignment of its
/// patch. When no corner matches and the window is small, the patch is aligned from the predicted
/// pixel instead. An appearance without a patch ends at the corner. Paper A, steps 2.3 and 2.4.
/// kOutOfView: window outside the image; kNotFound: nothing matched. Cost: one FAST window of (2 *
/// kMaxHalfWindow + 1)^2 px, kMaxCorners descriptors, one alignment. SearchMethod::kPatch calls
/// search_patch instead, with its errors and its cost, and needs a patch.
Status search_landmark(const ImageView& image, const PixelPrediction<float>& prediction,
                       const Appearance& appearance, const Matrix2<float>& warp,
                       const SearchParameters& parameters, SearchScratch& scratch,
                       Vector2<float>& pixel, SearchReport& report);

}  // namespace cairn
