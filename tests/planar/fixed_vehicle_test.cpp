#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

namespace cairn {
namespace {

constexpr int kMax = 10;
using Slam = FixedVehicleSlam<kMax>;
using Double = GroupIekfSlam<double, kMax, 3>;

constexpr double kSameMean = 2e-5;        // m, rad
constexpr double kSameCovariance = 2e-4;  // of the deviations

template <class Matrix>
void expect_close(const Matrix& fixed, const Matrix& reference, const char* what) {
  for (int i = 0; i < reference.rows(); ++i) {
    for (int j = 0; j < reference.cols(); ++j) {
      const double scale = std::sqrt(reference(i, i) * reference(j, j)) + 1e-9;
      EXPECT_NEAR(fixed(i, j), reference(i, j), kSameCovariance * scale) << what << i << j;
    }
  }
}

/// The filter in fixed point and one in double, told the same.
class Pair {
 public:
  explicit Pair(bool tilts) {
    PlanarParameters<float> parameters;
    PlanarParameters<double> reference_parameters;
    if (tilts) {
      parameters.tilt = TiltParameters<float>::car();
      reference_parameters.tilt = TiltParameters<double>::car();
    }
    PlanarPose<float> pose;
    pose.position = {3.0F, -2.0F};
    pose.heading = 0.5F;
    Matrix3<float> covariance = Matrix3<float>::Identity() * 0.0025F;
    EXPECT_EQ(fixed->initialise(pose, covariance, parameters), Status::kOk);
    PlanarPose<double> reference_pose;
    reference_pose.position = pose.position.cast<double>();
    reference_pose.heading = 0.5;
    EXPECT_EQ(
        reference->initialise(reference_pose, covariance.cast<double>(), reference_parameters),
        Status::kOk);
    camera = {250, 250, 159.5F, 119.5F, 0, 0, 0, 0, 0, 320, 240};
    reference_camera = {250, 250, 159.5, 119.5, 0, 0, 0, 0, 0, 320, 240};
    mount.rotation = {0.48225F, -0.51715F, 0.51715F, -0.48225F};
    mount.rotation.normalize();
    mount.translation = {0.35F, 0.0F, 1.0F};
    reference_mount.rotation = mount.rotation.cast<double>();
    reference_mount.translation = mount.translation.cast<double>();
  }

  void drive(int steps) {
    for (int k = 0; k < steps; ++k) {
      PlanarIncrement<float> increment;
      increment.distance_m = 0.05F;
      increment.turn_rad = 0.02F;
      increment.covariance << 4e-6F, 1e-7F, 1e-7F, 3e-6F;
      increment.model = IncrementModel::kExactArc;
      EXPECT_EQ(fixed->predict(increment), Status::kOk);
      PlanarIncrement<double> step;
      step.distance_m = double{increment.distance_m};
      step.turn_rad = double{increment.turn_rad};
      step.covariance = increment.covariance.cast<double>();
      step.model = increment.model;
      EXPECT_EQ(reference->predict(step), Status::kOk);
      EXPECT_EQ(fixed->predict_tilt(0.04F), Status::kOk);
      EXPECT_EQ(reference->predict_tilt(double{0.04F}), Status::kOk);
    }
  }

  template <class Call>
  void both(const Call& call) {
    EXPECT_EQ(call(*fixed, float{}), Status::kOk);
    EXPECT_EQ(call(*reference, double{}), Status::kOk);
  }

  void add_seen(LandmarkId id, double ahead, double left, double height, LandmarkId past) {
    both([&](auto& filter, auto zero) {
      using T = decltype(zero);
      // Numbers that float has.
      const Vector3<T> y(static_cast<T>(static_cast<float>(ahead)),
                         static_cast<T>(static_cast<float>(left)),
                         static_cast<T>(static_cast<float>(height)));
      Matrix3<T> noise = Matrix3<T>::Identity() * static_cast<T>(0.015625);
      noise(0, 1) = noise(1, 0) = static_cast<T>(0.00390625);
      Matrix<T, 3, 2> by_path;
      by_path << T(2), T(-1), T(0.5), T(4), T(0.25), T(-0.5);
      return filter.add_landmark_on_path(id, y, noise, past, by_path);
    });
  }

