#pragma once

#include "cairn/ar/plane_fit.hpp"
#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

/// Points in front of a hand-held camera on which an object may be placed, map frame.
template <int MaxPoints>
struct ScenePoints {
  static_assert(MaxPoints <= kMaxPlanePoints, "the plane is fitted to all points");
  static constexpr int kMinPoints = 10;       ///< fewer say too little
  static constexpr float kTolerance = 0.03F;  ///< of a plane, of the median depth

  FixedVector<Vector3<float>, MaxPoints> points;
  FixedVector<float, MaxPoints> depths;  ///< of all points, ascending, each > 0

  void add(const Vector3<float>& p_map, float depth) {
    points.push_back(p_map);
    depths.push_back(depth);
    for (int i = depths.size() - 1; i > 0 && depths[i - 1] > depths[i]; --i) {
      const float swapped = depths[i];
      depths[i] = depths[i - 1];
      depths[i - 1] = swapped;
    }
  }
  float median_depth() const { return depths[depths.size() / 2]; }

  /// So many of the points lie on a plane that they do so by more than chance. A slab of the
  /// plane's thickness holds a share p = 0.06 of points scattered over a median depth; of n points
  /// it holds k with a probability of at most exp(-2 n (k / n - p)^2) (Hoeffding 1963). The count
  /// at which this is one in the number of triples of kMaxPlanePoints, 41664.
  int least_on_plane() const {
    constexpr float kShare = 2.0F * kTolerance;
    constexpr float kDeviations = 2.306F;  // sqrt(ln(41664) / 2)
    const auto n = static_cast<float>(points.size());
    return static_cast<int>(kShare * n + kDeviations * sqrt(n)) + 1;
  }

  /// The plane on which most points lie, to 3 % of their median depth; false where those are not
  /// least_on_plane().
  bool find_plane(const Rigid<float>& T_map_camera, Random& random, PlaneFit& plane) const {
    PlaneFitOptions options;
    options.inlier_m = kTolerance * median_depth();
    options.samples = 64;  // three of half the points are among them but once in 5000 times
    options.min_inliers = least_on_plane();
    return ok(
        fit_plane(points.data(), points.size(), T_map_camera.translation, options, random, plane));
  }
};

/// The features that are known to a fifth of their depth.
template <class Filter>
void gather_known_features(const Filter& filter, ScenePoints<Filter::kMaxFeatures>& scene) {
  const Rigid<float> T_camera_map = filter.T_world_camera().inverse();
  for (int slot = 0; slot < filter.feature_count(); ++slot) {
    Vector3<float> p_map;
    Matrix3<float> covariance;
    if (!ok(filter.feature_position(slot, p_map, covariance))) continue;
    const float depth = (T_camera_map * p_map).z();
    const float trace = covariance(0, 0) + covariance(1, 1) + covariance(2, 2);
    if (depth > 0.0F && trace < square(0.2F * depth)) scene.add(p_map, depth);
  }
}

/// Upright as the camera is held: object z against the camera's y.
inline Rigid<float> upright_in_view(const Rigid<float>& T_map_camera, const Vector3<float>& p_map) {
  const Quaternion<float> R_camera_object(0.70710678F, 0.70710678F, 0.0F, 0.0F);
  return {T_map_camera.rotation * R_camera_object, p_map};
}

/// A place for an object in front of a hand-held camera: on the plane of most of `scene`'s points,
/// where the one of them stands that is seen nearest to the optical axis, so that the plane is
/// known there. False while there are fewer than ten points, or too few of them lie on one plane;
/// `T_map_object` and `random` are then unchanged. Cost: fit_plane() and a pass over the points.
template <int MaxPoints>
bool place_on_plane(const ScenePoints<MaxPoints>& scene, const Rigid<float>& T_map_camera,
                    Random& random, Rigid<float>& T_map_object) {
  if (scene.points.size() < scene.kMinPoints) return false;
  Random draws = random;
  PlaneFit plane;
  if (!scene.find_plane(T_map_camera, draws, plane)) return false;
  const Rigid<float> T_camera_map = T_map_camera.inverse();
  const float limit = scene.kTolerance * scene.median_depth();
  Vector3<float> foot = plane.centroid;
  float nearest = -1.0F;
  for (const Vector3<float>& p_map : scene.points) {
    if (!(abs(plane.normal.dot(p_map) - plane.offset) < limit)) continue;
    const Vector3<float> p = T_camera_map * p_map;
    const float distance = (square(p.x()) + square(p.y())) / square(p.z());
    if (nearest >= 0.0F && !(distance < nearest)) continue;
    nearest = distance;
    foot = p_map;
  }
  const Vector3<float> facing = T_map_camera.rotation * Vector3<float>(1.0F, 0.0F, 0.0F);
  if (!ok(pose_on_plane(plane, foot, facing, T_map_object))) return false;
  random = draws;
  return true;
}

