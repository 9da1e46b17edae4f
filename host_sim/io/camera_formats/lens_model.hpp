#pragma once

#include <string>
#include <vector>

#include "cairn/geometry/camera.hpp"

#include "host_sim/io/camera_formats/camera_section.hpp"

namespace cairn::host {

// What all formats of camera files share about lenses. A key that speaks of the lens is read or
// refused: no coefficient is dropped, and no lens model is taken for another one. Everything here
// throws InputError naming the key.

/// How far a file says which lens model it means.
enum class LensModel {
  kUnstated,          ///< k1 k2 p1 p2 [k3 [k4 k5 k6]], as in OpenCV
  kNone,              ///< no distortion
  kRadialTangential,  ///< k1 k2 p1 p2 [k3]
  kRational,          ///< k1 k2 p1 p2 k3 k4 k5 k6
  kFisheye,           ///< Kannala-Brandt (equidistant), k1 k2 k3 k4
};

/// Reads every key of `section` that names a camera or lens model (`distortion_model`,
/// `camera_model`, `Camera.type`, `model_type`, `fisheye_model`, ...) and refuses what is neither
/// pinhole nor one of LensModel, and two that contradict one another.
LensModel read_lens_model(const CameraSection& section);

/// What a single model's name says; `key` is for the message.
LensModel lens_model_named(const CameraSection& section, const std::string& key,
                           const std::string& name);

/// Sets the lens from OpenCV's order of coefficients: none, or 4, 5, 8, 12 or 14 (those behind k6
/// 0); of a fisheye none or 4.
void set_distortion(const CameraSection& section, const std::string& key, LensModel model,
                    const std::vector<double>& coefficients, PinholeCamera<double>& camera);

/// Reads the list of coefficients under any of its usual names (`distortion_coefficients`,
/// `distortion_coeffs`, `dist_coeff`, `distCoeffs`, `D`, ...), where there is one.
void read_distortion_list(const CameraSection& section, LensModel model,
                          PinholeCamera<double>& camera);

/// Whether there is a key of read_distortion_keys().
bool has_distortion_keys(const CameraSection& section, const std::string& prefix);

/// Reads `prefix`k1, k2, p1, p2 and k3, where they are, and k4 to k6 where the model has them or
/// all three are there; of a fisheye k1 to k4.
void read_distortion_keys(const CameraSection& section, const std::string& prefix, LensModel model,
                          PinholeCamera<double>& camera);

/// Refuses unread keys that speak of the lens (k7, xi, dist..., skew, ...) unless their values are
/// all 0. Keys are looked at without `prefix`; those with another prefix belong to another camera.
void refuse_unread_lens_keys(const CameraSection& section, const std::string& prefix = {});

/// Width and height of the picture: two keys, such as `width` and `height`, `image_width` and
/// `image_height`, `cols` and `rows`, or a list of both (`resolution`, `image_size`).
void read_picture_size(const CameraSection& section, const std::string& prefix,
                       PinholeCamera<double>& camera);

/// fx, fy, cx, cy of a 3x3 camera matrix that is checked element by element.
void read_camera_matrix(const CameraSection& section, const std::string& key,
                        PinholeCamera<double>& camera);

/// fx, fy, cx, cy of a list in this order.
void read_intrinsics_list(const CameraSection& section, const std::string& key,
                          PinholeCamera<double>& camera);

}  // namespace cairn::host
