// The parts of the monocular filter, each alone.

#include <gtest/gtest.h>

#include "cairn/mono/camera_motion.hpp"
#include "cairn/mono/covariance_guard.hpp"
#include "cairn/mono/fading_memory.hpp"
#include "cairn/mono/feature_map.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

using T = double;
using Features = mono::FeatureMap<T, 6, 2>;
using State = Features::State;

PinholeCamera<T> a_camera() {
  PinholeCamera<T> camera;
  camera.fx = camera.fy = 500.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.width = 640;
  camera.height = 480;
  return camera;
}

/// GIVEN the state of a camera that moves and turns, without features.
class PartsOfTheMonocularFilter : public ::testing::Test {
 protected:
  PartsOfTheMonocularFilter() { begin(MotionModel::kSixDof); }

  void begin(MotionModel motion, bool with_focal = false) {
    parameters_.motion = motion;
    parameters_.estimate_focal_length = with_focal;
    state_ = State();
    state_.camera.reset(a_camera(), parameters_);
    const mono::CameraLayout& layout = state_.layout();
    state_.covariance.resize(layout.size);
    for (int i = 0; i < layout.size; ++i) {
      state_.covariance(i, i) = 0.01 + 0.001 * i;
      for (int j = 0; j < i; ++j) state_.covariance(i, j) = 1e-4 * ((i * 7 + j * 3) % 5 - 2);
    }
    const T q[4] = {0.9, 0.3, -0.2, 0.24372115213907885};
    for (int i = 0; i < 4; ++i) state_.x[layout.quaternion + i] = q[i];
    for (int i = 0; i < 3; ++i) {
      state_.x[layout.rate + i] = 0.2 - 0.1 * i;
      if (layout.position >= 0) state_.x[layout.position + i] = 1.0 + i;
      if (layout.velocity >= 0) state_.x[layout.velocity + i] = 0.5 * i - 0.3;
      if (layout.lever >= 0) state_.x[layout.lever + i] = 0.1 * (i + 1);
    }
  }
  Status add(LandmarkId id, T u, T v) {
    return features_.add(state_, parameters_, id, {u, v}, 0.4, 0.2);
  }
  Vector2<T> pixel(LandmarkId id) const {
    Vector2<T> result;
    EXPECT_TRUE(ok(features_.pixel_at(state_, state_.x, features_.find(id), result)));
    return result;
  }

  MonoParameters<T> parameters_;
  State state_;
  mono::CameraMotion<T> motion_;
  Features features_;
};

TEST_F(PartsOfTheMonocularFilter, CameraBlockHasWhatTheMotionNeeds) {
  EXPECT_EQ(state_.layout().size, 13);
  EXPECT_EQ(state_.layout().measured, 7);
  begin(MotionModel::kRotationOnly, true);
  EXPECT_EQ(state_.layout().size, 8);
  EXPECT_EQ(state_.layout().block, 2);
  EXPECT_EQ(state_.position(), Vector3<T>::Zero());
  begin(MotionModel::kPivot);
  const Matrix3<T> turn =
      mono::rotation_matrix<T>(state_.quaternion()) - Matrix3<T>(Matrix3<T>::Identity());
  EXPECT_LT((state_.position() - turn * Vector3<T>(0.1, 0.2, 0.3)).norm(), 1e-12);
}

TEST_F(PartsOfTheMonocularFilter, CameraBlockScalesTheFocalLengthAlone) {
  begin(MotionModel::kSixDof, true);
  state_.x[state_.layout().focal] = 0.1;
  const PinholeCamera<T> camera = state_.camera.camera(state_.x);
  EXPECT_NEAR(camera.fx, 550.0, 1e-9);
  EXPECT_NEAR(camera.fy, 550.0, 1e-9);
  EXPECT_EQ(camera.cx, 319.5);
  EXPECT_EQ(state_.camera.told().fx, 500.0);
}

