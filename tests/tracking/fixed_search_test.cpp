// Windows and warps of patches, and the poses behind them, in fixed point beside double.
#include <cmath>

#include <gtest/gtest.h>

#include "cairn/geometry/fixed_rigid.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/fixed_landmark_sight.hpp"
#include "cairn/tracking/fixed_patch_window.hpp"

namespace cairn {
namespace {

class FixedSearch : public ::testing::Test {
 protected:
  double uniform() { return random_.below(20001) / 10000.0 - 1.0; }
  Vector3<double> uniform_vector(double most) {
    Vector3<double> v;
    for (double& value : v) value = most * uniform();
    return v;
  }
  Rigid<double> pose(double angle, double distance) {
    const Vector3<double> turn = uniform_vector(angle);
    return {rotation_exp(turn), uniform_vector(distance)};
  }
  static Rigid<float> to_float(const Rigid<double>& T) {
    return {T.rotation.cast<float>(), T.translation.cast<float>()};
  }
  static Rigid<double> to_double(const Rigid<float>& T) {
    Rigid<double> out = {T.rotation.cast<double>(), T.translation.cast<double>()};
    out.rotation.normalize();
    return out;
  }
  static PinholeCamera<double> camera() {
    PinholeCamera<double> out;
    out.fx = 230.0;
    out.fy = 226.0;
    out.cx = 159.5;
    out.cy = 119.5;
    out.k1 = -0.1;
    out.k2 = 0.02;
    out.p1 = 0.001;
    out.width = 320;
    out.height = 240;
    return out;
  }
  static PinholeCamera<float> to_float(const PinholeCamera<double>& from) {
    PinholeCamera<float> out;
    out.fx = static_cast<float>(from.fx);
    out.fy = static_cast<float>(from.fy);
    out.cx = static_cast<float>(from.cx);
    out.cy = static_cast<float>(from.cy);
    out.k1 = static_cast<float>(from.k1);
    out.k2 = static_cast<float>(from.k2);
    out.p1 = static_cast<float>(from.p1);
    out.width = from.width;
    out.height = from.height;
    return out;
  }

  Random random_{3};
  std::uint32_t lost_ = 0;
};

TEST_F(FixedSearch, PosesMultiplyAsInDouble) {
  for (int k = 0; k < 300; ++k) {
    const Rigid<float> a = to_float(pose(2.0, 50.0));
    const Rigid<float> b = to_float(pose(2.0, 10.0));
    const Rigid<double> expected = to_double(a) * to_double(b);
    const Rigid<float> product =
        float_of(fixed_rigid_of(a, lost_).times(fixed_rigid_of(b, lost_), lost_));
    EXPECT_LT((product.translation.cast<double>() - expected.translation).norm(), 1e-5);
    EXPECT_LT(1.0 - std::abs(product.rotation.cast<double>().dot(expected.rotation)), 1e-7);
    const detail::FixedMotionBetween motion =
        detail::motion_between(fixed_rigid_of(a, lost_), fixed_rigid_of(b, lost_), lost_);
    const Rigid<double> between = to_double(a).inverse() * to_double(b);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(motion.t[i].to_double(), between.translation(i), 1e-6);
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(motion.R.r[i][j].to_double(), between.rotation.toRotationMatrix()(i, j), 1e-8);
      }
    }
  }
  EXPECT_EQ(lost_, 0U);
}

TEST_F(FixedSearch, SmallTurnsAreRotations) {
  for (int k = 0; k < 300; ++k) {
    const Vector3<double> phi = uniform_vector(0.17);
    std::int64_t raw[3];
    for (int i = 0; i < 3; ++i) raw[i] = FixedCoordinate::nearest(phi(i)).raw();
    const FixedRigid turn = small_turn(raw[0], raw[1], raw[2]);
    const Quaternion<double> expected = rotation_exp(phi);
    EXPECT_NEAR(turn.rotation[0].to_double(), expected.w(), 4e-9);
    EXPECT_NEAR(turn.rotation[1].to_double(), expected.x(), 4e-9);
    EXPECT_NEAR(turn.rotation[2].to_double(), expected.y(), 4e-9);
    EXPECT_NEAR(turn.rotation[3].to_double(), expected.z(), 4e-9);
  }
}

