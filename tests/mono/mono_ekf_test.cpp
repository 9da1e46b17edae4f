#include "cairn/mono/mono_ekf.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "mono_scene.hpp"

namespace cairn {
namespace {

using test::MonoScene;

template <class T>
class MonoEkfContract : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(MonoEkfContract, Scalars, );

TEST(MonoEkfSize, CovarianceOfThirtyFeaturesFitsThirtyKilobytes) {
  using Filter = MonoEkf<float, 30>;
  constexpr int kBytes = Filter::kMaxStates * (Filter::kMaxStates + 1) / 2 * 4;
  static_assert(kBytes <= 30 * 1024, "P of n = 30");
  EXPECT_LE(sizeof(Filter), 39U * 1024U);
}

TYPED_TEST(MonoEkfContract, RefusesImpossibleConfiguration) {
  using Filter = MonoEkf<TypeParam, 24>;
  Filter filter;
  auto camera = MonoScene::camera<TypeParam>();
  EXPECT_EQ(filter.predict(TypeParam(0.04)), Status::kNotInitialised);
  camera.fx = TypeParam(0);
  EXPECT_EQ(filter.initialise(camera, {}), Status::kBadConfig);
  camera = MonoScene::camera<TypeParam>();
  MonoParameters<TypeParam> parameters;
  parameters.sigma_px = std::numeric_limits<TypeParam>::quiet_NaN();
  EXPECT_EQ(filter.initialise(camera, parameters), Status::kBadConfig);
  parameters = {};
  for (const double factor : {0.9, 1e30}) {
    parameters.fading_factor = TypeParam(factor);
    EXPECT_EQ(filter.initialise(camera, parameters), Status::kBadConfig);
  }
  parameters = {};
  parameters.initial_inverse_depth = TypeParam(1e-30);
  EXPECT_EQ(filter.initialise(camera, parameters), Status::kBadConfig);
  for (TypeParam MonoParameters<TypeParam>::*sigma :
       {&MonoParameters<TypeParam>::velocity_noise,
        &MonoParameters<TypeParam>::initial_rate_sigma_radps,
        &MonoParameters<TypeParam>::initial_inverse_depth, &MonoParameters<TypeParam>::sigma_px}) {
    parameters = {};
    parameters.*sigma = TypeParam(1e20);
    EXPECT_EQ(filter.initialise(camera, parameters), Status::kBadConfig);
  }
  EXPECT_EQ(filter.initialise(camera, {}), Status::kOk);
}

TYPED_TEST(MonoEkfContract, MotionNoiseCanBeChangedBetweenPredictions) {
  using T = TypeParam;
  MonoEkf<T, 8> filter;
  ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), {})));
  EXPECT_EQ(filter.set_motion_noise(T(-1), T(1)), Status::kInvalidArgument);
  // Its square would not be a number.
  EXPECT_EQ(filter.set_motion_noise(T(1e20), T(1)), Status::kInvalidArgument);
  EXPECT_EQ(filter.set_motion_noise(T(1), T(1e20)), Status::kInvalidArgument);
  EXPECT_EQ(filter.set_motion_noise(T(1), std::numeric_limits<T>::quiet_NaN()),
            Status::kNonFiniteInput);
  EXPECT_EQ(filter.parameters().velocity_noise, MonoParameters<T>().velocity_noise);
  MonoEkf<T, 8> calm = filter;
  ASSERT_EQ(calm.set_motion_noise(T(0.1), T(0.1)), Status::kOk);
  ASSERT_TRUE(ok(filter.predict(T(0.1))));
  ASSERT_TRUE(ok(calm.predict(T(0.1))));
  ASSERT_TRUE(ok(filter.predict(T(0.1))));
  ASSERT_TRUE(ok(calm.predict(T(0.1))));
  EXPECT_LT(calm.pose_covariance()(0, 0), filter.pose_covariance()(0, 0));
  EXPECT_LT(calm.pose_covariance()(3, 3), filter.pose_covariance()(3, 3));
}

