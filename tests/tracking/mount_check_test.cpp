#include "cairn/tracking/mount_check.hpp"

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

constexpr float kStep_s = 1.0F / 30.0F;
constexpr int kPoints = 1500;
constexpr int kLandmarks = 40;

float normal(Random& random) {
  float sum = 0.0F;
  for (int i = 0; i < 12; ++i) sum += static_cast<float>(random.below(1 << 20)) / 1048576.0F;
  return sum - 6.0F;
}

/// What differs from what the check is told.
struct Truth {
  float yaw = 0.0F;
  float pitch = 0.0F;
  float roll = 0.0F;
  float focal = 1.0F;
  float column_px = 0.0F;
  float sigma_tilt = 0.0F;  ///< of the body, each frame anew, rad
};

/// GIVEN a vehicle that weaves through a cloud of points at 0.6 m/s, tracks 40 of them with noise
/// of 0.5 px, and has odometry with noise of 0.1 m/s and 0.05 rad/s a tenth of a second.
class Drive {
 public:
  Drive(const Truth& truth, std::uint64_t seed) : truth_(truth), random_(seed) {
    camera_.fx = camera_.fy = 280.0F;
    camera_.cx = 159.5F;
    camera_.cy = 119.5F;
    camera_.width = 320;
    camera_.height = 240;
    Matrix3<float> forward;
    forward << 0.0F, 0.0F, 1.0F, -1.0F, 0.0F, 0.0F, 0.0F, -1.0F, 0.0F;
    mount_.rotation = Quaternion<float>(forward);
    mount_.translation = Vector3<float>(0.2F, 0.0F, 0.6F);
    for (Vector3<float>& point : points_) {
      point = {uniform(-10.0F, 10.0F), uniform(-10.0F, 10.0F), uniform(0.0F, 3.0F)};
    }
    check_.reset(camera_, mount_, 0.5F);
  }

  void run(float seconds) {
    for (const float end = t_s_ + seconds; t_s_ < end; t_s_ += kStep_s) frame(t_s_);
  }
  const MountOffset& offset() const { return check_.offset(); }
  /// From now on the mount is as the check was told.
  void mend() { truth_ = Truth(); }

 private:
  float uniform(float low, float high) {
    return low + (high - low) * static_cast<float>(random_.below(1 << 20)) / 1048576.0F;
  }
  static void move(PlanarPose<float>& pose, float speed_mps, float yaw_rate) {
    float sine = 0.0F;
    float cosine = 0.0F;
    sin_cos(pose.heading + 0.5F * kStep_s * yaw_rate, sine, cosine);
    pose.position += kStep_s * speed_mps * Vector2<float>(cosine, sine);
    pose.heading += kStep_s * yaw_rate;
  }

  void frame(float t) {
    const float noise = sqrt(0.1F / kStep_s);
    float sine = 0.0F;
    float cosine = 0.0F;
    sin_cos(0.7F * t, sine, cosine);
    const float yaw_rate = 0.15F + 0.25F * sine;
    move(pose_, 0.6F, yaw_rate);
    OdometryStep step;
    const float speed_read = 0.6F + noise * 0.1F * normal(random_);
    const float yaw_rate_read = yaw_rate + noise * 0.05F * normal(random_);
    move(path_, speed_read, yaw_rate_read);
    step.path = path_;
    step.yaw_variance = square(noise * 0.05F * kStep_s);
    step.tilt_variance = 2.0F * square(truth_.sigma_tilt);
    step.step_s = kStep_s;
    PixelMatch<float> matches[kLandmarks];
    check_.add(camera_, step, matches, see(matches));
  }

  int see(PixelMatch<float>* matches) {
    const Vector3<float> tilt{truth_.sigma_tilt * normal(random_),
                              truth_.sigma_tilt * normal(random_), 0.0F};
    Rigid<float> T_world_vehicle;
    T_world_vehicle.rotation =
        rotation_exp(Vector3<float>(0.0F, 0.0F, pose_.heading)) * rotation_exp(tilt);
    T_world_vehicle.translation = {pose_.position.x(), pose_.position.y(), 0.0F};
    Rigid<float> mount = mount_;
    mount.rotation =
        rotation_exp(Vector3<float>(truth_.roll, truth_.pitch, truth_.yaw)) * mount.rotation;
    const Rigid<float> T_camera_world = (T_world_vehicle * mount).inverse();
    PinholeCamera<float> camera = camera_;
    camera.fx *= truth_.focal;
    camera.fy *= truth_.focal;
    camera.cx += truth_.column_px;
    int seen = 0;
    for (int i = 0; i < kPoints && seen < kLandmarks; ++i) {
      const Vector3<float> p_camera = T_camera_world * points_[i];
      Vector2<float> pixel;
      if (p_camera.z() > 7.0F || !ok(camera.project(p_camera, pixel))) continue;
      if (!camera.contains(pixel)) continue;
      matches[seen].id = static_cast<LandmarkId>(i + 1);
      matches[seen].pixel = pixel + 0.5F * Vector2<float>{normal(random_), normal(random_)};
      ++seen;
    }
    return seen;
  }