  void add_map_frame() {
    both([&](auto& filter, auto zero) {
      using T = decltype(zero);
      const Matrix3<T> shared = Matrix3<T>::Identity() * static_cast<T>(0.03125);
      return filter.add_frame_position(90, Vector3<T>(T(3), T(-1), T(0)), shared);
    });
    both([&](auto& filter, auto zero) {
      using T = decltype(zero);
      Matrix3<T> by_heading = Matrix3<T>::Identity() * static_cast<T>(9.5367431640625e-07);
      by_heading(1, 1) = static_cast<T>(0.125);
      return filter.add_frame_position(91, Vector3<T>(T(13), T(-1), T(0)), by_heading, 90);
    });
    both([&](auto& filter, auto zero) {
      using T = decltype(zero);
      const Matrix3<T> own = Matrix3<T>::Identity() * static_cast<T>(0.001953125);
      return filter.add_framed_landmark(92, Vector3<T>(T(6), T(1), T(0.5)), own, 90, 91);
    });
  }

  void expect_equal() const {
    EXPECT_NEAR(fixed->mean_pose().position.x(), reference->mean_pose().position.x(), kSameMean);
    EXPECT_NEAR(fixed->mean_pose().position.y(), reference->mean_pose().position.y(), kSameMean);
    EXPECT_NEAR(fixed->mean_pose().heading, reference->mean_pose().heading, kSameMean);
    expect_close(Matrix3<double>(fixed->pose_covariance().cast<double>()),
                 Matrix3<double>(reference->pose_covariance()), "pose ");
    expect_close(Matrix3<double>(fixed->own_pose_covariance().cast<double>()),
                 Matrix3<double>(reference->own_pose_covariance()), "own pose ");
    ASSERT_EQ(fixed->landmark_count(), reference->landmark_count());
    for (int slot = 0; slot < fixed->landmark_count(); ++slot) {
      const int other = reference->find(fixed->landmark_id(slot));
      const Vector3<double> away =
          fixed->mean_landmark(slot).cast<double>() - reference->mean_landmark(other);
      EXPECT_LT(std::sqrt(away.dot(away)), kSameMean) << slot;
      expect_close(Matrix3<double>(fixed->landmark_covariance(slot).cast<double>()),
                   Matrix3<double>(reference->landmark_covariance(other)), "landmark ");
      expect_close(Matrix3<double>(fixed->relative_landmark_covariance(slot).cast<double>()),
                   Matrix3<double>(reference->relative_landmark_covariance(other)), "relative ");
    }
    EXPECT_EQ(fixed->saturations(), 0U);
  }

  /// Windows of the landmarks that are seen; their number.
  int compare_windows() const {
    int windows = 0;
    for (int slot = 0; slot < fixed->landmark_count(); ++slot) {
      PixelPrediction<float> own;
      PixelPrediction<double> expected;
      const int other = reference->find(fixed->landmark_id(slot));
      const Status status = fixed->predict_pixel(slot, camera, mount, 0.5F, own);
      EXPECT_EQ(status,
                reference->predict_pixel(other, reference_camera, reference_mount, 0.5, expected));
      if (!ok(status)) continue;
      ++windows;
      for (int i = 0; i < 2; ++i) EXPECT_NEAR(own.pixel(i), expected.pixel(i), 0.02);
      expect_close(Matrix2<double>(own.covariance.cast<double>()), expected.covariance, "window ");
    }
    return windows;
  }

