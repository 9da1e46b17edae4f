#pragma once

#include "cairn/ar/plane_fit.hpp"
#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

/// How far from a plane its points may lie, of their median depth.
inline constexpr float kPlaneTolerance = 0.03F;

namespace detail {

/// Least number of n points on a plane that is no chance, for every n: of points scattered over a
/// median depth, one of the planes through three of them holds as many with a probability below
/// 10 % (binomial tail for the others, times the number of triples; Desolneux, Moisan and Morel
/// 2000). Made by the compiler: it needs double precision.
struct LeastOnPlane {
  int of[kMaxPlanePoints + 1] = {};

  constexpr LeastOnPlane() {
    for (int n = 0; n <= kMaxPlanePoints; ++n) of[n] = least(n);
  }

 private:
  static constexpr int least(int n) {
    constexpr double kShare = 2.0 * static_cast<double>(kPlaneTolerance);
    constexpr double kChance = 0.1;
    const int others = n - 3;
    const double triples = n * (n - 1.0) * (n - 2.0) / 6.0;
    double all = 1.0;  // the probability that every other point lies on it
    for (int i = 0; i < others; ++i) all *= kShare;
    double tail = 0.0;
    double exactly = all;
    for (int on = others; on > 0; --on) {
      tail += exactly;
      if (tail * triples >= kChance) return on + 4;
      exactly *= on / (others - on + 1.0) * (1.0 - kShare) / kShare;
    }
    return 4;
  }
};
inline constexpr LeastOnPlane kLeastOnPlane{};

}  // namespace detail

/// Least number of n points, at most kMaxPlanePoints, on a plane that is no chance.
constexpr int least_on_plane(int n) {
  return detail::kLeastOnPlane.of[n];
}

/// Points in front of a hand-held camera on which an object may be placed, map frame.
template <int MaxPoints>
struct ScenePoints {
  static_assert(MaxPoints <= kMaxPlanePoints, "the plane is fitted to all points");
  static constexpr int kMinPoints = 10;  ///< fewer say too little

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

  /// The plane on which most points lie, to 3 % of their median depth; false where those are not
  /// least_on_plane().
  bool find_plane(const Rigid<float>& T_map_camera, Random& random, PlaneFit& plane) const {
    PlaneFitOptions options;
    options.inlier_m = kPlaneTolerance * median_depth();
    options.samples = 64;  // three of 40 % of the points are among them in 98 % of the cases
    options.min_inliers = least_on_plane(points.size());
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
  const float limit = kPlaneTolerance * scene.median_depth();
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
