#pragma once

#include "cairn/numeric/fixed_math.hpp"

namespace cairn {

/// As OnePointRansacParameters; hypotheses_needed() counts as there.
struct FixedRansacParameters {
  FixedRatio probability = kProbability;
  int max_hypotheses = 16;
  int min_inliers = 3;
  FixedRatio min_inlier_share = kShare;

  bool valid() const { return max_hypotheses >= 1 && probability.raw() > 0 && probability < kOne; }

 private:
  static constexpr FixedRatio kOne = FixedRatio::nearest(1.0);
  // The float's number, which decides where a power of the share equals what is left.
  static constexpr FixedRatio kProbability = FixedRatio::nearest(static_cast<double>(0.99F));
  static constexpr FixedRatio kShare = FixedRatio::nearest(0.5);
};
/// Least n with (1 - inlier_count / count)^n <= 1 - probability, at least 1 and at most `limit`.
int hypotheses_needed(const FixedRansacParameters& parameters, int inlier_count, int count,
                      int limit);
/// Whether `inlier_count` of `count` candidates passes both limits.
bool is_consensus(int inlier_count, int count, const FixedRansacParameters& parameters);

}  // namespace cairn