/// The columns of a function of the position, against central differences.
TEST_F(PartsOfTheMonocularFilter, CameraBlockKnowsHowThePositionFollows) {
  for (const MotionModel motion : {MotionModel::kSixDof, MotionModel::kPivot}) {
    begin(motion);
    mono::SparseRows<T, 3> rows;
    state_.camera.add_position_run(state_.x, rows, Matrix3<T>(Matrix3<T>::Identity()));
    for (int i = 0; i < state_.layout().size; ++i) {
      T unit[State::kMaxStates] = {};
      unit[i] = 1.0;
      T ahead[State::kMaxStates];
      T behind[State::kMaxStates];
      for (int k = 0; k < State::kMaxStates; ++k) {
        ahead[k] = state_.x[k] + 1e-5 * unit[k];
        behind[k] = state_.x[k] - 1e-5 * unit[k];
      }
      const Vector3<T> slope =
          (state_.camera.position(ahead) - state_.camera.position(behind)) / 2e-5;
      for (int r = 0; r < 3; ++r) EXPECT_NEAR(rows.dot(r, unit), slope(r), 1e-8) << i;
    }
  }
}

/// P against F P F^T with F by central differences of the motion itself.
TEST_F(PartsOfTheMonocularFilter, CameraMotionMovesMeanAndCovarianceAlike) {
  constexpr T kStep = 0.04;
  const int n = state_.layout().size;
  motion_.reset(n);
  Matrix<T, 13, 13> F;
  for (int i = 0; i < n; ++i) {
    State ahead = state_;
    State behind = state_;
    ahead.x[i] += 1e-5;
    behind.x[i] -= 1e-5;
    static_cast<void>(motion_.move(ahead, kStep));
    static_cast<void>(motion_.move(behind, kStep));
    for (int k = 0; k < n; ++k) F(k, i) = (ahead.x[k] - behind.x[k]) / 2e-5;
  }
  Matrix<T, 13, 13> P;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) P(i, j) = state_.covariance(i, j);
  }
  const Matrix<T, 13, 13> expected = F * P * F.transpose();
  const Vector3<T> before = state_.position();
  const mono::RotationStep<T> step = motion_.move(state_, kStep);
  EXPECT_LT((state_.position() - before - kStep * Vector3<T>(-0.3, 0.2, 0.7)).norm(), 1e-12);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) EXPECT_NEAR(state_.covariance(i, j), expected(i, j), 1e-9);
  }
  const State moved = state_;
  motion_.add_noise(state_, step, 0.5, 0.1, kStep);
  const int r = state_.layout().position;
  const int v = state_.layout().velocity;
  const T variance = 0.25 * kStep;
  EXPECT_NEAR(state_.covariance(v, v) - moved.covariance(v, v), variance, 1e-12);
  EXPECT_NEAR(state_.covariance(r, v) - moved.covariance(r, v), kStep * variance, 1e-12);
  EXPECT_NEAR(motion_.noise()(r, r), kStep * kStep * variance, 1e-15);
}

TEST(FadingMemoryOfTheMonocularFilter, ScalesUpToTheLimit) {
  PackedSymmetric<T, 3> p;
  p.resize(3);
  p.set_zero();
  for (int i = 0; i < 3; ++i) p(i, i) = 4.0;
  p(1, 0) = 1.0;
  p(2, 0) = 1.0;
  PackedSymmetric<T, 3> kept;
  kept.resize(1);
  kept(0, 0) = 0.5;
  T limit[3] = {100.0, 5.0, 3.0};  // free, stopped on the way, beyond it before
  mono::FadingMemory<T>::fade(1.44, p, limit, &kept);
  EXPECT_NEAR(p(0, 0), 4.0 * 1.44 - 0.44 * 0.5, 1e-12);
  EXPECT_NEAR(p(1, 1), 5.0, 1e-12);
  EXPECT_NEAR(p(2, 2), 4.0, 1e-12);
  EXPECT_NEAR(p(1, 0), 1.2 * sqrt(5.0 / 4.0), 1e-12);
  EXPECT_NEAR(p(2, 0), 1.2, 1e-12);
}

TEST(FadingMemoryOfTheMonocularFilter, FadesByWhatTheInnovationsShow) {
  MonoParameters<T> parameters;
  parameters.sigma_px = 1.0;
  mono::FadingMemory<T> memory;
  mono::FadingMemory<T>::Residuals residuals;
  residuals.used = 10;
  residuals.driven = 2.0;
  residuals.whole = 22.0;                                             // a pixel of 20 is P's
  residuals.nu_squared = 2.0 + 20.0 * parameters.adaptive_softening;  // nothing is missing
  EXPECT_NEAR(memory.factor_for(residuals, parameters), 1.0, 1e-12);
  memory.reset();
  residuals.nu_squared += 30.0;
  EXPECT_NEAR(memory.factor_for(residuals, parameters),
              clamp(1.5, 1.0, parameters.adaptive_max_factor), 1e-12);
}