TYPED_TEST(MonoEkfContract, TakesARotationMeasuredByOtherMeans) {
  using T = TypeParam;
  MonoEkf<T, 8> filter;
  const Vector3<T> turn(T(0.02), T(-0.05), T(0.01));
  const Vector3<T> sigma(T(0.001), T(0.001), T(0.001));
  EXPECT_EQ(filter.observe_rotation(turn, sigma, T(0.1)), Status::kNotInitialised);
  ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), {})));
  ASSERT_TRUE(ok(filter.predict(T(0.1))));
  const std::uint64_t before = test::hash_of(filter);
  const T nan = std::numeric_limits<T>::quiet_NaN();
  EXPECT_EQ(filter.observe_rotation({nan, T(0), T(0)}, sigma, T(0.1)), Status::kNonFiniteInput);
  EXPECT_EQ(filter.observe_rotation(turn, Vector3<T>::Zero(), T(0.1)), Status::kInvalidArgument);
  EXPECT_EQ(filter.observe_rotation(turn, sigma, T(0)), Status::kInvalidArgument);
  EXPECT_EQ(test::hash_of(filter), before);

  const T uncertain = filter.pose_covariance()(4, 4);
  ASSERT_EQ(filter.observe_rotation(turn, sigma, T(0.1)), Status::kOk);
  EXPECT_LT((filter.rate_radps() - turn / T(0.1)).norm(), T(0.01));
  // The attitude follows the rate to first order, by what both have in common.
  EXPECT_LT((rotation_log(filter.T_world_camera().rotation) - turn).norm(), T(0.002));
  EXPECT_LT(filter.pose_covariance()(4, 4), T(2e-6));
  EXPECT_GT(uncertain, T(1e-4));
}

TYPED_TEST(MonoEkfContract, RestartsAtAPose) {
  using T = TypeParam;
  using Filter = MonoEkf<TypeParam, 24>;
  MonoScene scene;
  Filter filter;
  Random random(1);
  const Rigid<T> pose{rotation_exp(Vector3<T>(T(0.1), T(-0.2), T(0.3))), {T(1), T(2), T(-3)}};
  EXPECT_EQ(filter.restart(pose), Status::kNotInitialised);
  ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), {})));
  scene.add_features(filter, 24);
  for (int k = 0; k < 10; ++k) scene.step(filter, random);
  const std::uint32_t used = filter.health().innovations_used;

  // A pose that is none: refused, nothing changed.
  const std::uint64_t before = test::hash_of(filter);
  Rigid<T> bad = pose;
  bad.translation.x() = std::numeric_limits<T>::infinity();
  EXPECT_EQ(filter.restart(bad), Status::kNonFiniteInput);
  bad = pose;
  bad.rotation.coeffs() *= T(2);
  EXPECT_EQ(filter.restart(bad), Status::kNonFiniteInput);
  EXPECT_EQ(test::hash_of(filter), before);

  ASSERT_EQ(filter.restart(pose), Status::kOk);
  EXPECT_EQ(filter.feature_count(), 0);
  EXPECT_EQ(filter.health().resets, 1U);
  EXPECT_EQ(filter.health().innovations_used, used);
  EXPECT_LT((filter.T_world_camera().translation - pose.translation).norm(), T(1e-6));
  EXPECT_LT(rotation_log(filter.T_world_camera().rotation.conjugate() * pose.rotation).norm(),
            T(1e-6));
  EXPECT_LT((filter.pose_covariance().norm()), T(1e-9));

  // The lever says where a camera on a pivot is.
  MonoParameters<T> pivot;
  pivot.motion = MotionModel::kPivot;
  ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), pivot)));
  EXPECT_EQ(filter.restart(pose), Status::kBadConfig);
}

