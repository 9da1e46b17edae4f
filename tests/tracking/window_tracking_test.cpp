// Parts of a WindowTracker, each alone.
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/tracking/camera_track.hpp"
#include "cairn/tracking/keyframe_choice.hpp"
#include "cairn/tracking/window_covariance.hpp"
#include "cairn/tracking/window_exposures.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using Window = KeyframeWindow<float, WindowBounds>;

constexpr std::int64_t kPeriodUs = 40000;
constexpr float kPeriod_s = 0.04F;

class CameraTracks : public ::testing::Test {
 protected:
  void SetUp() override {
    parameters_.rotation.used = false;  // pictures have tests of their own
    track_.reset(parameters_, 1.0F, 8.0F);
  }
  Rigid<float> predict(bool gap = false) {
    FrameStep step;
    step.us = kPeriodUs;
    step.gap = gap;
    track_.advance(step);
    return track_.predict(frame_, step);
  }
  static Rigid<float> at(float x) {
    Rigid<float> pose;
    pose.translation.x() = x;
    return pose;
  }

  CameraTrack::Parameters parameters_;
  CameraTrack track_;
  ImageView image_;
  const PinholeCamera<float> camera_ = test::to_float(test::small_camera());
  FrameWork work_;
  Random random_;
  FrameReport report_;
  Health health_;
  FrameContext frame_{image_, camera_, work_, random_, report_, health_};
};

TEST_F(CameraTracks, GoOnWithTheirVelocity) {
  EXPECT_FLOAT_EQ(predict().translation.x(), 0.0F) << "nothing is known yet";
  track_.move_to(at(0.1F));
  EXPECT_NEAR(predict().translation.x(), 0.2F, 1e-6F);
  const CameraMovement movement = track_.movement_to(at(0.3F));
  EXPECT_TRUE(movement.known);
  EXPECT_NEAR(movement.velocity.x(), 0.2F / kPeriod_s, 1e-4F);
}

TEST_F(CameraTracks, ExpectToStandAfterAGap) {
  predict();
  track_.move_to(at(0.1F));
  EXPECT_FLOAT_EQ(predict(true).translation.x(), 0.1F);
  EXPECT_FALSE(track_.movement_to(at(0.3F)).known);
  track_.move_to(at(0.3F));
  EXPECT_NEAR(predict().translation.x(), 0.3F, 1e-6F) << "the time of the movement is not known";
}

TEST_F(CameraTracks, KnowThePoseTheLessTheLongerNothingWasSeen) {
  const auto information = [&] {
    WindowPoseOptions<float> options;
    track_.observe(predict(), 0.0F, options);
    EXPECT_EQ(options.attitude_information, 0.0F) << "no gyroscope";
    return options.centre_information;
  };
  const float once = information();
  EXPECT_NEAR(once, square(8.0F / kPeriod_s), 1e-3F * once);
  EXPECT_NEAR(information(), 0.25F * once, 1e-3F * once);
  track_.move_to(at(0.0F));
  EXPECT_NEAR(information(), once, 1e-3F * once);
}

TEST_F(CameraTracks, StayWhereTheyWereWithoutAGyroscope) {
  predict();
  track_.drift_to(at(0.5F));
  EXPECT_EQ(track_.pose().translation.x(), 0.0F);
  EXPECT_EQ(track_.standing().translation.x(), 0.0F);
  EXPECT_LT(track_.direction_sigma(FrameStep{}), 0.0F);
  Quaternion<float> turned;
  float variance = 0.0F;
  EXPECT_FALSE(track_.note_keyframe(turned, variance));
}

/// Grey values of the direction of each pixel, seen by a camera that is turned about y.
void paint_turned(const PinholeCamera<float>& camera, float turn_rad,
                  std::vector<std::uint8_t>& pixels) {
  const Matrix3<float> R = rotation_exp(Vector3<float>(0.0F, turn_rad, 0.0F)).toRotationMatrix();
  pixels.clear();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vector2<float> pixel(static_cast<float>(u), static_cast<float>(v));
      const Vector3<float> ray = (R * camera.unproject(pixel)).normalized();
      const double x = ray.x(), y = ray.y();
      const double grey = 120.0 + 40.0 * std::sin(9.0 * x + 2.0 * std::sin(7.0 * y)) +
                          40.0 * std::sin(13.0 * y + 3.0 * std::sin(5.0 * x));
      pixels.push_back(static_cast<std::uint8_t>(grey));
    }
  }
}

