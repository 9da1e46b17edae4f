#include <cstdlib>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/mono/mono_ekf.hpp"

#include "covariance_eigenvalue.hpp"
#include "mono_scene.hpp"

namespace cairn {
namespace {

using mono_test::smallest_correlation_eigenvalue;
using test::MonoScene;

constexpr double kSound = -1e-5;  ///< least eigenvalue of a correlation matrix that passes
using Filter = MonoEkf<float, 32>;

/// A filter of a hand-held tracker, and the scene that it looks at.
struct Follower {
  explicit Follower(std::uint32_t seed, int features = 32, MonoParameters<float> parameters = {})
      : scene(seed), random(seed), wanted(features) {
    parameters.sigma_px = 0.7F;
    parameters.max_triples = 16;
    good = ok(filter->initialise(MonoScene::camera<float>(), parameters));
    scene.add_features(*filter, wanted);
  }
  /// One frame: prediction, update with `matches`, features replaced.
  void frame(std::vector<PixelMatch<float>> matches) {
    status = filter->update(matches.data(), static_cast<int>(matches.size()), random, report);
    filter->prune({}, 0);
    scene.add_features(*filter, wanted);
  }
  void frame(bool moves = true) {
    if (moves) scene.advance();
    good = ok(filter->predict(0.04F)) && good;
    frame(scene.matches(*filter));
  }

  std::unique_ptr<Filter> filter = std::make_unique<Filter>();
  MonoScene scene;
  Random random;
  UpdateReport report;
  Status status = Status::kOk;
  int wanted;
  bool good = false;
};

/// Minutes that a camera stands: CAIRN_STAND_MINUTES, 1 where it is not set.
int stand_minutes() {
  const char* minutes = std::getenv("CAIRN_STAND_MINUTES");
  return minutes == nullptr ? 1 : std::atoi(minutes);
}

TEST(MonoCovariance, StaysSoundWhileTheCameraStands) {
  Follower follower(3);
  for (int k = 0; k < 100; ++k) follower.frame();
  const Rigid<float> stopped = follower.filter->T_world_camera();
  const int frames = stand_minutes() * 60 * 25;
  for (int k = 0; k < frames; ++k) {
    follower.frame(false);
    ASSERT_TRUE(ok(follower.status)) << k;
    if (k % 100 == 0) {
      ASSERT_GT(smallest_correlation_eigenvalue(*follower.filter), kSound) << k;
    }
  }
  ASSERT_TRUE(follower.good);
  // Nothing ties the world down while the camera stands. An hour walked by 0.1 units.
  const float most = stand_minutes() > 1 ? 0.15F : 0.05F;
  const Rigid<float> now = follower.filter->T_world_camera();
  EXPECT_LT((now.translation - stopped.translation).norm(), most);
  EXPECT_EQ(follower.filter->health().covariance_repairs, 0U);
  EXPECT_EQ(follower.filter->health().innovations_singular, 0U);
  EXPECT_EQ(follower.filter->health().resets, 0U);
}

TEST(MonoCovariance, StaysSoundWhileTheCameraSwings) {
  Follower follower(4);
  for (int k = 0; k < 3000; ++k) {
    follower.frame();
    if (k % 10 == 0) {
      ASSERT_GT(smallest_correlation_eigenvalue(*follower.filter), kSound) << k;
    }
  }
  EXPECT_EQ(follower.filter->health().covariance_repairs, 0U);
  EXPECT_EQ(follower.filter->health().resets, 0U);
}

/// Pixels far better than the arithmetic: whatever had to be done was counted, and the filter goes
/// on.
TEST(MonoCovariance, SurvivesPixelsOfImpossiblePrecision) {
  for (const float claimed : {1e-2F, 1e-3F, 1e-5F}) {
    MonoParameters<float> parameters;
    auto filter = std::make_unique<Filter>();
    parameters.sigma_px = claimed;
    MonoScene scene(5, 0.0);
    Random random(5);
    ASSERT_TRUE(ok(filter->initialise(MonoScene::camera<float>(), parameters)));
    scene.add_features(*filter, 32);
    for (int k = 0; k < 300; ++k) {
      scene.step(*filter, random);
      filter->prune({}, 0);
      scene.add_features(*filter, 32);
      const double smallest = smallest_correlation_eigenvalue(*filter);
      const bool counted = filter->health().covariance_repairs + filter->health().resets > 0;
      ASSERT_GT(smallest, counted ? -1.0 : kSound) << claimed << ' ' << k;
    }
  }
}

/// A camera that may have turned anywhere, and then sees its features: of a huge uncertainty the
/// matches leave next to nothing.
TEST(MonoCovariance, SurvivesLongBlindTurns) {
  Follower follower(48837, 12);
  ASSERT_TRUE(ok(follower.filter->set_motion_noise(20.0F, 40.0F)));
  for (int k = 0; k < 60; ++k) {
    for (int i = 0; i < k % 7; ++i) ASSERT_TRUE(ok(follower.filter->predict(1.0F)));
    follower.frame();
    ASSERT_GT(smallest_correlation_eigenvalue(*follower.filter), kSound) << k;
  }
  EXPECT_EQ(follower.filter->health().resets, 0U);
}

/// Any sequence of motions, rests, good, bad and missing matches, gaps and lost features keeps a
/// sound covariance.
TEST(MonoCovariance, HoldsForRandomSequences) {
  const bool holds = rc::check([] {
    const auto seed = *rc::gen::inRange<unsigned>(0, 100000);
    Follower follower(seed, *rc::gen::inRange(6, 33));
    const auto steps = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 8));
    for (const int step : steps) {
      for (int k = 0; k < 15; ++k) {
        std::vector<PixelMatch<float>> matches;
        switch (step) {
          case 0:
            follower.frame();
            break;
          case 1:
            follower.frame(false);
            break;
          case 2:  // a blind camera
            follower.scene.advance();
            RC_ASSERT(ok(follower.filter->predict(0.04F)));
            follower.frame(std::vector<PixelMatch<float>>());
            break;
          case 3:  // wrong matches
            follower.scene.advance();
            RC_ASSERT(ok(follower.filter->predict(0.04F)));
            matches = follower.scene.matches(*follower.filter);
            for (std::size_t i = 0; i < matches.size(); i += 2) matches[i].pixel.x() += 40.0F;
            follower.frame(matches);
            break;
          case 4:  // a long step
            RC_ASSERT(ok(follower.filter->predict(1.0F)));
            follower.frame();
            break;
          case 5:
            RC_ASSERT(ok(follower.filter->set_motion_noise(k % 2 == 0 ? 0.0F : 20.0F, 40.0F)));
            follower.frame();
            break;
          case 6:
            if (follower.filter->feature_count() > 0)
              RC_ASSERT(ok(follower.filter->remove_feature(0)));
            follower.frame();
            break;
          default:
            RC_ASSERT(ok(follower.filter->restart_moving(follower.filter->T_world_camera())));
            follower.scene.add_features(*follower.filter, follower.wanted);
            follower.frame();
        }
        RC_ASSERT(smallest_correlation_eigenvalue(*follower.filter) > kSound);
      }
    }
    RC_ASSERT(follower.filter->health().innovations_singular == 0U);
  });
  EXPECT_TRUE(holds);
}

}  // namespace
}  // namespace cairn
