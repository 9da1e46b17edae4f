#pragma once

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {

/// Limits of one_point_ransac().
struct OnePointRansacParameters {
  float probability = 0.99F;       ///< wanted chance that one hypothesis is free of outliers
  int max_hypotheses = 16;         ///< bound of the work
  int min_inliers = 5;             ///< fewer inliers: no consensus
  float min_inlier_share = 0.25F;  ///< smaller share of the candidates: no consensus
};

/// Outcome of one_point_ransac(). `inliers[i]` says whether candidate i agrees with the best
/// hypothesis; meaningful up to the candidate count only.
template <int Capacity>
struct OnePointRansacResult {
  bool inliers[Capacity] = {};
  int inlier_count = 0;
  int candidate = -1;      ///< of the best hypothesis of one measurement
  int hypotheses = 0;      ///< of one measurement, evaluated
  int triples = 0;         ///< of three, evaluated
  bool consensus = false;  ///< the inlier count passes both limits
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

inline int hypotheses_needed(const OnePointRansacParameters& parameters, int inlier_count,
                             int count, int limit) {
  const float share = static_cast<float>(inlier_count) / static_cast<float>(count);
  return hypotheses_needed(parameters.probability, share, limit);
}

/// Whether `inlier_count` of `count` candidates passes both limits.
inline bool is_consensus(int inlier_count, int count, const OnePointRansacParameters& parameters) {
  return inlier_count >= parameters.min_inliers &&
         static_cast<float>(inlier_count) >=
             parameters.min_inlier_share * static_cast<float>(count);
}

/// 1-point RANSAC: the filter's prior replaces all but one measurement of a minimal set. Draws
/// candidates without replacement; `evaluate(candidate, inliers)` forms the hypothesis of one
/// candidate, marks its inliers and returns their number. The count of hypotheses is
/// re-evaluated after every one (with the published MATLAB code it never is). Domain: 0 <= count <=
/// Capacity. Cost: at most min(count, max_hypotheses) calls of `evaluate`. `Parameters`: those
/// above, or others with max_hypotheses for which hypotheses_needed() and is_consensus() exist.
///
/// Source: J. Civera, O. Grasa, A. Davison, J. Montiel, "1-Point RANSAC for extended Kalman
/// filtering", Journal of Field Robotics 27(5), 2010, algorithm 1.
template <int Capacity, class Parameters = OnePointRansacParameters, class Evaluate>
OnePointRansacResult<Capacity> one_point_ransac(int count, const Parameters& parameters,
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
    const int inlier_count = evaluate(candidate, inliers);
    ++best.hypotheses;
    if (inlier_count <= best.inlier_count) continue;
    best.inlier_count = inlier_count;
    best.candidate = candidate;
    for (int i = 0; i < count; ++i) best.inliers[i] = inliers[i];
    needed = hypotheses_needed(parameters, inlier_count, count, needed);
  }
  best.consensus = is_consensus(best.inlier_count, count, parameters);
  return best;
}

/// Hypotheses of three measurements, after one_point_ransac() gave `best`: one measurement leaves
/// a part of the motion to the prior, which does not suffice at a start or in a surprising motion.
/// `evaluate(candidates, inliers)` forms the hypothesis of three different candidates, marks its
/// inliers and returns their number. `best` becomes the best of all. Domain: 0 <= count <=
/// Capacity. Cost: at most max_triples calls of `evaluate`; none for fewer than three candidates.
template <int Capacity, class Evaluate>
void three_point_ransac(int count, const OnePointRansacParameters& parameters, int max_triples,
                        Random& random, Evaluate&& evaluate, OnePointRansacResult<Capacity>& best) {
  if (count < 3) return;
  int needed = max_triples;
  for (int k = 0; k < needed; ++k) {
    int candidates[3];
    candidates[0] = random.below(count);
    candidates[1] = (candidates[0] + 1 + random.below(count - 1)) % count;
    const int low = candidates[0] < candidates[1] ? candidates[0] : candidates[1];
    const int high = candidates[0] < candidates[1] ? candidates[1] : candidates[0];
    candidates[2] = random.below(count - 2);
    if (candidates[2] >= low) ++candidates[2];
    if (candidates[2] >= high) ++candidates[2];
    bool inliers[Capacity] = {};
    const int inlier_count = evaluate(candidates, inliers);
    ++best.triples;
    if (inlier_count <= best.inlier_count) continue;
    best.inlier_count = inlier_count;
    for (int i = 0; i < count; ++i) best.inliers[i] = inliers[i];
    const float share = static_cast<float>(inlier_count) / static_cast<float>(count);
    needed = hypotheses_needed(parameters.probability, share * share * share, needed);
  }
  best.consensus = is_consensus(best.inlier_count, count, parameters);
}

}  // namespace cairn
