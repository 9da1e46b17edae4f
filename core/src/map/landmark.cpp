#include "cairn/map/landmark.hpp"

namespace cairn {
namespace {

constexpr int kOrientationBins = 256;
constexpr int kScaleStepsPerOctave = 16;

template <class T>
T focal(const PinholeCamera<T>& camera) {
  return T(0.5) * (camera.fx + camera.fy);
}

template <class T>
T bin_angle(std::uint8_t bin) {
  return kTwoPi<T> / T(kOrientationBins) * static_cast<T>(bin);
}

template <class T>
std::uint8_t angle_bin(T angle) {
  const int bin = round_to_int(angle * (T(kOrientationBins) / kTwoPi<T>));
  return static_cast<std::uint8_t>(static_cast<unsigned>(bin) & (kOrientationBins - 1U));
}

}  // namespace

template <class T>
Status predict_view(const PinholeCamera<T>& camera, const Rigid<T>& T_map_camera,
                    const Vector3<T>& p_map, const LandmarkView<T>& view,
                    ViewPrediction<T>& prediction) {
  const Vector3<T> p_camera = T_map_camera.inverse() * p_map;
  Vector2<T> pixel;
  Matrix<T, 2, 3> jacobian;
  const Status status = camera.project(p_camera, pixel, jacobian);
  if (!ok(status)) return status;
  const Vector3<T> p_reference = view.T_map_reference.inverse() * p_map;
  if (!(p_reference.z() >= PinholeCamera<T>::kMinDepth)) return Status::kOutOfView;
  T sine = T(0);
  T cosine = T(1);
  sin_cos(bin_angle<T>(view.pose.orientation_bin), sine, cosine);
  Vector3<T> axis(cosine, sine, T(0));
  // Moving along the ray does not move the pixel.
  axis -= (axis.dot(p_reference) / p_reference.squaredNorm()) * p_reference;
  const Quaternion<T> R_camera_reference =
      T_map_camera.rotation.conjugate() * view.T_map_reference.rotation;
  const Vector2<T> in_image = jacobian * (R_camera_reference * axis);

  const Vector3<T> to_camera = T_map_camera.translation - p_map;
  const Vector3<T> to_reference = view.T_map_reference.translation - p_map;
  const T cosine_of_view =
      to_camera.dot(to_reference) / sqrt(to_camera.squaredNorm() * to_reference.squaredNorm());
  const T scale_ratio = (focal(camera) * p_reference.z()) / (view.focal_px * p_camera.z());
  if (!is_finite(pixel.sum() + scale_ratio + cosine_of_view)) return Status::kOutOfView;
  prediction.pixel = pixel;
  prediction.p_camera = p_camera;
  prediction.cosine = cosine_of_view;
  prediction.scale_ratio = scale_ratio;
  const T octaves = log(prediction.scale_ratio) * static_cast<T>(1.44269504088896341);
  const int index = view.pose.scale_index + round_to_int(octaves * T(kScaleStepsPerOctave));
  prediction.pose.scale_index = static_cast<std::uint8_t>(clamp(index, 0, kMaxFreakScaleIndex));
  prediction.pose.orientation_bin = angle_bin(atan2(in_image.y(), in_image.x()));
  return Status::kOk;
}

template Status predict_view(const PinholeCamera<float>&, const Rigid<float>&,
                             const Vector3<float>&, const LandmarkView<float>&,
                             ViewPrediction<float>&);
template Status predict_view(const PinholeCamera<double>&, const Rigid<double>&,
                             const Vector3<double>&, const LandmarkView<double>&,
                             ViewPrediction<double>&);

}  // namespace cairn
