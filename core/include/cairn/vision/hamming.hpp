#pragma once

#include "cairn/numeric/fixed_vector.hpp"
#include "cairn/vision/freak.hpp"

namespace cairn {

/// Number of differing bits, 0..512.
int hamming_distance(const Descriptor& a, const Descriptor& b);

struct HammingMatch {
  int index = -1;  ///< of the best candidate, -1 when there is none
  int distance = 513;
  int second_distance = 513;  ///< 513 when there is no second candidate
};

/// Best and second best of `candidates` for `query`; ties keep the lower index. Cost: 8 words a
/// candidate.
HammingMatch match_hamming(const Descriptor& query, Span<Descriptor> candidates);

}  // namespace cairn