TYPED_TEST(MonoEkfContract, EveryErrorLeavesTheEstimateUnchangedToTheBit) {
  using T = TypeParam;
  using Filter = MonoEkf<TypeParam, 24>;
  MonoScene scene;
  Filter filter;
  Random random(1);
  UpdateReport report;
  ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), {})));
  scene.add_features(filter, 24);
  for (int k = 0; k < 10; ++k) scene.step(filter, random);
  const std::uint64_t before = test::hash_of(filter);
  const T nan = std::numeric_limits<T>::quiet_NaN();

  EXPECT_EQ(filter.predict(T(0)), Status::kDuplicate);
  EXPECT_EQ(filter.predict(T(-0.1)), Status::kTimeBackwards);
  EXPECT_EQ(filter.predict(T(5)), Status::kTimeGap);
  EXPECT_EQ(filter.predict(nan), Status::kNonFiniteInput);
  EXPECT_EQ(filter.remove_feature(-1), Status::kInvalidArgument);
  EXPECT_EQ(filter.remove_feature(24), Status::kInvalidArgument);
  EXPECT_EQ(filter.add_feature(999, {T(100), T(100)}), Status::kFull);
  auto matches = scene.matches(filter);
  EXPECT_EQ(filter.update(matches.data(), -1, random, report), Status::kInvalidArgument);
  EXPECT_EQ(filter.update(matches.data(), 25, random, report), Status::kInvalidArgument);
  matches[1].slot = matches[0].slot;
  EXPECT_EQ(filter.update(matches.data(), 2, random, report), Status::kInvalidArgument);
  matches = scene.matches(filter);
  matches[0].id += 1;
  EXPECT_EQ(filter.update(matches.data(), 2, random, report), Status::kInvalidArgument);
  matches = scene.matches(filter);
  matches[3].pixel.x() = nan;
  EXPECT_EQ(filter.update(matches.data(), 8, random, report), Status::kNonFiniteInput);
  matches = scene.matches(filter);
  EXPECT_EQ(filter.update(matches.data(), 3, random, report), Status::kNoConsensus);
  EXPECT_EQ(filter.update(nullptr, 0, random, report), Status::kNoConsensus);
  EXPECT_EQ(test::hash_of(filter), before);

  ASSERT_TRUE(ok(filter.remove_feature(5)));
  const std::uint64_t shorter = test::hash_of(filter);
  EXPECT_EQ(filter.add_feature(filter.feature_id(0), {T(100), T(100)}), Status::kDuplicate);
  EXPECT_EQ(filter.add_feature(kNoLandmark, {T(100), T(100)}), Status::kInvalidArgument);
  EXPECT_EQ(filter.add_feature(999, {T(100), T(100)}, T(-1), T(1)), Status::kInvalidArgument);
  EXPECT_EQ(filter.add_feature(999, {T(-5), T(100)}), Status::kOutOfView);
  EXPECT_EQ(filter.add_feature(999, {nan, T(100)}), Status::kNonFiniteInput);
  EXPECT_EQ(test::hash_of(filter), shorter);
  EXPECT_EQ(filter.health().time_errors, 3U);
  EXPECT_EQ(filter.health().non_finite_inputs, 3U);
  EXPECT_EQ(filter.health().ransac_no_consensus, 1U);
}

TYPED_TEST(MonoEkfContract, TwoInstancesInterleavedGiveTheSameBytes) {
  using T = TypeParam;
  using Filter = MonoEkf<TypeParam, 24>;
  MonoScene scene_a, scene_b;
  Filter a, b;
  Random random_a(4), random_b(4);
  ASSERT_TRUE(ok(a.initialise(MonoScene::camera<T>(), {})));
  scene_a.add_features(a, 20);
  ASSERT_TRUE(ok(b.initialise(MonoScene::camera<T>(), {})));
  scene_b.add_features(b, 20);
  for (int k = 0; k < 30; ++k) {
    scene_a.step(a, random_a);
    scene_b.step(b, random_b);
    ASSERT_EQ(test::hash_of(a), test::hash_of(b));
  }
}

TYPED_TEST(MonoEkfContract, FollowsATranslatingCamera) {
  using T = TypeParam;
  using Filter = MonoEkf<TypeParam, 24>;
  MonoScene scene;
  Filter filter;
  Random random(1);
  ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), {})));
  scene.add_features(filter, 24);
  for (int k = 0; k < 100; ++k) scene.step(filter, random);
  const Rigid<double> truth = scene.T_world_camera();
  const Rigid<T> estimate = filter.T_world_camera();
  const Quaternion<double> error =
      truth.rotation.conjugate() * estimate.rotation.template cast<double>();
  EXPECT_LT(rotation_log(error).norm(), 0.02);
  const Vector3<double> moved = estimate.translation.template cast<double>();
  const double cosine = moved.dot(truth.translation) / (moved.norm() * truth.translation.norm());
  EXPECT_GT(cosine, 0.99);
}

