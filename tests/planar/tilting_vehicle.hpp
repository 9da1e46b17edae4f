#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/planar/tilt.hpp"

#include "vga_camera.hpp"

namespace cairn::planar_test {

/// A camera ahead of a car's rear axle that looks slightly down.
inline Rigid<double> mounting() {
  Rigid<double> T_vehicle_camera;
  T_vehicle_camera.rotation =
      Quaternion<double>(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()).toRotationMatrix() *
                         test::looking_ahead<double>());
  T_vehicle_camera.translation = {1.1, 0.2, 1.6};
  return T_vehicle_camera;
}

inline TiltParameters<double> suspension() {
  return {0.01, 0.015, 0.7};
}

}  // namespace cairn::planar_test
