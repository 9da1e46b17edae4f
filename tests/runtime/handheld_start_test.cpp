#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/runtime/handheld_tracker.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using Handheld = HandheldTracker<DefaultConfig>;
using Image = std::vector<std::uint8_t>;

/// GIVEN a tracker that calls its first start mirrored, whatever it sees.
class StartOnTrial : public ::testing::Test {
 protected:
  static constexpr std::int64_t kStepUs = 33333;

  StartOnTrial() {
    Handheld::Parameters parameters;
    parameters.start.max_misfit = 1e-6F;
    parameters.start.max_restarts = 1;
    block_ = parameters.start.block_frames;
    EXPECT_TRUE(ok(tracker_->initialise(test::to_float(test::small_camera()), parameters)));
  }

  /// With read-out noise of some grey levels, so that no innovation is zero.
  void show(const Image& image, int frames) {
    for (int k = 0; k < frames; ++k) {
      Image exposed = image;
      for (std::uint8_t& grey : exposed) {
        if (grey > 0 && grey < 248) grey = static_cast<std::uint8_t>(grey + (noise_.next() >> 29U));
      }
      static_cast<void>(tracker_->process_frame(test::view(exposed, test::small_camera()),
                                                frame_ * kStepUs, TickSource{}, report_));
      ++frame_;
    }
  }

  const Image wall_ = test::PlaneScene(2.0, 0.2).render(test::small_camera(), {});
  const Image black_ = Image(320 * 240, 0);
  std::unique_ptr<Handheld> tracker_ = std::make_unique<Handheld>();
  FrameReport report_;
  Random noise_{3};
  int block_ = 0;
  int frame_ = 0;
};

TEST_F(StartOnTrial, IsLostAndBeginsAnew) {
  show(wall_, block_ - 1);
  ASSERT_EQ(report_.state, TrackingState::kTracking);
  show(wall_, 1);
  EXPECT_EQ(report_.state, TrackingState::kLost);
  EXPECT_EQ(report_.status, Status::kLost);
  EXPECT_EQ(tracker_->health().losses, 1U);
  EXPECT_EQ(tracker_->filter().feature_count(), 0);
  show(wall_, 3);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

TEST_F(StartOnTrial, BeginsAnewAlsoWhereItSawNothingWhenTheTrialEnded) {
  show(wall_, block_ - 5);
  ASSERT_EQ(report_.state, TrackingState::kTracking);
  show(black_, 5);
  ASSERT_EQ(report_.state, TrackingState::kLost);
  show(wall_, 3);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

}  // namespace
}  // namespace cairn
