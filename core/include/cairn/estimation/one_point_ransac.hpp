#pragma once

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {

/// Limits of one_point_ransac().
struct OnePointRansacParameters {
  float probability = 0.99F;           ///< wanted chance that one hypothesis is free of outliers
  int max_hypotheses = 16;             ///< bound of the work
  int min_support = 5;                 ///< fewer inliers: no consensus
  float min_support_fraction = 0.25F;  ///< smaller share of the candidates: no consensus
};

/// Outcome of one_point_ransac(). `inliers[i]` says whether candidate i agrees with the best
/// hypothesis; meaningful up to the candidate count only.
template <int Capacity>
struct OnePointRansacResult {
  bool inliers[Capacity] = {};
  int support = 0;
  int candidate = -1;      ///< of the best hypothesis
  int hypotheses = 0;      ///< evaluated
  bool consensus = false;  ///< the support passes both limits
};

/// Number of one-measurement hypotheses that holds a good one with the given probability when the
/// share `inlier_share` of the candidates is good: n = log(1 - p) / log(1 - (1 - e)^m), m = 1, at
/// least 1 and at most `limit`. Civera et al. 2010, eq. 5.
inline int hypotheses_needed(float probability, float inlier_share, int limit) {
  if (inlier_share >= 1.0F) return limit < 1 ? limit : 1;
  if (inlier_share <= 0.0F) return limit;
  const float n = log(1.0F - probability) / log(1.0F - inlier_share);
  if (!(n < static_cast<float>(limit))) return limit;
  const int whole = static_cast<int>(n);
  const int needed = static_cast<float>(whole) < n ? whole + 1 : whole;
  return needed < 1 ? 1 : needed;
}

/// 1-point RANSAC: the filter's prior replaces all but one measurement of a minimal set. Draws
/// candidates without replacement; `evaluate(candidate, inliers)` forms the hypothesis of one
/// candidate, marks its inliers and returns their number. The count of hypotheses is
/// re-evaluated after every one (with the published MATLAB code it never is). Domain: 0 <= count <=
/// Capacity. Cost: at most min(count, max_hypotheses) calls of `evaluate`.
///
/// Source: J. Civera, O. Grasa, A. Davison, J. Montiel, "1-Point RANSAC for extended Kalman
/// filtering", Journal of Field Robotics 27(5), 2010, algorithm 1.
template <int Capacity, class Evaluate>
OnePointRansacResult<Capacity> one_point_ransac(int count,
                                                const OnePointRansacParameters& parameters,
                                                Random& random, Evaluate&& evaluate) {
  OnePointRansacResult<Capacity> best;
  int order[Capacity];
  for (int i = 0; i < count; ++i) order[i] = i;
  int needed = count < parameters.max_hypotheses ? count : parameters.max_hypotheses;
  for (int k = 0; k < needed; ++k) {
    const int pick = k + random.below(count - k);
    const int candidate = order[pick];
    order[pick] = order[k];
    order[k] = candidate;
    bool inliers[Capacity] = {};
    const int support = evaluate(candidate, inliers);
    ++best.hypotheses;
    if (support <= best.support) continue;
    best.support = support;
    best.candidate = candidate;
    for (int i = 0; i < count; ++i) best.inliers[i] = inliers[i];
    const float share = static_cast<float>(support) / static_cast<float>(count);
    needed = hypotheses_needed(parameters.probability, share, needed);
  }
  best.consensus = best.support >= parameters.min_support &&
                   static_cast<float>(best.support) >=
                       parameters.min_support_fraction * static_cast<float>(count);
  return best;
}

}  // namespace cairn