TEST(CameraTrack, TurnsWithTheWholePictureWhereNoLandmarkShowsThePose) {
  constexpr float kTurn_rad = 0.1F;
  constexpr int kFrames = 3;
  const PinholeCamera<float> camera = test::to_float(test::small_camera());
  CameraTrack track;
  track.reset(CameraTrack::Parameters(), 1.0F, 8.0F);
  FrameWork work;
  work.reset(11600, 0);
  Random random;
  FrameReport report;
  Health health;
  FrameStep step;
  step.us = kPeriodUs;
  std::vector<std::uint8_t> pixels;
  for (int k = 0; k <= kFrames; ++k) {
    paint_turned(camera, static_cast<float>(k) * kTurn_rad, pixels);
    const ImageView image{pixels.data(), camera.width, camera.height, camera.width};
    work.begin(0);
    FrameContext frame{image, camera, work, random, report, health};
    track.take_frame(frame, k * kPeriodUs);
    track.advance(step);
    const Rigid<float> predicted = track.predict(frame, step);
    track.note_weak();
    track.drift_to(predicted);
    track.forget_motion();
  }
  const Vector3<float> turned = rotation_log(track.pose().inverse().rotation);
  EXPECT_NEAR(turned.y(), kFrames * kTurn_rad, 0.1F * kFrames * kTurn_rad);
  EXPECT_NEAR(turned.x(), 0.0F, 0.02F);
}

ViewChange change(int found, int common, float flow, float parallax) {
  return {found, common, flow, parallax};
}

TEST(KeyframeChoice, WantsOneWhereTheViewHasChanged) {
  const KeyframeChoice::Parameters p;
  KeyframeChoice choice;
  choice.reset(p);
  choice.note_keyframe(40);
  const ViewChange moved = change(40, 40, 20.0F, p.keyframe_parallax_px + 1.0F);
  choice.note_frame();
  EXPECT_TRUE(choice.follows_keyframe());
  EXPECT_FALSE(choice.wants_keyframe(moved)) << "the frame before is one";
  choice.note_frame();
  EXPECT_FALSE(choice.follows_keyframe());
  EXPECT_TRUE(choice.wants_keyframe(moved));
  EXPECT_FALSE(choice.wants_keyframe(change(40, 40, 2.0F, 1.0F)));
  EXPECT_TRUE(choice.wants_keyframe(change(40, 19, 2.0F, 1.0F))) << "it sees other landmarks";
  EXPECT_TRUE(choice.wants_keyframe(change(29, 29, 2.0F, 1.0F))) << "it sees few";
}

TEST(KeyframeChoice, WantsOneInTimeOfACameraThatDoesNotStand) {
  const KeyframeChoice::Parameters p;
  KeyframeChoice choice;
  choice.reset(p);
  choice.note_keyframe(40);
  const ViewChange turning = change(40, 40, p.standing_px + 1.0F, 0.0F);
  for (int i = 1; i < p.keyframe_frames; ++i) {
    choice.note_frame();
    EXPECT_FALSE(choice.wants_keyframe(turning)) << i;
  }
  choice.note_frame();
  EXPECT_TRUE(choice.wants_keyframe(turning));
  EXPECT_FALSE(choice.moved(turning)) << "it turns on the spot";
  EXPECT_FALSE(choice.wants_keyframe(change(40, 40, p.standing_px - 1.0F, 0.0F)));
}

TEST(KeyframeChoice, RemembersTheWorkOfOneThatWasPutOff) {
  KeyframeChoice choice;
  choice.reset({});
  choice.postpone(700);
  EXPECT_EQ(choice.postponed_work(), 700);
  choice.postpone(0);
  EXPECT_EQ(choice.postponed_work(), 0);
}

class CovarianceOfTheWindow : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(window_.initialise({}), Status::kOk);
    window_.begin_keyframe({});
    covariance_.reset({});
  }
  float attitude_variance() {
    covariance_.update(window_, {}, Matrix<float, 6, 6>::Zero());
    return covariance_.value()(3, 3);
  }

  Window window_;
  HandheldGyro gyro_;
  WindowCovariance covariance_;
};

TEST_F(CovarianceOfTheWindow, GrowsWhileNothingIsSeen) {
  EXPECT_EQ(attitude_variance(), 0.0F);
  covariance_.note_frame(0.5F, gyro_);
  EXPECT_FLOAT_EQ(attitude_variance(), 0.25F);
  covariance_.note_frame(0.5F, gyro_);
  EXPECT_FLOAT_EQ(attitude_variance(), 1.0F);
  covariance_.note_seen();
  EXPECT_EQ(attitude_variance(), 0.0F);
}

