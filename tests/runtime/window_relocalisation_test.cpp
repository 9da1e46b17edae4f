#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/runtime/window_tracker.hpp"

#include "plane_scene.hpp"
#include "two_walls.hpp"
#include "vga_camera.hpp"

namespace cairn {
namespace {

using Tracker = WindowTracker<DefaultConfig>;
using Image = std::vector<std::uint8_t>;

/// GIVEN a window that was moved before two textured planes, one behind the other, and has a
/// library of them.
class WindowWithoutSight : public ::testing::Test {
 protected:
  static constexpr int kFrames = 80;
  static constexpr std::int64_t kStepUs = 33333;

  WindowWithoutSight() { start({}); }

  void start(const Tracker::Parameters& parameters) {
    frame_ = 0;
    before_.clear();
    EXPECT_TRUE(ok(tracker_->initialise(test::to_float(test::small_camera()), parameters)));
    for (int k = 0; k < kFrames; ++k) {
      step(test::two_walls(k));
      before_.push_back(report_.T_map_camera);
    }
    EXPECT_EQ(report_.state, TrackingState::kTracking);
    EXPECT_GE(tracker_->library().size(), 16);
    relocalised_ = false;
  }
  void step(const Image& image) {
    static_cast<void>(tracker_->process_frame(test::view(image, test::small_camera()),
                                              frame_ * kStepUs, TickSource{}, report_));
    ++frame_;
    relocalised_ = relocalised_ || report_.relocalised;
  }
  void show_dark(int frames) {
    const Image black(test::two_walls(0).size(), 0);
    for (int k = 0; k < frames; ++k) step(black);
    EXPECT_EQ(report_.state, TrackingState::kLost);
  }
  /// Another pair of walls, along the same way.
  void show_elsewhere() {
    static const std::vector<Image> images = [] {
      const test::PlaneScene far_wall(2.5, 0.28, 21);
      const test::PlaneScene near_wall(1.2, 0.13, 22);
      std::vector<Image> rendered;
      for (int k = 20; k < 60; ++k) {
        rendered.push_back(test::render_walls(test::two_walls_pose(k), far_wall, near_wall));
      }
      return rendered;
    }();
    for (const Image& image : images) {
      step(image);
      sure_ = sure_ || report_.state == TrackingState::kTracking;
    }
  }

  std::unique_ptr<Tracker> tracker_ = std::make_unique<Tracker>();
  std::vector<Rigid<float>> before_;  ///< poses of the first frames
  FrameReport report_;
  int frame_ = 0;
  bool relocalised_ = false;
  bool sure_ = false;  ///< in some frame of show_elsewhere()
};

TEST_F(WindowWithoutSight, ReturnsToTheMapsFrameAndScale) {
  show_dark(15);
  int k = kFrames - 5;
  for (; k > 45; --k) step(test::two_walls(k));
  EXPECT_TRUE(relocalised_);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_FALSE(tracker_->astray());
  const Rigid<float>& then = before_[static_cast<std::size_t>(k + 1)];
  const Rigid<float> off = then.inverse() * report_.T_map_camera;
  EXPECT_LT(off.translation.norm(), 0.1F * then.translation.norm());
  EXPECT_LT(rotation_log(off.rotation).norm(), 0.03F);
  EXPECT_GE(tracker_->health().landmarks_reactivated, 12U);
}

TEST_F(WindowWithoutSight, ReturnsWithARollingShutter) {
  Tracker::Parameters parameters;
  parameters.readout.row_time_s = 1e-9F;  // which moves no pixel of these pictures
  start(parameters);
  show_dark(15);
  int k = kFrames - 5;
  for (; k > 45 && !relocalised_; --k) step(test::two_walls(k));
  ASSERT_TRUE(relocalised_);
  step(test::two_walls(k));
  const Tracker::Window& window = tracker_->window();
  int near = 0;
  int seen_by_keyframe = 0;
  for (int slot = 0; slot < Tracker::Window::kLandmarks; ++slot) {
    Vector2<float> seen;
    Vector2<float> expected;
    if (!window.newest_sees(slot, seen)) continue;
    ++seen_by_keyframe;
    near +=
        window.project(slot, window.newest_pose(), expected) && (seen - expected).norm() < 0.02F;
  }
  EXPECT_GE(seen_by_keyframe, 8);
  EXPECT_EQ(near, seen_by_keyframe);
}

TEST_F(WindowWithoutSight, KnowsThePlaceByItsViewsWhereNoDescriptorMatches) {
  Tracker::Parameters parameters;
  parameters.memory.recogniser.matcher.max_distance = 0;
  start(parameters);
  show_dark(15);
  int k = kFrames - 5;
  for (; k > 40; --k) step(test::two_walls(k));
  EXPECT_TRUE(relocalised_);
  const Rigid<float>& then = before_[static_cast<std::size_t>(k + 1)];
  const Rigid<float> off = then.inverse() * report_.T_map_camera;
  EXPECT_LT(off.translation.norm(), 0.15F * then.translation.norm());
  EXPECT_LT(rotation_log(off.rotation).norm(), 0.03F);
}

TEST_F(WindowWithoutSight, RemembersTheDepthsThatWereKnownLast) {
  const Tracker::Window& window = tracker_->window();
  const auto newest_depths = [&] {
    std::vector<std::pair<LandmarkId, Vector3<float>>> known;
    for (int i = 0; i < tracker_->feature_count(); ++i) {
      const LandmarkId id = tracker_->feature_id(i);
      if (tracker_->library().find(id) < 0) continue;
      for (int slot = 0; slot < Tracker::Window::kLandmarks; ++slot) {
        if (window.live(slot) && window.id(slot) == id) {
          known.emplace_back(id, window.position(slot));
        }
      }
    }
    return known;
  };
  const auto known = newest_depths();
  ASSERT_GE(known.size(), 8U);
  show_dark(15);
  std::size_t renewed = 0;
  for (const auto& [id, p] : known) {
    const int slot = tracker_->library().find(id);
    ASSERT_GE(slot, 0);
    renewed += (tracker_->library()[slot].p_map - p).norm() < 1e-3F ? 1 : 0;
  }
  EXPECT_GE(10 * renewed, 9 * known.size());
}

TEST_F(WindowWithoutSight, DoesNotTakeAnotherPlaceForTheMap) {
  show_dark(15);
  show_elsewhere();
  EXPECT_FALSE(relocalised_);
  EXPECT_TRUE(tracker_->astray());
  EXPECT_FALSE(sure_);
  EXPECT_EQ(report_.state, TrackingState::kUncertain);
  EXPECT_GE(tracker_->library().size(), 16) << "the map is remembered meanwhile";
}

TEST_F(WindowWithoutSight, TakesTheNewMapAfterSomeTime) {
  Tracker::Parameters parameters;
  parameters.forget_s = 0.7F;
  start(parameters);
  show_dark(15);
  show_elsewhere();
  EXPECT_FALSE(relocalised_);
  EXPECT_TRUE(sure_);
  EXPECT_FALSE(tracker_->astray());
}

TEST_F(WindowWithoutSight, StaysWithinItsWorkWhileItSeeks) {
  show_dark(15);
  int most = 0;
  for (int k = kFrames - 5; k > 45; --k) {
    step(test::two_walls(k));
    most = report_.work > most ? report_.work : most;
  }
  EXPECT_LE(most, 12000);
}

}  // namespace
}  // namespace cairn
