#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

#include "tilting_vehicle.hpp"
#include "vga_camera.hpp"

// A road that begins to climb by 6 degrees over 40 m, and goes on. The filter knows a plane alone.

namespace cairn {
namespace {

using planar_test::mounting;

constexpr double kPixel = 0.5;
constexpr double kStep_m = 0.7;
constexpr double kStep_s = 0.1;
constexpr double kNearest_m = 3.0;
constexpr double kFarthest_m = 25.0;

struct Road {
  static constexpr double kSlope = 0.1;
  static constexpr double kCurved_m = 40.0;

  static double slope(double s) { return kSlope * std::min(s / kCurved_m, 1.0); }
  static double height(double s) {
    const double curved = std::min(s, kCurved_m);
    return 0.5 * curved * slope(curved) + kSlope * (s - curved);
  }
  static Rigid<double> T_world_vehicle(double s) {
    return {Quaternion<double>(Eigen::AngleAxisd(-std::atan(slope(s)), Eigen::Vector3d::UnitY())),
            {s, 0.0, height(s)}};
  }
};

template <class Filter>
class ClimbingRoad : public ::testing::Test {
 protected:
  void SetUp() override {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (double s = 2.0; s < 330.0; s += 1.0) {
      const double up = 2.0 + 2.0 * uniform(generator_);
      points_.push_back({s, 8.0 * uniform(generator_), Road::height(s) + up});
    }
    PlanarParameters<double> parameters;
    parameters.tilt = TiltParameters<double>::car();
    parameters.reacquire_after = 0;
    ASSERT_TRUE(ok(filter_.initialise({}, Matrix3<double>::Identity() * 1e-6, parameters)));
  }

  void move() {
    s_ += kStep_m;
    PlanarIncrement<double> increment;
    increment.distance_m = kStep_m;
    increment.covariance << 1e-4, 0.0, 0.0, 2.5e-7;
    ASSERT_TRUE(ok(filter_.predict(increment)));
    ASSERT_TRUE(ok(filter_.predict_tilt(kStep_s)));
  }

  /// Landmarks that are seen correct the filter, those that are not leave it.
  void look() {
    for (int slot = filter_.landmark_count() - 1; slot >= 0; --slot) {
      Vector2<double> pixel;
      if (sees(point(slot), kNearest_m, pixel)) continue;
      ASSERT_TRUE(ok(filter_.remove_landmark(slot)));
    }
    std::vector<PixelMatch<double>> matches;
    for (int slot = 0; slot < filter_.landmark_count(); ++slot) {
      PixelMatch<double> match;
      match.id = filter_.landmark_id(slot);
      match.slot = slot;
      ASSERT_TRUE(sees(point(slot), kNearest_m, match.pixel));
      match.pixel += Vector2<double>(normal(kPixel), normal(kPixel));
      matches.push_back(match);
    }
    if (matches.size() < 3) return;
    UpdateReport report;
    ASSERT_TRUE(ok(filter_.update_pixels(camera_, mounting(), kPixel, matches.data(),
                                         static_cast<int>(matches.size()), random_, report)));
  }

  void add_landmarks() {
    constexpr double kFarEnough_m = 12.0;
    for (std::size_t i = 0; i < points_.size() && filter_.landmark_count() < 20; ++i) {
      const auto id = static_cast<LandmarkId>(i + 1);
      Vector2<double> pixel;
      if (filter_.find(id) >= 0 || !sees(points_[i], kFarEnough_m, pixel)) continue;
      const Vector3<double> seen = Road::T_world_vehicle(s_).inverse() * points_[i] +
                                   Vector3<double>(normal(0.3), normal(0.05), normal(0.05));
      const Matrix3<double> R = Vector3<double>(0.09, 0.0025, 0.0025).asDiagonal();
      ASSERT_TRUE(ok(filter_.add_landmark(id, seen, R)));
    }
  }

  /// Largest error of the height of a landmark at most 6 m ahead, above the road at the vehicle.
  double height_error() const {
    double largest = 0.0;
    for (int slot = 0; slot < filter_.landmark_count(); ++slot) {
      const Vector3<double> ahead = Road::T_world_vehicle(s_).inverse() * point(slot);
      if (ahead.x() > 6.0) continue;
      largest = std::max(largest, std::abs(filter_.mean_landmark(slot).z() - ahead.z()));
    }
    return largest;
  }

  Filter filter_;
  double s_ = 0.0;  ///< of the way, m

 private:
  const Vector3<double>& point(int slot) const { return points_[filter_.landmark_id(slot) - 1]; }
  bool sees(const Vector3<double>& point, double nearest_m, Vector2<double>& pixel) const {
    const Vector3<double> p = (Road::T_world_vehicle(s_) * mounting()).inverse() * point;
    return p.z() > nearest_m && p.z() < kFarthest_m && ok(camera_.project(p, pixel)) &&
           camera_.contains(pixel);
  }
  double normal(double sigma) { return sigma * gauss_(generator_); }

  std::mt19937_64 generator_{5};
  std::normal_distribution<double> gauss_;
  std::vector<Vector3<double>> points_;
  PinholeCamera<double> camera_ = test::vga_camera<double>();
  Random random_{1};
};

using Filters = ::testing::Types<GroupIekfSlam<double, 40, 3>, EkfSlam<double, 40, 3>>;
TYPED_TEST_SUITE(ClimbingRoad, Filters, );

/// Nothing is left of the slope in the tilt, and heights count from the road at the vehicle. Were
/// the floor to stay where it began, the tilt would reach 0.06 rad and heights be 0.6 m off.
TYPED_TEST(ClimbingRoad, IsTheFloorAndNotATilt) {
  double pitch = 0.0;
  double height = 0.0;
  for (this->add_landmarks(); this->s_ < 300.0; this->add_landmarks()) {
    this->move();
    this->look();
    pitch = std::max(pitch, std::abs(this->filter_.tilt().pitch));
    height = std::max(height, this->height_error());
  }
  EXPECT_LT(pitch, 0.03);
  EXPECT_LT(height, 0.25);
}

}  // namespace
}  // namespace cairn
