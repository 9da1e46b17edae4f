#include "cairn/ar/line_drawing.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kOne = 256;
constexpr unsigned kLeft = 1, kRight = 2, kAbove = 4, kBelow = 8;

struct Box {
  std::int32_t x0, y0, x1, y1;

  unsigned code(std::int32_t x, std::int32_t y) const {
    unsigned c = 0;
    if (x < x0) c |= kLeft;
    if (x > x1) c |= kRight;
    if (y < y0) c |= kAbove;
    if (y > y1) c |= kBelow;
    return c;
  }
};

bool in_range(std::int32_t v) {
  return v >= -kMaxLineCoordinate && v <= kMaxLineCoordinate;
}

/// from + (at - start) * rise / run, rounded to nearest.
std::int32_t interpolate(std::int32_t from, std::int32_t at, std::int32_t start, std::int32_t rise,
                         std::int32_t run) {
  const std::int64_t product = static_cast<std::int64_t>(at - start) * rise;
  const std::int64_t half = (run < 0 ? -static_cast<std::int64_t>(run) : run) / 2;
  const std::int64_t rounded = (product < 0) == (run < 0) ? half : -half;
  const std::int64_t signed_half = run < 0 ? -rounded : rounded;
  return from + static_cast<std::int32_t>((product + signed_half) / run);
}

/// Moves one end to the border that `code` names first.
void move_to_border(const Box& box, unsigned code, const LineQ8& line, std::int32_t& x,
                    std::int32_t& y) {
  const std::int32_t dx = line.x1 - line.x0;
  const std::int32_t dy = line.y1 - line.y0;
  if ((code & (kLeft | kRight)) != 0) {
    const std::int32_t border = (code & kLeft) != 0 ? box.x0 : box.x1;
    y = interpolate(line.y0, border, line.x0, dy, dx);
    x = border;
  } else {
    const std::int32_t border = (code & kAbove) != 0 ? box.y0 : box.y1;
    x = interpolate(line.x0, border, line.y0, dx, dy);
    y = border;
  }
}

/// Blends `grey` over the pixel with coverage 0..256.
void blend(std::uint8_t& pixel, std::uint8_t grey, int coverage) {
  const int difference = static_cast<int>(grey) - static_cast<int>(pixel);
  pixel = static_cast<std::uint8_t>(static_cast<int>(pixel) + difference * coverage / kOne);
}

/// One span across the line: pixels of the minor axis from `low` to `high` (1/256 px, pixel k
/// covers [256 k - 128, 256 k + 128]). `step` is the distance of two of them in memory.
int draw_span(std::uint8_t* origin, std::ptrdiff_t step, int count, std::int32_t low,
              std::int32_t high, std::uint8_t grey) {
  const int first = (low + kOne / 2) >> 8;
  const int last = (high + kOne / 2) >> 8;
  int written = 0;
  for (int k = first < 0 ? 0 : first; k <= last && k < count; ++k) {
    const std::int32_t begin = k * kOne - kOne / 2;
    const std::int32_t from = low > begin ? low : begin;
    const std::int32_t to = high < begin + kOne ? high : begin + kOne;
    if (to <= from) continue;
    blend(origin[k * step], grey, to - from);
    ++written;
  }
  return written;
}

/// Width across the minor axis of a line of this width: width * length / |major|, Q8.
int span_width(std::int64_t major, std::int64_t minor, int width_q8) {
  if (major == 0) return width_q8;
  const float ratio = static_cast<float>(minor) / static_cast<float>(major);
  return round_to_int(static_cast<float>(width_q8) * sqrt(1.0F + ratio * ratio));
}

}  // namespace

bool clip_line(int width, int height, int margin_q8, LineQ8& line) {
  if (width <= 0 || height <= 0 || !in_range(line.x0) || !in_range(line.y0) || !in_range(line.x1) ||
      !in_range(line.y1)) {
    return false;
  }
  const Box box{-margin_q8, -margin_q8, (width - 1) * kOne + margin_q8,
                (height - 1) * kOne + margin_q8};
  const LineQ8 whole = line;  // intersections are taken on it, so that errors do not add up
  for (int pass = 0; pass < 4; ++pass) {
    const unsigned start = box.code(line.x0, line.y0);
    const unsigned end = box.code(line.x1, line.y1);
    if ((start | end) == 0) return true;
    if ((start & end) != 0) return false;
    if (start != 0) {
      move_to_border(box, start, whole, line.x0, line.y0);
    } else {
      move_to_border(box, end, whole, line.x1, line.y1);
    }
  }
  return (box.code(line.x0, line.y0) | box.code(line.x1, line.y1)) == 0;
}

int draw_line(const MutableImageView& image, const LineQ8& line, int width_q8, std::uint8_t grey) {
  if (!ImageView(image).valid()) return 0;
  const int thickness = clamp(width_q8, kOne, kMaxLineWidthQ8);
  LineQ8 l = line;
  if (!clip_line(image.width, image.height, thickness, l)) return 0;
  const std::int32_t dx = l.x1 - l.x0;
  const std::int32_t dy = l.y1 - l.y0;
  const bool steep = (dy < 0 ? -dy : dy) > (dx < 0 ? -dx : dx);
  // Along the major axis u, across it v.
  std::int32_t u0 = steep ? l.y0 : l.x0;
  std::int32_t v0 = steep ? l.x0 : l.y0;
  std::int32_t u1 = steep ? l.y1 : l.x1;
  std::int32_t v1 = steep ? l.x1 : l.y1;
  if (u0 > u1) {
    const std::int32_t u = u0;
    const std::int32_t v = v0;
    u0 = u1;
    v0 = v1;
    u1 = u;
    v1 = v;
  }
  const int half = span_width(u1 - u0, v1 - v0, thickness) / 2;
  const int u_count = steep ? image.height : image.width;
  const int v_count = steep ? image.width : image.height;
  const std::ptrdiff_t u_step = steep ? image.stride : 1;
  const std::ptrdiff_t v_step = steep ? 1 : image.stride;
  const int first = clamp(static_cast<int>((u0 + kOne / 2) >> 8), 0, u_count - 1);
  const int last = clamp(static_cast<int>((u1 + kOne / 2) >> 8), 0, u_count - 1);
  int written = 0;
  for (int u = first; u <= last; ++u) {
    const std::int32_t at = clamp(static_cast<std::int32_t>(u * kOne), u0, u1);
    const std::int32_t v = u1 > u0 ? interpolate(v0, at, u0, v1 - v0, u1 - u0) : v0;
    written += draw_span(image.data + u * u_step, v_step, v_count, v - half, v + half, grey);
  }
  return written;
}

}  // namespace cairn
