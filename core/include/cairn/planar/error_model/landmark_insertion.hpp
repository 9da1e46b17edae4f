#pragma once

#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/planar/types.hpp"

namespace cairn::detail {

/// Errors of new states as sparse combinations of those that a model has: row i is
/// sum_k weight[i][k] * error[index[i][k]].
template <class T, int Rows>
struct ErrorRows {
  static constexpr int kMaxTerms = 8;
  int index[Rows][kMaxTerms] = {};
  T weight[Rows][kMaxTerms] = {};
  int count[Rows] = {};

  void add(int row, int state, T factor) {
    index[row][count[row]] = state;
    weight[row][count[row]++] = factor;
  }
};

/// Appends `Rows` states to P whose errors are `rows` plus independent noise.
/// Cost: at most kMaxTerms * Rows multiply-adds for each state.
template <class T, int Rows, int Capacity>
void append_error_rows(PackedSymmetric<T, Capacity>& P, const ErrorRows<T, Rows>& rows,
                       const Matrix<T, Rows, Rows>& noise) {
  const int first = P.size();
  P.resize(first + Rows);
  for (int i = 0; i < Rows; ++i) {
    T* row = P.row(first + i);
    for (int k = 0; k < rows.count[i]; ++k) {
      const int state = rows.index[i][k];
      const T weight = rows.weight[i][k];
      for (int j = 0; j < first; ++j) row[j] += weight * P(state, j);
    }
    for (int j = 0; j <= i; ++j) {
      T sum = noise(i, j);
      for (int k = 0; k < rows.count[j]; ++k) sum += rows.weight[j][k] * row[rows.index[j][k]];
      // What the other states add is not below 0, but by rounding where large variances cancel.
      row[first + j] = i == j && sum < noise(i, i) ? noise(i, i) : sum;
    }
  }
}

// How PlanarSlam's landmarks enter a model over CartesianMap. Such a model gives, as ErrorRows, the
// error of its next landmark when it moves with the vehicle (rows_beside_vehicle) and when it
// stands in the world (rows_in_world). Its deferred noise has been absorbed.

template <class Model>
using ErrorRowsOf = ErrorRows<typename Model::Scalar, Model::kLandmarkDim>;

template <class Model>
void append_landmark(Model& model, const ErrorRowsOf<Model>& rows,
                     const typename Model::LandmarkMatrix& noise) {
  append_error_rows(model.covariance(), rows, noise);
  model.count_landmark();
}

/// The landmark placed last was seen by a sensor that tilts with the vehicle, `seen` away from it
/// in the world's axes: its error has the tilt's part.
template <class Model>
void add_tilt_rows(const Model& model, const typename Model::LandmarkVector& seen,
                   ErrorRowsOf<Model>& rows) {
  if constexpr (Model::kTiltStates > 0) {
    if (!model.tilts()) return;
    using T = typename Model::Scalar;
    const TiltAxes<T> axes = model.tilt_axes(model.frame());
    for (int k = 0; k < 2; ++k) {
      const T* a = axes.axis(k);
      rows.add(0, Model::kTiltState + k, a[1] * seen(2) - a[2] * seen(1));
      rows.add(1, Model::kTiltState + k, a[2] * seen(0) - a[0] * seen(2));
      rows.add(2, Model::kTiltState + k, a[0] * seen(1) - a[1] * seen(0));
    }
  } else {
    static_cast<void>(model);
    static_cast<void>(seen);
    static_cast<void>(rows);
  }
}

/// A landmark seen from the vehicle at `y` with noise `R`, both in the vehicle's axes.
template <class Model>
void append_seen(Model& model, const typename Model::LandmarkVector& y,
                 const typename Model::LandmarkMatrix& R) {
  using LandmarkMatrix = typename Model::LandmarkMatrix;
  const LandmarkMatrix rotation = model.vehicle_axes();
  model.place_beside_vehicle(rotation, y);
  ErrorRowsOf<Model> rows;
  model.rows_beside_vehicle(model.landmark_count(), rows);
  add_tilt_rows(model, rotation * y, rows);
  const LandmarkMatrix half = rotation * R;
  append_landmark(model, rows, LandmarkMatrix(half * rotation.transpose()));
}

/// The same with an error that depends on the path from the landmark `past` to the vehicle,
/// `by_path` = d y / d path in the vehicle's axes.
template <class Model>
void append_seen_on_path(Model& model, const typename Model::LandmarkVector& y,
                         const typename Model::LandmarkMatrix& R, int past,
                         const Matrix<typename Model::Scalar, Model::kLandmarkDim, 2>& by_path) {
  using T = typename Model::Scalar;
  using LandmarkMatrix = typename Model::LandmarkMatrix;
  constexpr int kDim = Model::kLandmarkDim;
  const LandmarkMatrix rotation = model.vehicle_axes();
  model.place_beside_vehicle(rotation, y);
  ErrorRowsOf<Model> rows;
  model.rows_beside_vehicle(model.landmark_count(), rows);
  add_tilt_rows(model, rotation * y, rows);
  const Matrix<T, kDim, 2> turned = rotation * by_path;
  const Matrix<T, kDim, 2> by_world =
      turned * model.level_axes().template topLeftCorner<2, 2>().transpose();
  for (int i = 0; i < kDim; ++i) {
    for (int k = 0; k < 2; ++k) {
      rows.add(i, Model::kPositionState + k, by_world(i, k));
      rows.add(i, model.state_of(past) + k, -by_world(i, k));
    }
  }
  const LandmarkMatrix half = rotation * R;
  append_landmark(model, rows, LandmarkMatrix(half * rotation.transpose()));
}

/// A landmark known in the world whose error is that of the landmark `reference` (-1: none) plus an
/// independent part.
template <class Model>
void append_of_world(Model& model, const typename Model::LandmarkVector& p_world,
                     const typename Model::LandmarkMatrix& covariance, int reference) {
  using T = typename Model::Scalar;
  model.join_world();
  model.place_in_world(p_world);
  ErrorRowsOf<Model> rows;
  model.rows_in_world(model.landmark_count(), rows, T(1));
  if (reference >= 0) {
    model.rows_in_world(reference, rows, T(-1));
    for (int i = 0; i < Model::kLandmarkDim; ++i) {
      rows.add(i, model.state_of(reference) + i, T(1));
    }
  }
  append_landmark(model, rows, covariance);
}

/// A landmark that moves with the vehicle's error, or with that of the landmark `reference` (-1:
/// none) as the vehicle's heading turns it, plus an independent part in the world's axes.
template <class Model>
void append_beside_vehicle(Model& model, const typename Model::LandmarkVector& p_world,
                           const typename Model::LandmarkMatrix& covariance, int reference) {
  using T = typename Model::Scalar;
  model.place_in_world(p_world);
  ErrorRowsOf<Model> rows;
  model.rows_beside_vehicle(model.landmark_count(), rows);
  if (reference >= 0) {
    ErrorRowsOf<Model> there;
    model.rows_beside_vehicle(reference, there);
    for (int i = 0; i < Model::kLandmarkDim; ++i) {
      for (int k = 0; k < there.count[i]; ++k) {
        rows.add(i, there.index[i][k], -there.weight[i][k]);
      }
      rows.add(i, model.state_of(reference) + i, T(1));
    }
  }
  append_landmark(model, rows, covariance);
}

/// Place of a point in the frame held by the landmarks `origin` and `ahead`: p = origin + lambda
/// (ahead - origin) in complex numbers of the plane. False when both are in one place.
template <class Model>
bool place_in_frame(const Model& model, const typename Model::LandmarkVector& p_world, int origin,
                    int ahead, typename Model::Scalar (&lambda)[2]) {
  using T = typename Model::Scalar;
  const T* a = model.landmark(origin);
  const T* b = model.landmark(ahead);
  const T arm[2] = {b[0] - a[0], b[1] - a[1]};
  const T squared = square(arm[0]) + square(arm[1]);
  if (!(squared > T(0))) return false;
  const T d[2] = {p_world(0) - model.anchor()[0] - a[0], p_world(1) - model.anchor()[1] - a[1]};
  lambda[0] = (d[0] * arm[0] + d[1] * arm[1]) / squared;
  lambda[1] = (d[1] * arm[0] - d[0] * arm[1]) / squared;
  return true;
}

/// A landmark known in the world whose error is what turn and offset of such a frame make of it,
/// (1 - lambda) that of origin + lambda that of ahead, plus an independent part. Nothing turns with
/// the error of the heading here: in the group's error, xi = p - R(e) p^, the terms -J p^ e of
/// origin, ahead and landmark cancel.
template <class Model>
void append_of_frame(Model& model, const typename Model::LandmarkVector& p_world,
                     const typename Model::LandmarkMatrix& covariance, int origin, int ahead,
                     const typename Model::Scalar (&lambda)[2]) {
  using T = typename Model::Scalar;
  model.place_in_world(p_world);
  const int at_origin = model.state_of(origin);
  const int at_ahead = model.state_of(ahead);
  ErrorRowsOf<Model> rows;
  for (int i = 0; i < 2; ++i) {
    const T across = i == 0 ? -lambda[1] : lambda[1];
    rows.add(i, at_origin + i, T(1) - lambda[0]);
    rows.add(i, at_origin + 1 - i, -across);
    rows.add(i, at_ahead + i, lambda[0]);
    rows.add(i, at_ahead + 1 - i, across);
  }
  if constexpr (Model::kLandmarkDim > 2) rows.add(2, at_origin + 2, T(1));
  append_landmark(model, rows, covariance);
}

/// Noise of such a frame: an offset of `position_variance` per axis, a turn about the vehicle of
/// `heading_variance`.
template <class Model>
void widen_frame(Model& model, int origin, int ahead, typename Model::Scalar position_variance,
                 typename Model::Scalar heading_variance) {
  using T = typename Model::Scalar;
  const int slots[2] = {origin, ahead};
  const T* x = model.vehicle();
  auto& P = model.covariance();
  T by_turn[4];
  for (int k = 0; k < 2; ++k) {
    by_turn[2 * k] = x[1] - model.landmark(slots[k])[1];
    by_turn[2 * k + 1] = model.landmark(slots[k])[0] - x[0];
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) {
      const T shift = i % 2 == j % 2 ? position_variance : T(0);
      P(model.state_of(slots[i / 2]) + i % 2, model.state_of(slots[j / 2]) + j % 2) +=
          shift + by_turn[i] * heading_variance * by_turn[j];
    }
  }
  if constexpr (Model::kLandmarkDim > 2) {
    const int height = model.state_of(origin) + 2;
    P(height, height) += position_variance;
  }
}

}  // namespace cairn::detail
