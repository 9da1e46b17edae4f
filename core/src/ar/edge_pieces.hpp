#pragma once

#include <cstdint>

#include "cairn/ar/object_drawing.hpp"
#include "cairn/base/fixed_vector.hpp"

namespace cairn::detail {

inline constexpr std::uint32_t kWholeEdge = 65535;

/// Part of an edge, in 1/65535 of its length.
struct EdgePiece {
  std::uint16_t begin = 0;
  std::uint16_t end = kWholeEdge;
};
/// What is left of an edge after cutting: at most one piece more than there are parts.
using EdgePieces = FixedVector<EdgePiece, VirtualObject::kMaxParts + 1>;

/// Takes `hidden` from all pieces.
inline void cut(const EdgePiece& hidden, EdgePieces& pieces) {
  EdgePieces kept;
  for (const EdgePiece& piece : pieces) {
    if (hidden.end <= piece.begin || hidden.begin >= piece.end) {
      kept.push_back(piece);
      continue;
    }
    if (hidden.begin > piece.begin) kept.push_back({piece.begin, hidden.begin});
    if (hidden.end < piece.end) kept.push_back({hidden.end, piece.end});
  }
  pieces = kept;
}

/// What is to be seen of the object's edges, for both passes.
struct VisiblePiece {
  std::uint8_t part = 0;
  std::uint8_t edge = 0;
  EdgePiece piece;
};
using VisiblePieces = FixedVector<VisiblePiece, kMaxVisiblePieces>;

/// Adds what is left of the edges of a part: of each its `pieces`, and whether some of it was
/// `cut`.
template <class EdgeView>
void add_visible(int part, const EdgeView* edges, int count, VisiblePieces& visible,
                 DrawReport& report) {
  for (int e = 0; e < count; ++e) {
    report.edges += edges[e].pieces.empty() && !edges[e].cut ? 0 : 1;
    report.cut += edges[e].cut ? 1 : 0;
    for (const EdgePiece& piece : edges[e].pieces) {
      const VisiblePiece next = {static_cast<std::uint8_t>(part), static_cast<std::uint8_t>(e),
                                 piece};
      if (!visible.push_back(next)) ++report.left_out;
    }
  }
}

}  // namespace cairn::detail
