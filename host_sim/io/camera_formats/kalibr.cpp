// Kalibr's camchain (cam0, cam1, ...) and, with the same words at the top, EuRoC's sensor.yaml.
#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

PinholeCamera<double> read_camera(const CameraSection& section) {
  PinholeCamera<double> camera;
  const LensModel model = read_lens_model(section);
  read_intrinsics_list(section, "intrinsics", camera);
  const std::vector<double> resolution = section.numbers("resolution", "width, height");
  if (resolution.size() != 2) section.fail("resolution", "expected width, height");
  camera.width = section.to_extent(resolution[0], "resolution");
  camera.height = section.to_extent(resolution[1], "resolution");
  read_distortion_list(section, model, camera);
  refuse_unread_lens_keys(section);
  return camera;
}

}  // namespace

const CameraFormat kKalibrFormat{"Kalibr or EuRoC", "cam0.intrinsics",
                                 [](const CameraSection& root) {
                                   return !root.one_of({"cam0", "intrinsics"}).empty();
                                 },
                                 [](const CameraSection& root) {
                                   return read_camera(root.has("cam0") ? root.child("cam0") : root);
                                 }};

}  // namespace cairn::host
