#include "cairn/runtime/window_tracker.hpp"

#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "two_walls.hpp"
#include "vga_camera.hpp"

namespace cairn {
namespace {

using Tracker = WindowTracker<TinyConfig>;
using Image = std::vector<std::uint8_t>;

constexpr std::int64_t kStepUs = 33333;

/// Every second frame of the walk before two walls.
Rigid<double> walk_pose(int k) {
  return test::two_walls_pose(2 * k);
}
const Image& walls(int k) {
  static std::vector<Image> images;
  while (static_cast<int>(images.size()) <= k) {
    images.push_back(test::render_two_walls(walk_pose(static_cast<int>(images.size()))));
  }
  return images[static_cast<std::size_t>(k)];
}

struct Walk {
  std::unique_ptr<Tracker> tracker = std::make_unique<Tracker>();
  FrameReport report;
  int frame = 0;
  int most_work = 0;

  explicit Walk(const Tracker::Parameters& parameters = {}, float focal_error = 0.0F) {
    PinholeCamera<float> camera = test::to_float(test::small_camera());
    camera.fx *= 1.0F + focal_error;
    camera.fy *= 1.0F + focal_error;
    EXPECT_TRUE(ok(tracker->initialise(camera, parameters)));
  }
  void show(const Image& image) {
    static_cast<void>(tracker->process_frame(test::view(image, test::small_camera()),
                                             frame * kStepUs, TickSource{}, report));
    ++frame;
    most_work = report.work > most_work ? report.work : most_work;
  }
  std::uint64_t hash() const {
    Hash64 hash;
    tracker->hash(hash);
    return hash.value();
  }
};

/// Angle between a frame's estimated and true attitude, both relative to the first frame, rad.
float attitude_error(const Walk& run, int k) {
  const Quaternion<double> truth = walk_pose(0).rotation.conjugate() * walk_pose(k).rotation;
  const Quaternion<float> off = run.report.T_map_camera.rotation.conjugate() * truth.cast<float>();
  return sqrt(rotation_log(off).squaredNorm());
}

TEST(WindowTracker, FollowsTwoWallsAndKnowsTheirDepths) {
  Walk run;
  for (int k = 0; k < 30; ++k) {
    run.show(walls(k));
    ASSERT_TRUE(k < 2 || run.report.state != TrackingState::kInitialising) << k;
    ASSERT_NE(run.report.state, TrackingState::kLost) << k;
  }
  EXPECT_EQ(run.report.state, TrackingState::kTracking);
  EXPECT_LT(attitude_error(run, 29), 0.02F);
  EXPECT_EQ(run.tracker->health().losses, 0U);
  // The way that the camera went: against its x axis, a quarter as far along y.
  const Vector3<float> p = run.report.T_map_camera.translation;
  EXPECT_LT(p.x(), 0.0F);
  EXPECT_NEAR(p.y() / p.x(), -0.25F, 0.1F);
  EXPECT_GT(run.tracker->pose_covariance()(5, 5), 0.0F);
}

TEST(WindowTracker, IsLostInTheDarkAndBeginsAnewWithoutALibrary) {
  Tracker::Parameters parameters;
  parameters.memory.min_library = 1000;
  Walk run(parameters);
  for (int k = 0; k < 14; ++k) run.show(walls(k));
  const Image black(walls(0).size(), 0);
  for (int k = 0; k < 10; ++k) {
    run.show(black);
    EXPECT_NE(run.report.state, TrackingState::kTracking);
  }
  EXPECT_EQ(run.report.state, TrackingState::kLost);
  EXPECT_EQ(run.report.status, Status::kLowTexture);
  const float before = run.tracker->pose_covariance()(4, 4);
  for (int k = 14; k < 30; ++k) run.show(walls(k));
  EXPECT_EQ(run.report.state, TrackingState::kTracking);
  EXPECT_EQ(run.tracker->health().losses, 1U);
  EXPECT_EQ(run.tracker->health().resets, 1U);
  EXPECT_EQ(run.tracker->health().relocalisations, 0U);
  EXPECT_GT(run.tracker->pose_covariance()(4, 4), before) << "the turn in the dark is not known";
}

/// Its first frame is exact in it, whatever was known in the old one; the attitude is relative to
/// the first camera, and the turn in the dark is not known.
TEST(WindowTracker, ANewMapsPoseHasACovarianceOfItsOwn) {
  Tracker::Parameters parameters;
  parameters.memory.min_library = 1000;
  Walk run(parameters);
  for (int k = 0; k < 14; ++k) run.show(walls(k));
  const Matrix<float, 6, 6> before = run.tracker->pose_covariance();
  ASSERT_GT(before(0, 0), 0.0F);
  constexpr int kDark = 10;
  for (int k = 0; k < kDark; ++k) run.show(Image(walls(0).size(), 0));
  ASSERT_EQ(run.tracker->window().keyframes(), 0);
  run.show(walls(14));
  ASSERT_EQ(run.tracker->window().keyframes(), 1);
  const Matrix<float, 6, 6>& after = run.tracker->pose_covariance();
  EXPECT_EQ((after.topLeftCorner<3, 3>().norm()), 0.0F);
  const float blind_s = 1e-6F * static_cast<float>(kDark * kStepUs);
  for (int axis = 3; axis < 6; ++axis) {
    EXPECT_GT(after(axis, axis), square(parameters.blind_rate_radps * blind_s));
  }
}

/// The picture with noise of a camera, another one each time.
Image noisy(const Image& image, std::uint32_t seed) {
  Image out = image;
  std::uint32_t state = seed;
  for (std::uint8_t& grey : out) {
    state = state * 1664525U + 1013904223U;
    const int value = grey + static_cast<int>(state >> 30U) - 2;
    grey = static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
  }
  return out;
}

TEST(WindowTracker, AStandingCameraSettlesNothing) {
  Walk run;
  for (std::uint32_t k = 0; k < 90; ++k) {
    run.show(noisy(walls(0), k));
    ASSERT_NE(run.report.state, TrackingState::kTracking) << k;
  }
  EXPECT_EQ(run.tracker->window().keyframes(), 1);
  EXPECT_FALSE(run.tracker->window().settled());
  for (int k = 0; k < 30; ++k) run.show(walls(k));
  EXPECT_EQ(run.report.state, TrackingState::kTracking);
  EXPECT_LT(attitude_error(run, 29), 0.02F);
  EXPECT_EQ(run.tracker->health().losses, 0U);
}

TEST(WindowTracker, NoFrameExceedsItsWorkWhateverHappens) {
  for (const int limit : {4000, 6000, 9000, 11600}) {
    Tracker::Parameters parameters;
    parameters.work_limit = limit;
    Walk run(parameters);
    for (int k = 0; k < 12; ++k) run.show(walls(k));
    for (int k = 12; k < 28; k += 3) run.show(walls(k));  // too fast for it
    for (std::uint32_t k = 0; k < 6; ++k) run.show(noisy(Image(walls(0).size(), 40), k));
    for (int k = 29; k > 12; --k) run.show(walls(k));
    EXPECT_GT(run.tracker->health().losses, 0U) << limit;
    EXPECT_LE(run.most_work, limit);
  }
}

TEST(WindowTrackerParameters, ScaleTheirPixelsToThePicture) {
  const Tracker::Parameters plain;
  const Tracker::Parameters same = plain.scaled_to(640, 408);
  EXPECT_EQ(same.keyframe_parallax_px, plain.keyframe_parallax_px);
  EXPECT_EQ(same.sigma_px, plain.sigma_px);
  const Tracker::Parameters upright = plain.scaled_to(240, 320);
  EXPECT_FLOAT_EQ(upright.keyframe_parallax_px, 0.5F * plain.keyframe_parallax_px);
  EXPECT_FLOAT_EQ(upright.standing_px, 0.5F * plain.standing_px);
  EXPECT_FLOAT_EQ(upright.sigma_px, 0.70710678F * plain.sigma_px);
}

TEST(WindowTracker, RepeatsItselfAndStaysWithinItsWork) {
  Walk a;
  Walk b;
  for (int k = 0; k < 24; ++k) {
    a.show(walls(k));
    b.show(walls(k));
    ASSERT_EQ(a.hash(), b.hash()) << k;
  }
  EXPECT_LE(a.most_work, 11600);
}

TEST(WindowTracker, LittleWorkLeavesThePoseFirst) {
  Tracker::Parameters parameters;
  parameters.work_limit = 3500;
  Walk run(parameters);
  for (int k = 0; k < 30; ++k) run.show(walls(k));
  EXPECT_NE(run.report.state, TrackingState::kLost);
  EXPECT_GT(run.tracker->health().budget_exceeded, 0U);
  EXPECT_LT(attitude_error(run, 29), 0.05F);
}

/// Sideways, while the camera turns towards where it came from and back.
const Image& turning(int k) {
  static std::vector<Image> images;
  while (static_cast<int>(images.size()) <= k) {
    const double t = 0.018 * static_cast<double>(images.size());
    double sine = 0.0;
    double cosine = 1.0;
    sin_cos(6.0 * t, sine, cosine);
    images.push_back(
        test::render_two_walls({rotation_exp(Vector3<double>(0.1 * sine, 0.3 * sine, 0.05 * sine)),
                                {-0.6 * t, 0.2 * t, 0.0}}));
  }
  return images[static_cast<std::size_t>(k)];
}

FocalScale focal_scale_after_turns(float told_error, float told_sigma) {
  Tracker::Parameters parameters;
  parameters.window.focal_sigma = told_sigma;
  Walk run(parameters, told_error);
  for (int k = 0; k < 50; ++k) run.show(turning(k));
  EXPECT_EQ(run.tracker->health().losses, 0U);
  const FocalScale scale = run.tracker->focal_scale();
  const float told = (1.0F + told_error) * test::to_float(test::small_camera()).fx;
  EXPECT_FLOAT_EQ(run.tracker->camera().fx, scale.value * told);
  return scale;
}

TEST(WindowTracker, FindsAFocalLengthThatWasAGuess) {
  for (const float error : {-0.15F, 0.15F}) {
    const FocalScale scale = focal_scale_after_turns(error, 0.15F);
    EXPECT_NEAR((1.0F + error) * scale.value, 1.0F, 0.06F) << error;
    EXPECT_LT(abs((1.0F + error) * scale.value - 1.0F), 3.0F * scale.sigma) << error;
    EXPECT_LT(scale.sigma, 0.08F) << error;
    EXPECT_EQ(scale.told_sigma, 0.15F);
  }
}

TEST(WindowTracker, BelievesAFocalLengthThatIsKnown) {
  const FocalScale scale = focal_scale_after_turns(0.05F, 0.0F);
  EXPECT_EQ(scale.value, 1.0F);
  EXPECT_EQ(scale.sigma, 0.0F);
}

/// An unknown focal length makes the attitude uncertain by its share of the turn; all else that
/// does is left out.
TEST(WindowTracker, CountsTheFocalLengthInTheAttitude) {
  constexpr float kTurn = 0.3F;  // about y, after a quarter of the period
  Tracker::Parameters parameters;
  parameters.lens_sigma = 0.0F;
  parameters.covariance_factor = 0.01F;
  for (const float told_sigma : {0.0F, 0.15F}) {
    parameters.window.focal_sigma = told_sigma;
    Walk run(parameters);
    for (int k = 0; k < 15; ++k) run.show(turning(k));
    const float expected = run.tracker->focal_scale().sigma * kTurn;
    const float sigma = sqrt(run.tracker->pose_covariance()(4, 4));
    EXPECT_GT(sigma, 0.5F * expected);
    EXPECT_LT(sigma, 1.5F * expected + 0.001F);
  }
}

TEST(WindowTracker, BelievesTheFocalLengthOfAFisheye) {
  PinholeCamera<float> camera = test::to_float(test::small_camera());
  camera.lens = Lens::kFisheye;
  const auto tracker = std::make_unique<Tracker>();
  ASSERT_TRUE(ok(tracker->initialise(camera, {})));
  EXPECT_EQ(tracker->focal_scale().told_sigma, 0.0F);
}

TEST(WindowTracker, RefusesWhatItCannotUse) {
  Walk run;
  run.show(walls(0));
  const std::uint64_t before = run.hash();
  FrameReport report;
  EXPECT_EQ(run.tracker->process_frame({}, kStepUs, TickSource{}, report),
            Status::kInvalidArgument);
  EXPECT_EQ(run.tracker->process_frame(test::view(walls(1), test::small_camera()), 0, TickSource{},
                                       report),
            Status::kDuplicate);
  EXPECT_EQ(run.hash(), before);
  Tracker::Parameters parameters;
  parameters.sigma_px = -1.0F;
  EXPECT_EQ(run.tracker->initialise(test::to_float(test::small_camera()), parameters),
            Status::kBadConfig);
  EXPECT_EQ(run.tracker->set_work_limit(-1), Status::kInvalidArgument);
}

}  // namespace
}  // namespace cairn
