// VINS-Mono, VINS-Fusion and camodocal: model_type with projection_ and distortion_parameters.
#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

PinholeCamera<double> read(const CameraSection& root) {
  PinholeCamera<double> camera;
  const LensModel model = read_lens_model(root);
  camera.width = root.extent("image_width", "the image width, px");
  camera.height = root.extent("image_height", "the image height, px");
  const CameraSection projection = root.child("projection_parameters");
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
    [](const CameraSection& root) { return root.has("projection_parameters"); }, read};

}  // namespace cairn::host
