#pragma once

#include "cairn/base/status.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/numeric/positive_definite.hpp"
#include "cairn/planar/observation/linearised_observation.hpp"

namespace cairn {

/// A landmark seen as a Cartesian point in the vehicle frame (x forward, y left), m. Paper A's
/// observation, its equation (20).
template <class T>
struct PointObservation {
  LandmarkId id = kNoLandmark;
  Vector2<T> y = Vector2<T>::Zero();
  Matrix2<T> R = Matrix2<T>::Identity();  ///< noise covariance, vehicle frame, m^2
};

/// Observation model (see PlanarSlam::update()) of PointObservation: rotated into the relative
/// frame, the rows are the relative vector itself.
template <class T>
struct PointSensor {
  /// kNonFiniteInput, or kInvalidArgument when R is not positive definite.
  Status check(const PointObservation<T>& o) const {
    if (!all_finite(o.y) || !all_finite(o.R)) return Status::kNonFiniteInput;
    return positive_definite(o.R) ? Status::kOk : Status::kInvalidArgument;
  }

  template <int Dim>
  bool linearise(const PointObservation<T>& observation, const RelativeFrame<T>& frame,
                 const T* relative, const RelativeCovariance<T>&,
                 LinearisedObservation<T, Dim>& out) const {
    const T y[2] = {observation.y.x(), observation.y.y()};
    T turned[2];
    frame.to_relative(y, turned);
    out.direct = true;
    out.innovation[0] = turned[0] - relative[0];
    out.innovation[1] = turned[1] - relative[1];
    const T c = frame.cosine;
    const T s = frame.sine;
    const T a = observation.R(0, 0);
    const T b = observation.R(0, 1);
    const T d = observation.R(1, 1);
    out.r00 = c * c * a - T(2) * c * s * b + s * s * d;
    out.r01 = c * s * (a - d) + (c * c - s * s) * b;
    out.r11 = s * s * a + T(2) * c * s * b + c * c * d;
    return true;
  }
};

}  // namespace cairn