  Truth truth_;
  Random random_;
  float t_s_ = 0.0F;
  PinholeCamera<float> camera_;
  Rigid<float> mount_;
  Vector3<float> points_[kPoints];
  PlanarPose<float> pose_;
  PlanarPose<float> path_;
  MountCheck check_;
};

class MountOf : public ::testing::TestWithParam<int> {
 protected:
  MountOffset after(const Truth& truth, float seconds) const {
    Drive drive(truth, static_cast<std::uint64_t>(GetParam()));
    drive.run(seconds);
    return drive.offset();
  }
  static void expect(const MountOffset& offset, MountOffset::Part part, float truth) {
    EXPECT_TRUE(offset.suspect[part]);
    EXPECT_NEAR(offset.value[part], truth, 4.0F * offset.sigma[part]);
    EXPECT_NEAR(offset.value[part], truth, 0.4F * abs(truth));
  }
};

TEST_P(MountOf, ARightCalibrationIsNeverSuspect) {
  Drive level({}, static_cast<std::uint64_t>(GetParam()));
  Truth tilting;
  tilting.sigma_tilt = 3e-3F;
  Drive rough(tilting, static_cast<std::uint64_t>(GetParam()));
  for (int second = 0; second < 60; ++second) {
    level.run(1.0F);
    rough.run(1.0F);
    ASSERT_FALSE(level.offset().any_suspect()) << second;
    ASSERT_FALSE(rough.offset().any_suspect()) << second;
  }
}

TEST_P(MountOf, AYawOffByFiveDegreesIsSuspect) {
  Truth truth;
  truth.yaw = 0.0873F;
  expect(after(truth, 20.0F), MountOffset::kYaw, truth.yaw);
}

TEST_P(MountOf, APitchOffByTwoDegreesIsSuspect) {
  Truth truth;
  truth.pitch = -0.0349F;
  expect(after(truth, 20.0F), MountOffset::kPitch, truth.pitch);
}

TEST_P(MountOf, ARollOffByThreeDegreesIsSuspect) {
  Truth truth;
  truth.roll = 0.0524F;
  expect(after(truth, 10.0F), MountOffset::kRoll, truth.roll);
}

TEST_P(MountOf, APrincipalPointOffByTwentyPixelsLooksLikeYaw) {
  Truth truth;
  truth.column_px = 20.0F;
  expect(after(truth, 20.0F), MountOffset::kYaw, truth.column_px / 280.0F);
}

/// An estimate within what is tolerated, but not surely, takes nothing back.
TEST_P(MountOf, ASuspicionEndsOnlyOnceTheMountIsKnownToBeRight) {
  Truth truth;
  truth.yaw = 0.0873F;
  Drive drive(truth, static_cast<std::uint64_t>(GetParam()));
  drive.run(20.0F);
  ASSERT_TRUE(drive.offset().suspect[MountOffset::kYaw]);
  drive.mend();
  const auto& offset = drive.offset();
  constexpr int kMostFrames = 9000;
  int frames = 0;
  for (; frames < kMostFrames && offset.suspect[MountOffset::kYaw]; ++frames) drive.run(kStep_s);
  EXPECT_LT(frames, kMostFrames);
  constexpr float kTolerance = 0.0175F;
  EXPECT_LT(abs(offset.value[MountOffset::kYaw]) + 2.0F * offset.sigma[MountOffset::kYaw],
            kTolerance);
}

/// Pictures tell the focal length by the yaw of odometry alone.
TEST_P(MountOf, AFocalLengthOffByATwelfthIsSuspectAfterAMinute) {
  Truth truth;
  truth.focal = 1.0F / 1.12F;
  expect(after(truth, 60.0F), MountOffset::kFocal, -0.113F);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MountOf, ::testing::Range(1, 6));

}  // namespace
}  // namespace cairn
