#pragma once

#include <cstdint>

#include "cairn/c_api/types.h"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/vision/image.hpp"

namespace cairn::c_api {

inline cairn_status to_c(Status status) {
  return static_cast<cairn_status>(status);
}

cairn_transform to_c(const Rigid<float>& T_a_b);
Rigid<float> from_c(const cairn_transform& T_a_b);
PinholeCamera<float> from_c(const cairn_camera& camera);

inline ImageView from_c(const cairn_image& image) {
  return {image.data, image.width, image.height, image.stride};
}

/// A canvas of the camera's size, or an invalid view.
inline MutableImageView from_c(const cairn_canvas& canvas, const PinholeCamera<float>& camera) {
  const bool good = canvas.data != nullptr && canvas.width == camera.width &&
                    canvas.height == camera.height && canvas.stride >= canvas.width;
  return good ? MutableImageView{canvas.data, canvas.width, canvas.height, canvas.stride}
              : MutableImageView{};
}

cairn_report to_c(const FrameReport& report);

/// `position` and `covariance` in the filter's frame; T_world_map: the map's frame in it.
cairn_landmark to_c(std::uint32_t id, const Vector3<float>& position,
                    const Matrix3<float>& covariance, const Rigid<float>& T_world_map);

}  // namespace cairn::c_api
