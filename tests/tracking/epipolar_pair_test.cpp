#include "cairn/tracking/epipolar_pair.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "cairn/numeric/float_bits.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

constexpr int kParts = EpipolarPair::kParts;
constexpr int kMotions = EpipolarPair::kMotions;
constexpr int kAll = kParts + kMotions;

/// What a residual depends on: yaw, pitch, roll and focal length of the camera, then roll, pitch
/// and yaw of the motion.
using Change = Eigen::Matrix<double, kAll, 1>;

Matrix3<double> turn(double x, double y, double z) {
  const Vector3<double> v(x, y, z);
  const double angle = v.norm();
  if (angle == 0.0) return Matrix3<double>::Identity();
  return Eigen::AngleAxisd(angle, v / angle).toRotationMatrix();
}

/// GIVEN a camera on a vehicle that moved, and the residual in double precision, whose derivatives
/// are differences.
class APairOfFrames : public ::testing::Test {
 protected:
  double uniform(double most) { return most * (random_.below(20001) / 10000.0 - 1.0); }
  float single(double most) { return static_cast<float>(uniform(most)); }

  void draw() {
    Matrix3<float> forward;
    forward << 0.0F, 0.0F, 1.0F, -1.0F, 0.0F, 0.0F, 0.0F, -1.0F, 0.0F;
    camera_.rotation_vehicle_camera =
        rotation_exp(Vector3<float>{single(0.5), single(0.5), single(0.5)}).toRotationMatrix() *
        forward;
    camera_.origin_m = {single(1.0), single(1.0), single(1.0)};
    camera_.focal_px = 300.0F;
    camera_.view_scale = 1.0F + single(0.2);
    camera_.sigma_px = 0.4F;
    motion_.rotation = rotation_exp(Vector3<float>{single(0.02), single(0.02), single(0.2)});
    motion_.translation = {-0.5F + single(0.3), single(0.2), single(0.05)};
    const Geometry now = geometry(Change::Zero());
    Vector3<double> first{0.0, 0.0, 1.0};
    for (int i = 0; i < 2; ++i) {
      views_.first[i] = FixedTangent::nearest(uniform(0.7));
      first[i] = now.scale * views_.first[i].to_double();
    }
    const Vector3<double> second = now.R * (4.0 + uniform(3.0)) * first + now.t;
    for (int i = 0; i < 2; ++i) {
      const double noise = uniform(1.2e-3);
      views_.second[i] = FixedTangent::nearest(second[i] / second.z() / now.scale + noise);
    }
  }

  /// First camera to second, and the scale of views.
  struct Geometry {
    Matrix3<double> R;
    Vector3<double> t;
    double scale;
  };
  Geometry geometry(const Change& change) const {
    const Matrix3<double> mount =
        turn(change[MountOffset::kRoll], change[MountOffset::kPitch], change[MountOffset::kYaw]) *
        camera_.rotation_vehicle_camera.cast<double>();
    const Matrix3<double> told = motion_.rotation.cast<double>().toRotationMatrix();
    const Matrix3<double> moved = turn(change[4], change[5], change[6]) * told;
    const Vector3<double> origin = camera_.origin_m.cast<double>();
    return {mount.transpose() * moved * mount,
            mount.transpose() * (told * origin + motion_.translation.cast<double>() - origin),
            camera_.view_scale * std::exp(-change[MountOffset::kFocal])};
  }
  /// Divided by the standard deviation of a view.
  double residual(const Change& change) const {
    const Geometry now = geometry(change);
    const auto ray = [&](const FixedTangent(&view)[2]) {
      return Vector3<double>(now.scale * view[0].to_double(), now.scale * view[1].to_double(), 1.0);
    };
    const Vector3<double> second = ray(views_.second);
    const Vector3<double> line = now.t.cross(now.R * ray(views_.first));
    const Vector3<double> line_first = now.R.transpose() * second.cross(now.t);
    const double gradient =
        std::sqrt(line.head<2>().squaredNorm() + line_first.head<2>().squaredNorm());
    return camera_.focal_px / (now.scale * camera_.sigma_px) * second.dot(line) / gradient;
  }
  Change derivatives() const {
    constexpr double kStep = 1e-5;
    Change by;
    for (int i = 0; i < kAll; ++i) {
      const Change step = kStep * Change::Unit(i);
      by[i] = (residual(step) - residual(-step)) / (2.0 * kStep);
    }
    return by;
  }

