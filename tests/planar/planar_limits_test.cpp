#include <limits>
#include <memory>
#include <type_traits>

#include <gtest/gtest.h>

#include "cairn/numeric/positive_definite.hpp"
#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

namespace cairn {
namespace {

/// What is finite and yet beyond all sense: squares and products of it are not.
template <class Filter>
class PlanarLimits : public ::testing::Test {
 protected:
  using Scalar = typename Filter::Scalar;

  void SetUp() override {
    ASSERT_TRUE(ok(filter().initialise({}, Scalar(1e-6) * Matrix3<Scalar>::Identity())));
    for (LandmarkId id = 1; id <= 4; ++id) {
      ASSERT_TRUE(
          ok(filter().add_landmark(id, place(id), Scalar(0.3) * Matrix3<Scalar>::Identity())));
    }
  }

  static Vector3<Scalar> place(LandmarkId id) {
    return {Scalar(4), Scalar(-3) + static_cast<Scalar>(id), Scalar(1.3)};
  }
  Filter& filter() { return *filter_; }
  std::uint64_t hash() {
    Hash64 sum;
    filter().hash(sum);
    return sum.value();
  }
  void see(Scalar shift) {
    PointObservation<Scalar> seen[4];
    for (int i = 0; i < 4; ++i) {
      seen[i].id = static_cast<LandmarkId>(i + 1);
      seen[i].y = place(seen[i].id).template head<2>() + Vector2<Scalar>::Constant(shift);
      seen[i].R = Scalar(1e-4) * Matrix2<Scalar>::Identity();
    }
    UpdateReport report;
    EXPECT_TRUE(ok(filter().update_points({seen, 4}, report)));
  }
  void expect_sound() {
    const PlanarPose<Scalar> pose = filter().pose();
    EXPECT_TRUE(all_finite(pose.position) && is_finite(pose.heading));
    expect_sound(filter().pose_covariance());
    for (int slot = 0; slot < filter().landmark_count(); ++slot) {
      EXPECT_TRUE(all_finite(filter().landmark_position(slot)));
      expect_sound(filter().landmark_covariance(slot));
    }
  }
  void expect_sound(const Matrix3<Scalar>& covariance) {
    EXPECT_TRUE(all_finite(covariance));
    for (int i = 0; i < 3; ++i) EXPECT_GE(covariance(i, i), Scalar(0));
  }