/// A camera at rest rolls by 0.08 rad in one frame. A single match leaves open whether it rolled or
/// turned sideways.
TYPED_TEST(MonoEkfContract, ThreeMatchesTellARollThatOneCannot) {
  using T = TypeParam;
  using Filter = MonoEkf<TypeParam, 24>;
  constexpr double kRoll = 0.08;
  for (const int triples : {0, 16}) {
    MonoScene scene;
    Filter filter;
    Random random(1);
    MonoParameters<T> parameters;
    parameters.max_triples = triples;
    ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), parameters)));
    scene.add_features(filter, 24);
    ASSERT_TRUE(ok(filter.predict(T(0.1))));
    std::vector<PixelMatch<T>> matches = scene.matches(filter);
    const PinholeCamera<T> camera = MonoScene::camera<T>();
    const Quaternion<T> roll = rotation_exp(Vector3<T>(T(0), T(0), T(kRoll)));
    for (PixelMatch<T>& match : matches) {
      Vector3<T> ray;
      ASSERT_TRUE(ok(camera.unproject(match.pixel, ray)));
      ASSERT_TRUE(ok(camera.project(roll.conjugate() * ray, match.pixel)));
    }
    UpdateReport report;
    const int count = static_cast<int>(matches.size());
    const Status status = filter.update(matches.data(), count, random, report);
    EXPECT_EQ(report.triples > 0, triples > 0);
    EXPECT_LE(report.triples, triples);
    const int inliers = report.low_innovation;
    if (triples == 0) {
      EXPECT_LT(2 * inliers, count);
      continue;
    }
    EXPECT_EQ(status, Status::kOk);
    EXPECT_GT(2 * inliers, count);
    EXPECT_NEAR(rotation_log(filter.T_world_camera().rotation).z(), kRoll, 0.01);
  }
}

TYPED_TEST(MonoEkfContract, RestartsMovingWithItsVelocitiesAndScale) {
  using T = TypeParam;
  using Filter = MonoEkf<TypeParam, 24>;
  MonoScene scene;
  Filter filter;
  Random random(1);
  MonoParameters<T> parameters;
  parameters.initial_inverse_depth = T(0.6);
  ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), parameters)));
  scene.add_features(filter, 24);
  for (int k = 0; k < 60; ++k) scene.step(filter, random);
  const Vector3<T> velocity = filter.velocity_mps();
  const Vector3<T> rate = filter.rate_radps();
  ASSERT_EQ(filter.restart_moving(filter.T_world_camera()), Status::kOk);
  EXPECT_EQ(filter.feature_count(), 0);
  EXPECT_EQ(filter.velocity_mps(), velocity);
  EXPECT_EQ(filter.rate_radps(), rate);
  ASSERT_TRUE(ok(filter.add_feature(1000, Vector2<T>(T(181), T(118)))));
  T inverse_depth = T(0), sigma = T(0);
  ASSERT_TRUE(ok(filter.feature_inverse_depth(0, inverse_depth, sigma)));
  EXPECT_NE(inverse_depth, parameters.initial_inverse_depth);
  EXPECT_NEAR(static_cast<double>(sigma / inverse_depth), 0.5, 1e-3);
  ASSERT_EQ(filter.restart(Rigid<T>()), Status::kOk);
  EXPECT_EQ(filter.rate_radps(), Vector3<T>(Vector3<T>::Zero()));
  ASSERT_TRUE(ok(filter.add_feature(1000, Vector2<T>(T(181), T(118)))));
  ASSERT_TRUE(ok(filter.feature_inverse_depth(0, inverse_depth, sigma)));
  EXPECT_NEAR(static_cast<double>(inverse_depth), 0.6, 1e-6);
}

TYPED_TEST(MonoEkfContract, RemovedAndAddedFeaturesKeepTheirIdentities) {
  using T = TypeParam;
  using Filter = MonoEkf<TypeParam, 24>;
  MonoScene scene;
  Filter filter;
  Random random(1);
  ASSERT_TRUE(ok(filter.initialise(MonoScene::camera<T>(), {})));
  scene.add_features(filter, 24);
  for (int k = 0; k < 60; ++k) {
    scene.step(filter, random);
    ASSERT_TRUE(ok(filter.remove_feature(random.below(filter.feature_count()))));
    ASSERT_TRUE(ok(filter.remove_feature(random.below(filter.feature_count()))));
    scene.add_features(filter, 24);
    for (int slot = 0; slot < filter.feature_count(); ++slot) {
      ASSERT_EQ(filter.find(filter.feature_id(slot)), slot);
      PixelPrediction<T> prediction;
      if (!ok(filter.predict_feature(slot, prediction))) continue;
      const Vector2<double> want = scene.pixel(filter.feature_id(slot));
      EXPECT_LT((prediction.pixel.template cast<double>() - want).norm(), 8.0);
    }
    ASSERT_LE(filter.anchor_count(), Filter::kMaxAnchors);
  }
}

}  // namespace
}  // namespace cairn