  Random random_{3};
  EpipolarPair::Camera camera_;
  Rigid<float> motion_;
  TwoViews views_;
};

TEST_F(APairOfFrames, HasTheResidualsAndDerivativesOfDoublePrecision) {
  int compared = 0;
  for (int trial = 0; trial < 400; ++trial) {
    draw();
    const float sigma[kMotions] = {0.3F, 0.3F, 0.3F};
    EpipolarPair pair(camera_, motion_, sigma);
    // Without a point in it there is nothing to correct: the motion is taken for known.
    pair.refine_motion();
    pair.add(views_);
    const EpipolarPair::Equations found = pair.equations();
    const double expected = residual(Change::Zero());
    if (std::abs(expected) > 1.9) continue;
    const Change by = derivatives();
    ASSERT_EQ(found.rows, 1.0F) << trial;
    ++compared;
    const double size = by.norm();
    EXPECT_NEAR(found.squares, expected * expected, 2e-3) << trial;
    for (int i = 0; i < kParts; ++i) {
      EXPECT_NEAR(found.right[i], by[i] * expected, 2e-3 * size) << trial;
      for (int k = 0; k < kParts; ++k) {
        EXPECT_NEAR(found.information[i][k], by[i] * by[k], 2e-3 * size * size) << trial;
      }
      for (int k = 0; k < kMotions; ++k) {
        EXPECT_NEAR(found.mixed[i][k], by[i] * by[kParts + k], 2e-3 * size * size) << trial;
      }
    }
    for (int i = 0; i < kMotions; ++i) {
      EXPECT_NEAR(found.right_motion[i], by[kParts + i] * expected, 2e-3 * size) << trial;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST_F(APairOfFrames, CountsADistantViewAsAnOutlier) {
  draw();
  const float sigma[kMotions] = {1e-3F, 1e-3F, 1e-3F};
  EpipolarPair pair(camera_, motion_, sigma);
  views_.second[0] = FixedTangent::nearest(views_.first[0].to_double() + 0.3);
  views_.second[1] = FixedTangent::nearest(views_.first[1].to_double() - 0.3);
  pair.add(views_);
  EXPECT_EQ(pair.equations().rows, 0.0F);
  EXPECT_EQ(pair.equations().outliers, 1.0F);
}

TEST_F(APairOfFrames, SaysNothingWhereTheCameraStands) {
  draw();
  motion_ = Rigid<float>();
  const float sigma[kMotions] = {1e-3F, 1e-3F, 1e-3F};
  EpipolarPair pair(camera_, motion_, sigma);
  pair.add(views_);
  EXPECT_EQ(pair.equations().rows, 0.0F);
  EXPECT_EQ(pair.equations().outliers, 0.0F);
}

TEST_F(APairOfFrames, StaysFiniteForAnyView) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  for (int trial = 0; trial < 300; ++trial) {
    draw();
    if (trial % 3 == 0) camera_.sigma_px = 1e-6F;
    const float sigma[kMotions] = {1e-3F, 10.0F, 1e-3F};
    EpipolarPair pair(camera_, motion_, sigma);
    for (int pass = 0; pass < 2; ++pass) {
      for (int k = 0; k < 24; ++k) {
        for (int i = 0; i < 2; ++i) {
          const auto any = [&] {
            return static_cast<std::int32_t>(uniform(1.0) * kMost) >> random_.below(12);
          };
          views_.first[i] = FixedTangent::from_raw(any());
          views_.second[i] =
              random_.below(2) == 0 ? views_.first[i] : FixedTangent::from_raw(any());
        }
        pair.add(views_);
        EXPECT_TRUE(is_finite(pair.flow_px(views_)));
      }
      const EpipolarPair::Equations found = pair.equations();
      for (int i = 0; i < kParts; ++i) {
        EXPECT_TRUE(is_finite(found.right[i]));
        EXPECT_GE(found.information[i][i], 0.0F);
      }
      pair.refine_motion();
    }
  }
}

}  // namespace
}  // namespace cairn
