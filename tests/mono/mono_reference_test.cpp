#include "mono_reference.hpp"

#include <memory>
#include <set>

#include <gtest/gtest.h>

#include "cairn/mono/mono_ekf.hpp"

#include "mono_scene.hpp"

namespace cairn {
namespace {

using test::MonoReference;
using test::MonoScene;

/// No RANSAC decision and no conversion to points, so that the filter does what the reference does.
MonoParameters<double> plain_parameters() {
  MonoParameters<double> parameters;
  parameters.ransac.min_inliers = 1;
  parameters.inlier_gate = 1e12;
  parameters.depth_from_map = false;
  parameters.min_inverse_depth = 1e-12;
  return parameters;
}

class AgainstReference : public ::testing::Test {
 protected:
  using Filter = MonoEkf<double, 24, 24>;

  void start(const MonoParameters<double>& parameters) {
    reference_ = std::make_unique<MonoReference>(MonoScene::camera<double>(), parameters);
    ASSERT_TRUE(ok(filter_.initialise(MonoScene::camera<double>(), parameters)));
  }

  void add(int count) {
    const int before = filter_.feature_count();
    scene_.add_features(filter_, before + count);
    ASSERT_EQ(filter_.feature_count(), before + count);
    for (const auto& pixel : scene_.added()) reference_->add_feature(pixel);
    scene_.clear_added();
  }

  void step(int frame) {
    scene_.advance();
    ASSERT_TRUE(ok(filter_.predict(0.04)));
    reference_->predict(0.04);
    auto matches = scene_.matches(filter_);
    std::vector<int> features;
    std::vector<Eigen::Vector2d> pixels;
    for (const auto& match : matches) {
      features.push_back(match.slot);
      pixels.push_back(match.pixel);
    }
    UpdateReport report;
    ASSERT_TRUE(
        ok(filter_.update(matches.data(), static_cast<int>(matches.size()), random_, report)));
    ASSERT_EQ(report.low_innovation, static_cast<int>(matches.size())) << frame;
    reference_->update(features, pixels);
  }

  /// Largest differences of pose, pose covariance, predicted pixels and their covariances.
  double difference() const {
    const Eigen::VectorXd& x = reference_->state();
    const Rigid<double> pose = filter_.T_world_camera();
    double worst = (pose.translation - x.head<3>()).cwiseAbs().maxCoeff();
    const Eigen::Vector4d q(pose.rotation.w(), pose.rotation.x(), pose.rotation.y(),
                            pose.rotation.z());
    worst = std::max(worst, (q - x.segment<4>(3)).cwiseAbs().maxCoeff());
    worst = std::max(worst, (filter_.velocity_mps() - x.segment<3>(7)).cwiseAbs().maxCoeff());
    worst = std::max(worst, (filter_.rate_radps() - x.segment<3>(10)).cwiseAbs().maxCoeff());
    const Eigen::Matrix3d position = filter_.pose_covariance().topLeftCorner<3, 3>();
    worst = std::max(
        worst, (position - reference_->covariance().topLeftCorner<3, 3>()).cwiseAbs().maxCoeff());
    for (int slot = 0; slot < filter_.feature_count(); ++slot) {
      PixelPrediction<double> prediction;
      if (!ok(filter_.predict_feature(slot, prediction))) continue;
      worst = std::max(worst,
                       (prediction.pixel - reference_->pixel(slot)).cwiseAbs().maxCoeff() / 300.0);
      const Eigen::Matrix2d s = reference_->innovation_covariance(slot);
      worst = std::max(worst,
                       (prediction.covariance - s).cwiseAbs().maxCoeff() / s.cwiseAbs().maxCoeff());
    }
    return worst;
  }

  MonoScene scene_;
  Random random_{5};
  Filter filter_;
  std::unique_ptr<MonoReference> reference_;
};

TEST_F(AgainstReference, SequentialUpdateEqualsTheBatchUpdate) {
  start(plain_parameters());
  add(20);
  step(1);
  EXPECT_LT(difference(), 1e-12);
}

TEST_F(AgainstReference, SharedAnchorsEqualThePlainFilterOverARun) {
  start(plain_parameters());
  add(8);
  for (int k = 0; k < 60; ++k) {
    step(k);
    if (k == 10 || k == 25 || k == 40) add(4);
    ASSERT_LT(difference(), 1e-9) << k;
  }
  EXPECT_EQ(filter_.feature_count(), 20);
  EXPECT_EQ(filter_.anchor_count(), 4);
  EXPECT_EQ(filter_.state_size(), 13 + 3 * 20 + 3 * 4);
  EXPECT_EQ(reference_->state().size(), 13 + 6 * 20);
}

TEST_F(AgainstReference, OwnAnchorsAreThePlainFilter) {
  MonoParameters<double> parameters = plain_parameters();
  parameters.share_anchors = false;
  start(parameters);
  add(12);
  for (int k = 0; k < 20; ++k) step(k);
  EXPECT_EQ(filter_.state_size(), 13 + 6 * 12);
  EXPECT_LT(difference(), 1e-9);
}

TEST_F(AgainstReference, FadingMultipliesThePredictedCovariance) {
  MonoParameters<double> parameters = plain_parameters();
  parameters.fading_factor = 1.009;
  start(parameters);
  add(16);
  for (int k = 0; k < 15; ++k) step(k);
  // The cap holds the inverse depth at its prior, which the reference does not have.
  EXPECT_LT(difference(), 2e-2);
  EXPECT_EQ(filter_.last_fading_factor(), 1.009);
}

TEST(Fading, FactorOneIsEqualToTheBitToNone) {
  MonoParameters<float> none;
  MonoParameters<float> one;
  one.fading_factor = 1.0F;
  MonoScene scene_a, scene_b;
  MonoEkf<float, 20> a, b;
  Random random_a(2), random_b(2);
  ASSERT_TRUE(ok(a.initialise(MonoScene::camera<float>(), none)));
  ASSERT_TRUE(ok(b.initialise(MonoScene::camera<float>(), one)));
  scene_a.add_features(a, 20);
  scene_b.add_features(b, 20);
  for (int k = 0; k < 40; ++k) {
    scene_a.step(a, random_a);
    scene_b.step(b, random_b);
    ASSERT_EQ(test::hash_of(a), test::hash_of(b)) << k;
  }
}

}  // namespace
}  // namespace cairn
