#include "cairn/ar/line_drawing.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

/// Width across the minor axis of a line of this width: width * length / |major|, Q8.
int span_width(std::int64_t major, std::int64_t minor, int width_q8) {
  if (major == 0) return width_q8;
  const float ratio = static_cast<float>(minor) / static_cast<float>(major);
  return round_to_int(static_cast<float>(width_q8) * sqrt(1.0F + ratio * ratio));
}

}  // namespace

int draw_line(const MutableImageView& image, const LineQ8& line, int width_q8, std::uint8_t grey) {
  const detail::ClippedLine clipped(image, line, width_q8);
  if (!clipped.visible) return 0;
  const int half = span_width(clipped.u1 - clipped.u0, clipped.v1 - clipped.v0, clipped.width) / 2;
  return detail::draw_clipped(image, clipped, half, grey);
}

}  // namespace cairn
