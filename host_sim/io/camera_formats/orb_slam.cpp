// ORB-SLAM2 and OpenVSLAM write Camera.fx, ORB-SLAM3 also Camera1.fx, stella_vslam fx below Camera;
// the plain format is the same without prefix.
#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/camera_formats/lens_model.hpp"

namespace cairn::host {
namespace {

bool has_any(const CameraSection& root, const std::string& prefix) {
  return root.has(prefix + "fx") || root.has(prefix + "fy") || root.has(prefix + "cx");
}

bool is_nested(const CameraSection& root) {
  return root.has_child("Camera") && has_any(root.child("Camera"), "");
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
  read_picture_size(root, size_prefix, camera);
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
    [](const CameraSection& root) {
      return has_any(root, "Camera.") || has_any(root, "Camera1.") || is_nested(root);
    },
    [](const CameraSection& root) {
      if (is_nested(root)) return read_keys(root.child("Camera"), "", "");
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
