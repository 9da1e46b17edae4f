// update_pixels() linearises again at the best hypothesis: landmarks that have no pixel there.
#include <array>

#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "vga_camera.hpp"

namespace cairn {
namespace {

/// A vehicle that is 3 cm ahead of where its filter has it (10 cm standard deviation). The first
/// landmark is 31 cm away for the filter and 28 cm in truth, nearer than the 30 cm that a pixel row
/// is good for.
template <class Filter>
class Relinearisation : public ::testing::Test {
 protected:
  static constexpr double kAhead = 0.03;
  static constexpr double kVariance = 0.01;
  static constexpr int kNear = 0;

  void SetUp() override {
    PlanarParameters<double> parameters;
    parameters.ransac.min_inliers = 1;
    const Matrix3<double> known = 1e-10 * Matrix3<double>::Identity();
    ASSERT_TRUE(ok(filter_.initialise({}, known, parameters)));
    const Matrix3<double> noise = 1e-8 * Matrix3<double>::Identity();
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      ASSERT_TRUE(ok(filter_.add_landmark(static_cast<LandmarkId>(i + 1), landmarks_[i], noise)));
    }
    ASSERT_TRUE(ok(filter_.widen_pose(kVariance, 1e-6)));
  }

  PixelMatch<double> match(int landmark) const {
    const Vector3<double> from_truth =
        landmarks_[static_cast<std::size_t>(landmark)] - Vector3<double>(kAhead, 0.0, 0.0);
    PixelMatch<double> match;
    match.id = static_cast<LandmarkId>(landmark + 1);
    EXPECT_TRUE(ok(camera_.project(T_vehicle_camera_.inverse() * from_truth, match.pixel)));
    return match;
  }

  UpdateReport update(PixelMatch<double>* matches, int count) {
    UpdateReport report;
    Random random(1);
    EXPECT_EQ(
        filter_.update_pixels(camera_, T_vehicle_camera_, 1.0, matches, count, random, report),
        Status::kOk);
    return report;
  }

  const std::array<Vector3<double>, 4> landmarks_ = {
      {{0.31, 0.05, 0.02}, {2.0, 0.5, 0.9}, {2.0, -0.8, 0.7}, {2.5, 0.3, -1.1}}};
  PinholeCamera<double> camera_ = test::vga_camera(300.0);
  Rigid<double> T_vehicle_camera_{Quaternion<double>(test::looking_ahead<double>()),
                                  Vector3<double>::Zero()};
  Filter filter_;
};

using Filters = ::testing::Types<EkfSlam<double, 8, 3>, GroupIekfSlam<double, 8, 3>,
                                 LiftedIekfSlam<double, 8, 3>>;
TYPED_TEST_SUITE(Relinearisation, Filters, );

TYPED_TEST(Relinearisation, LeavesOutWhatHasNoPixelAndUsesTheOthersOnce) {
  std::array<PixelMatch<double>, 4> matches = {this->match(0), this->match(1), this->match(2),
                                               this->match(3)};
  const UpdateReport report = this->update(matches.data(), 4);
  EXPECT_EQ(report.low_innovation, 3);
  EXPECT_EQ(report.high_innovation, 0);
  EXPECT_EQ(report.gated, 1);
  EXPECT_EQ(report.nis_dof, 6);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(matches[static_cast<std::size_t>(i)].inlier, i != this->kNear);
    EXPECT_EQ(this->filter_.landmark_statistics(i).measured, i == this->kNear ? 1U : 2U);
  }
  EXPECT_NEAR(this->filter_.pose().position.x(), this->kAhead, 0.005);
}

/// The only inlier has no pixel at the hypothesis: the mean returns to the prediction, where the
/// landmark has a pixel and is used after all.
TYPED_TEST(Relinearisation, ReturnsToThePredictionWhenNoInlierIsLeft) {
  PixelMatch<double> match = this->match(this->kNear);
  const UpdateReport report = this->update(&match, 1);
  EXPECT_EQ(report.low_innovation, 0);
  EXPECT_EQ(report.high_innovation, 1);
  EXPECT_TRUE(match.inlier);
  EXPECT_NEAR(this->filter_.pose().position.x(), this->kAhead, 0.01);
  EXPECT_LT(this->filter_.pose_covariance()(0, 0), 0.1 * this->kVariance);
}

}  // namespace
}  // namespace cairn
