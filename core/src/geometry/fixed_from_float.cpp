#include <cstring>

#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/numeric/float_bits.hpp"

namespace cairn {
namespace {

using Count = std::uint32_t;

/// Whether a float is +-0, by its bits.
bool is_zero(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return (bits << 1U) == 0U;
}

}  // namespace

Status fixed_of(const PinholeCamera<float>& camera, FixedCamera& out) {
  const bool rational = !is_zero(camera.k4) || !is_zero(camera.k5) || !is_zero(camera.k6);
  if (camera.lens != Lens::kRadialTangential || rational) return Status::kBadConfig;
  Count lost = 0;
  FixedCamera fixed;
  fixed.fx = fixed_of<FixedPixel>(camera.fx, lost);
  fixed.fy = fixed_of<FixedPixel>(camera.fy, lost);
  fixed.cx = fixed_of<FixedPixel>(camera.cx, lost);
  fixed.cy = fixed_of<FixedPixel>(camera.cy, lost);
  fixed.k1 = fixed_of<FixedTangent>(camera.k1, lost);
  fixed.k2 = fixed_of<FixedTangent>(camera.k2, lost);
  fixed.p1 = fixed_of<FixedTangent>(camera.p1, lost);
  fixed.p2 = fixed_of<FixedTangent>(camera.p2, lost);
  fixed.k3 = fixed_of<FixedTangent>(camera.k3, lost);
  fixed.width = camera.width;
  fixed.height = camera.height;
  if (lost != 0) return Status::kBadConfig;
  out = fixed;
  return Status::kOk;
}

FixedMount fixed_of(const Rigid<float>& T_vehicle_camera, Count& saturations) {
  FixedMount out;
  const Quaternion<float>& q = T_vehicle_camera.rotation;
  out.w = fixed_of<FixedRatio>(q.w(), saturations);
  out.x = fixed_of<FixedRatio>(q.x(), saturations);
  out.y = fixed_of<FixedRatio>(q.y(), saturations);
  out.z = fixed_of<FixedRatio>(q.z(), saturations);
  for (int axis = 0; axis < 3; ++axis) {
    out.origin[axis] = fixed_of<FixedLength>(T_vehicle_camera.translation(axis), saturations);
  }
  return out;
}

}  // namespace cairn
