#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"

namespace cairn::test {

/// 640x480, no distortion.
template <class T>
PinholeCamera<T> vga_camera(T focal_px = T(500)) {
  PinholeCamera<T> camera;
  camera.fx = focal_px;
  camera.fy = focal_px;
  camera.cx = T(320);
  camera.cy = T(240);
  camera.width = 640;
  camera.height = 480;
  return camera;
}

/// R_vehicle_camera of a camera that looks along the vehicle's x axis.
template <class T>
Matrix3<T> looking_ahead() {
  Matrix3<T> R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

}  // namespace cairn::test
