// VINS-Mono, VINS-Fusion and camodocal: model_type with projection_ and distortion_parameters.
#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

PinholeCamera<double> read_vins(const CameraSection& root) {
  PinholeCamera<double> camera;
  const LensModel model = read_lens_model(root);
  camera.width = root.extent("image_width", "the image width, px");
  camera.height = root.extent("image_height", "the image height, px");
  const CameraSection projection = root.child("projection_parameters");
  if (model == LensModel::kFisheye) {  // theta + k2 theta^3 + ... + k5 theta^9
    camera.fx = projection.number("mu", "the focal length, px");
    camera.fy = projection.number("mv", "the focal length, px");
    camera.cx = projection.number("u0", "the principal point, px");
    camera.cy = projection.number("v0", "the principal point, px");
    std::vector<double> coefficients;
    for (const char* key : {"k2", "k3", "k4", "k5"}) {
      coefficients.push_back(projection.number(key, "a distortion coefficient"));
    }
    set_distortion(projection, "k2", model, coefficients, camera);
    refuse_unread_lens_keys(projection);
    refuse_unread_lens_keys(root);
    return camera;
  }
  camera.fx = projection.number("fx", "the focal length, px");
  camera.fy = projection.number("fy", "the focal length, px");
  camera.cx = projection.number("cx", "the principal point, px");
  camera.cy = projection.number("cy", "the principal point, px");
  refuse_unread_lens_keys(projection);
  const CameraSection distortion = root.child("distortion_parameters");
  read_distortion_keys(distortion, "", model, camera);
  refuse_unread_lens_keys(distortion);
  refuse_unread_lens_keys(root);
  return camera;
}

}  // namespace

const CameraFormat kVinsFormat{
    "VINS", "projection_parameters",
    [](const CameraSection& root) { return root.has("projection_parameters"); }, read_vins};

}  // namespace cairn::host
