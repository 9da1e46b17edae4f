#include "cairn/planar/fixed/ransac.hpp"

namespace cairn {

int hypotheses_needed(const FixedRansacParameters& parameters, int inlier_count, int count,
                      int limit) {
  constexpr int kBits = FixedRatio::kFractionBits;
  constexpr std::int64_t kOne = std::int64_t{1} << kBits;
  if (inlier_count >= count) return limit < 1 ? limit : 1;
  if (inlier_count <= 0) return limit;
  const std::int64_t allowed = kOne - parameters.probability.raw();
  const std::int64_t outliers = (count - inlier_count) * kOne / count;
  std::int64_t missed = outliers;
  int needed = 1;
  while (needed < limit && missed > allowed) {
    missed = wide::round_shift(missed * outliers, kBits);
    ++needed;
  }
  return needed < limit ? needed : limit;
}

bool is_consensus(int inlier_count, int count, const FixedRansacParameters& parameters) {
  constexpr int kBits = FixedRatio::kFractionBits;
  const std::int64_t least = std::int64_t{parameters.min_inlier_share.raw()} * count;
  return inlier_count >= parameters.min_inliers &&
         std::int64_t{inlier_count} * (std::int64_t{1} << kBits) >= least;
}

}  // namespace cairn
