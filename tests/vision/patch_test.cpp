#include "cairn/vision/patch.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr int kExtent = 48;

struct Affine {
  double xx = 1;
  double xy = 0;
  double yx = 0;
  double yy = 1;

  static Affine similarity(double angle, double scale) {
    return {scale * std::cos(angle), -scale * std::sin(angle), scale * std::sin(angle),
            scale * std::cos(angle)};
  }
  PatchWarp q16() const {
    const auto q = [](double v) { return static_cast<std::int32_t>(std::lround(v * 65536)); };
    return {q(xx), q(xy), q(yx), q(yy)};
  }
};

/// Continuous texture without a grid of its own: waves of up to 1.2 rad per pixel around (0, 0).
class Texture {
 public:
  explicit Texture(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (auto& wave : waves_) {
      const double k = 0.2 + unit(random);
      const double angle = 6.2832 * unit(random);
      wave = {k * std::cos(angle), k * std::sin(angle), 6.2832 * unit(random),
              5 + 9 * unit(random)};
    }
  }
  double at(double x, double y) const {
    double value = 0;
    for (const auto& w : waves_) value += w[3] * std::sin(w[0] * x + w[1] * y + w[2]);
    return value;
  }

 private:
  std::array<std::array<double, 4>, 14> waves_{};
};

struct Look {
  Affine warp;
  double x = 24;  // where the texture's origin lies
  double y = 24;
  double gain = 1;
  double offset = 0;
  double noise = 0;
};

std::vector<std::uint8_t> render(const Texture& texture, const Look& look, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Affine& a = look.warp;
  const double determinant = a.xx * a.yy - a.xy * a.yx;
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kExtent; ++y) {
    for (int x = 0; x < kExtent; ++x) {
      const double dx = x - look.x;
      const double dy = y - look.y;
      const double value =
          texture.at((a.yy * dx - a.xy * dy) / determinant, (a.xx * dy - a.yx * dx) / determinant);
      const double grey = 128 + look.offset + look.gain * value + look.noise * normal(random) + 0.5;
      pixels.push_back(static_cast<std::uint8_t>(std::min(255.0, std::max(0.0, grey))));
    }
  }
  return pixels;
}

ImageView view_of(const std::vector<std::uint8_t>& pixels) {
  return {pixels.data(), kExtent, kExtent, kExtent};
}

struct Accuracy {
  double rms_px = 0;
  int converged = 0;
  int trials = 0;
};

/// Error per axis over random textures, sub-pixel places and starts up to 1 px off.
template <class MakeLook>
Accuracy measure(unsigned seed, MakeLook make_look) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Accuracy result;
  double squares = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Texture texture(random);
    Look reference;
    Look look = make_look(unit, random);
    reference.noise = look.noise;
    look.x += unit(random);
    look.y += unit(random);
    const auto first = render(texture, reference, random);
    const auto second = render(texture, look, random);
    Patch patch;
    EXPECT_EQ(extract_patch(view_of(first), 24 * 256, 24 * 256, patch), Status::kOk);
    int x = static_cast<int>(std::lround(256 * (look.x + 2 * unit(random) - 1)));
    int y = static_cast<int>(std::lround(256 * (look.y + 2 * unit(random) - 1)));
    PatchAlignment report;
    EXPECT_EQ(align_patch(view_of(second), patch, look.warp.q16(), x, y, report), Status::kOk);
    ++result.trials;
    if (!report.converged) continue;
    ++result.converged;
    EXPECT_GT(report.correlation, 850);
    const double ex = x / 256.0 - look.x;
    const double ey = y / 256.0 - look.y;
    squares += ex * ex + ey * ey;
  }
  result.rms_px = std::sqrt(squares / (2 * result.converged));
  return result;
}

using Unit = std::uniform_real_distribution<double>;

TEST(AlignPatch, FindsSubPixelShift) {
  const Accuracy a = measure(1, [](Unit&, std::mt19937&) { return Look{}; });
  EXPECT_EQ(a.converged, a.trials);
  EXPECT_LE(a.rms_px, 0.03);
}

TEST(AlignPatch, FindsShiftUnderNoiseGainAndOffset) {
  const Accuracy a = measure(2, [](Unit& unit, std::mt19937& random) {
    Look look;
    look.noise = 2;
    look.gain = 0.8 + 0.4 * unit(random);
    look.offset = 40 * unit(random) - 20;
    return look;
  });
  EXPECT_EQ(a.converged, a.trials);
  EXPECT_LE(a.rms_px, 0.05);
}

TEST(AlignPatch, FindsShiftUnderRotationScaleAndNoise) {
  const Accuracy a = measure(3, [](Unit& unit, std::mt19937& random) {
    Look look;
    look.noise = 2;
    const double turn = 6.28 * unit(random);
    look.warp = Affine::similarity(turn, 0.8 + 0.6 * unit(random));
    return look;
  });
  EXPECT_GE(a.converged, a.trials - 4);
  EXPECT_LE(a.rms_px, 0.05);
}

TEST(AlignPatch, FindsShiftUnderShear) {
  const Accuracy a = measure(4, [](Unit& unit, std::mt19937& random) {
    Look look;
    look.noise = 2;
    look.warp = {0.8 + 0.4 * unit(random), 0.6 * unit(random) - 0.3, 0.6 * unit(random) - 0.3,
                 0.8 + 0.4 * unit(random)};
    return look;
  });
  EXPECT_GE(a.converged, a.trials - 4);
  EXPECT_LE(a.rms_px, 0.05);
}

