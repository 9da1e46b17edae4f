// Windows of patch searches in fixed point, against their ellipses in integers of 128 bits.
#include <cstdlib>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/tracking/fixed_patch_window.hpp"

#include "any_integer.hpp"

namespace cairn {
namespace {

/// A window of deviations from 0.5 to 20 px, of any slope that leaves it positive definite.
struct AnyWindow {
  FixedPixelPrediction prediction;
  PatchSearchParameters parameters;

  AnyWindow() {
    constexpr int kBits = FixedPixelVariance::kFractionBits;
    const auto variance = [] {
      const std::int64_t deviation = *rc::gen::inRange(8, 320);  // 1/16 px
      return deviation * deviation * (std::int64_t{1} << (kBits - 8));
    };
    const std::int64_t xx = variance();
    const std::int64_t yy = variance();
    const std::int64_t share = *rc::gen::inRange(-90, 91);  // of the geometric mean, percent
    prediction.xx = FixedPixelVariance::from_raw(xx);
    prediction.yy = FixedPixelVariance::from_raw(yy);
    prediction.xy = FixedPixelVariance::from_raw((xx < yy ? xx : yy) / 100 * share);
    for (FixedPixel& at : prediction.pixel) {
      at = FixedPixel::from_raw(*rc::gen::inRange(50 << 16, 600 << 16));
    }
    // No limit of its own.
    parameters.max_half_window_px = 1000;
  }

  /// Squared distance of a point in 1/256 px times the determinant, 4 kBits - 16 of fraction, and
  /// the gate times the determinant.
  void distance(int x_q8, int y_q8, Int128& squared, Int128& determinant) const {
    const Int128 xx = prediction.xx.raw(), xy = prediction.xy.raw(), yy = prediction.yy.raw();
    const Int128 u = Int128{x_q8} * 256 - prediction.pixel[0].raw();  // 16 bits of fraction
    const Int128 v = Int128{y_q8} * 256 - prediction.pixel[1].raw();
    determinant = xx * yy - xy * xy;
    squared = yy * u * u - 2 * xy * u * v + xx * v * v;  // kBits + 32
  }
};

TEST(FixedWindowProperty, HoldsWhatLiesInItsEllipse) {
  EXPECT_TRUE(rc::check([] {
    const AnyWindow any;
    FixedPatchWindow window;
    RC_ASSERT(window.set(any.prediction, any.parameters));
    RC_PRE(window.places() < PatchSearchParameters::kMaxPlaces);
    const int x_q8 = any.prediction.pixel[0].raw() / 256 + *rc::gen::inRange(-20000, 20001);
    const int y_q8 = any.prediction.pixel[1].raw() / 256 + *rc::gen::inRange(-20000, 20001);
    Int128 squared = 0;
    Int128 determinant = 0;
    any.distance(x_q8, y_q8, squared, determinant);
    // gate = squared / determinant: both with kBits + 32 of fraction.
    const auto gate = static_cast<std::int64_t>(any.parameters.gate * 1000.0F);
    constexpr int kDown = 32 - FixedPixelVariance::kFractionBits;
    const Int128 exact = squared * 1000;
    const Int128 most = (determinant << kDown) * gate;
    // A hundredth beside it rounding decides.
    if (exact < most / 100 * 99) RC_ASSERT(window.contains_q8(x_q8, y_q8));
    if (exact > most / 100 * 101) RC_ASSERT(!window.contains_q8(x_q8, y_q8));
  }));
}

TEST(FixedWindowProperty, ItsRowsReachWhatItHolds) {
  EXPECT_TRUE(rc::check([] {
    const AnyWindow any;
    FixedPatchWindow window;
    RC_ASSERT(window.set(any.prediction, any.parameters));
    const int y = window.middle_y() + *rc::gen::inRange(-60, 61);
    int first = 1;
    int last = 0;
    const bool has = window.columns(y, first, last);
    for (int x = window.middle_x() - 200; x <= window.middle_x() + 200; ++x) {
      if (!window.contains_q8(256 * x, 256 * y)) continue;
      RC_ASSERT(has && x >= first && x <= last);
    }
  }));
}

}  // namespace
}  // namespace cairn