 private:
  std::unique_ptr<Filter> filter_ = std::make_unique<Filter>();
};

using Filters = ::testing::Types<GroupIekfSlam<float, 6, 3>, EkfSlam<float, 6, 3>,
                                 LiftedIekfSlam<float, 6, 3>, GroupIekfSlam<double, 6, 3>,
                                 EkfSlam<double, 6, 3>, LiftedIekfSlam<double, 6, 3>>;
TYPED_TEST_SUITE(PlanarLimits, Filters, );

TYPED_TEST(PlanarLimits, APoseOfWhichNothingIsKnownStaysFinite) {
  using T = typename TypeParam::Scalar;
  for (const T variance : {T(1e12), T(1e20), T(3e38)}) {
    ASSERT_TRUE(ok(this->filter().widen_pose(T(0), variance)));
    this->expect_sound();
    ASSERT_TRUE(ok(this->filter().widen_pose(variance, variance)));
    this->expect_sound();
    ASSERT_TRUE(ok(this->filter().slip_laterally(variance)));
    this->expect_sound();
    this->see(T(0.1));
    this->expect_sound();
  }
}

TYPED_TEST(PlanarLimits, OdometryOfWhichNothingIsKnownStaysFinite) {
  using T = typename TypeParam::Scalar;
  for (const auto model : {IncrementModel::kEuler, IncrementModel::kExactArc}) {
    for (const T sigma : {T(1e6), T(1e12), T(1e18)}) {
      ASSERT_TRUE(ok(this->filter().predict(
          ackermann_increment(T(1), T(0.5), T(0.1), T(0.5), sigma, sigma, model))));
      this->expect_sound();
      ASSERT_TRUE(
          ok(this->filter().predict(twist_increment(T(1), T(0.5), T(0.1), sigma, sigma, model))));
      this->expect_sound();
      this->see(T(-0.1));
      this->expect_sound();
    }
  }
}

/// The path from where the vehicle stood is a difference of large variances.
TYPED_TEST(PlanarLimits, ALandmarkSeenOnAPathFromAPlaceOfWhichNothingIsKnownStaysSound) {
  using T = typename TypeParam::Scalar;
  constexpr LandmarkId kThen = 5;
  ASSERT_TRUE(ok(this->filter().widen_pose(T(1e10), T(1e4))));
  ASSERT_TRUE(ok(this->filter().add_position(kThen)));
  Matrix<T, 3, 2> by_path;
  by_path << T(1.3), T(-0.7), T(0.4), T(1.9), T(-1.6), T(1.1);
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(ok(this->filter().predict(
        twist_increment(T(1), T(0.5), T(0.1), T(0.1), T(0.1), IncrementModel::kExactArc))));
    ASSERT_TRUE(ok(this->filter().add_landmark_on_path(
        LandmarkId(6), this->place(2), T(1e-3) * Matrix3<T>::Identity(), kThen, by_path)));
    this->expect_sound();
    ASSERT_TRUE(ok(this->filter().remove_landmark(this->filter().find(LandmarkId(6)))));
  }
}

TYPED_TEST(PlanarLimits, VariancesThatNoFilterReckonsWithAreRefused) {
  using T = typename TypeParam::Scalar;
  const std::uint64_t before = this->hash();
  PlanarIncrement<T> increment;
  increment.covariance(0, 0) = T(1.1) * kMostPositionVariance<T>;
  EXPECT_EQ(this->filter().predict(increment), Status::kInvalidArgument);
  increment.covariance = Matrix2<T>::Zero();
  increment.covariance(1, 1) = T(1.1) * kMostHeadingVariance<T>;
  EXPECT_EQ(this->filter().predict(increment), Status::kInvalidArgument);
  const Matrix3<T> wide = T(1.1) * kMostPositionVariance<T> * Matrix3<T>::Identity();
  EXPECT_EQ(this->filter().add_landmark(9, this->place(1), wide), Status::kInvalidArgument);
  ASSERT_TRUE(ok(this->filter().add_position(8)));
  const std::uint64_t with_position = this->hash();
  Matrix<T, 3, 2> by_path = Matrix<T, 3, 2>::Zero();
  by_path(2, 1) = T(1e30);
  EXPECT_EQ(
      this->filter().add_landmark_on_path(9, this->place(1), Matrix3<T>::Identity(), 8, by_path),
      Status::kInvalidArgument);
  EXPECT_EQ(this->hash(), with_position);
  ASSERT_TRUE(ok(this->filter().remove_landmark(4)));
  EXPECT_EQ(this->hash(), before);
  EXPECT_EQ(this->filter().initialise({}, wide), Status::kInvalidArgument);
  PlanarPose<T> far;
  far.position.y() = T(2e36);
  EXPECT_EQ(this->filter().initialise(far, Matrix3<T>::Identity()), Status::kInvalidArgument);
  EXPECT_EQ(this->hash(), before);
}

/// In float a variance of 1e10 m^2 leaves the 1e-7 of it that rounding takes, and more.
TYPED_TEST(PlanarLimits, RecoversFromAPoseOfWhichNothingIsKnown) {
  using T = typename TypeParam::Scalar;
  ASSERT_TRUE(ok(this->filter().widen_pose(T(3e38), T(3e38))));
  for (int k = 0; k < 20; ++k) this->see(T(0));
  this->expect_sound();
  ASSERT_TRUE(ok(this->filter().predict(
      twist_increment(T(0.1), T(0), T(0.1), T(0.1), T(0.1), IncrementModel::kEuler))));
  for (int k = 0; k < 20; ++k) this->see(T(-0.01));
  this->expect_sound();
  const T left = std::is_same<T, float>::value ? T(1e-5) * kMostPositionVariance<T> : T(2);
  EXPECT_LT(this->filter().pose_covariance().diagonal().maxCoeff(), left);
}

TEST(Variances, BeyondTheMostAreUnsoundAndBecomeTheMost) {
  for (const float broken : {-1.0F, 1e30F, std::numeric_limits<float>::infinity(),
                             std::numeric_limits<float>::quiet_NaN()}) {
    PackedSymmetric<float, 2> p;
    p.resize(2);
    p(0, 0) = 4.0F;
    p(1, 0) = 1.0F;
    p(1, 1) = 2.0F;
    EXPECT_TRUE(variances_sound(p));
    p(1, 1) = broken;
    EXPECT_FALSE(variances_sound(p)) << broken;
    forget_correlations(p);
    EXPECT_TRUE(variances_sound(p)) << broken;
    EXPECT_EQ(p(0, 0), 4.0F);
    EXPECT_EQ(p(1, 0), 0.0F);
    EXPECT_GE(p(1, 1), 1.0F);
    EXPECT_LE(p(1, 1), kMostVariance<float>);
  }
}

}  // namespace
}  // namespace cairn
