#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// Whether a rigid transform from outside is one: kNonFiniteInput; kBadConfig for a rotation whose
/// length is off 1 by more than 1e-3.
inline Status validate_mounting(const Rigid<float>& T_vehicle_camera) {
  const Quaternion<float>& q = T_vehicle_camera.rotation;
  const Vector3<float>& p = T_vehicle_camera.translation;
  for (const float value : {q.w(), q.x(), q.y(), q.z(), p.x(), p.y(), p.z()}) {
    if (!is_finite(value)) return Status::kNonFiniteInput;
  }
  const float length = q.norm();
  return abs(length - 1.0F) <= 1e-3F ? Status::kOk : Status::kBadConfig;
}

}  // namespace cairn
