#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/vision/freak.hpp"

namespace cairn {

/// How a landmark looked when it was described, and from where: what is needed to steer the
/// descriptor in another view.
template <class T>
struct LandmarkView {
  Descriptor descriptor;
  FreakPose pose;            ///< the pattern's pose at description: reference roll and scale
  T focal_px = T(0);         ///< mean focal length of the camera at description
  Rigid<T> T_map_reference;  ///< camera pose at description: distance and viewing direction
};

/// One archived landmark. `Views`: descriptors kept for it.
template <class T, int Views = 1>
struct LibraryLandmark {
  static constexpr int kViews = Views;
  LandmarkId id = kNoLandmark;
  Vector3<T> p_map = Vector3<T>::Zero();       ///< m, in the map's frame
  Matrix3<T> covariance = Matrix3<T>::Zero();  ///< own part, beside the map as a whole, m^2
  std::uint16_t sightings = 0;                 ///< searches that found it; saturates
  std::uint16_t searches = 0;                  ///< saturates, with sightings halved too
  std::uint8_t view_count = 0;                 ///< 1 .. Views
  LandmarkView<T> views[Views];

  /// Counts a search for it, and whether it was found.
  void record(bool seen) {
    if (searches == 0xFFFFU) {
      searches = static_cast<std::uint16_t>(searches / 2);
      sightings = static_cast<std::uint16_t>(sightings / 2);
    }
    ++searches;
    if (seen) ++sightings;
  }
};

/// Score of a landmark by itself, 0 .. 65535: the product of
///   reliability (sightings + 1) / (searches + 2),
///   sightings   1/4 + 3/4 min(sightings, 16) / 16,
///   precision   1 / (1 + (s / 4 px)^2), s the rms deviation of the point seen from its first view.
template <class T, int Views>
int landmark_score(const LibraryLandmark<T, Views>& landmark) {
  constexpr int kFullSightings = 16;
  constexpr int kHalfPrecisionPx = 4;
  const LandmarkView<T>& view = landmark.views[0];
  const T distance_squared = (view.T_map_reference.translation - landmark.p_map).squaredNorm();
  const T variance_px =
      landmark.covariance.trace() / T(3) * view.focal_px * view.focal_px / distance_squared;
  const T precision = T(1) / (T(1) + variance_px / T(kHalfPrecisionPx * kHalfPrecisionPx));
  const T reliability =
      static_cast<T>(landmark.sightings + 1) / static_cast<T>(landmark.searches + 2);
  const int seen = landmark.sightings < kFullSightings ? landmark.sightings : kFullSightings;
  const T sightings = T(0.25) + T(0.75) * static_cast<T>(seen) / T(kFullSightings);
  return clamp(round_to_int(T(65535) * reliability * sightings * precision), 0, 65535);
}

/// Where and how a landmark's view should be described in another image.
template <class T>
struct ViewPrediction {
  Vector2<T> pixel = Vector2<T>::Zero();
  Vector3<T> p_camera = Vector3<T>::Zero();
  FreakPose pose;        ///< steered pattern pose, scale clamped to what the pattern can do
  T scale_ratio = T(1);  ///< image scale now over image scale at description
  T cosine = T(1);       ///< of the angle between the directions of view, now and then
};

/// Largest pattern scale index of describe_freak.
inline constexpr int kMaxFreakScaleIndex = 24;

/// Predicts pixel, roll and scale of a view from another camera pose. Roll: the direction that the
/// orientation bin had in the reference image, put on a plane facing the reference camera,
/// projected again. Scale index = reference + 16 log2(scale_ratio), scale_ratio = (f / z) / (f_ref
/// / z_ref). kOutOfView, output untouched, when the point has no pixel in one of the two cameras,
/// or is so far away that numbers overflow; the pixel may lie outside the image.
template <class T>
Status predict_view(const PinholeCamera<T>& camera, const Rigid<T>& T_map_camera,
                    const Vector3<T>& p_map, const LandmarkView<T>& view,
                    ViewPrediction<T>& prediction);

extern template Status predict_view(const PinholeCamera<float>&, const Rigid<float>&,
                                    const Vector3<float>&, const LandmarkView<float>&,
                                    ViewPrediction<float>&);
extern template Status predict_view(const PinholeCamera<double>&, const Rigid<double>&,
                                    const Vector3<double>&, const LandmarkView<double>&,
                                    ViewPrediction<double>&);

}  // namespace cairn
