#include "cairn/planar/lifted/error_model.hpp"

#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "cairn/planar/detail/whitened_update.hpp"
#include "cairn/planar/error_model/group.hpp"
#include "cairn/planar/error_model/world.hpp"

// The error models alone, without gates, maps of ids and sensors: what they say of first order
// against differences, what they say of covariances against dense products.

namespace cairn {
namespace {

using World = WorldErrorModel<double, 4, 3>;
using Group = GroupErrorModel<double, 4, 3>;
using Lifted = LiftedErrorModel<double, 4, 3>;
constexpr int kSlots = 3;
constexpr double kStep = 1e-6;

template <class Model>
using ErrorVector = Eigen::Matrix<double, Model::kStates, 1>;
using Body = Eigen::Vector3d;

PlanarIncrement<double> increment(IncrementModel model = IncrementModel::kExactArc) {
  return twist_increment(0.7, 0.4, 0.5, 0.1, 0.05, model);
}

/// A model with landmarks around a vehicle that has moved since its start and since they came.
template <class Model>
Model model_in_mid_drive() {
  Model model;
  PlanarPose<double> pose;
  pose.position = {1.0, -2.0};
  pose.heading = 0.7;
  Matrix3<double> covariance;
  covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  model.start(pose, covariance);
  const Vector3<double> seen[kSlots] = {{3.0, 1.0, 0.5}, {2.0, -1.5, 0.0}, {-1.0, 4.0, 2.0}};
  for (const Vector3<double>& y : seen) {
    model.append_landmark(y, Vector3<double>(0.01, 0.02, 0.03).asDiagonal());
  }
  model.propagate(increment());
  return model;
}

/// The landmark in the vehicle's axes, m: what every sensor depends on.
template <class Model>
Body body_of(const Model& model, int slot) {
  double relative[3];
  Body body;
  model.relative(slot, relative);
  model.frame().to_body(relative, body.data());
  body(2) = relative[2];
  return body;
}

template <class Model>
Eigen::MatrixXd dense_covariance(const Model& model) {
  const int n = model.covariance().size();
  Eigen::MatrixXd P(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) P(i, j) = model.error_covariance(i, j);
  }
  return P;
}

/// Jacobian C of the relative vector, column by column.
template <class Model>
Eigen::MatrixXd relative_jacobian(const Model& model, int slot) {
  const int n = model.covariance().size();
  Eigen::MatrixXd C(3, n);
  for (int i = 0; i < n; ++i) {
    ErrorVector<Model> unit = ErrorVector<Model>::Zero();
    unit(i) = 1.0;
    model.relative_of(slot, unit.data(), C.col(i).data());
  }
  return C;
}

template <class Model>
class ErrorModel : public ::testing::Test {
 protected:
  Model model_ = model_in_mid_drive<Model>();
  int states() const { return model_.covariance().size(); }
};
using Models = ::testing::Types<World, Group, Lifted>;
TYPED_TEST_SUITE(ErrorModel, Models, );

/// C v is how far a landmark moves in the vehicle's axes when the mean is corrected by v.
TYPED_TEST(ErrorModel, RelativeJacobianAgreesWithDifferences) {
  for (int slot = 0; slot < kSlots; ++slot) {
    const Eigen::MatrixXd C = relative_jacobian(this->model_, slot);
    for (int i = 0; i < this->states(); ++i) {
      ErrorVector<TypeParam> d = ErrorVector<TypeParam>::Zero();
      d(i) = kStep;
      TypeParam up = this->model_;
      TypeParam down = this->model_;
      up.correct(d.data());
      d(i) = -kStep;
      down.correct(d.data());
      const Body difference = (body_of(up, slot) - body_of(down, slot)) / (2.0 * kStep);
      Body linear;
      const Eigen::Vector3d column = C.col(i);
      this->model_.frame().to_body(column.data(), linear.data());
      linear(2) = column(2);
      EXPECT_LT((difference - linear).norm(), 1e-8) << "slot " << slot << " state " << i;
    }
  }
}

/// The hypothesis of a correction is what the correction then does, far beyond first order.
TYPED_TEST(ErrorModel, RetractionForeseesTheCorrection) {
  ErrorVector<TypeParam> d = ErrorVector<TypeParam>::Zero();
  for (int i = 0; i < this->states(); ++i) d(i) = 0.3 * std::sin(1.0 + i);
  const auto retraction = this->model_.retraction(d.data());
  TypeParam corrected = this->model_;
  corrected.correct(d.data());
  for (int slot = 0; slot < kSlots; ++slot) {
    double relative[3];
    Body foreseen;
    this->model_.relative_after(slot, d.data(), retraction, relative);
    this->model_.frame().to_body(relative, foreseen.data());
    foreseen(2) = relative[2];
    EXPECT_LT((foreseen - body_of(corrected, slot)).norm(), 1e-12) << slot;
  }
}

TYPED_TEST(ErrorModel, RelativeCovarianceIsTheDenseProduct) {
  const Eigen::MatrixXd P = dense_covariance(this->model_);
  for (int slot = 0; slot < kSlots; ++slot) {
    const Eigen::MatrixXd C = relative_jacobian(this->model_, slot);
    const Eigen::Matrix3d expected = C * P * C.transpose();
    RelativeCovariance<double> got;
    this->model_.relative_covariance(slot, got);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) EXPECT_NEAR(got.at(i, j), expected(i, j), 1e-12) << slot;
    }
  }
}

