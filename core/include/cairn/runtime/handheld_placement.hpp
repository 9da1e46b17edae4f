#pragma once

#include "cairn/ar/plane_fit.hpp"
#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {

/// A place for an object in front of a hand-held camera: on the plane of the features where most of
/// them lie on one, else upright at their median depth. False while fewer than ten features are
/// known to a fifth of their depth; `T_map_object` is then unchanged. `random`: the caller's own,
/// so that placing an object does not change the tracking. `filter`: MonoEkf or WindowTracker.
/// Cost: fit_plane() with all features.
template <class Filter>
bool place_on_features(const Filter& filter, Random& random, Rigid<float>& T_map_object) {
  constexpr int MaxFeatures = Filter::kMaxFeatures;
  static_assert(MaxFeatures <= kMaxPlanePoints, "the plane is fitted to all features");
  constexpr int kMinPoints = 10;
  const Rigid<float> T_map_camera = filter.T_world_camera();
  const Rigid<float> T_camera_map = T_map_camera.inverse();
  FixedVector<Vector3<float>, MaxFeatures> points;
  FixedVector<float, MaxFeatures> depths;
  for (int slot = 0; slot < filter.feature_count(); ++slot) {
    Vector3<float> p_map;
    Matrix3<float> covariance;
    if (!ok(filter.feature_position(slot, p_map, covariance))) continue;
    const float depth = (T_camera_map * p_map).z();
    const float trace = covariance(0, 0) + covariance(1, 1) + covariance(2, 2);
    if (!(depth > 0.0F) || !(trace < square(0.2F * depth))) continue;
    points.push_back(p_map);
    depths.push_back(depth);
    for (int i = depths.size() - 1; i > 0 && depths[i - 1] > depths[i]; --i) {
      const float swapped = depths[i];
      depths[i] = depths[i - 1];
      depths[i - 1] = swapped;
    }
  }
  if (points.size() < kMinPoints) return false;
  const float median = depths[depths.size() / 2];
  const Vector3<float> in_front = T_map_camera * Vector3<float>(0.0F, 0.0F, median);
  PlaneFitOptions options;
  options.inlier_m = 0.03F * median;
  options.min_inliers = points.size() * 2 / 3;
  PlaneFit plane;
  if (ok(fit_plane(points.data(), points.size(), T_map_camera.translation, options, random,
                   plane)) &&
      ok(pose_on_plane(plane, in_front, T_map_camera.rotation * Vector3<float>(1.0F, 0.0F, 0.0F),
                       T_map_object))) {
    return true;
  }
  // Upright as the camera is held: object z against the camera's y.
  const Quaternion<float> R_camera_object(0.70710678F, 0.70710678F, 0.0F, 0.0F);
  T_map_object = {T_map_camera.rotation * R_camera_object, in_front};
  return true;
}

}  // namespace cairn
