#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/runtime/handheld_tracker.hpp"

#include "plane_scene.hpp"
#include "two_walls.hpp"

namespace cairn {
namespace {

using Handheld = HandheldTracker<DefaultConfig>;
using Image = std::vector<std::uint8_t>;

/// A map file in memory.
struct Memory {
  std::vector<std::uint8_t> bytes;
  static bool write(void* context, const std::uint8_t* from, int count) {
    auto& memory = *static_cast<Memory*>(context);
    memory.bytes.insert(memory.bytes.end(), from, from + count);
    return true;
  }
  static bool read(void* context, std::uint32_t offset, std::uint8_t* to, int count) {
    const auto& memory = *static_cast<Memory*>(context);
    for (int i = 0; i < count; ++i) to[i] = memory.bytes[offset + static_cast<std::uint32_t>(i)];
    return true;
  }
  ByteSink sink() { return {&write, this}; }
  ByteSource source() { return {&read, this, static_cast<std::uint32_t>(bytes.size())}; }
};

/// GIVEN a hand-held camera that was moved before two textured planes, one behind the other, and
/// has a library of them.
class HandheldWithoutSight : public ::testing::Test {
 protected:
  static constexpr int kFrames = 100;
  static constexpr int kAgain = kFrames - 11;  ///< where the camera is when the picture is back
  static constexpr std::int64_t kStepUs = 33333;

  static Handheld::Parameters parameters() {
    Handheld::Parameters p;
    p.start.blocks = 3;  // a shorter start: what follows is about the library
    return p;
  }

  HandheldWithoutSight() {
    EXPECT_TRUE(ok(tracker_->initialise(test::to_float(test::small_camera()), parameters())));
    for (int k = 0; k < kFrames; ++k) {
      step(test::two_walls(k));
      if (k == kAgain) then_ = report_.T_world_camera;
    }
    EXPECT_EQ(report_.state, TrackingState::kTracking);
    EXPECT_GE(tracker_->library().size(), parameters().map_reuse.min_library);
  }

  void step(const Image& image) {
    static_cast<void>(tracker_->process_frame(test::view(image, test::small_camera()),
                                              frame_ * kStepUs, TickSource{}, report_));
    ++frame_;
  }
  void show(const Image& image, int frames) {
    Image seen = image;
    for (int k = 0; k < frames; ++k) {
      seen[0] =
          static_cast<std::uint8_t>(image[0] ^ (k & 1));  // no camera repeats a picture's bytes
      step(seen);
      relocalised_ = relocalised_ || report_.relocalised;
      tracked_ = tracked_ || report_.state == TrackingState::kTracking;
    }
  }

  void expect_the_pose_of_then() const {
    const Rigid<float> off = then_.inverse() * report_.T_world_camera;
    EXPECT_LT(off.translation.norm(), 0.1F * then_.translation.norm());
    EXPECT_LT(rotation_log(off.rotation).norm(), 0.03F);
  }

  std::unique_ptr<Handheld> tracker_ = std::make_unique<Handheld>();
  FrameReport report_;
  Rigid<float> then_;  ///< the estimate at frame kAgain
  bool relocalised_ = false;
  bool tracked_ = false;
  int frame_ = 0;
};

TEST_F(HandheldWithoutSight, SaysThatItIsLostAndHoldsItsPose) {
  show(Image(320 * 240, 0), 15);
  EXPECT_EQ(report_.state, TrackingState::kLost);
  EXPECT_EQ(report_.status, Status::kLost);
  EXPECT_EQ(tracker_->health().losses, 1U);
  const Rigid<float> held = report_.T_world_camera;
  show(Image(320 * 240, 0), 30);
  EXPECT_EQ(report_.state, TrackingState::kLost);
  EXPECT_EQ((report_.T_world_camera.translation - held.translation).norm(), 0.0F);
  EXPECT_EQ(tracker_->health().losses, 1U);
}

TEST_F(HandheldWithoutSight, FindsItsPlaceInTheLibraryAndKeepsItsScale) {
  show(Image(320 * 240, 0), 20);
  ASSERT_EQ(report_.state, TrackingState::kLost);
  tracked_ = false;
  show(test::two_walls(kAgain), 20);
  EXPECT_TRUE(relocalised_);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_EQ(tracker_->health().relocalisations, 1U);
  EXPECT_GE(tracker_->health().landmarks_reactivated, 8U);
  expect_the_pose_of_then();
}

TEST_F(HandheldWithoutSight, NeverTakesAnotherPlaceForItsOwn) {
  const test::PlaneScene elsewhere(2.0, 0.2, 99);
  const Image other = elsewhere.render(test::small_camera(), test::two_walls_pose(0));
  show(Image(320 * 240, 0), 20);
  ASSERT_EQ(report_.state, TrackingState::kLost);
  tracked_ = false;
  show(other, 60);
  EXPECT_FALSE(tracked_);
  EXPECT_FALSE(relocalised_);
  EXPECT_EQ(report_.state, TrackingState::kLost);
  show(test::two_walls(kAgain), 20);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

TEST_F(HandheldWithoutSight, FindsItsPlaceInAMapThatWasSaved) {
  Memory file;
  ASSERT_EQ(tracker_->save_map(file.sink()), Status::kOk);
  auto other = std::make_unique<Handheld>();
  MapFileInfo info;
  EXPECT_EQ(other->load_map(file.source(), info), Status::kNotInitialised);
  ASSERT_TRUE(ok(other->initialise(test::to_float(test::small_camera()), parameters())));
  ASSERT_EQ(other->load_map(file.source(), info), Status::kOk);
  EXPECT_EQ(other->library().size(), tracker_->library().size());
  EXPECT_EQ(other->state(), TrackingState::kLost);
  tracker_ = std::move(other);
  show(test::two_walls(kAgain), 20);
  EXPECT_TRUE(relocalised_);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  expect_the_pose_of_then();
}

TEST_F(HandheldWithoutSight, RefusesADamagedMapAndKeepsItsOwn) {
  Memory file;
  ASSERT_EQ(tracker_->save_map(file.sink()), Status::kOk);
  file.bytes[file.bytes.size() / 2] ^= 1U;
  Hash64 before;
  tracker_->hash(before);
  MapFileInfo info;
  EXPECT_EQ(tracker_->load_map(file.source(), info), Status::kCorrupt);
  EXPECT_EQ(info.fault, MapFileFault::kChecksum);
  Hash64 after;
  tracker_->hash(after);
  EXPECT_EQ(after.value(), before.value());
  EXPECT_EQ(tracker_->state(), TrackingState::kTracking);
}

TEST_F(HandheldWithoutSight, ResetsAMapThatIsTooSmallToRelocaliseIn) {
  ASSERT_TRUE(ok(tracker_->initialise(test::to_float(test::small_camera()), {})));
  for (int k = 0; k < 20; ++k) step(test::two_walls(k));
  ASSERT_EQ(tracker_->library().size(), 0);
  show(Image(320 * 240, 0), 20);
  ASSERT_EQ(report_.state, TrackingState::kLost);
  show(test::two_walls(20), 1);
  EXPECT_EQ(report_.state, TrackingState::kLost);  // of this frame, too
  EXPECT_EQ(tracker_->state(), TrackingState::kInitialising);
  show(test::two_walls(20), 3);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_FALSE(relocalised_);
  EXPECT_EQ(tracker_->health().losses, 1U);
}

}  // namespace
}  // namespace cairn
