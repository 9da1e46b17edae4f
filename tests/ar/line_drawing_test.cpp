#include "cairn/ar/line_drawing.hpp"

#include <cmath>
#include <limits>

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

TEST(DrawLine, AnInvalidViewDrawsNothing) {
  EXPECT_EQ(draw_line(MutableImageView(), line_px(0, 0, 10, 10), 256, 255), 0);
}

}  // namespace
}  // namespace cairn
