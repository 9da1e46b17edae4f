// ViSP's JSON of a camera: px, py, u0, v0.
#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

PinholeCamera<double> read_visp(const CameraSection& root) {
  PinholeCamera<double> camera;
  static_cast<void>(read_lens_model(root));
  camera.fx = root.number("px", "the focal length, px");
  camera.fy = root.number("py", "the focal length, px");
  camera.cx = root.number("u0", "the principal point, px");
  camera.cy = root.number("v0", "the principal point, px");
  camera.width = root.extent("w", "the image width, px");
  camera.height = root.extent("h", "the image height, px");
  for (const char* key : {"kud", "kdu"}) {
    if (root.has(key) && !root.is_zero(key)) {
      root.fail(key, "expected 0: ViSP's distortion is not read; found " + root.shown(key));
    }
  }
  refuse_unread_lens_keys(root);
  return camera;
}

}  // namespace

const CameraFormat kVispFormat{
    "ViSP", "px",
    [](const CameraSection& root) { return root.has("px") || root.has("py") || root.has("u0"); },
    read_visp};

}  // namespace cairn::host
