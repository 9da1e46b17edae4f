// The integer geometry of FREAK against OpenCV's floating-point expressions, exhaustively.

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

#include "freak_kernel.hpp"

namespace cairn::vision {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kOuterRadius = 2.0 / 3.0;
constexpr double kInnerRadius = 2.0 / 24.0;
constexpr double kUnit = (kOuterRadius - kInnerRadius) / 21.0;
constexpr double kRadii[8] = {kOuterRadius,
                              kOuterRadius - 6 * kUnit,
                              kOuterRadius - 11 * kUnit,
                              kOuterRadius - 15 * kUnit,
                              kOuterRadius - 18 * kUnit,
                              kOuterRadius - 20 * kUnit,
                              kInnerRadius,
                              0.0};
double sigma(int ring) {
  return (ring == kRings ? kRadii[6] : kRadii[ring]) / 2;
}
double pattern_scale(int scale_index) {
  return 22.0 * std::pow(2.0, scale_index / 16.0);
}

TEST(FreakGeometry, TablesFollowFromTheDefinition) {
  for (int k = 0; k <= 192; ++k) {
    EXPECT_EQ(kQuarterCosine[k], std::lround(std::cos(k * kTwoPi / kTurn) * (1 << 30)));
  }
  for (int k = 0; k < 32; ++k) {
    EXPECT_EQ(kBinTangent[k], std::lround(std::tan((k + 0.5) * kTwoPi / 256) * (1 << 28)));
  }
  const auto position = [](int point, float& x, float& y) {
    const int ring = point / 6;
    const double angle = (128 * (point % 6) + 64 * (ring & 1)) * kTwoPi / kTurn;
    x = static_cast<float>(kRadii[ring] * std::cos(angle) * 22);
    y = static_cast<float>(kRadii[ring] * std::sin(angle) * 22);
  };
  for (const OrientationPair& pair : kOrientationPairs) {
    float x1 = 0;
    float y1 = 0;
    float x2 = 0;
    float y2 = 0;
    position(pair.first, x1, y1);
    position(pair.second, x2, y2);
    const float dx = x1 - x2;
    const float dy = y1 - y2;
    const float square = dx * dx + dy * dy;
    EXPECT_EQ(pair.weight_x, std::lround(dx / square * 4096.0));
    EXPECT_EQ(pair.weight_y, std::lround(dy / square * 4096.0));
  }
}

TEST(FreakGeometry, RingSizesAreTheScaledRadii) {
  for (int scale = 0; scale <= kMaxScaleIndex; ++scale) {
    for (int ring = 0; ring < kRings; ++ring) {
      const double radius = kRadii[ring] * pattern_scale(scale) * kOnePixel;
      EXPECT_NEAR(ring_size(ring, scale).radius, radius, 0.51) << ring << " " << scale;
      EXPECT_NEAR(ring_size(ring, scale).reach, radius / 2, 0.51) << ring << " " << scale;
    }
  }
}

Interval opencv_interval(float offset, float reach, int coordinate) {
  const float position = offset + static_cast<float>(coordinate);
  return {static_cast<int>(std::lrint(position - reach)),
          static_cast<int>(std::lrint(position + reach + 1))};
}

Interval our_interval(std::int32_t offset, std::int32_t reach, int coordinate, int ring) {
  // One special axis sends both through the slow path, so it has to be right for all coordinates.
  const Interval special = special_interval(coordinate, offset, reach, ring);
  if (is_special_coordinate(coordinate)) return special;
  const std::int32_t base = coordinate * kOnePixel + kRoundingBias;
  const Interval ordinary{round_biased(base - reach + offset),
                          round_biased(base + kOnePixel + reach + offset)};
  EXPECT_EQ(ordinary.begin, special.begin);
  EXPECT_EQ(ordinary.end, special.end);
  return ordinary;
}

// Every direction that a point takes in any orientation, every ring, every coordinate: 50 million
// edges.
TEST(FreakGeometry, BoxEdgesEqualOpenCvEverywhereAtScaleZero) {
  long different = 0;
  for (int ring = 0; ring <= kRings; ++ring) {
    const RingSize size = ring == kRings ? RingSize{0, ring_size(6, 0).reach} : ring_size(ring, 0);
    const auto reach = static_cast<float>(sigma(ring) * 22.0);
    for (int step = 0; step < kTurn; ++step) {
      const auto offset = static_cast<float>(kRadii[ring] * std::cos(step * kTwoPi / kTurn) * 22.0);
      const std::int32_t ours = multiply_q30(size.radius, cosine_q30(step));
      for (int k = 24; k <= ImageView::kMaxExtent - 24; ++k) {
        const Interval want = opencv_interval(offset, reach, k);
        const Interval got = our_interval(ours, size.reach, k, ring);
        different += want.begin != got.begin || want.end != got.end ? 1 : 0;
      }
      if (ring == kRings) break;  // the centre point has no direction
    }
  }
  EXPECT_EQ(different, 0);
}

// A 4,096 x 4,096 image of a texture that is computed where it is needed: descriptors at its far
// end equal those that OpenCV's expressions give.
TEST(FreakGeometry, DescriptorsFarFromTheOriginEqualOpenCv) {
  constexpr int kExtent = ImageView::kMaxExtent;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(kExtent) * kExtent);
  const auto hash = [](std::uint32_t v) {
    v ^= v >> 15U;
    v *= 0x2C1B3C6DU;
    v ^= v >> 12U;
    return v;
  };
  for (int y = 0; y < kExtent; ++y) {
    for (int x = 0; x < kExtent; ++x) {
      const std::uint32_t block =
          hash(static_cast<std::uint32_t>((x / 5) * 7919 + (y / 7) * 104729 + 1));
      const auto noise = static_cast<std::uint32_t>(x * 31 + y * 17) % 23;
      pixels[static_cast<std::size_t>(y) * kExtent + x] =
          static_cast<std::uint8_t>(block % 230 + noise);
    }
  }
  const ImageView view{pixels.data(), kExtent, kExtent, kExtent};
  Random random(21);
  for (int trial = 0; trial < 400; ++trial) {
    const int x = trial % 4 == 0 ? kExtent - 24 : 24 + random.below(kExtent - 47);
    const int y = trial % 3 == 0 ? kExtent - 24 - trial % 90 : 24 + random.below(kExtent - 47);
    const int bin = random.below(256);
    Descriptor got;
    ASSERT_EQ(describe_freak(view, x, y, FreakPose{static_cast<std::uint8_t>(bin), 0}, got),
              Status::kOk);
    int means[kFreakPoints];
    for (int p = 0; p < kFreakPoints; ++p) {
      const int ring = p / 6;
      const double angle =
          kStepsPerBin * bin * kTwoPi / kTurn + (128 * (p % 6) + 64 * (ring & 1)) * kTwoPi / kTurn;
      const auto reach = static_cast<float>(sigma(ring) * 22.0);
      const Interval ix =
          opencv_interval(static_cast<float>(kRadii[ring] * std::cos(angle) * 22.0), reach, x);
      const Interval iy =
          opencv_interval(static_cast<float>(kRadii[ring] * std::sin(angle) * 22.0), reach, y);
      int sum = 0;
      for (int v = iy.begin; v < iy.end; ++v) {
        for (int u = ix.begin; u < ix.end; ++u) sum += view.row(v)[u];
      }
      const int area = (ix.end - ix.begin) * (iy.end - iy.begin);
      means[p] = (sum + area / 2) / area;
    }
    for (int b = 0; b < 512; ++b) {
      const bool expected = means[kComparisonPairs[b][0]] >= means[kComparisonPairs[b][1]];
      ASSERT_EQ(got.bytes[b / 8] >> (b % 8) & 1, expected ? 1 : 0)
          << "x " << x << " y " << y << " bin " << bin << " bit " << b;
    }
  }
}

}  // namespace
}  // namespace cairn::vision
