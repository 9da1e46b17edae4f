#include "cairn/tracking/appearance.hpp"

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn {

template <class T>
Status predict_warp(const PinholeCamera<T>& camera, const Rigid<T>& T_world_reference,
                    const Rigid<T>& T_world_camera, const Vector3<T>& p_camera, Matrix2<T>& warp) {
  const Rigid<T> T_reference_camera = T_world_reference.inverse() * T_world_camera;
  const Vector3<T> p_reference = T_reference_camera * p_camera;
  Vector2<T> pixel;
  Matrix<T, 2, 3> jacobian_reference;
  Matrix<T, 2, 3> jacobian_camera;
  Status status = camera.project(p_reference, pixel, jacobian_reference);
  if (!ok(status)) return status;
  status = camera.project(p_camera, pixel, jacobian_camera);
  if (!ok(status)) return status;
  const Matrix2<T> gram = jacobian_reference * jacobian_reference.transpose();
  T i00, i01, i11;
  if (!invert_spd2(gram(0, 0), gram(0, 1), gram(1, 1), i00, i01, i11)) return Status::kDegenerate;
  Matrix2<T> inverse;
  inverse << i00, i01, i01, i11;
  const Matrix<T, 3, 2> lift = jacobian_reference.transpose() * inverse;
  const Matrix3<T> R_camera_reference = T_reference_camera.rotation.conjugate().toRotationMatrix();
  const Matrix<T, 3, 2> turned = R_camera_reference * lift;
  warp = jacobian_camera * turned;
  return Status::kOk;
}

template <class T>
T warp_scale(const Matrix2<T>& warp) {
  return sqrt(abs(warp(0, 0) * warp(1, 1) - warp(0, 1) * warp(1, 0)));
}

template <class T>
FreakPose steer(const Matrix2<T>& warp, int reference_scale_index) {
  constexpr T kBinsPerRadian = T(256) / kTwoPi<T>;
  constexpr T kStepsPerLog = T(16) * T(1.4426950408889634);
  const T roll = atan2(warp(1, 0) - warp(0, 1), warp(0, 0) + warp(1, 1));
  const T scale = warp_scale(warp);
  const int steps = scale > T(1e-3) ? round_to_int(kStepsPerLog * log(scale)) : -100;
  FreakPose pose;
  pose.orientation_bin = static_cast<std::uint8_t>(round_to_int(roll * kBinsPerRadian) & 255);
  pose.scale_index = static_cast<std::uint8_t>(clamp(reference_scale_index + steps, 0, 24));
  return pose;
}

template <class T>
bool to_patch_warp(const Matrix2<T>& warp, PatchWarp& fixed) {
  for (int r = 0; r < 2; ++r) {
    for (int c = 0; c < 2; ++c) {
      if (!(abs(warp(r, c)) < T(8))) return false;
    }
  }
  constexpr T kOne = T(65536);
  fixed.xx = round_to_int(warp(0, 0) * kOne);
  fixed.xy = round_to_int(warp(0, 1) * kOne);
  fixed.yx = round_to_int(warp(1, 0) * kOne);
  fixed.yy = round_to_int(warp(1, 1) * kOne);
  return true;
}

Status make_appearance(const ImageView& image, int x, int y, const Rigid<float>& T_world_camera,
                       Appearance& appearance) {
  const int margin = freak_margin(kReferenceScaleIndex);
  const bool fits =
      x >= margin && y >= margin && x <= image.width - margin && y <= image.height - margin;
  if (!fits) return Status::kOutOfView;
  return make_patch_appearance(image, x, y, T_world_camera, appearance);
}

Status make_patch_appearance(const ImageView& image, int x, int y,
                             const Rigid<float>& T_world_camera, Appearance& appearance) {
  Patch patch;
  const Status status = extract_patch(image, x * 256, y * 256, patch);
  if (!ok(status)) return status;
  FreakPose pose;
  pose.scale_index = kReferenceScaleIndex;
  appearance.descriptor = Descriptor{};
  appearance.has_descriptor = ok(describe_freak(image, x, y, pose, appearance.descriptor));
  appearance.patch = patch;
  appearance.T_world_reference = T_world_camera;
  appearance.scale_index = kReferenceScaleIndex;
  appearance.has_patch = true;
  return Status::kOk;
}

template Status predict_warp(const PinholeCamera<float>&, const Rigid<float>&, const Rigid<float>&,
                             const Vector3<float>&, Matrix2<float>&);
template Status predict_warp(const PinholeCamera<double>&, const Rigid<double>&,
                             const Rigid<double>&, const Vector3<double>&, Matrix2<double>&);
template FreakPose steer(const Matrix2<float>&, int);
template FreakPose steer(const Matrix2<double>&, int);
template float warp_scale(const Matrix2<float>&);
template double warp_scale(const Matrix2<double>&);
template bool to_patch_warp(const Matrix2<float>&, PatchWarp&);
template bool to_patch_warp(const Matrix2<double>&, PatchWarp&);

}  // namespace cairn
