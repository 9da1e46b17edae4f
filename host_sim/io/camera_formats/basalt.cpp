// basalt's calibration.json: value0 with intrinsics and resolution of every camera; the first is
// read.
#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

PinholeCamera<double> read_basalt(const CameraSection& root) {
  PinholeCamera<double> camera;
  const CameraSection value = root.child("value0");
  const CameraSection first = value.element("intrinsics", 0);
  const std::string type = first.text("camera_type", "the camera's model");
  const LensModel model = lens_model_named(first, "camera_type", type);
  const CameraSection intrinsics = first.child("intrinsics");
  camera.fx = intrinsics.number("fx", "the focal length, px");
  camera.fy = intrinsics.number("fy", "the focal length, px");
  camera.cx = intrinsics.number("cx", "the principal point, px");
  camera.cy = intrinsics.number("cy", "the principal point, px");
  read_distortion_keys(intrinsics, "", model, camera);
  // The radius that basalt uses the model to; the fold of the polynomial is checked anyway.
  if (intrinsics.has("rpmax")) static_cast<void>(intrinsics.number("rpmax", "a radius"));
  refuse_unread_lens_keys(intrinsics);
  const std::vector<double> sides = value.numbers("resolution", "width, height of each camera");
  if (sides.size() < 2) value.fail("resolution", "expected width, height of each camera");
  camera.width = value.to_extent(sides[0], "resolution");
  camera.height = value.to_extent(sides[1], "resolution");
  return camera;
}

}  // namespace

const CameraFormat kBasaltFormat{"basalt", "value0.intrinsics",
                                 [](const CameraSection& root) { return root.has("value0"); },
                                 read_basalt};

}  // namespace cairn::host
