#include "cairn/ar/line_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "drawing_fixture.hpp"

namespace cairn {
namespace {

using test::GuardedImage;

LineQ8 line_px(double x0, double y0, double x1, double y1) {
  const auto q8 = [](double v) { return static_cast<std::int32_t>(std::lround(v * 256)); };
  return {q8(x0), q8(y0), q8(x1), q8(y1)};
}

TEST(ClipLine, KeepsTheLineAndEndsOnTheBorder) {
  std::mt19937 engine(1);
  std::uniform_int_distribution<std::int32_t> wide(-2000000, 2000000);
  int kept = 0;
  for (int i = 0; i < 20000; ++i) {
    const LineQ8 whole{wide(engine), wide(engine), wide(engine), wide(engine)};
    LineQ8 l = whole;
    if (!clip_line(640, 480, 0, l)) continue;
    ++kept;
    for (const auto& end : {Vector2<double>(l.x0, l.y0), Vector2<double>(l.x1, l.y1)}) {
      EXPECT_GE(end.x(), 0);
      EXPECT_GE(end.y(), 0);
      EXPECT_LE(end.x(), 639 * 256);
      EXPECT_LE(end.y(), 479 * 256);
      const Vector2<double> a(whole.x0, whole.y0);
      const Vector2<double> d = Vector2<double>(whole.x1, whole.y1) - a;
      const double off = (d.x() * (end.y() - a.y()) - d.y() * (end.x() - a.x())) / d.norm();
      EXPECT_LE(std::abs(off), 1.0) << "an end left the line by more than 1/256 px";
    }
  }
  EXPECT_GT(kept, 500);
}

TEST(ClipLine, AgreesWithSamplingOnWhetherAnythingIsLeft) {
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> near(-400, 1000);
  for (int i = 0; i < 2000; ++i) {
    const double x0 = near(engine), y0 = near(engine), x1 = near(engine), y1 = near(engine);
    double deepest = -1e9;  // how far inside the image the line gets
    for (int k = 0; k <= 2000; ++k) {
      const double t = k / 2000.0;
      const double x = x0 + t * (x1 - x0), y = y0 + t * (y1 - y0);
      deepest = std::max(deepest, std::min(std::min(x, 639 - x), std::min(y, 479 - y)));
    }
    if (std::abs(deepest) < 1) continue;
    LineQ8 l = line_px(x0, y0, x1, y1);
    EXPECT_EQ(clip_line(640, 480, 0, l), deepest > 0);
  }
}

TEST(ClipLine, RefusesCoordinatesBeyondItsRange) {
  LineQ8 l{std::numeric_limits<std::int32_t>::min(), 0, 100, 0};
  EXPECT_FALSE(clip_line(640, 480, 0, l));
}

TEST(DrawLine, NeverLeavesTheImage) {
  std::mt19937 engine(3);
  std::uniform_int_distribution<std::int32_t> close(-300 * 256, 500 * 256);
  std::uniform_int_distribution<std::int32_t> far(-kMaxLineCoordinate, kMaxLineCoordinate);
  std::uniform_int_distribution<int> width(-10, 6000);
  GuardedImage image(200, 150);
  for (int i = 0; i < 3000; ++i) {
    auto& range = i % 3 == 0 ? far : close;
    const LineQ8 l{range(engine), range(engine), range(engine), range(engine)};
    draw_line(image.view(), l, width(engine), 255);
  }
  EXPECT_TRUE(image.guard_is_whole());
}

TEST(DrawLine, CoverageAddsUpToTheArea) {
  for (const double angle : {0.0, 0.2, 0.7, 1.3, 1.57, 2.5}) {
    GuardedImage image(200, 200, 0);
    const double c = std::cos(angle), s = std::sin(angle);
    draw_line(image.view(), line_px(100 - 60 * c, 100 - 60 * s, 100 + 60 * c, 100 + 60 * s), 512,
              255);
    double sum = 0;
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) sum += image.at(x, y) / 255.0;
    }
    EXPECT_NEAR(sum, 2 * 120, 6) << angle;
  }
}

