#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// What careful calibration leaves of a vehicle: errors that last as long as the drive, which white
/// noise does not model and of which the filter has no states. They turn and scale the whole
/// estimate, map and path alike, about its start; no sighting shows them.
struct SystematicError {
  float scale = 0.03F;       ///< of distances: wheels, their load and slip; standard deviation
  float yaw_rad = 0.0087F;   ///< of the camera against the direction of travel
  float position_m = 0.01F;  ///< of the vehicle's origin against its wheels, per axis

  /// kBadConfig unless every value is finite and not negative.
  Status validate() const {
    const bool good = is_finite(scale) && scale >= 0.0F && is_finite(yaw_rad) && yaw_rad >= 0.0F &&
                      is_finite(position_m) && position_m >= 0.0F;
    return good ? Status::kOk : Status::kBadConfig;
  }

  /// Covariance over (x, y, heading) that they add to a pose `since_start` (m) from the start.
  Matrix3<float> covariance(const Vector2<float>& since_start) const {
    const float x = since_start.x();
    const float y = since_start.y();
    const Vector3<float> by_scale(scale * x, scale * y, 0.0F);
    const Vector3<float> by_yaw(-yaw_rad * y, yaw_rad * x, 0.0F);
    Matrix3<float> sum = by_scale * by_scale.transpose() + by_yaw * by_yaw.transpose();
    sum(0, 0) += square(position_m);
    sum(1, 1) += square(position_m);
    sum(2, 2) += square(yaw_rad);
    return sum;
  }
};

}  // namespace cairn
