#pragma once

#include "cairn/vision/fast.hpp"

#include "corner_sink.hpp"
#include "fast_kernel.hpp"
#include "fast_pixel_kernel.hpp"

namespace cairn::vision {

/// Three score rows in rotation over the caller's scratch memory.
class ScoreRows {
 public:
  ScoreRows(const cairn::detail::FastBuffers& buffers, int width) : words_((width + 31) / 32) {
    for (int i = 0; i < 3; ++i) {
      std::uint8_t* const scores = buffers.scores + i * buffers.score_pitch;
      rows_[i] = {scores + cairn::detail::kScorePadding, buffers.bits + i * buffers.bit_pitch};
      std::memset(scores, 0, cairn::detail::kScorePadding);
      for (int w = 0; w < words_; ++w) {
        clear_block(rows_[i], w);
        rows_[i].corner_bits[w] = 0;
      }
      std::memset(rows_[i].scores + 32 * words_, 0, cairn::detail::kScorePadding);
    }
  }

  /// Moves on by one row; the new current row is empty.
  void advance() {
    const ScoreRow oldest = rows_[0];
    rows_[0] = rows_[1];
    rows_[1] = rows_[2];
    rows_[2] = oldest;
    for (int w = 0; w < words_; ++w) {
      if (oldest.corner_bits[w] == 0) continue;
      clear_block(oldest, w);
      oldest.corner_bits[w] = 0;
    }
  }
  ScoreRow current() const { return rows_[2]; }

  /// Corners of the row before the current one whose score is above all eight neighbours'. Returns
  /// how many corners there were before suppression.
  template <class Lanes>
  int suppress(int x0, int y, CornerSink& sink) const {
    int candidates = 0;
    for (int w = 0; w < words_; ++w) {
      std::uint32_t bits = rows_[1].corner_bits[w];
      if (bits == 0) continue;
      if constexpr (Lanes::kCount >= 16) {
        candidates += __builtin_popcount(bits);
        bits = 0;
        for (int x = 0; x < 32; x += Lanes::kCount) {
          bits |= peaks<Lanes>(32 * w + x) << static_cast<unsigned>(x);
        }
      }
      for (; bits != 0; bits &= bits - 1) {
        const int x = 32 * w + __builtin_ctz(bits);
        if constexpr (Lanes::kCount < 16) {
          ++candidates;
          if (!is_peak(x)) continue;
        }
        sink.add(x0 + x, y, rows_[1].scores[x]);
      }
    }
    return candidates;
  }

 private:
  /// Rows of FastBuffers are whole words: small C libraries clear by bytes what they do not know
  /// of.
  static void clear_block(const ScoreRow& row, int w) {
    std::memset(__builtin_assume_aligned(row.scores + 32 * w, 4), 0, 32);
  }
  bool is_peak(int x) const {
    const std::uint8_t* const above = rows_[0].scores + x;
    const std::uint8_t* const middle = rows_[1].scores + x;
    const std::uint8_t* const below = rows_[2].scores + x;
    const int score = middle[0];
    return score > middle[-1] && score > middle[1] && score > above[-1] && score > above[0] &&
           score > above[1] && score > below[-1] && score > below[0] && score > below[1];
  }

  /// The same for the columns from x on, a bit each.
  template <class Lanes>
  std::uint32_t peaks(int x) const {
    const std::uint8_t* const middle = rows_[1].scores + x;
    auto strongest = Lanes::max(Lanes::load(middle - 1), Lanes::load(middle + 1));
    for (const ScoreRow& row : {rows_[0], rows_[2]}) {
      const std::uint8_t* const p = row.scores + x;
      strongest = Lanes::max(strongest, Lanes::max(Lanes::load(p - 1), Lanes::load(p + 1)));
      strongest = Lanes::max(strongest, Lanes::load(p));
    }
    return Lanes::nonzero_mask(Lanes::subtract_saturated(Lanes::load(middle), strongest));
  }

  ScoreRow rows_[3];
  int words_;
};

/// The detector over one back end; `rect` is already inside what circles reach.
template <class Lanes>
int detect_corners(const ImageView& image, const Rect& rect, int threshold,
                   const cairn::detail::FastBuffers& buffers, CornerSink& sink) {
  ScoreRows rows(buffers, rect.width());
  int candidates = 0;
  for (int y = rect.y0; y <= rect.y1; ++y) {
    rows.advance();
    if (y < rect.y1) {
      const std::uint8_t* const first = image.row(y) + rect.x0;
      if (rect.width() >= Lanes::kCount) {
        scan_row<Lanes>(first, image.stride, rect.width(), threshold, rows.current());
      } else {
        scan_short_row<Lanes>(first, image.stride, rect.width(), threshold, rows.current());
      }
    }
    if (y > rect.y0) candidates += rows.suppress<Lanes>(rect.x0, y - 1, sink);
  }
  return candidates;
}

/// See cairn::detect_fast and cairn::detect_fast_cells, which are this with one cell or many.
template <class Lanes>
Status detect_fast_with(const ImageView& image, const Rect& rect, int threshold,
                        const FastCells& cells, const cairn::detail::FastBuffers& buffers,
                        Corner* corners, int* counts, FastReport& report) {
  if (!image.valid() || threshold < 1 || threshold > 254 || corners == nullptr ||
      counts == nullptr || cells.width < 1 || cells.height < 1 || cells.capacity < 0) {
    return Status::kInvalidArgument;
  }
  const Rect visible = intersect(rect, {0, 0, image.width, image.height});
  const Rect inside = intersect(visible, {kCircleRadius, kCircleRadius, image.width - kCircleRadius,
                                          image.height - kCircleRadius});
  if (!inside.empty() && inside.width() > buffers.max_width) return Status::kInvalidArgument;
  CornerSink sink(visible, cells, corners, counts);
  report = {};
  if (inside.empty()) return Status::kOk;
  report.candidates = detect_corners<Lanes>(image, inside, threshold, buffers, sink);
  sink.finish();
  report.found = sink.found();
  report.dropped = sink.dropped();
  return Status::kOk;
}

}  // namespace cairn::vision