TEST_F(CovarianceOfTheWindow, ANewMapKeepsWhatTheLossCost) {
  covariance_.note_frame(0.5F, gyro_);
  covariance_.begin(window_.newest());
  EXPECT_FLOAT_EQ(attitude_variance(), 0.25F);
  covariance_.note_loss(window_, {});
  covariance_.note_frame(0.5F, gyro_);
  covariance_.begin(window_.newest());
  EXPECT_FLOAT_EQ(attitude_variance(), 0.5F);
}

TEST_F(CovarianceOfTheWindow, AReturnToTheMapForgetsTheTimeSinceTheLoss) {
  covariance_.note_frame(0.5F, gyro_);
  covariance_.begin(window_.newest());
  covariance_.note_loss(window_, {});
  covariance_.note_frame(3.0F, gyro_);
  covariance_.resume(window_.newest());
  EXPECT_FLOAT_EQ(attitude_variance(), 0.25F);
}

class ExposuresOfAWindow : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(window_.initialise({}), Status::kOk);
    window_.begin_keyframe({});
    feature_.pixel = feature_.keyframe_pixel = Vector2<float>(200.0F, 200.0F);
    const Vector3<float> ray = camera_.unproject(feature_.pixel);
    direction_ = Vector2<float>(ray.x(), ray.y());
    feature_.slot = window_.add_landmark(1, direction_);
    feature_.found = true;
    ASSERT_GE(feature_.slot, 0);
  }

  const PinholeCamera<float> camera_ = test::to_float(test::small_camera());
  Window window_;
  WindowFeature feature_;
  Vector2<float> direction_ = Vector2<float>::Zero();
  WindowExposures exposures_;
};

TEST_F(ExposuresOfAWindow, AGlobalShutterSeesAlongTheRay) {
  exposures_.reset({}, camera_.width, camera_.height);
  exposures_.expose({true, Vector3<float>(1.0F, 1.0F, 1.0F), Vector3<float>::Zero()});
  EXPECT_FALSE(exposures_.used());
  EXPECT_EQ(exposures_.seen_direction(camera_, window_, feature_, {}), direction_);
}

TEST_F(ExposuresOfAWindow, ARollingOneSeesAlongItWhileNothingIsKnownOfTheMovement) {
  const Vector3<float> rate(0.0F, 1.0F, 0.0F);
  exposures_.reset({50e-6F, 0.0F}, camera_.width, camera_.height);
  exposures_.expose({true, rate, Vector3<float>::Zero()});
  EXPECT_GT((exposures_.seen_direction(camera_, window_, feature_, {}) - direction_).norm(), 1e-3F);
  exposures_.expose({false, rate, Vector3<float>::Zero()});
  EXPECT_LT((exposures_.seen_direction(camera_, window_, feature_, {}) - direction_).norm(), 1e-6F);
}

TEST_F(ExposuresOfAWindow, APixelIsExpectedWhereTheMovementTakesIt) {
  exposures_.reset({}, camera_.width, camera_.height);
  feature_.pixel += Vector2<float>(3.0F, -2.0F);  // what the depth gets wrong stays
  EXPECT_EQ(exposures_.expected_pixel(camera_, window_, feature_, {}, {}), feature_.pixel);
  Rigid<float> moved;
  moved.translation.x() = 0.1F;  // of a depth of one
  const Vector2<float> expected =
      exposures_.expected_pixel(camera_, window_, feature_, {}, moved) - feature_.pixel;
  EXPECT_NEAR(expected.x(), 0.1F * camera_.fx, 1e-2F);
  EXPECT_NEAR(expected.y(), 0.0F, 1e-2F);
}

TEST_F(ExposuresOfAWindow, AKeyframeDoubtsWhatDisagreesWhileTheStartIsOpen) {
  struct Features {
    WindowFeature feature;
    static int size() { return 1; }
    const WindowFeature& operator[](int) const { return feature; }
  } features{feature_};
  exposures_.reset({}, camera_.width, camera_.height);
  Vector2<float> seen;
  features.feature.outliers = 1;
  window_.begin_keyframe({});
  exposures_.observe_keyframe(camera_, features, {}, window_);
  EXPECT_FALSE(window_.newest_sees(feature_.slot, seen));
  features.feature.outliers = 0;
  exposures_.observe_keyframe(camera_, features, {}, window_);
  EXPECT_TRUE(window_.newest_sees(feature_.slot, seen));
  EXPECT_LT((seen - direction_).norm(), 1e-6F);
}

}  // namespace
}  // namespace cairn
