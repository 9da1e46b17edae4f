#include "cairn/tracking/depth_filter.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

/// GIVEN the filter and a dense Kalman filter in double precision, which see the same residuals.
class DepthAndDenseFilter : public ::testing::Test {
 protected:
  static constexpr int kKeyframes = 3;
  static constexpr int kSeeds = 6;
  using Filter = DepthFilter<kKeyframes, kSeeds>;
  static constexpr int kStates = Filter::kStates;
  using State = Eigen::Matrix<double, kStates, 1>;
  using Dense = Eigen::Matrix<double, kStates, kStates>;
  using Rows = Eigen::Matrix<double, 2, kStates>;
  static constexpr double kSigma_px = 0.5;
  static constexpr double kNoGate = 1e9;

  static int state_of(int slot) { return 2 + 2 * kKeyframes + slot; }
  double uniform() { return random_.below(2001) / 1000.0 - 1.0; }

  void predict(double sigma_pitch, double sigma_yaw) {
    filter_.predict(static_cast<float>(sigma_pitch), static_cast<float>(sigma_yaw));
    dense_(0, 0) += sigma_pitch * sigma_pitch;
    dense_(1, 1) += sigma_yaw * sigma_yaw;
  }
  void begin_keyframe(int k) {
    filter_.begin_keyframe(k);
    Dense copy = Dense::Identity();
    copy.middleRows<2>(2 + 2 * k) = copy.topRows<2>().eval();
    dense_ = copy * dense_ * copy.transpose();
  }
  void begin_seed(int slot, double variance) {
    filter_.begin_seed(slot, static_cast<float>(variance));
    forget(state_of(slot), 1);
    dense_(state_of(slot), state_of(slot)) = variance;
  }
  void forget(int first, int count) {
    dense_.middleRows(first, count).setZero();
    dense_.middleCols(first, count).setZero();
  }

  Filter::Residual residual(int slot, int keyframe) {
    Filter::Residual r;
    r.slot = slot;
    r.keyframe = keyframe;
    for (int i = 0; i < 2; ++i) {
      r.pixel(i) = static_cast<float>(2.0 * uniform());
      r.by_depth(i) = static_cast<float>(40.0 * uniform());
      for (int j = 0; j < 2; ++j) {
        r.by_camera(i, j) = static_cast<float>(300.0 * uniform());
        r.by_keyframe(i, j) = static_cast<float>(300.0 * uniform());
      }
    }
    return r;
  }
  static Rows rows_of(const Filter::Residual& r) {
    Rows rows = Rows::Zero();
    rows.leftCols<2>() = r.by_camera.cast<double>();
    rows.middleCols<2>(2 + 2 * r.keyframe) = r.by_keyframe.cast<double>();
    rows.col(state_of(r.slot)) = r.by_depth.cast<double>();
    return rows;
  }
  void update(const Filter::Residual& r, Filter::Correction& correction) {
    EXPECT_TRUE(
        filter_.update(r, static_cast<float>(kSigma_px), static_cast<float>(kNoGate), correction));
    const Rows h = rows_of(r);
    const Matrix2<double> s =
        h * dense_ * h.transpose() + kSigma_px * kSigma_px * Matrix2<double>::Identity();
    const Eigen::Matrix<double, kStates, 2> gain = dense_ * h.transpose() * s.inverse();
    moved_ += gain * (r.pixel.cast<double>() - h * moved_);
    const Dense rest = Dense::Identity() - gain * h;
    dense_ = rest * dense_ * rest.transpose() + kSigma_px * kSigma_px * gain * gain.transpose();
  }

  /// Single precision inverts S to some 1e-5, of the variance that a first look takes away.
  void expect_equal(const Filter::Correction& correction) const {
    constexpr double kBefore = 0.09;
    for (int i = 0; i < kStates; ++i) {
      EXPECT_NEAR(correction.state[i], moved_(i), 1e-2 * (1e-2 + std::abs(moved_(i)))) << i;
    }
    for (int slot = 0; slot < kSeeds; ++slot) {
      const double expected = dense_(state_of(slot), state_of(slot));
      EXPECT_NEAR(filter_.variance(slot), expected, 1e-5 * kBefore + 2e-3 * expected) << slot;
    }
  }
  /// The covariance between any two parts shows in the innovation of a residual about them.
  void expect_equal_innovation(const Filter::Residual& r) const {
    const Rows h = rows_of(r);
    const Matrix2<double> expected =
        h * dense_ * h.transpose() + kSigma_px * kSigma_px * Matrix2<double>::Identity();
    const Matrix2<float> s = filter_.innovation_covariance(r, static_cast<float>(kSigma_px));
    EXPECT_LT((s.cast<double>() - expected).norm(), 2e-3 * expected.norm());
  }

  Filter filter_;
  Dense dense_ = Dense::Zero();
  State moved_ = State::Zero();
  Random random_{5};
};

