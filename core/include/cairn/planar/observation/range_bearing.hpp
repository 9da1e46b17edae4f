#pragma once

#include "cairn/base/status.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/planar/observation/linearised_observation.hpp"

namespace cairn {

/// A landmark seen in range (m) and bearing (rad, positive to the left) from a sensor on the
/// vehicle's x axis.
template <class T>
struct RangeBearingObservation {
  LandmarkId id = kNoLandmark;
  T range = T(0);
  T bearing = T(0);
  T sigma_range = T(0);
  T sigma_bearing = T(0);
};

/// Range and bearing at which a landmark is expected, with their covariance: the input of a data
/// association.
template <class T>
struct RangeBearingPrediction {
  T range = T(0);
  T bearing = T(0);
  Matrix2<T> covariance = Matrix2<T>::Zero();  ///< innovation covariance, m^2, m rad, rad^2
};

/// Observation model (see PlanarSlam::update()) of RangeBearingObservation, from a sensor
/// `offset_m` ahead of the vehicle's centre.
template <class T>
struct RangeBearingSensor {
  T offset_m = T(0);

  /// kNonFiniteInput, or kInvalidArgument for a range or sigma that is not positive or a bearing
  /// beyond 1e4 rad.
  Status check(const RangeBearingObservation<T>& o) const {
    if (!is_finite(offset_m) || !is_finite(o.range) || !is_finite(o.bearing) ||
        !is_finite(o.sigma_range) || !is_finite(o.sigma_bearing)) {
      return Status::kNonFiniteInput;
    }
    const bool valid = o.range > T(0) && o.sigma_range > T(0) && o.sigma_bearing > T(0) &&
                       abs(o.bearing) <= T(1e4);
    return valid ? Status::kOk : Status::kInvalidArgument;
  }

  /// False when the predicted range is below 5 cm: no bearing there.
  template <int Dim>
  bool linearise(const RangeBearingObservation<T>& observation, const RelativeFrame<T>& frame,
                 const T* relative, const RelativeCovariance<T>&,
                 LinearisedObservation<T, Dim>& out) const {
    T body[2];
    frame.to_body(relative, body);
    body[0] -= offset_m;
    const T squared = body[0] * body[0] + body[1] * body[1];
    if (!(squared > T(0.0025))) return false;
    const T range = sqrt(squared);
    out.direct = false;
    out.innovation[0] = observation.range - range;
    out.innovation[1] = wrap_angle(observation.bearing - atan2(body[1], body[0]));
    const T inverse = T(1) / range;
    const T x = body[0] * inverse;
    const T y = body[1] * inverse;
    out.h[0][0] = x;
    out.h[0][1] = y;
    out.h[1][0] = -y * inverse;
    out.h[1][1] = x * inverse;
    frame.row_to_relative(out.h[0][0], out.h[0][1]);
    frame.row_to_relative(out.h[1][0], out.h[1][1]);
    if constexpr (Dim > 2) {
      out.h[0][2] = T(0);
      out.h[1][2] = T(0);
    }
    out.r00 = square(observation.sigma_range);
    out.r01 = T(0);
    out.r11 = square(observation.sigma_bearing);
    return true;
  }
};

}  // namespace cairn
