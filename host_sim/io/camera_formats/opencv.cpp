// OpenCV's calibration program and cv::FileStorage; ROS camera_info uses the same words.
#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

std::string matrix_key(const CameraSection& root) {
  return root.one_of(
      {"camera_matrix", "Camera_Matrix", "cameraMatrix", "CameraMatrix", "mtx", "K", "k"});
}

/// A camera_info of a cropped picture describes the whole sensor, not the picture.
void refuse_crop(const CameraSection& root, const PinholeCamera<double>& camera) {
  if (!root.has("roi")) return;
  const CameraSection roi = root.child("roi");
  for (const char* key : {"x_offset", "y_offset", "width", "height"}) {
    if (!roi.has(key) || roi.is_zero(key)) continue;
    const double value = roi.number(key, "a number of pixels");
    if (key[0] == 'w' && value == camera.width) continue;
    if (key[0] == 'h' && value == camera.height) continue;
    roi.fail(key, "expected the whole picture, found " + roi.shown(key));
  }
}

PinholeCamera<double> read_opencv(const CameraSection& root) {
  PinholeCamera<double> camera;
  const LensModel model = read_lens_model(root);
  read_camera_matrix(root, matrix_key(root), camera);
  read_picture_size(root, "", camera);
  read_distortion_list(root, model, camera);
  refuse_crop(root, camera);
  refuse_unread_lens_keys(root);
  return camera;
}

}  // namespace

const CameraFormat kOpenCvFormat{
    "OpenCV or ROS", "camera_matrix",
    [](const CameraSection& root) { return !matrix_key(root).empty(); }, read_opencv};

}  // namespace cairn::host