TEST_F(PartsOfTheMonocularFilter, FeaturesOfOneFrameShareAnAnchor) {
  ASSERT_TRUE(ok(add(1, 100.0, 100.0)));
  ASSERT_TRUE(ok(add(2, 500.0, 300.0)));
  EXPECT_EQ(features_.anchor_count(), 1);
  EXPECT_EQ(state_.size(), 13 + 3 + 2 * 3);
  features_.leave_anchor();
  ASSERT_TRUE(ok(add(3, 300.0, 200.0)));
  EXPECT_EQ(features_.anchor_count(), 2);
  EXPECT_LT((pixel(1) - Vector2<T>(100.0, 100.0)).norm(), 1e-6);
  EXPECT_LT((pixel(3) - Vector2<T>(300.0, 200.0)).norm(), 1e-6);
}

/// The last block of the state takes the place of one that is removed, and an anchor goes with the
/// last of its features.
TEST_F(PartsOfTheMonocularFilter, RemovingAFeatureLeavesTheOthersAsTheyWere) {
  ASSERT_TRUE(ok(add(1, 100.0, 100.0)));
  features_.leave_anchor();
  ASSERT_TRUE(ok(add(2, 500.0, 300.0)));
  ASSERT_TRUE(ok(add(3, 300.0, 200.0)));
  const int at = features_[features_.find(3)].at;
  const T variance = state_.covariance(at + 2, at + 2);
  features_.remove(state_, features_.find(1));
  EXPECT_EQ(features_.size(), 2);
  EXPECT_EQ(features_.anchor_count(), 1);
  EXPECT_EQ(features_.find(1), -1);
  EXPECT_EQ(state_.size(), 13 + 3 + 2 * 3);
  EXPECT_LT((pixel(2) - Vector2<T>(500.0, 300.0)).norm(), 1e-6);
  EXPECT_LT((pixel(3) - Vector2<T>(300.0, 200.0)).norm(), 1e-6);
  const int now = features_[features_.find(3)].at;
  EXPECT_EQ(state_.covariance(now + 2, now + 2), variance);
}

/// With both anchors in use the least used one moves to the camera: its features look the same.
TEST_F(PartsOfTheMonocularFilter, AnAnchorThatIsNeededMovesWithItsFeatures) {
  ASSERT_TRUE(ok(add(1, 100.0, 100.0)));
  features_.leave_anchor();
  ASSERT_TRUE(ok(add(2, 500.0, 300.0)));
  ASSERT_TRUE(ok(add(3, 300.0, 200.0)));
  for (int i = 0; i < 3; ++i) state_.x[state_.layout().position + i] += 0.1;
  const Vector2<T> before = pixel(1);
  features_.leave_anchor();
  ASSERT_TRUE(ok(add(4, 200.0, 400.0)));
  EXPECT_EQ(features_.anchor_count(), 2);
  EXPECT_EQ(features_[features_.find(1)].anchor, features_[features_.find(4)].anchor);
  EXPECT_LT((pixel(1) - before).norm(), 1e-6);
}

TEST_F(PartsOfTheMonocularFilter, GuardLeavesASoundCovarianceAlone) {
  mono::CovarianceGuard<T> guard;
  Health health;
  ASSERT_TRUE(ok(add(1, 100.0, 100.0)));
  const State before = state_;
  for (int k = 0; k < 5; ++k) guard.check(state_, features_, health);
  for (int i = 0; i < state_.size(); ++i) {
    for (int j = 0; j <= i; ++j) EXPECT_EQ(state_.covariance(i, j), before.covariance(i, j));
  }
  EXPECT_EQ(health.covariance_repairs + health.resets, 0U);
}

TEST_F(PartsOfTheMonocularFilter, GuardForgetsCorrelationsAfterWhatWasImpossible) {
  mono::CovarianceGuard<T> guard;
  Health health;
  guard.note_unsound();
  guard.check(state_, features_, health);
  EXPECT_EQ(health.resets, 1U);
  EXPECT_EQ(state_.covariance(state_.layout().velocity, state_.layout().position), 0.0);
  guard.check(state_, features_, health);
  EXPECT_EQ(health.resets, 1U) << "once";
  const int r = state_.layout().position;
  state_.covariance(r, r) = -1.0;
  guard.check(state_, features_, health);
  EXPECT_EQ(health.resets, 2U) << "a negative variance";
  EXPECT_GE(state_.covariance(r, r), 0.0);
}

}  // namespace
}  // namespace cairn