/// The columns are those of the stored P; the update engine adds deferred noise by itself.
TYPED_TEST(ErrorModel, RelativeColumnsAreTheDenseProduct) {
  detail::WhitenedUpdate<TypeParam> update;
  update.absorb_deferred_noise(this->model_);
  const Eigen::MatrixXd P = dense_covariance(this->model_);
  for (int slot = 0; slot < kSlots; ++slot) {
    const Eigen::MatrixXd expected = P * relative_jacobian(this->model_, slot).transpose();
    ErrorVector<TypeParam> columns[3];
    this->model_.relative_columns(slot, columns[0].data(), columns[1].data());
    for (int i = 0; i < this->states(); ++i) columns[2](i) = P(i, this->model_.height_state(slot));
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < this->states(); ++i) {
        EXPECT_NEAR(columns[k](i), expected(i, k), 1e-12) << slot << ' ' << k << ' ' << i;
      }
    }
  }
}

TYPED_TEST(ErrorModel, AbsorbingDeferredNoiseLeavesTheCovariance) {
  const Eigen::MatrixXd before = dense_covariance(this->model_);
  detail::WhitenedUpdate<TypeParam> update;
  update.absorb_deferred_noise(this->model_);
  EXPECT_LT((dense_covariance(this->model_) - before).cwiseAbs().maxCoeff(), 1e-14);
  const Eigen::MatrixXd once = dense_covariance(this->model_);
  update.absorb_deferred_noise(this->model_);
  EXPECT_EQ((dense_covariance(this->model_) - once).cwiseAbs().maxCoeff(), 0.0);
}

/// Error of `from`'s mean seen from `to`, to first order, in the model's coordinates.
ErrorVector<World> difference(const World& from, const World& to) {
  ErrorVector<World> d = ErrorVector<World>::Zero();
  for (int i = 0; i < 2; ++i) d(i) = to.vehicle()[i] - from.vehicle()[i];
  d(2) = to.mean_pose().heading - from.mean_pose().heading;
  for (int slot = 0; slot < kSlots; ++slot) {
    for (int i = 0; i < 3; ++i) {
      d(to.state_of(slot) + i) = to.landmark(slot)[i] - from.landmark(slot)[i];
    }
  }
  return d;
}
ErrorVector<Group> difference(const Group& from, const Group& to) {
  ErrorVector<Group> d = ErrorVector<Group>::Zero();
  d(0) = to.mean_pose().heading - from.mean_pose().heading;
  const double c = std::cos(d(0));
  const double s = std::sin(d(0));
  const auto xi = [c, s](const double* a, const double* b, double* out) {
    out[0] = b[0] - (c * a[0] - s * a[1]);
    out[1] = b[1] - (s * a[0] + c * a[1]);
  };
  xi(from.vehicle(), to.vehicle(), d.data() + 1);
  for (int slot = 0; slot < kSlots; ++slot) {
    double* l = d.data() + to.state_of(slot);
    xi(from.landmark(slot), to.landmark(slot), l);
    l[2] = to.landmark(slot)[2] - from.landmark(slot)[2];
  }
  return d;
}