  std::unique_ptr<Slam> fixed = std::make_unique<Slam>();
  std::unique_ptr<Double> reference = std::make_unique<Double>();
  PinholeCamera<float> camera;
  PinholeCamera<double> reference_camera;
  Rigid<float> mount;
  Rigid<double> reference_mount;
};

void map_on_the_way(Pair& pair) {
  pair.drive(5);
  pair.both([](auto& filter, auto) { return filter.add_position(50); });
  pair.drive(12);
  pair.add_seen(1, 4.0, 0.5, 0.75, 50);
  pair.add_seen(2, 6.0, -1.0, 0.25, 50);
  pair.drive(3);
  pair.both([](auto& filter, auto) { return filter.add_position(51); });
  pair.drive(9);
  pair.add_seen(3, 5.0, -0.25, 1.0, 51);
}

class FixedVehicle : public ::testing::TestWithParam<bool> {};

TEST_P(FixedVehicle, RememberedPositionsAndPathsEqualDouble) {
  Pair pair(GetParam());
  map_on_the_way(pair);
  pair.drive(2);
  pair.expect_equal();
  EXPECT_EQ(pair.compare_windows(), 3);
}

TEST_P(FixedVehicle, TheFrameOfAnOldMapEqualsDouble) {
  Pair pair(GetParam());
  map_on_the_way(pair);
  pair.add_map_frame();
  pair.both([](auto& filter, auto zero) {
    using T = decltype(zero);
    return filter.widen_frame(90, 91, T(0.0009765625), T(0.000244140625));
  });
  pair.drive(4);
  pair.expect_equal();
  expect_close(Matrix3<double>(pair.fixed->framed_pose_covariance(90, 91).cast<double>()),
               Matrix3<double>(pair.reference->framed_pose_covariance(90, 91)), "framed ");
  EXPECT_GE(pair.compare_windows(), 3);
}

TEST_P(FixedVehicle, AnUpdateAfterAllOfThemEqualsDouble) {
  Pair pair(GetParam());
  map_on_the_way(pair);
  pair.add_map_frame();
  pair.drive(2);
  const Slam& fixed = *pair.fixed;
  PixelMatch<float> seen[kMax];
  PixelMatch<double> seen_double[kMax];
  int count = 0;
  for (int slot = 0; slot < fixed.landmark_count(); ++slot) {
    PixelPrediction<float> expected;
    if (!ok(fixed.predict_pixel(slot, pair.camera, pair.mount, 0.5F, expected))) continue;
    seen[count].id = fixed.landmark_id(slot);
    seen[count].pixel = expected.pixel + Vector2<float>(0.5F, count % 2 == 0 ? 0.75F : -0.25F);
    seen_double[count].id = seen[count].id;
    seen_double[count].pixel = seen[count].pixel.cast<double>();
    ++count;
  }
  ASSERT_GE(count, 3);
  Random random(5);
  Random same(5);
  UpdateReport report;
  UpdateReport report_double;
  EXPECT_EQ(pair.fixed->update_pixels(pair.camera, pair.mount, 0.5F, seen, count, random, report),
            Status::kOk);
  EXPECT_EQ(pair.reference->update_pixels(pair.reference_camera, pair.reference_mount, 0.5,
                                          seen_double, count, same, report_double),
            Status::kOk);
  EXPECT_EQ(report.matches, report_double.matches);
  EXPECT_EQ(report.low_innovation, report_double.low_innovation);
  EXPECT_NEAR(report.nis, report_double.nis, 0.01);
  for (int k = 0; k < count; ++k) EXPECT_EQ(seen[k].inlier, seen_double[k].inlier);
  pair.expect_equal();
}

TEST_P(FixedVehicle, ThePlaceThatWasRecognisedAndBackEqualsDouble) {
  Pair pair(GetParam());
  map_on_the_way(pair);
  const PlanarPose<float> before = pair.fixed->mean_pose();
  PlanarPose<float> place = before;
  place.position += Vector2<float>(0.25F, -0.125F);
  place.heading += 0.0625F;
  PlanarPose<double> place_double;
  place_double.position = place.position.cast<double>();
  place_double.heading = double{place.heading};
  const auto fixed_before = pair.fixed->place(place, 1.0F, 1.0F);
  const auto reference_before = pair.reference->place(place_double, 1.0, 1.0);
  EXPECT_NEAR(pair.fixed->mean_pose().position.x(), place.position.x(), 1e-6);
  EXPECT_NEAR(pair.fixed->mean_pose().heading, place.heading, 1e-6);
  pair.fixed->put_back(fixed_before);
  pair.reference->put_back(reference_before);
  EXPECT_NEAR(pair.fixed->mean_pose().position.x(), before.position.x(), 1e-6);
  pair.expect_equal();
}

TEST(FixedVehicle, NoiseThatWaitsIsBoundedWhereThePlaceWasRecognised) {
  Pair pair(false);
  map_on_the_way(pair);
  ASSERT_EQ(pair.fixed->widen_pose(4.0F, 1.0F), Status::kOk);
  EXPECT_GT(pair.fixed->own_pose_covariance()(0, 0), 2.0F);
  static_cast<void>(pair.fixed->place(pair.fixed->mean_pose(), 0.25F, 0.01F));
  EXPECT_LT(pair.fixed->own_pose_covariance()(0, 0), 0.5F);
  static_cast<void>(pair.fixed->place(pair.fixed->mean_pose(), -1.0F, -1.0F));
  EXPECT_GE(pair.fixed->own_pose_covariance()(2, 2), 0.0F);
}

TEST_P(FixedVehicle, MovingTheCentreOfTheErrorKeepsTheEstimate) {
  Pair pair(GetParam());
  map_on_the_way(pair);
  pair.drive(60);
  EXPECT_FALSE(pair.fixed->recentre());
  EXPECT_FALSE(pair.reference->recentre());
  pair.both([](auto& filter, auto zero) {
    using T = decltype(zero);
    return filter.widen_pose(T(0.0625), T(0.25));
  });
  EXPECT_TRUE(pair.fixed->recentre());
  EXPECT_TRUE(pair.reference->recentre());
  pair.expect_equal();
  pair.drive(3);
  pair.expect_equal();
}

TEST_P(FixedVehicle, ADriftOfTheWorldEqualsDouble) {
  Pair pair(GetParam());
  map_on_the_way(pair);
  pair.both([](auto& filter, auto zero) {
    using T = decltype(zero);
    return filter.drift_world(T(0.03125), T(0.001953125));
  });
  pair.expect_equal();
}

TEST_P(FixedVehicle, LateralSlipEqualsDouble) {
  Pair pair(GetParam());
  map_on_the_way(pair);
  for (int k = 0; k < 5; ++k) {
    pair.both([](auto& filter, auto zero) {
      using T = decltype(zero);
      return filter.slip_laterally(T(0.015625));
    });
    pair.drive(3);
  }
  pair.expect_equal();
}

INSTANTIATE_TEST_SUITE_P(LevelAndTilting, FixedVehicle, ::testing::Bool());

TEST(FixedVehicle, RefusesALensThatHasNoFixedForm) {
  PinholeCamera<float> camera = {250, 250, 159.5F, 119.5F, 0, 0, 0, 0, 0, 320, 240};
  EXPECT_EQ(Slam::check_camera(camera), Status::kOk);
  camera.k4 = 0.1F;
  EXPECT_EQ(Slam::check_camera(camera), Status::kBadConfig);
  camera.k4 = 0.0F;
  camera.lens = Lens::kFisheye;
  EXPECT_EQ(Slam::check_camera(camera), Status::kBadConfig);
  camera.lens = Lens::kRadialTangential;
  camera.k1 = 9.0F;
  EXPECT_EQ(Slam::check_camera(camera), Status::kBadConfig);
}

/// How far it is off does not even fit the format; that is counted where it is used alone.
TEST(FixedVehicle, AHeightOutsideTheGateLeavesEverythingAsItWas) {
  Slam filter;
  ASSERT_TRUE(ok(filter.initialise({}, Matrix3<float>::Zero())));
  ASSERT_TRUE(ok(filter.add_landmark(1, {3.0F, 0.0F, 2.0F}, 0.01F * Matrix3<float>::Identity())));
  const auto hash = [&] {
    Hash64 sum;
    filter.hash(sum);
    return sum.value();
  };
  const std::uint64_t before = hash();
  EXPECT_EQ(filter.update_height(1, -2047.0F, 0.01F, 11.0F), Status::kGated);
  EXPECT_EQ(hash(), before);
  EXPECT_EQ(filter.saturations(), 0U);
}

TEST(FixedVehicle, RefusesWhatIsNotFinite) {
  Pair pair(false);
  map_on_the_way(pair);
  Hash64 before;
  pair.fixed->hash(before);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PlanarIncrement<float> increment;
  increment.distance_m = nan;
  EXPECT_EQ(pair.fixed->predict(increment), Status::kInvalidArgument);
  EXPECT_EQ(pair.fixed->widen_pose(nan, 0.0F), Status::kInvalidArgument);
  EXPECT_EQ(pair.fixed->slip_laterally(-1.0F), Status::kInvalidArgument);
  EXPECT_EQ(pair.fixed->drift_world(0.0F, -1.0F), Status::kInvalidArgument);
  Rigid<float> mount = pair.mount;
  mount.translation.x() = nan;
  PixelPrediction<float> prediction;
  EXPECT_EQ(pair.fixed->predict_pixel(0, pair.camera, mount, 0.5F, prediction),
            Status::kNonFiniteInput);
  PixelMatch<float> match;
  match.id = 50;
  Random random(1);
  UpdateReport report;
  EXPECT_EQ(pair.fixed->update_pixels(pair.camera, pair.mount, nan, &match, 1, random, report),
            Status::kNonFiniteInput);
  OnePointRansacParameters ransac = pair.fixed->parameters().ransac;
  const int hypotheses = ransac.max_hypotheses;
  ransac.max_hypotheses = -1;
  pair.fixed->set_ransac(ransac);
  EXPECT_EQ(pair.fixed->parameters().ransac.max_hypotheses, hypotheses);
  EXPECT_EQ(pair.fixed->add_landmark_on_path(9, {nan, 0, 0}, Matrix3<float>::Identity(), 50,
                                             Matrix<float, 3, 2>::Zero()),
            Status::kInvalidArgument);
  EXPECT_EQ(pair.fixed->add_landmark_on_path(9, {1, 0, 0}, Matrix3<float>::Identity(), 77,
                                             Matrix<float, 3, 2>::Zero()),
            Status::kNotFound);
  EXPECT_EQ(pair.fixed->add_position(50), Status::kDuplicate);
  EXPECT_EQ(pair.fixed->add_framed_landmark(9, {1, 0, 0}, Matrix3<float>::Identity(), 50, 50),
            Status::kInvalidArgument);
  Hash64 after;
  pair.fixed->hash(after);
  EXPECT_EQ(before.value(), after.value());
}

}  // namespace
}  // namespace cairn
