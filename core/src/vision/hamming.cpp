#include "cairn/vision/hamming.hpp"

#include <cstring>

namespace cairn {
namespace {

std::uint64_t word(const Descriptor& d, int i) {
  std::uint64_t w = 0;
  std::memcpy(&w, d.bytes + 8 * i, sizeof w);
  return w;
}

int distance_of(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (int i = 0; i < 8; ++i) sum += __builtin_popcountll(word(a, i) ^ word(b, i));
  return sum;
}

}  // namespace

int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return distance_of(a, b);
}

HammingMatch match_hamming(const Descriptor& query, Span<Descriptor> candidates) {
  HammingMatch match;
  for (int i = 0; i < candidates.size; ++i) {
    const int distance = distance_of(query, candidates[i]);
    if (distance < match.distance) {
      match.second_distance = match.distance;
      match.distance = distance;
      match.index = i;
    } else if (distance < match.second_distance) {
      match.second_distance = distance;
    }
  }
  return match;
}

}  // namespace cairn
