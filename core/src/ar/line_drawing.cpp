#include "cairn/ar/line_drawing.hpp"

#include "cairn/numeric/fixed_math.hpp"
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

struct Division {
  std::int32_t quotient, rest;
};

/// Towards zero; in 32 bits where the numerator fits, which processors without a 64-bit divider do
/// ten times faster.
Division divide(std::int64_t numerator, std::int32_t divisor) {
  const auto narrow = static_cast<std::int32_t>(numerator);
  if (narrow == numerator) return {narrow / divisor, narrow % divisor};
  return {static_cast<std::int32_t>(numerator / divisor),
          static_cast<std::int32_t>(numerator % divisor)};
}

/// from + (at - start) * rise / run, rounded to nearest.
std::int32_t interpolate(std::int32_t from, std::int32_t at, std::int32_t start, std::int32_t rise,
                         std::int32_t run) {
  const std::int64_t product = static_cast<std::int64_t>(at - start) * rise;
  const std::int64_t half = (run < 0 ? -static_cast<std::int64_t>(run) : run) / 2;
  const std::int64_t rounded = (product < 0) == (run < 0) ? half : -half;
  const std::int64_t signed_half = run < 0 ? -rounded : rounded;
  return from + divide(product + signed_half, run).quotient;
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

/// A row or column of pixels, `step` apart in memory.
struct Pixels {
  std::uint8_t* origin;
  std::ptrdiff_t step;
  int count;
};

/// One span across the line: pixels of the minor axis from `low` to `high` (1/256 px, pixel k
/// covers [256 k - 128, 256 k + 128]). Returns how many pixels it wrote.
int draw_span(const Pixels& pixels, std::int32_t low, std::int32_t high, std::uint8_t grey) {
  const int first = (low + kOne / 2) >> 8;
  const int last = (high + kOne / 2 - 1) >> 8;
  if (last < 0 || first >= pixels.count || high <= low) return 0;
  const int begin = first < 0 ? 0 : first;
  const int end = last < pixels.count ? last + 1 : pixels.count;
  std::uint8_t* at = pixels.origin + begin * pixels.step;
  int whole = end - begin;
  if (first >= 0) {
    const std::int32_t pixel_end = first * kOne + kOne / 2;
    blend(*at, grey, (high < pixel_end ? high : pixel_end) - low);
    at += pixels.step;
    --whole;
  }
  const bool has_tail = last > first && last < pixels.count;
  if (has_tail) --whole;
  for (; whole > 0; --whole, at += pixels.step) *at = grey;
  if (has_tail) blend(*at, grey, high - (last * kOne - kOne / 2));
  return end - begin;
}

/// v along a line at positions u that rise by one pixel: interpolate() without its division.
class LineStep {
 public:
  LineStep(std::int32_t v0, std::int32_t from_u0, std::int32_t rise, std::int32_t run)
      : v0_(v0), run_(run), down_(rise < 0) {
    const std::int64_t size = down_ ? -static_cast<std::int64_t>(rise) : rise;
    offset_ = divide(from_u0 * size + run / 2, run);
    if (offset_.rest < 0) {
      offset_.rest += run;
      --offset_.quotient;
    }
    step_ = divide(kOne * size, run);
  }
  std::int32_t value() const { return down_ ? v0_ - offset_.quotient : v0_ + offset_.quotient; }
  void advance() {
    offset_.quotient += step_.quotient;
    offset_.rest += step_.rest;
    if (offset_.rest >= run_) {
      offset_.rest -= run_;
      ++offset_.quotient;
    }
  }

 private:
  std::int32_t v0_, run_;
  Division offset_, step_;
  bool down_;
};

/// Width across the minor axis of a line of this width: width * length / |major|, Q8.
int span_width(std::int32_t major, std::int32_t minor, int width_q8) {
  constexpr int kBits = 15;
  if (major == 0) return width_q8;
  const int down = wide::bit_length(static_cast<std::uint64_t>(major)) - kBits;
  const std::int32_t across = minor < 0 ? -minor : minor;
  const auto scaled = [down](std::int32_t value) {
    return static_cast<std::uint32_t>(down > 0 ? value >> down : value);
  };
  const std::uint32_t ratio = (scaled(across) << kBits) / scaled(major);
  const FixedRoot root =
      square_root((std::int64_t{1} << 2 * kBits) + std::int64_t{ratio} * ratio, 2 * kBits);
  std::uint32_t none = 0;
  return static_cast<int>(wide::scale(std::int64_t{width_q8} * root.mantissa, -root.bits, none));
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

namespace detail {

ClippedLine::ClippedLine(const MutableImageView& image, const LineQ8& line, int width_q8) {
  if (!ImageView(image).valid()) return;
  width = clamp(width_q8, kOne, kMaxLineWidthQ8);
  LineQ8 l = line;
  if (!clip_line(image.width, image.height, width, l)) return;
  visible = true;
  const std::int32_t dx = l.x1 - l.x0;
  const std::int32_t dy = l.y1 - l.y0;
  steep = (dy < 0 ? -dy : dy) > (dx < 0 ? -dx : dx);
  u0 = steep ? l.y0 : l.x0;
  v0 = steep ? l.x0 : l.y0;
  u1 = steep ? l.y1 : l.x1;
  v1 = steep ? l.x1 : l.y1;
  if (u0 > u1) {
    const std::int32_t u = u0;
    const std::int32_t v = v0;
    u0 = u1;
    v0 = v1;
    u1 = u;
    v1 = v;
  }
}

int draw_clipped(const MutableImageView& image, const ClippedLine& line, int half,
                 std::uint8_t grey) {
  const bool steep = line.steep;
  const std::int32_t u0 = line.u0;
  const std::int32_t v0 = line.v0;
  const std::int32_t u1 = line.u1;
  const std::int32_t v1 = line.v1;
  const int u_count = steep ? image.height : image.width;
  const int v_count = steep ? image.width : image.height;
  const std::ptrdiff_t u_step = steep ? image.stride : 1;
  const std::ptrdiff_t v_step = steep ? 1 : image.stride;
  const int first = clamp(static_cast<int>((u0 + kOne / 2) >> 8), 0, u_count - 1);
  const int last = clamp(static_cast<int>((u1 + kOne / 2) >> 8), 0, u_count - 1);
  LineStep line_step(v0, first * kOne - u0, v1 - v0, u1 > u0 ? u1 - u0 : 1);
  int written = 0;
  for (int u = first; u <= last; ++u, line_step.advance()) {
    const std::int32_t at = u * kOne;
    const std::int32_t v = at <= u0 ? v0 : at >= u1 ? v1 : line_step.value();
    written += draw_span({image.data + u * u_step, v_step, v_count}, v - half, v + half, grey);
  }
  return written;
}

}  // namespace detail

int draw_line_in_integers(const MutableImageView& image, const LineQ8& line, int width_q8,
                          std::uint8_t grey) {
  const detail::ClippedLine clipped(image, line, width_q8);
  if (!clipped.visible) return 0;
  const int half = span_width(clipped.u1 - clipped.u0, clipped.v1 - clipped.v0, clipped.width) / 2;
  return detail::draw_clipped(image, clipped, half, grey);
}

}  // namespace cairn
