#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/runtime/handheld_tracker.hpp"

#include "two_walls.hpp"

namespace cairn {
namespace {

using Handheld = HandheldTracker<DefaultConfig>;
using Image = std::vector<std::uint8_t>;

/// GIVEN a hand-held camera that moves before two textured planes.
class HandheldInATrickyPlace : public ::testing::Test {
 protected:
  static constexpr int kWarm = 60;
  static constexpr std::int64_t kStepUs = 33333;

  HandheldInATrickyPlace() {
    EXPECT_TRUE(ok(tracker_->initialise(test::to_float(test::small_camera()), {})));
  }

  void step(const Image& image, int at) {
    static_cast<void>(tracker_->process_frame(test::view(image, test::small_camera()),
                                              frame_ * kStepUs, TickSource{}, report_));
    const Rigid<double> truth = test::two_walls_pose(at);
    const Rigid<double> estimate{report_.T_world_camera.rotation.cast<double>(),
                                 report_.T_world_camera.translation.cast<double>()};
    if (frame_ == kWarm) scale_ = estimate.translation.norm() / truth.translation.norm();
    if (frame_ > kWarm)
      note_jump(estimate_before_.inverse() * estimate, truth_before_.inverse() * truth);
    keep_sigmas();
    estimate_before_ = estimate;
    truth_before_ = truth;
    ++frame_;
  }

  /// Largest error of the motion from frame to frame, by what the pose's deviation was before it:
  /// of the position at the map's own scale, and of the rotation.
  void note_jump(const Rigid<double>& moved, const Rigid<double>& truly) {
    const double position = (moved.translation - scale_ * truly.translation).norm();
    const double rotation = rotation_log(truly.rotation.conjugate() * moved.rotation).norm();
    worst_jump_ = std::max({worst_jump_, position / sigma_before_[0], rotation / sigma_before_[1]});
  }
  void keep_sigmas() {
    // Half a millimetre and half a milliradian are left to the patch alignment's bias.
    constexpr double kBias = 5e-4;
    const Matrix<float, 6, 6> P = tracker_->filter().pose_covariance();
    for (int i = 0; i < 2; ++i) {
      const float trace = P(3 * i, 3 * i) + P(3 * i + 1, 3 * i + 1) + P(3 * i + 2, 3 * i + 2);
      sigma_before_[i] = std::sqrt(static_cast<double>(trace)) + kBias;
    }
  }

  std::unique_ptr<Handheld> tracker_ = std::make_unique<Handheld>();
  FrameReport report_;
  Rigid<double> estimate_before_;
  Rigid<double> truth_before_;
  double sigma_before_[2] = {};
  double scale_ = 0.0;
  double worst_jump_ = 0.0;
  int frame_ = 0;
};

TEST_F(HandheldInATrickyPlace, TilesThatAllLookAlikeMakeItJumpNowhere) {
  test::PlaneScene far_tiles(2.5, 0.28);
  test::PlaneScene near_tiles(1.2, 0.13, 7);
  far_tiles.repeat(1);
  near_tiles.repeat(1);
  for (int k = 0; k < 95; ++k) {
    step(test::render_walls(test::two_walls_pose(k), far_tiles, near_tiles), k);
  }
  EXPECT_LT(worst_jump_, 3.0);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

/// Something with a texture of its own fills 40 % of the picture and moves against the camera.
TEST_F(HandheldInATrickyPlace, AMovingThingDoesNotTakeItAlong) {
  const test::PlaneScene thing(0.9, 0.12, 5);
  const PinholeCamera<double> camera = test::small_camera();
  for (int k = 0; k < 95; ++k) {
    Image image = test::two_walls(k);
    if (k > kWarm) {
      const Image moving = thing.render(
          camera, {Quaternion<double>::Identity(), {0.01 * (k - kWarm), 0.004 * (k - kWarm), 0.0}});
      const int edge = camera.width * 6 / 10;
      for (int v = 0; v < camera.height; ++v) {
        for (int u = edge; u < camera.width; ++u) {
          const auto i = static_cast<std::size_t>(v * camera.width + u);
          image[i] = moving[i];
        }
      }
    }
    step(image, k);
  }
  EXPECT_LT(worst_jump_, 3.0);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

/// A driver that hands every third picture out twice: the second tells nothing, and no time passes.
TEST_F(HandheldInATrickyPlace, APictureGivenTwiceIsPassedOver) {
  for (int k = 0; k <= kWarm; ++k) step(test::two_walls(k), k);
  std::uint32_t repeated = 0;
  for (int k = kWarm + 1; k < kWarm + 30; ++k) {
    const bool again = k % 3 == 0;
    const Rigid<float> before = report_.T_map_camera;
    const std::uint32_t used = tracker_->filter().health().innovations_used;
    const int at = again ? k - 1 : k;
    step(test::two_walls(at), at);
    EXPECT_EQ(report_.status, again ? Status::kRepeatedImage : Status::kOk) << k;
    EXPECT_EQ(report_.state, again ? TrackingState::kUncertain : TrackingState::kTracking) << k;
    if (!again) continue;
    EXPECT_EQ(report_.T_map_camera.translation, before.translation);
    EXPECT_EQ(tracker_->filter().health().innovations_used, used);
    ++repeated;
  }
  EXPECT_EQ(tracker_->health().repeated_images, repeated);
  EXPECT_LT(worst_jump_, 3.0);
}

/// Registration error of a resting camera: rms of what a pixel of the map moves from frame to
/// frame, at the distance of each wall.
TEST_F(HandheldInATrickyPlace, ARestingCameraDoesNotJitter) {
  for (int k = 0; k <= kWarm; ++k) step(test::two_walls(k), k);
  const PinholeCamera<float> camera = test::to_float(test::small_camera());
  const Rigid<float> T_world_camera = report_.T_world_camera;
  const auto scale = static_cast<float>(scale_);
  const Vector3<float> points[] = {
      T_world_camera * Vector3<float>(-0.3F * scale, 0.1F, 1.2F * scale),
      T_world_camera * Vector3<float>(0.5F * scale, 0.1F, 2.5F * scale)};
  Vector2<float> before[2];
  Random random(1);
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k < 60; ++k) {
    Image image = test::two_walls(kWarm);
    for (std::uint8_t& grey : image) {  // read-out noise, 2 grey levels rms
      const int off = static_cast<int>(random.next() >> 29U) - 3;
      grey = static_cast<std::uint8_t>(clamp(int{grey} + off, 0, 255));
    }
    step(image, kWarm);
    for (int i = 0; i < 2; ++i) {
      Vector2<float> pixel;
      ASSERT_TRUE(ok(camera.project(report_.T_world_camera.inverse() * points[i], pixel)));
      if (k >= 10) {  // at rest, once the filter's velocity has died away
        sum += static_cast<double>((pixel - before[i]).squaredNorm());
        ++count;
      }
      before[i] = pixel;
    }
  }
  EXPECT_LT(std::sqrt(sum / count), 0.3);
  RecordProperty("jitter_millipixels", static_cast<int>(1e3 * std::sqrt(sum / count)));
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

}  // namespace
}  // namespace cairn