TEST_F(DepthAndDenseFilter, AgreeOverALifeOfKeyframesAndSeeds) {
  predict(2e-3, 4e-3);
  begin_keyframe(0);
  for (int slot = 0; slot < 4; ++slot) begin_seed(slot, 0.04);
  for (int frame = 0; frame < 6; ++frame) {
    predict(1e-3, 3e-3);
    if (frame == 3) {
      begin_keyframe(2);
      for (int slot = 4; slot < kSeeds; ++slot) begin_seed(slot, 0.09);
    }
    Filter::Correction correction;
    moved_.setZero();
    for (int slot = 0; slot < (frame < 3 ? 4 : kSeeds); ++slot) {
      update(residual(slot, slot < 4 ? 0 : 2), correction);
    }
    expect_equal(correction);
    for (int slot = 0; slot < 4; ++slot) expect_equal_innovation(residual(slot, 0));
  }
}

/// A new keyframe is the camera of this moment: what has not moved between them is known.
TEST_F(DepthAndDenseFilter, AKeyframeBeginsFullyCorrelatedWithTheCamera) {
  predict(2e-3, 4e-3);
  begin_keyframe(1);
  Filter::Residual r = residual(0, 1);
  r.by_keyframe = -r.by_camera;
  r.by_depth.setZero();
  const Matrix2<float> s = filter_.innovation_covariance(r, 0.5F);
  EXPECT_LT((s - 0.25F * Matrix2<float>::Identity()).norm(), 1e-4F);
}

TEST_F(DepthAndDenseFilter, AMovedSeedKeepsItsEstimate) {
  predict(2e-3, 4e-3);
  begin_keyframe(0);
  begin_seed(1, 0.04);
  begin_seed(4, 0.09);
  predict(1e-3, 3e-3);
  Filter::Correction correction;
  update(residual(4, 0), correction);
  Filter::Residual about = residual(4, 0);
  const Matrix2<float> before = filter_.innovation_covariance(about, 0.5F);
  const float variance = filter_.variance(4);
  filter_.move_seed(4, 1);
  about.slot = 1;
  EXPECT_EQ(filter_.variance(1), variance);
  EXPECT_EQ(filter_.variance(4), 0.0F);
  EXPECT_LT((filter_.innovation_covariance(about, 0.5F) - before).norm(), 1e-3F * before.norm());
}

TEST_F(DepthAndDenseFilter, ForgetWhatEnds) {
  predict(2e-3, 4e-3);
  begin_keyframe(0);
  begin_seed(2, 0.04);
  predict(1e-3, 3e-3);
  Filter::Correction correction;
  update(residual(2, 0), correction);
  filter_.end_keyframe(0);
  filter_.end_seed(2);
  forget(2, 2);
  forget(state_of(2), 1);
  EXPECT_EQ(filter_.variance(2), 0.0F);
  expect_equal_innovation(residual(2, 0));
  begin_seed(2, 0.25);
  expect_equal_innovation(residual(2, 0));
}

/// Odometry that jumps leaves the yaw unsure by more than a radian, of which single precision loses
/// more than a few looks leave.
TEST_F(DepthAndDenseFilter, TheYawsVarianceIsAboveZeroWhereItWasUnknown) {
  for (const double sigma_yaw : {0.3, 1.7, 30.0}) {
    for (int turn = 0; turn < 40; ++turn) {
      filter_.clear();
      predict(1e-3, 1e-3);
      begin_keyframe(0);
      for (int slot = 0; slot < 4; ++slot) begin_seed(slot, 1.0);
      predict(1e-3, sigma_yaw);
      Filter::Correction correction;
      for (int slot = 0; slot < 4; ++slot) {
        Filter::Residual look = residual(slot, 0);
        look.by_keyframe = -look.by_camera;
        static_cast<void>(
            filter_.update(look, static_cast<float>(kSigma_px), HUGE_VALF, correction));
        EXPECT_GE(filter_.yaw_variance(0), 1e-9F) << sigma_yaw;
        EXPECT_GT(filter_.variance(slot), 0.0F);
      }
    }
  }
}

TEST_F(DepthAndDenseFilter, RefuseAResidualOutsideTheGate) {
  predict(1e-4, 1e-4);
  begin_keyframe(0);
  begin_seed(0, 1e-4);
  Filter::Residual far = residual(0, 0);
  far.by_depth = Vector2<float>(1.0F, 0.0F);
  far.pixel = Vector2<float>(5.0F, 0.0F);
  far.by_camera.setZero();
  far.by_keyframe.setZero();
  Filter::Correction correction;
  const float variance = filter_.variance(0);
  EXPECT_FALSE(filter_.update(far, 0.5F, 9.21F, correction));
  EXPECT_EQ(filter_.variance(0), variance);
  for (const float moved : correction.state) EXPECT_EQ(moved, 0.0F);
  // What an earlier update of the frame explains is not an innovation any more.
  correction.state[state_of(0)] = 5.0F;
  EXPECT_TRUE(filter_.update(far, 0.5F, 9.21F, correction));
}

}  // namespace
}  // namespace cairn
