#pragma once

#include <cstdint>

#include "cairn/vision/image.hpp"

namespace cairn {

/// A line between two points in 1/256 pixel; (0, 0) is the centre of the first pixel.
struct LineQ8 {
  std::int32_t x0 = 0;
  std::int32_t y0 = 0;
  std::int32_t x1 = 0;
  std::int32_t y1 = 0;
};

/// Largest magnitude of a coordinate that clip_line takes, in 1/256 pixel.
inline constexpr std::int32_t kMaxLineCoordinate = 1 << 29;
inline constexpr int kMaxLineWidthQ8 = 16 * 256;

/// Clips a line to the closed rectangle of pixel centres [0, width - 1] x [0, height - 1], widened
/// by `margin_q8`. Cohen and Sutherland's outcodes, at most four intersections in 64-bit integers.
/// False when nothing is left (`line` is then undefined) or a coordinate is beyond
/// kMaxLineCoordinate.
bool clip_line(int width, int height, int margin_q8, LineQ8& line);

/// Draws a smooth line of `width_q8` (1/256 pixel, clamped to [256, kMaxLineWidthQ8]) in grey level
/// `grey`, clipped to the image: no pixel outside is touched, whatever the line. Coverage is that
/// of the span across the minor axis. An invalid view draws nothing. Returns the number of pixels
/// written. Cost: at most (longer side of the image) spans of width_q8 sqrt(2) / 256 + 2 pixels.
int draw_line(const MutableImageView& image, const LineQ8& line, int width_q8, std::uint8_t grey);

/// The same without floating point; the width is right to 1/256 px.
int draw_line_in_integers(const MutableImageView& image, const LineQ8& line, int width_q8,
                          std::uint8_t grey);

namespace detail {
/// A line within the image, widened by the line's width: along the major axis u, u0 <= u1, and
/// across it v.
struct ClippedLine {
  bool visible = false;
  int width = 0;  ///< 1/256 px
  bool steep = false;
  std::int32_t u0 = 0;
  std::int32_t v0 = 0;
  std::int32_t u1 = 0;
  std::int32_t v1 = 0;

  ClippedLine(const MutableImageView& image, const LineQ8& line, int width_q8);
};
/// Draws it with spans of `half` to both sides, 1/256 px.
int draw_clipped(const MutableImageView& image, const ClippedLine& line, int half,
                 std::uint8_t grey);
}  // namespace detail

}  // namespace cairn
