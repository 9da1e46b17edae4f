#include "cairn/planar/tilt.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "tilting_vehicle.hpp"
#include "vga_camera.hpp"

// A vehicle whose body pitches and rolls.

namespace cairn {
namespace {

using planar_test::mounting;
using planar_test::suspension;

constexpr int kMax = 40;
using Group = GroupIekfSlam<double, kMax, 3>;
using Ekf = EkfSlam<double, kMax, 3>;

template <class Filter>
Filter tilting_filter(double heading = 0.7) {
  Filter filter;
  PlanarPose<double> pose;
  pose.position = {3.0, -2.0};
  pose.heading = heading;
  PlanarParameters<double> parameters;
  parameters.tilt = suspension();
  parameters.reacquire_after = 0;
  EXPECT_TRUE(ok(filter.initialise(pose, Matrix3<double>::Identity() * 1e-6, parameters)));
  return filter;
}

/// A model of a vehicle that has moved and tilted, with three landmarks that it saw at another
/// tilt.
template <class Model>
Model tilted_model() {
  Model model;
  PlanarPose<double> pose;
  pose.position = {1.0, -2.0};
  pose.heading = 0.7;
  model.start(pose, Vector3<double>(0.04, 0.09, 0.01).asDiagonal());
  model.start_tilt(suspension());
  std::vector<double> d(Model::kStates, 0.0);
  d[3] = 0.04;
  d[4] = -0.06;
  model.correct(d.data());
  const Vector3<double> seen[] = {{9.0, 1.0, 0.5}, {6.0, -1.5, 0.0}, {12.0, 4.0, 2.0}};
  for (const Vector3<double>& y : seen) {
    model.append_landmark(y, Vector3<double>(0.01, 0.02, 0.03).asDiagonal());
  }
  const Vector2<double> noise(1e-5, 2e-5);
  model.propagate_tilt(0.8, noise);
  return model;
}

template <class Model>
CameraView<double> view_of(const Model& model, const PinholeCamera<double>& camera) {
  CameraView<double> view(camera, model.tilt().T_level_vehicle() * mounting(), 0.5);
  view.frame = model.frame();
  view.tilts = true;
  return view;
}

template <class Model>
LinearisedObservation<double, 3> linearised(const Model& model, const PinholeCamera<double>& camera,
                                            int slot) {
  LinearisedObservation<double, 3> out;
  RelativeCovariance<double> covariance;
  double relative[3];
  model.relative(slot, relative);
  model.relative_covariance(slot, covariance);
  Vector3<double> p_camera;
  EXPECT_TRUE(view_of(model, camera).linearise(relative, covariance, out, p_camera));
  out.slot = slot;
  return out;
}

template <class Model>
TiltRows<double> tilt_rows(const Model& model, const LinearisedObservation<double, 3>& o) {
  double relative[3];
  model.relative(o.slot, relative);
  return {o, relative, model.tilt_axes(model.frame())};
}

template <class Model>
class TiltModel : public ::testing::Test {
 protected:
  Model model_ = tilted_model<Model>();
  PinholeCamera<double> camera_ = test::vga_camera<double>();

