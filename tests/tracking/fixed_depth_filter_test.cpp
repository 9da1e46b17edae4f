#include "cairn/tracking/fixed_depth_filter.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

/// GIVEN the filter in fixed point and a dense one in double precision, which see the same
/// residuals.
class FixedDepthAndDenseFilter : public ::testing::Test {
 protected:
  static constexpr int kKeyframes = 3;
  static constexpr int kSeeds = 6;
  using Filter = FixedDepthFilter<kKeyframes, kSeeds>;
  using Residual = Filter::Residual;
  static constexpr int kStates = Filter::kStates;
  using State = Eigen::Matrix<double, kStates, 1>;
  using Dense = Eigen::Matrix<double, kStates, kStates>;
  using Rows = Eigen::Matrix<double, 2, kStates>;
  static constexpr auto kNoGate = Fixed<std::int32_t, 16>::nearest(16000.0);
  static constexpr FixedTangent kSigma[2] = {FixedTangent::nearest(1.5e-3),
                                             FixedTangent::nearest(1.2e-3)};

  static int state_of(int slot) { return 2 + 2 * kKeyframes + slot; }
  double uniform() { return random_.below(20001) / 10000.0 - 1.0; }

  void predict(double pitch, double yaw) {
    filter_.predict(FixedAngle::nearest(pitch), FixedAngle::nearest(yaw));
    dense_(0, 0) += std::pow(FixedAngle::nearest(pitch).to_double(), 2);
    dense_(1, 1) += std::pow(FixedAngle::nearest(yaw).to_double(), 2);
  }
  void begin_keyframe(int k) {
    filter_.begin_keyframe(k);
    Dense copy = Dense::Identity();
    copy.middleRows<2>(2 + 2 * k) = copy.topRows<2>().eval();
    dense_ = copy * dense_ * copy.transpose();
  }
  void begin_seed(int slot, double sigma) {
    filter_.begin_seed(slot, Filter::Rho::nearest(sigma));
    forget(state_of(slot), 1);
    dense_(state_of(slot), state_of(slot)) = sigma * sigma;
  }
  void forget(int first, int count) {
    dense_.middleRows(first, count).setZero();
    dense_.middleCols(first, count).setZero();
  }

  Residual residual(int slot, int keyframe, double baseline_m = 0.3) {
    Residual r;
    r.slot = slot;
    r.keyframe = keyframe;
    const auto tangent = [&](double scale) { return FixedTangent::nearest(scale * uniform()); };
    for (int i = 0; i < 2; ++i) {
      r.pixel[i] = tangent(3e-3);
      r.by_depth[i] = FixedLength::nearest(baseline_m * uniform());
      r.unmodelled[i] = tangent(1e-3);
      for (int j = 0; j < 2; ++j) {
        r.by_camera[i][j] = tangent(1.3);
        r.by_keyframe[i][j] = tangent(1.3);
      }
    }
    return r;
  }
  static Rows rows_of(const Residual& r) {
    Rows rows = Rows::Zero();
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        rows(i, j) = r.by_camera[i][j].to_double();
        rows(i, 2 + 2 * r.keyframe + j) = r.by_keyframe[i][j].to_double();
      }
      rows(i, state_of(r.slot)) = r.by_depth[i].to_double();
    }
    return rows;
  }
  Matrix2<double> noise_of(const Residual& r) const {
    const Vector2<double> u(r.unmodelled[0].to_double(), r.unmodelled[1].to_double());
    Matrix2<double> noise = u * u.transpose();
    for (int i = 0; i < 2; ++i) noise(i, i) += std::pow(kSigma[i].to_double(), 2);
    return noise;
  }
  void update(const Residual& r, Filter::Correction& correction) {
    EXPECT_TRUE(filter_.update(r, kSigma, kNoGate, correction));
    const Rows h = rows_of(r);
    const Matrix2<double> s = h * dense_ * h.transpose() + noise_of(r);
    const Eigen::Matrix<double, kStates, 2> gain = dense_ * h.transpose() * s.inverse();
    const Vector2<double> pixel(r.pixel[0].to_double(), r.pixel[1].to_double());
    moved_ += gain * (pixel - h * moved_);
    const Dense rest = Dense::Identity() - gain * h;
    dense_ = rest * dense_ * rest.transpose() + gain * noise_of(r) * gain.transpose();
  }
  void expect_equal(const Filter::Correction& correction) const {
    for (int i = 0; i < kStates; ++i) {
      const double sigma = std::sqrt(dense_(i, i));
      EXPECT_NEAR(correction.state[i].to_double(), moved_(i), 1e-5 * sigma + 1e-8) << i;
    }
    for (int slot = 0; slot < kSeeds; ++slot) {
      const double expected = std::sqrt(dense_(state_of(slot), state_of(slot)));
      EXPECT_NEAR(filter_.sigma(slot).to_double(), expected, 1e-5 * expected + 1e-9) << slot;
    }
  }
  /// The covariance between any two parts shows in the innovation of a residual about them.
  void expect_equal_innovation(const Residual& r) const {
    const Rows h = rows_of(r);
    const Matrix2<double> expected = h * dense_ * h.transpose() + noise_of(r);
    const Filter::Innovation s = filter_.innovation_covariance(r, kSigma);
    Matrix2<double> got;
    const auto entry = [&](std::int64_t value, int i, int j) {
      return std::ldexp(static_cast<double>(value), 32 - s.bits[i] - s.bits[j]);
    };
    got << entry(s.xx, 0, 0), entry(s.xy, 0, 1), entry(s.xy, 0, 1), entry(s.yy, 1, 1);
    EXPECT_LT((got - expected).norm(), 1e-5 * expected.norm());
  }

  Filter filter_;
  Dense dense_ = Dense::Zero();
  State moved_ = State::Zero();
  Random random_{5};
};