/// place_on_plane() with the features that are known to a fifth of their depth. `random`: the
/// caller's own, so that placing an object does not change the tracking. `filter`: MonoEkf or
/// WindowTracker.
template <class Filter>
bool place_on_features(const Filter& filter, Random& random, Rigid<float>& T_map_object) {
  ScenePoints<Filter::kMaxFeatures> scene;
  gather_known_features(filter, scene);
  return place_on_plane(scene, filter.T_world_camera(), random, T_map_object);
}

/// Depth along `ray` (camera frame, z 1) at which it meets the plane; 0 where it does not within
/// four times `typical_depth`.
inline float depth_on_plane(const PlaneFit& plane, const Rigid<float>& T_map_camera,
                            const Vector3<float>& ray, float typical_depth) {
  constexpr float kFarthest = 4.0F;
  const float towards = plane.normal.dot(T_map_camera.rotation * ray);
  const float away = plane.offset - plane.normal.dot(T_map_camera.translation);
  const float farthest = kFarthest * typical_depth;
  // Compared before it is divided: the ray may run along the plane.
  const bool meets = towards < 0.0F ? away < 0.0F && away > towards * farthest
                                    : away > 0.0F && away < towards * farthest;
  return meets ? away / towards : 0.0F;
}

/// Depth of the point that is seen nearest to `ray` (camera frame, z 1).
template <int MaxPoints>
float depth_beside_ray(const ScenePoints<MaxPoints>& scene, const Rigid<float>& T_map_camera,
                       const Vector3<float>& ray) {
  const Rigid<float> T_camera_map = T_map_camera.inverse();
  float depth = scene.median_depth();
  float nearest = -1.0F;
  for (const Vector3<float>& p_map : scene.points) {
    const Vector3<float> p = T_camera_map * p_map;
    const float distance = square(p.x() / p.z() - ray.x()) + square(p.y() / p.z() - ray.y());
    if (nearest >= 0.0F && !(distance < nearest)) continue;
    nearest = distance;
    depth = p.z();
  }
  return depth;
}

/// A place for an object where `ray` (camera frame, z 1) meets the scene: on the plane of the
/// points where most of them lie on one and the ray meets it within four times their median depth,
/// else upright at the depth of the point that is seen nearest to the ray. False, `T_map_object`
/// then unchanged, with fewer than ten points. Cost: fit_plane() and a pass over the points.
template <int MaxPoints>
bool place_on_ray(const ScenePoints<MaxPoints>& scene, const Rigid<float>& T_map_camera,
                  const Vector3<float>& ray, Random& random, Rigid<float>& T_map_object) {
  if (scene.points.size() < scene.kMinPoints) return false;
  PlaneFit plane;
  if (scene.find_plane(T_map_camera, random, plane)) {
    const float depth = depth_on_plane(plane, T_map_camera, ray, scene.median_depth());
    const Vector3<float> p_map = T_map_camera * Vector3<float>(depth * ray);
    if (depth > 0.0F &&
        ok(pose_on_plane(plane, p_map, T_map_camera.rotation * Vector3<float>(1.0F, 0.0F, 0.0F),
                         T_map_object))) {
      return true;
    }
  }
  const float depth = depth_beside_ray(scene, T_map_camera, ray);
  T_map_object = upright_in_view(T_map_camera, T_map_camera * Vector3<float>(depth * ray));
  return true;
}

/// place_on_ray() with the features that are known to a fifth of their depth and the ray of a
/// pixel. False also for a pixel that is not in the image.
template <class Filter>
bool place_at_pixel(const Filter& filter, const Vector2<float>& pixel, Random& random,
                    Rigid<float>& T_map_object) {
  Vector3<float> ray;
  if (!filter.camera().contains(pixel) || !ok(filter.camera().unproject(pixel, ray))) return false;
  ScenePoints<Filter::kMaxFeatures> scene;
  gather_known_features(filter, scene);
  return place_on_ray(scene, filter.T_world_camera(), ray, random, T_map_object);
}

}  // namespace cairn
