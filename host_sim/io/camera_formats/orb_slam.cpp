// ORB-SLAM2 writes Camera.fx, ORB-SLAM3 also Camera1.fx; the plain format is the same without
// prefix.
#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

bool has_any(const CameraSection& root, const std::string& prefix) {
  return root.has(prefix + "fx") || root.has(prefix + "fy") || root.has(prefix + "cx");
}

/// Intrinsics under `prefix`; the size under `size_prefix`.
PinholeCamera<double> read_keys(const CameraSection& root, const std::string& prefix,
                                const std::string& size_prefix) {
  PinholeCamera<double> camera;
  const LensModel model = read_lens_model(root);
  camera.fx = root.number(prefix + "fx", "the focal length, px");
  camera.fy = root.number(prefix + "fy", "the focal length, px");
  camera.cx = root.number(prefix + "cx", "the principal point, px");
  camera.cy = root.number(prefix + "cy", "the principal point, px");
  camera.width = root.extent(size_prefix + "width", "the image width, px");
  camera.height = root.extent(size_prefix + "height", "the image height, px");
  read_distortion_keys(root, prefix, model, camera);
  if (prefix.empty() && !has_distortion_keys(root, prefix)) {
    read_distortion_list(root, model, camera);
  }
  refuse_unread_lens_keys(root, prefix);
  return camera;
}

}  // namespace

const CameraFormat kOrbSlamFormat{
    "ORB-SLAM", "Camera.fx or Camera1.fx",
    [](const CameraSection& root) { return has_any(root, "Camera.") || has_any(root, "Camera1."); },
    [](const CameraSection& root) {
      const bool numbered = has_any(root, "Camera1.");
      if (numbered && has_any(root, "Camera.")) {
        root.fail("Camera1.fx", "expected Camera1.fx or Camera.fx, found keys of both");
      }
      return read_keys(root, numbered ? "Camera1." : "Camera.", "Camera.");
    }};

const CameraFormat kPlainFormat{"plain", "fx",
                                [](const CameraSection& root) { return has_any(root, ""); },
                                [](const CameraSection& root) { return read_keys(root, "", ""); }};

}  // namespace cairn::host
