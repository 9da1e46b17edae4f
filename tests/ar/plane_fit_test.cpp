#include "cairn/ar/plane_fit.hpp"

#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

class Cloud {
 public:
  explicit Cloud(unsigned seed) : engine_(seed) {
    const Vector3<float> axis = vector(1);
    rotation_ = rotation_exp(Vector3<float>(1.5F * axis));
    origin_ = vector(4);
  }
  float uniform(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine_);
  }
  Vector3<float> vector(float reach) {
    const float x = uniform(-reach, reach);
    const float y = uniform(-reach, reach);
    const float z = uniform(-reach, reach);
    return {x, y, z};
  }
  Vector3<float> normal() const { return rotation_ * Vector3<float>(0, 0, 1); }
  const Vector3<float>& origin() const { return origin_; }

  /// Points on the plane with noise, then points anywhere around it.
  std::vector<Vector3<float>> points(int on_plane, int elsewhere, float noise_m) {
    std::normal_distribution<float> gauss(0, noise_m);
    std::vector<Vector3<float>> result;
    for (int i = 0; i < on_plane; ++i) {
      const float x = uniform(-1, 1);
      const float y = uniform(-1, 1);
      result.push_back(origin_ + rotation_ * Vector3<float>(x, y, gauss(engine_)));
    }
    for (int i = 0; i < elsewhere; ++i) result.push_back(origin_ + vector(1.5F));
    return result;
  }

 private:
  std::mt19937 engine_;
  Quaternion<float> rotation_;
  Vector3<float> origin_;
};

Status fit(const std::vector<Vector3<float>>& points, const Vector3<float>& toward, PlaneFit& plane,
           const PlaneFitOptions& options = {}) {
  Random random(1);
  return fit_plane(points.data(), static_cast<int>(points.size()), toward, options, random, plane);
}

TEST(FitPlane, FindsThePlaneAmongStrangers) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    Cloud cloud(seed);
    const auto points = cloud.points(24, 12, 0.01F);
    PlaneFit plane;
    const Vector3<float> above = cloud.origin() + 3 * cloud.normal();
    ASSERT_EQ(fit(points, above, plane), Status::kOk) << seed;
    EXPECT_GT(plane.normal.dot(cloud.normal()), 0.9995F) << seed;
    EXPECT_NEAR(plane.normal.dot(cloud.origin()), plane.offset, 0.02) << seed;
    EXPECT_GE(plane.inliers, 23) << seed;
    EXPECT_LT(plane.rms_m, 0.02F) << seed;
    PlaneFit below;
    ASSERT_EQ(fit(points, cloud.origin() - 3 * cloud.normal(), below), Status::kOk);
    EXPECT_LT(below.normal.dot(cloud.normal()), -0.9995F) << seed;
  }
}

TEST(FitPlane, RefusesLinesAndScatter) {
  Cloud cloud(3);
  PlaneFit plane;
  plane.inliers = -3;
  std::vector<Vector3<float>> line(10);
  for (std::size_t i = 0; i < line.size(); ++i) {
    line[i] = cloud.origin() + static_cast<float>(i) * cloud.normal();
  }
  EXPECT_EQ(fit(line, {0, 0, 0}, plane), Status::kDegenerate);
  PlaneFitOptions strict;
  strict.min_inliers = 20;
  strict.inlier_m = 0.01F;
  EXPECT_EQ(fit(cloud.points(0, 30, 0), {0, 0, 0}, plane, strict), Status::kNoConsensus);
  auto bad = cloud.points(10, 0, 0);
  bad[4].z() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(fit(bad, {0, 0, 0}, plane), Status::kNonFiniteInput);
  bad.resize(2);
  EXPECT_EQ(fit(bad, {0, 0, 0}, plane), Status::kInvalidArgument);
  EXPECT_EQ(plane.inliers, -3);
}

TEST(PoseOnPlane, StandsOnThePlaneAndFacesWhereAsked) {
  Cloud cloud(4);
  PlaneFit plane;
  ASSERT_TRUE(ok(fit(cloud.points(30, 0, 0), cloud.origin() + cloud.normal(), plane)));
  Rigid<float> pose;
  const Vector3<float> above = cloud.origin() + 0.7F * cloud.normal();
  const Vector3<float> facing = cloud.vector(1);
  ASSERT_TRUE(ok(pose_on_plane(plane, above, facing, pose)));
  EXPECT_NEAR((pose.translation - cloud.origin()).norm(), 0, 1e-3);
  EXPECT_NEAR((pose.rotation * Vector3<float>(0, 0, 1) - plane.normal).norm(), 0, 1e-5);
  const Vector3<float> x = pose.rotation * Vector3<float>(1, 0, 0);
  EXPECT_NEAR(x.dot(facing.cross(plane.normal).normalized()), 0, 1e-4);
  EXPECT_GT(x.dot(facing), 0.0F);
  EXPECT_EQ(pose_on_plane(plane, above, plane.normal, pose), Status::kDegenerate);
  EXPECT_EQ(pose_on_plane(plane, above, Vector3<float>::Zero(), pose), Status::kDegenerate);

  // A direction of any length, and places that are no numbers.
  const Rigid<float> usual = pose;
  for (const float length : {1e-25F, 1e25F}) {
    ASSERT_TRUE(ok(pose_on_plane(plane, above, length * facing, pose)));
    EXPECT_NEAR(pose.rotation.norm(), 1.0F, 1e-5F);
    EXPECT_NEAR(pose.rotation.dot(usual.rotation), 1.0F, 1e-5F);
  }
  pose = usual;
  const Vector3<float> far_away = Vector3<float>::Constant(std::numeric_limits<float>::infinity());
  EXPECT_EQ(pose_on_plane(plane, far_away, facing, pose), Status::kNonFiniteInput);
  const Vector3<float> none = std::numeric_limits<float>::quiet_NaN() * facing;
  EXPECT_EQ(pose_on_plane(plane, above, none, pose), Status::kNonFiniteInput);
  EXPECT_EQ(pose.rotation.coeffs(), usual.rotation.coeffs());
  EXPECT_EQ(pose.translation, usual.translation);
}

}  // namespace
}  // namespace cairn
