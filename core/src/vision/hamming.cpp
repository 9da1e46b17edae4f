#include "cairn/vision/hamming.hpp"

#include "hamming_kernel.hpp"

namespace cairn {
namespace vision {
namespace {

#if CAIRN_VISION_X86
// Chosen when the program runs: baseline x86-64 has no population count, nearly every CPU does.
__attribute__((target("popcnt"))) HammingMatch match_popcnt(const Descriptor& query,
                                                            Span<Descriptor> candidates,
                                                            int prefix_limit) {
  return match_with<PopulationCounter>(query, candidates, prefix_limit);
}
#endif

#if CAIRN_VISION_X86 || defined(__aarch64__)
using NativeCounter = PopulationCounter;
#else
using NativeCounter = WordCounter;
#endif

}  // namespace
}  // namespace vision

int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return vision::cascade<vision::NativeCounter>(a, b, kNoPrefixLimit);
}

HammingMatch match_hamming(const Descriptor& query, Span<Descriptor> candidates, int prefix_limit) {
#if CAIRN_VISION_X86
  if (__builtin_cpu_supports("popcnt")) {
    return vision::match_popcnt(query, candidates, prefix_limit);
  }
#endif
  return vision::match_with<vision::NativeCounter>(query, candidates, prefix_limit);
}

HammingMatch match_hamming_in(const Rect& window, const Descriptor& query, Span<Corner> corners,
                              Span<Descriptor> candidates, int prefix_limit) {
  HammingMatch match;
  for (int i = 0; i < candidates.size; ++i) {
    const Corner& corner = corners[i];
    if (corner.x < window.x0 || corner.x >= window.x1 || corner.y < window.y0 ||
        corner.y >= window.y1) {
      continue;
    }
    vision::offer(match, i,
                  vision::cascade<vision::NativeCounter>(query, candidates[i], prefix_limit));
  }
  return match;
}

void cross_match_hamming(Span<Descriptor> queries, Span<Descriptor> candidates, int prefix_limit,
                         HammingMatch* matches, HammingMatch* best_query) {
  for (int c = 0; c < candidates.size; ++c) best_query[c] = {};
  for (int q = 0; q < queries.size; ++q) {
    HammingMatch& match = matches[q];
    match = {};
    for (int c = 0; c < candidates.size; ++c) {
      const int distance =
          vision::cascade<vision::NativeCounter>(queries[q], candidates[c], prefix_limit);
      vision::offer(match, c, distance);
      vision::offer(best_query[c], q, distance);
    }
  }
  for (int q = 0; q < queries.size; ++q) {
    HammingMatch& match = matches[q];
    if (match.index >= 0 && best_query[match.index].index != q) match.index = -1;
  }
}

}  // namespace cairn