TEST(AlignPatch, NeverGoesFarWithoutSayingSo) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> start(20 * 256, 27 * 256);
  int refused = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Texture wanted(random);
    const Texture other(random);
    Look look;
    look.noise = trial % 3 * 4;
    const auto first = render(wanted, look, random);
    const auto second = render(other, look, random);
    Patch patch;
    ASSERT_EQ(extract_patch(view_of(first), 24 * 256, 24 * 256, patch), Status::kOk);
    const int x0 = start(random);
    const int y0 = start(random);
    int x = x0;
    int y = y0;
    PatchAlignment report;
    ASSERT_EQ(align_patch(view_of(second), patch, PatchWarp{}, x, y, report), Status::kOk);
    EXPECT_LE(std::abs(x - x0), 512);
    EXPECT_LE(std::abs(y - y0), 512);
    if (!report.converged) {
      ++refused;
      EXPECT_EQ(x, x0);
      EXPECT_EQ(y, y0);
    } else {
      EXPECT_EQ(x - x0, report.shift_x_q8);
      EXPECT_EQ(y - y0, report.shift_y_q8);
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(AlignPatch, WeakAndOneDimensionalTextureIsDegenerate) {
  std::vector<std::uint8_t> flat(kExtent * kExtent, 90);
  std::vector<std::uint8_t> edge(kExtent * kExtent, 90);
  for (int y = 0; y < kExtent; ++y) {
    for (int x = 24; x < kExtent; ++x) edge[static_cast<std::size_t>(y * kExtent + x)] = 190;
  }
  for (const auto& pixels : {flat, edge}) {
    Patch patch;
    ASSERT_EQ(extract_patch(view_of(pixels), 24 * 256, 24 * 256, patch), Status::kOk);
    int x = 24 * 256;
    int y = 24 * 256;
    PatchAlignment report;
    EXPECT_EQ(align_patch(view_of(pixels), patch, PatchWarp{}, x, y, report), Status::kDegenerate);
    EXPECT_EQ(x, 24 * 256);
  }
}

TEST(AlignPatch, UnusableWarpsAreDegenerate) {
  std::mt19937 random(6);
  const auto pixels = render(Texture(random), Look{}, random);
  Patch patch;
  ASSERT_EQ(extract_patch(view_of(pixels), 24 * 256, 24 * 256, patch), Status::kOk);
  const std::int32_t one = 1 << 16;
  const std::int32_t huge = INT32_MAX;
  const std::int32_t low = INT32_MIN;
  for (const PatchWarp& warp :
       {PatchWarp{0, 0, 0, 0}, PatchWarp{-one, 0, 0, one}, PatchWarp{one / 4, 0, 0, one / 4},
        PatchWarp{4 * one, 0, 0, 4 * one}, PatchWarp{huge, 0, 0, huge},
        PatchWarp{low, low, low, low}, PatchWarp{8 * one, 0, 0, one / 8}}) {
    int x = 24 * 256;
    int y = 24 * 256;
    PatchAlignment report;
    EXPECT_EQ(align_patch(view_of(pixels), patch, warp, x, y, report), Status::kDegenerate);
  }
}

TEST(AlignPatch, WindowsBeyondTheBorderAreOutOfView) {
  std::mt19937 random(7);
  const auto pixels = render(Texture(random), Look{}, random);
  Patch patch;
  EXPECT_EQ(extract_patch(view_of(pixels), 7 * 256 - 1, 24 * 256, patch), Status::kOutOfView);
  EXPECT_EQ(extract_patch(view_of(pixels), 24 * 256, 40 * 256 + 1, patch), Status::kOutOfView);
  EXPECT_EQ(extract_patch(view_of(pixels), 7 * 256, 40 * 256, patch), Status::kOk);
  EXPECT_EQ(patch.pixels[0], pixels[33 * kExtent]);
  EXPECT_EQ(patch.pixels[224], pixels[47 * kExtent + 14]);
  PatchAlignment report;
  using Limits = std::numeric_limits<int>;
  for (const int bad : {5 * 256 - 1, 42 * 256 + 1, -99999, Limits::max(), Limits::min()}) {
    int x = bad;
    int y = 24 * 256;
    EXPECT_EQ(align_patch(view_of(pixels), patch, PatchWarp{}, x, y, report), Status::kOutOfView);
    EXPECT_EQ(x, bad);
  }
  int x = 24 * 256;
  int y = 24 * 256;
  EXPECT_EQ(align_patch(ImageView{}, patch, PatchWarp{}, x, y, report), Status::kInvalidArgument);
}

TEST(AlignPatch, RestsWhereThePatchWasTaken) {
  std::mt19937 random(8);
  const auto pixels = render(Texture(random), Look{}, random);
  Patch patch;
  ASSERT_EQ(extract_patch(view_of(pixels), 20 * 256, 22 * 256, patch), Status::kOk);
  int x = 20 * 256;
  int y = 22 * 256;
  PatchAlignment report;
  ASSERT_EQ(align_patch(view_of(pixels), patch, PatchWarp{}, x, y, report), Status::kOk);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(x, 20 * 256);
  EXPECT_EQ(y, 22 * 256);
  EXPECT_GE(report.correlation, 1022);
}

}  // namespace
}  // namespace cairn
