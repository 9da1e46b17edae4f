#pragma once

#include <cstdint>

#include "cairn/ar/virtual_object.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"

namespace cairn_web {

/// A picture of red, green, blue, opacity of the camera's size, and a depth for each pixel.
struct ShadedPicture {
  std::uint8_t* colours;
  float* depths;
};

/// Clears the first `pixels` pixels: nothing there, infinitely far.
void clear(const ShadedPicture& picture, int pixels);

/// Fills the shadow that a light from above casts of the object on the plane that it stands on. To
/// be drawn before the objects. Faces that reach nearer than 5 cm to the camera's plane are left
/// out.
void fill_shadow(const cairn::VirtualObject& object, const cairn::Rigid<float>& T_camera_object,
                 const cairn::PinholeCamera<float>& camera, const ShadedPicture& picture);

/// Fills the faces that look at the camera, nearer ones over farther ones.
void fill_object(const cairn::VirtualObject& object, const cairn::Rigid<float>& T_camera_object,
                 const cairn::PinholeCamera<float>& camera, const ShadedPicture& picture);

}  // namespace cairn_web