  int states() const { return model_.covariance().size(); }
  Vector2<double> pixel(const Model& model, int slot) const {
    const LinearisedObservation<double, 3> o = linearised(model, camera_, slot);
    return {-o.innovation[0], -o.innovation[1]};
  }
  /// Rows of a pixel by differences.
  Eigen::MatrixXd rows_by_differences(int slot) const {
    constexpr double kStep = 1e-6;
    Eigen::MatrixXd H(2, states());
    for (int i = 0; i < states(); ++i) {
      Vector2<double> at[2];
      for (int side = 0; side < 2; ++side) {
        std::vector<double> d(Model::kStates, 0.0);
        d[i] = side == 0 ? kStep : -kStep;
        Model moved = model_;
        moved.correct(d.data());
        at[side] = pixel(moved, slot);
      }
      H.col(i) = (at[0] - at[1]) / (2.0 * kStep);
    }
    return H;
  }
};
using Models = ::testing::Types<GroupErrorModel<double, 4, 3>, WorldErrorModel<double, 4, 3>>;
TYPED_TEST_SUITE(TiltModel, Models, );

TYPED_TEST(TiltModel, RowsAgreeWithDifferences) {
  for (int slot = 0; slot < 3; ++slot) {
    const LinearisedObservation<double, 3> o = linearised(this->model_, this->camera_, slot);
    const TiltRows<double> tilt = tilt_rows(this->model_, o);
    const Eigen::MatrixXd H = this->rows_by_differences(slot);
    for (int i = 0; i < this->states(); ++i) {
      std::vector<double> unit(TypeParam::kStates, 0.0);
      unit[i] = 1.0;
      double relative[3];
      this->model_.relative_of(slot, unit.data(), relative);
      for (int r = 0; r < 2; ++r) {
        const double row = o.row(r, relative) + tilt.row(r, unit.data() + TypeParam::kTiltState);
        EXPECT_NEAR(row, H(r, i), 1e-5) << "slot " << slot << " row " << r << " state " << i;
      }
    }
  }
}

TYPED_TEST(TiltModel, InnovationCovarianceIsTheDenseProduct) {
  const int n = this->states();
  Eigen::MatrixXd P(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) P(i, j) = this->model_.error_covariance(i, j);
  }
  for (int slot = 0; slot < 3; ++slot) {
    const LinearisedObservation<double, 3> o = linearised(this->model_, this->camera_, slot);
    RelativeCovariance<double> covariance;
    TiltCovariance<double> tilt;
    this->model_.relative_covariance(slot, covariance);
    this->model_.tilt_covariance(slot, tilt);
    InnovationCovariance<double> s = innovation_covariance(o, covariance);
    add_tilt_covariance(o, tilt_rows(this->model_, o), tilt, s);
    const Eigen::MatrixXd H = this->rows_by_differences(slot);
    const Eigen::Matrix2d S = H * P * H.transpose();
    EXPECT_NEAR(s.s00 - o.r00, S(0, 0), 1e-6 * S(0, 0));
    EXPECT_NEAR(s.s01 - o.r01, S(0, 1), 1e-6 * S(0, 0));
    EXPECT_NEAR(s.s11 - o.r11, S(1, 1), 1e-6 * S(1, 1));
  }
}

/// What was seen from the tilted vehicle turns with the tilt's error: the landmark's errors by
/// differences of its place.
TYPED_TEST(TiltModel, ALandmarkEntersWithTheErrorOfTheTilt) {
  const Vector3<double> y(8.0, 2.0, 0.7);
  TypeParam with = this->model_;
  with.append_landmark(y, Matrix3<double>::Identity() * 1e-8);
  const int at = with.state_of(3);
  for (int k = 0; k < 2; ++k) {
    constexpr double kStep = 1e-6;
    Vector3<double> place[2];
    for (int side = 0; side < 2; ++side) {
      std::vector<double> d(TypeParam::kStates, 0.0);
      d[3 + k] = side == 0 ? kStep : -kStep;
      TypeParam moved = this->model_;
      moved.correct(d.data());
      moved.append_landmark(y, Matrix3<double>::Identity() * 1e-8);
      place[side] = moved.mean_landmark(3);
    }
    const Vector3<double> by_tilt = (place[0] - place[1]) / (2.0 * kStep);
    const int other = 4 - k;
    for (int i = 0; i < 3; ++i) {
      // The two angles are independent of each other and of the pose here.
      const double variance = with.error_covariance(3 + k, 3 + k);
      if (this->model_.error_covariance(3 + k, other) == 0.0) {
        double expected = by_tilt(i) * variance;
        const int pose_states = i < 2 ? TypeParam::kPositionState + i : -1;
        if (pose_states >= 0) expected += with.error_covariance(3 + k, pose_states);
        EXPECT_NEAR(with.error_covariance(at + i, 3 + k), expected, 1e-9) << i << ' ' << k;
      }
    }
  }
}

/// Right after it was seen, the tilt's error moves landmark and camera alike: the pixel is as sure
/// as the sighting.
TYPED_TEST(TiltModel, TheTiltItWasSeenAtCancels) {
  TypeParam model = this->model_;
  model.append_landmark({8.0, 0.5, 0.7}, Matrix3<double>::Identity() * 1e-8);
  const LinearisedObservation<double, 3> o = linearised(model, this->camera_, 3);
  RelativeCovariance<double> covariance;
  TiltCovariance<double> tilt;
  model.relative_covariance(3, covariance);
  model.tilt_covariance(3, tilt);
  InnovationCovariance<double> s = innovation_covariance(o, covariance);
  EXPECT_GT(s.s11 - o.r11, 1.0);
  add_tilt_covariance(o, tilt_rows(model, o), tilt, s);
  EXPECT_LT(s.s00 - o.r00, 1e-3);
  EXPECT_LT(s.s11 - o.r11, 1e-3);
}

template <class Filter>
class TiltFilter : public ::testing::Test {};
using Filters = ::testing::Types<Group, Ekf>;
TYPED_TEST_SUITE(TiltFilter, Filters, );

TYPED_TEST(TiltFilter, TiltReturnsToZeroWithItsStationaryVariance) {
  TypeParam filter = tilting_filter<TypeParam>();
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(ok(filter.predict_tilt(0.1)));
  EXPECT_NEAR(filter.tilt_covariance()(0, 0), 1e-4, 1e-12);
  EXPECT_NEAR(filter.tilt_covariance()(1, 1), 2.25e-4, 1e-12);
  EXPECT_NEAR(filter.tilt_noise(0.07)(0), 1e-4 * (1.0 - std::exp(-0.2)), 1e-12);
  EXPECT_EQ(filter.predict_tilt(-0.1), Status::kInvalidArgument);
}

TYPED_TEST(TiltFilter, RefusesHalfATilt) {
  TypeParam filter;
  PlanarParameters<double> parameters;
  parameters.tilt.sigma_pitch_rad = 0.01;
  EXPECT_EQ(filter.initialise({}, Matrix3<double>::Zero(), parameters), Status::kBadConfig);
  parameters.tilt.sigma_roll_rad = 0.01;
  parameters.tilt.time_constant_s = 0.0;
  EXPECT_EQ(filter.initialise({}, Matrix3<double>::Zero(), parameters), Status::kBadConfig);
}

TEST(LevelFilter, RefusesATilt) {
  PlanarParameters<double> parameters;
  parameters.tilt = suspension();
  LiftedIekfSlam<double, 4, 3> lifted;
  GroupIekfSlam<double, 4, 3, 0> level;
  EXPECT_EQ(lifted.initialise({}, Matrix3<double>::Zero(), parameters), Status::kBadConfig);
  EXPECT_EQ(level.initialise({}, Matrix3<double>::Zero(), parameters), Status::kBadConfig);
}

/// With all sigmas at zero the states and their arithmetic are those of a filter without them.
TEST(LevelFilter, IsEqualToTheBitWithoutATilt) {
  const auto run = [](auto filter) {
    PlanarParameters<double> parameters;
    EXPECT_TRUE(ok(filter.initialise({}, Matrix3<double>::Identity() * 1e-4, parameters)));
    Random random(1);
    PinholeCamera<double> camera = test::vga_camera<double>();
    for (int i = 0; i < 12; ++i) {
      const auto y = Vector3<double>(6.0 + i, 0.3 * i - 2.0, 0.2 * i);
      EXPECT_TRUE(ok(filter.add_landmark(i + 1, y, Matrix3<double>::Identity() * 0.01)));
    }
    for (int frame = 0; frame < 10; ++frame) {
      EXPECT_TRUE(ok(filter.predict(twist_increment(0.5, 0.1, 0.1, 0.1, 0.05))));
      EXPECT_TRUE(ok(filter.predict_tilt(0.1)));
      std::vector<PixelMatch<double>> matches;
      for (int slot = 0; slot < filter.landmark_count(); ++slot) {
        PixelPrediction<double> seen;
        if (!ok(filter.predict_pixel(slot, camera, mounting(), 0.5, seen))) continue;
        PixelMatch<double> match;
        match.id = seen.id;
        match.slot = seen.slot;
        match.pixel = seen.pixel + Vector2<double>(0.3 * std::sin(7.0 * slot + frame), 0.2);
        matches.push_back(match);
      }
      UpdateReport report;
      EXPECT_TRUE(ok(filter.update_pixels(camera, mounting(), 0.5, matches.data(),
                                          static_cast<int>(matches.size()), random, report)));
    }
    Hash64 hash;
    filter.hash(hash);
    return hash.value();
  };
  EXPECT_EQ(run(GroupIekfSlam<double, kMax, 3, 2>{}), run(GroupIekfSlam<double, kMax, 3, 0>{}));
  EXPECT_EQ(run(EkfSlam<double, kMax, 3, 2>{}), run(EkfSlam<double, kMax, 3, 0>{}));
}

}  // namespace
}  // namespace cairn