TEST_F(FixedSearch, WarpsAreThoseOfDouble) {
  const PinholeCamera<double> lens = camera();
  int compared = 0;
  for (int k = 0; k < 500; ++k) {
    const Rigid<float> reference = to_float(pose(0.3, 0.5));
    const Rigid<float> present = to_float(pose(0.3, 0.5));
    FixedLength p[3];
    Vector3<double> p_camera = uniform_vector(1.0).cwiseProduct(Vector3<double>(1.0, 0.7, 2.0));
    p_camera(2) += 3.0;
    for (int i = 0; i < 3; ++i) {
      p[i] = FixedLength::nearest(p_camera(i));
      p_camera(i) = p[i].to_double();
    }
    Matrix2<double> expected;
    const bool seen =
        ok(predict_warp(lens, to_double(reference), to_double(present), p_camera, expected)) &&
        expected.cwiseAbs().maxCoeff() < 7.5;
    PatchWarp warp;
    const FixedCameraPose at(to_float(lens), fixed_rigid_of(present, lost_));
    const bool done = at.predict(reference, p, warp);
    if (!seen || !done) continue;
    ++compared;
    const Matrix2<float> got = matrix_of(warp);
    EXPECT_LT((got.cast<double>() - expected).norm(), 1e-4 * expected.norm()) << k;
  }
  EXPECT_GE(compared, 400);
}

/// The places of the ellipse are those of the window in float, but on its rim.
TEST_F(FixedSearch, WindowsHoldThePlacesOfTheirEllipse) {
  PatchSearchParameters parameters;
  parameters.max_half_window_px = PatchSearchParameters::kMaxHalfWindow;
  int places = 0;
  int differ = 0;
  for (int k = 0; k < 300; ++k) {
    const double sx = std::pow(10.0, 0.7 + 0.9 * uniform());
    const double sy = std::pow(10.0, 0.3 + 0.8 * uniform());
    const double correlation = 0.99 * uniform();
    FixedPixelPrediction fixed;
    fixed.pixel[0] = FixedPixel::nearest(160.0 + 100.0 * uniform());
    fixed.pixel[1] = FixedPixel::nearest(120.0 + 80.0 * uniform());
    fixed.xx = FixedPixelVariance::nearest(sx * sx);
    fixed.xy = FixedPixelVariance::nearest(correlation * sx * sy);
    fixed.yy = FixedPixelVariance::nearest(sy * sy);
    PixelPrediction<float> prediction;
    for (int i = 0; i < 2; ++i) {
      prediction.pixel(i) = static_cast<float>(fixed.pixel[i].to_double());
    }
    prediction.covariance << static_cast<float>(fixed.xx.to_double()),
        static_cast<float>(fixed.xy.to_double()), static_cast<float>(fixed.xy.to_double()),
        static_cast<float>(fixed.yy.to_double());
    PatchWindow window;
    FixedPatchWindow own;
    ASSERT_TRUE(make_patch_window(prediction, parameters, window));
    ASSERT_TRUE(own.set(fixed, parameters));
    EXPECT_NEAR(own.half_x(), window.half_x, 1);
    EXPECT_NEAR(own.half_y(), window.half_y, 1);
    const int allowed = 2 + window.places / 100 + window.half_x + window.half_y;
    EXPECT_NEAR(own.places(), window.places, allowed);
    for (int y = 0; y < 240; ++y) {
      int first = 0;
      int last = -1;
      if (!own.columns(y, first, last)) last = first - 1;
      for (int x = -100; x < 420; ++x) {
        const bool inside = window.contains(static_cast<float>(x), static_cast<float>(y));
        const bool within = x >= first && x <= last;
        places += inside ? 1 : 0;
        differ += inside != within ? 1 : 0;
        if (within != own.contains_q8(256 * x, 256 * y)) ADD_FAILURE() << x << ' ' << y;
      }
    }
  }
  EXPECT_GT(places, 20000);
  EXPECT_LE(500 * differ, places);
}

TEST_F(FixedSearch, RefusesACovarianceThatIsNone) {
  FixedPixelPrediction prediction;
  FixedPatchWindow window;
  const PatchSearchParameters parameters;
  EXPECT_FALSE(window.set(prediction, parameters));
  prediction.xx = prediction.xy = prediction.yy = FixedPixelVariance::nearest(4.0);
  EXPECT_FALSE(window.set(prediction, parameters));
  prediction.xy = -prediction.xy;
  EXPECT_FALSE(window.set(prediction, parameters));
  prediction.xx = prediction.yy = FixedPixelVariance::most();
  EXPECT_FALSE(window.set(prediction, parameters));
  prediction.xx = prediction.yy = FixedPixelVariance::from_raw(1);
  EXPECT_FALSE(window.set(prediction, parameters));
}

}  // namespace
}  // namespace cairn