template <class Model>
class PredictedError : public ::testing::Test {};
using WorldModels = ::testing::Types<World, Group>;
TYPED_TEST_SUITE(PredictedError, WorldModels, );

/// F P F^T + G Q G^T with F and G by differences of the motion itself.
TYPED_TEST(PredictedError, TransitionAndNoiseAgreeWithDifferences) {
  for (const IncrementModel kind : {IncrementModel::kEuler, IncrementModel::kExactArc}) {
    const TypeParam model = model_in_mid_drive<TypeParam>();
    const int n = model.covariance().size();
    const PlanarIncrement<double> u = increment(kind);
    TypeParam moved = model;
    moved.propagate(u);

    Eigen::MatrixXd F(n, n);
    for (int i = 0; i < n; ++i) {
      ErrorVector<TypeParam> after[2];
      for (int side = 0; side < 2; ++side) {
        ErrorVector<TypeParam> d = ErrorVector<TypeParam>::Zero();
        d(i) = side == 0 ? kStep : -kStep;
        TypeParam off = model;
        off.correct(d.data());
        off.propagate(u);
        after[side] = difference(moved, off);
      }
      F.col(i) = ((after[0] - after[1]) / (2.0 * kStep)).head(n);
    }
    Eigen::MatrixXd G(n, 2);
    for (int k = 0; k < 2; ++k) {
      ErrorVector<TypeParam> after[2];
      for (int side = 0; side < 2; ++side) {
        PlanarIncrement<double> off = u;
        (k == 0 ? off.distance_m : off.turn_rad) += side == 0 ? kStep : -kStep;
        TypeParam other = model;
        other.propagate(off);
        after[side] = difference(moved, other);
      }
      G.col(k) = ((after[0] - after[1]) / (2.0 * kStep)).head(n);
    }
    const Eigen::MatrixXd expected = F * dense_covariance(model) * F.transpose() +
                                     G * Eigen::Matrix2d(u.covariance) * G.transpose();
    EXPECT_LT((dense_covariance(moved) - expected).cwiseAbs().maxCoeff(), 1e-8);
  }
}

/// The group's error moves by itself alone: the reason why nothing unmeasured becomes known.
TEST(GroupErrorModel, TransitionIsTheIdentity) {
  const Group model = model_in_mid_drive<Group>();
  Group moved = model;
  moved.propagate(increment());
  for (int i = 0; i < model.covariance().size(); ++i) {
    ErrorVector<Group> d = ErrorVector<Group>::Zero();
    d(i) = 1e-3;
    Group off = model;
    off.correct(d.data());
    off.propagate(increment());
    ErrorVector<Group> kept = difference(moved, off);
    const ErrorVector<Group> before = difference(model, [&] {
      Group corrected = model;
      corrected.correct(d.data());
      return corrected;
    }());
    EXPECT_LT((kept - before).cwiseAbs().maxCoeff(), 1e-12) << i;
  }
}

TYPED_TEST(ErrorModel, RemovingALandmarkMovesTheLastIntoItsSlot) {
  const Body last = body_of(this->model_, kSlots - 1);
  const Matrix3<double> covariance = this->model_.landmark_covariance(kSlots - 1);
  this->model_.remove_landmark(0);
  EXPECT_EQ(this->states(), this->model_.state_of(kSlots - 1));
  EXPECT_LT((body_of(this->model_, 0) - last).norm(), 1e-15);
  EXPECT_LT((this->model_.landmark_covariance(0) - covariance).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace cairn