TEST_F(FixedDepthAndDenseFilter, AgreeOverALifeOfKeyframesAndSeeds) {
  predict(2e-3, 4e-3);
  begin_keyframe(0);
  for (int slot = 0; slot < 4; ++slot) begin_seed(slot, 0.25);
  for (int frame = 0; frame < 60; ++frame) {
    predict(1e-4, 3e-3);
    if (frame == 3) {
      begin_keyframe(2);
      for (int slot = 4; slot < kSeeds; ++slot) begin_seed(slot, 0.03);
    }
    Filter::Correction correction;
    moved_.setZero();
    for (int slot = 0; slot < (frame < 3 ? 4 : kSeeds); ++slot) {
      update(residual(slot, slot < 4 ? 0 : 2, 0.02 * (frame + 1)), correction);
    }
    expect_equal(correction);
    for (int slot = 0; slot < 4; ++slot) expect_equal_innovation(residual(slot, 0));
  }
  EXPECT_EQ(filter_.saturations(), 0U);
}

/// The error of all rotations together is never seen: it grows with the drive.
TEST_F(FixedDepthAndDenseFilter, AgreeWhileWhatIsNeverSeenGrows) {
  predict(2e-3, 4e-3);
  begin_keyframe(0);
  for (int frame = 0; frame < 3000; ++frame) {
    predict(1e-3, 3e-3);
    if (frame % 20 == 0) {
      begin_keyframe(frame / 20 % 2);
      for (int slot = 0; slot < kSeeds; ++slot) begin_seed(slot, 0.25);
    }
    Filter::Correction correction;
    moved_.setZero();
    for (int slot = 0; slot < kSeeds; ++slot) {
      Residual r = residual(slot, frame / 20 % 2, 0.1);
      for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) r.by_keyframe[i][j] = -r.by_camera[i][j];
      }
      update(r, correction);
    }
    for (int slot = 0; slot < kSeeds; ++slot) {
      const double expected = std::sqrt(dense_(state_of(slot), state_of(slot)));
      ASSERT_NEAR(filter_.sigma(slot).to_double(), expected, 1e-3 * expected) << frame;
    }
  }
  EXPECT_EQ(filter_.saturations(), 0U);
}