TEST(DrawLine, IsTheSameInBothDirections) {
  std::mt19937 engine(4);
  std::uniform_int_distribution<std::int32_t> range(0, 150 * 256);
  for (int i = 0; i < 100; ++i) {
    const LineQ8 l{range(engine), range(engine), range(engine), range(engine)};
    GuardedImage there(160, 160), back(160, 160);
    draw_line(there.view(), l, 300, 255);
    draw_line(back.view(), {l.x1, l.y1, l.x0, l.y0}, 300, 255);
    int largest = 0;
    for (std::size_t k = 0; k < there.bytes().size(); ++k) {
      largest = std::max(largest, std::abs(there.bytes()[k] - back.bytes()[k]));
    }
    EXPECT_LE(largest, 1);
  }
}

/// The rasterisation as it is defined: for each position of the major axis the exact height of the
/// line, rounded, and for each pixel across it the share that the span covers.
void draw_plainly(GuardedImage& image, int width, int height, const LineQ8& line, int width_q8,
                  std::uint8_t grey) {
  LineQ8 l = line;
  if (!clip_line(width, height, width_q8, l)) return;
  const bool steep = std::abs(l.y1 - l.y0) > std::abs(l.x1 - l.x0);
  std::int64_t u0 = steep ? l.y0 : l.x0, v0 = steep ? l.x0 : l.y0;
  std::int64_t u1 = steep ? l.y1 : l.x1, v1 = steep ? l.x1 : l.y1;
  if (u0 > u1) {
    std::swap(u0, u1);
    std::swap(v0, v1);
  }
  const float ratio = u1 > u0 ? static_cast<float>(v1 - v0) / static_cast<float>(u1 - u0) : 0.0F;
  const std::int64_t half =
      std::lround(static_cast<float>(width_q8) * std::sqrt(1.0F + ratio * ratio)) / 2;
  const std::int64_t u_last = (steep ? height : width) - 1, v_count = steep ? width : height;
  for (std::int64_t u = std::clamp<std::int64_t>((u0 + 128) >> 8, 0, u_last);
       u <= std::clamp<std::int64_t>((u1 + 128) >> 8, 0, u_last); ++u) {
    const std::int64_t rise = (std::clamp(u * 256, u0, u1) - u0) * (v1 - v0), run = u1 - u0;
    const std::int64_t v = run > 0 ? v0 + (rise + (rise < 0 ? -run / 2 : run / 2)) / run : v0;
    for (std::int64_t k = 0; k < v_count; ++k) {
      const std::int64_t share =
          std::min(v + half, k * 256 + 128) - std::max(v - half, k * 256 - 128);
      if (share <= 0) continue;
      std::uint8_t& pixel = image.view().row(static_cast<int>(steep ? u : k))[steep ? k : u];
      pixel = static_cast<std::uint8_t>(pixel + (grey - pixel) * share / 256);
    }
  }
}

TEST(DrawLine, EqualsThePlainRasterisationToTheBit) {
  std::mt19937 engine(5);
  std::uniform_int_distribution<std::int32_t> close(-20 * 256, 90 * 256);
  std::uniform_int_distribution<std::int32_t> far(-40000 * 256, 40000 * 256);
  std::uniform_int_distribution<int> width(256, 1500);
  GuardedImage fast(70, 50), plain(70, 50);
  for (int i = 0; i < 2000; ++i) {
    auto& range = i % 4 == 0 ? far : close;
    LineQ8 l{};
    for (std::int32_t* value : {&l.x0, &l.y0, &l.x1, &l.y1}) *value = range(engine);
    if (i % 16 == 1) l.x1 = l.x0;
    if (i % 16 == 2) l.y1 = l.y0;
    const int width_q8 = width(engine);
    const auto grey = static_cast<std::uint8_t>(i % 2 == 0 ? 255 : i % 251);
    draw_line(fast.view(), l, width_q8, grey);
    draw_plainly(plain, 70, 50, l, width_q8, grey);
    ASSERT_EQ(fast.bytes(), plain.bytes()) << i;
  }
}

TEST(DrawLine, AnInvalidViewDrawsNothing) {
  EXPECT_EQ(draw_line(MutableImageView(), line_px(0, 0, 10, 10), 256, 255), 0);
}

}  // namespace
}  // namespace cairn
