#pragma once

#include <opencv2/core.hpp>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/vision/image.hpp"

namespace cairn::host {

inline PinholeCamera<float> to_float(const PinholeCamera<double>& camera) {
  PinholeCamera<float> c;
  c.fx = static_cast<float>(camera.fx);
  c.fy = static_cast<float>(camera.fy);
  c.cx = static_cast<float>(camera.cx);
  c.cy = static_cast<float>(camera.cy);
  c.k1 = static_cast<float>(camera.k1);
  c.k2 = static_cast<float>(camera.k2);
  c.p1 = static_cast<float>(camera.p1);
  c.p2 = static_cast<float>(camera.p2);
  c.k3 = static_cast<float>(camera.k3);
  c.k4 = static_cast<float>(camera.k4);
  c.k5 = static_cast<float>(camera.k5);
  c.k6 = static_cast<float>(camera.k6);
  c.lens = camera.lens;
  c.width = camera.width;
  c.height = camera.height;
  return c;
}

inline Rigid<float> to_float(const Rigid<double>& T) {
  return {T.rotation.cast<float>(), T.translation.cast<float>()};
}

/// The rotation of unit length in double.
inline Rigid<double> to_double(const Rigid<float>& T) {
  return {T.rotation.cast<double>().normalized(), T.translation.cast<double>()};
}

inline ImageView to_view(const cv::Mat& grey) {
  return {grey.data, grey.cols, grey.rows, static_cast<int>(grey.step)};
}

inline MutableImageView to_mutable_view(cv::Mat& grey) {
  return {grey.data, grey.cols, grey.rows, static_cast<int>(grey.step)};
}

}  // namespace cairn::host