TEST_F(FixedDepthAndDenseFilter, AMovedSeedKeepsItsEstimate) {
  predict(2e-3, 4e-3);
  begin_keyframe(0);
  begin_seed(1, 0.2);
  begin_seed(4, 0.3);
  predict(1e-3, 3e-3);
  Filter::Correction correction;
  update(residual(4, 0), correction);
  Residual about = residual(4, 0);
  const Filter::Innovation before = filter_.innovation_covariance(about, kSigma);
  const Filter::Rho sigma = filter_.sigma(4);
  filter_.move_seed(4, 1);
  about.slot = 1;
  EXPECT_EQ(filter_.sigma(1), sigma);
  EXPECT_EQ(filter_.sigma(4).raw(), 0);
  const Filter::Innovation after = filter_.innovation_covariance(about, kSigma);
  EXPECT_EQ(after.xx, before.xx);
  EXPECT_EQ(after.xy, before.xy);
  EXPECT_EQ(after.yy, before.yy);
}

TEST_F(FixedDepthAndDenseFilter, ForgetWhatEnds) {
  predict(2e-3, 4e-3);
  begin_keyframe(0);
  begin_seed(2, 0.2);
  predict(1e-3, 3e-3);
  Filter::Correction correction;
  update(residual(2, 0), correction);
  filter_.end_keyframe(0);
  filter_.end_seed(2);
  forget(2, 2);
  forget(state_of(2), 1);
  EXPECT_EQ(filter_.sigma(2).raw(), 0);
  expect_equal_innovation(residual(2, 0));
  begin_seed(2, 0.5);
  expect_equal_innovation(residual(2, 0));
}

TEST_F(FixedDepthAndDenseFilter, RefuseAResidualOutsideTheGate) {
  constexpr auto kGate = Fixed<std::int32_t, 16>::nearest(9.21);
  predict(1e-4, 1e-4);
  begin_keyframe(0);
  begin_seed(0, 1e-2);
  Residual far;
  far.by_depth[0] = FixedLength::nearest(3e-3);
  far.pixel[0] = FixedTangent::nearest(1.5e-2);
  Filter::Correction correction;
  const Filter::Rho sigma = filter_.sigma(0);
  EXPECT_FALSE(filter_.update(far, kSigma, kGate, correction));
  EXPECT_EQ(filter_.sigma(0), sigma);
  for (const Filter::Rho& moved : correction.state) EXPECT_EQ(moved.raw(), 0);
  // What an earlier update of the frame explains is not an innovation any more.
  correction.state[state_of(0)] = Filter::Rho::nearest(5.0);
  EXPECT_TRUE(filter_.update(far, kSigma, kGate, correction));
}

/// Whatever the residuals are, variances stay above 0 and fall at every update.
TEST_F(FixedDepthAndDenseFilter, SurviveAnyResidual) {
  predict(0.5, 0.5);
  begin_keyframe(0);
  begin_keyframe(1);
  for (int slot = 0; slot < kSeeds; ++slot) {
    filter_.begin_seed(slot, Filter::Rho::nearest(std::pow(10.0, slot - 4)));
  }
  const auto any = [&] { return static_cast<std::int32_t>(random_.next() >> random_.below(31)); };
  for (int step = 0; step < 20000; ++step) {
    Residual r;
    r.slot = static_cast<int>(random_.below(kSeeds));
    r.keyframe = static_cast<int>(random_.below(2));
    for (int i = 0; i < 2; ++i) {
      r.pixel[i] = FixedTangent::from_raw(any() >> 8);
      r.by_depth[i] = FixedLength::from_raw(any());
      r.unmodelled[i] = FixedTangent::from_raw(any());
      for (int j = 0; j < 2; ++j) {
        r.by_camera[i][j] = FixedTangent::from_raw(any());
        r.by_keyframe[i][j] = FixedTangent::from_raw(any());
      }
    }
    const FixedTangent sigma[2] = {FixedTangent::from_raw(any()), FixedTangent::from_raw(any())};
    Filter::Correction correction;
    const Filter::Rho before = filter_.sigma(r.slot);
    static_cast<void>(filter_.update(r, sigma, kNoGate, correction));
    ASSERT_LE(filter_.sigma(r.slot).raw(), before.raw()) << step;
    if (step % 100 == 0) {
      filter_.predict(FixedAngle::from_raw(any()), FixedAngle::from_raw(any()));
      filter_.begin_seed(r.slot, Filter::Rho::from_raw(any()));
    }
  }
}

}  // namespace
}  // namespace cairn
