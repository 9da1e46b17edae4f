#pragma once

#include "cairn/mono/feature_map.hpp"

namespace cairn::mono {

template <class T, int MaxFeatures, int MaxAnchors>
int FeatureMap<T, MaxFeatures, MaxAnchors>::find(LandmarkId id) const {
  for (int i = 0; i < count_; ++i) {
    if (features_[i].id == id) return i;
  }
  return -1;
}

/// World vector from the camera towards the feature: rho (a - r) + m, p - r, or m.
template <class T, int MaxFeatures, int MaxAnchors>
Vector3<T> FeatureMap<T, MaxFeatures, MaxAnchors>::ray_to(const State& state, const T* x,
                                                          const Feature& feature,
                                                          T inverse_depth) const {
  if (feature.kind == FeatureKind::kPoint)
    return vector3_at(x, feature.at) - state.camera.position(x);
  const Vector3<T> m = feature.R_world_feature * direction<T>(x[feature.at], x[feature.at + 1]).m;
  if (feature.kind == FeatureKind::kDirection) return m;
  const Vector3<T> anchor = vector3_at(x, anchors_[feature.anchor].at);
  return inverse_depth * (anchor - state.camera.position(x)) + m;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status FeatureMap<T, MaxFeatures, MaxAnchors>::pixel_at(const State& state, const T* x, int slot,
                                                        Vector2<T>& pixel) const {
  const Feature& feature = features_[slot];
  const Vector3<T> ray = ray_to(state, x, feature, inverse_depth(x, feature));
  const Vector<T, 4> q = state.camera.quaternion(x);
  return state.camera.camera(x).project(rotation_matrix<T>(q).transpose() * ray, pixel);
}

/// Predicted pixel of a feature and H, its derivative by the state. Legend (Civera et al. 2008): r
/// camera position, a anchor, m direction, rho inverse depth, h = project(R^T (rho (a - r) + m)).
template <class T, int MaxFeatures, int MaxAnchors>
Status FeatureMap<T, MaxFeatures, MaxAnchors>::linearise(const State& state,
                                                         const Parameters& parameters, int slot,
                                                         Vector2<T>& pixel, Rows2& rows) const {
  const Feature& feature = features_[slot];
  const PinholeCamera<T> camera = state.camera.camera(state.x);
  const T factor = state.camera.focal_factor(state.x);
  const Vector<T, 4> q = state.quaternion();
  T rho = inverse_depth(state.x, feature);
  RayPixel<T> h;
  const Status status = project_ray<T>(camera, factor, q, ray_to(state, state.x, feature, rho), h);
  if (!ok(status)) return status;
  pixel = h.pixel;
  if (parameters.first_estimate_inverse_depth && feature.kind == FeatureKind::kInverseDepth) {
    RayPixel<T> first;
    const T first_rho = feature.first_inverse_depth;
    if (ok(project_ray<T>(camera, factor, q, ray_to(state, state.x, feature, first_rho), first))) {
      h = first;
      rho = first_rho;
    }
  }

  rows = Rows2{};
  if (feature.kind == FeatureKind::kPoint) {
    state.camera.add_camera_run(state.x, rows, -h.wrt_ray, h.wrt_q, h.wrt_focal);
    rows.add_run(feature.at, h.wrt_ray);
    return Status::kOk;
  }
  const Direction<T> m = direction<T>(state.x[feature.at], state.x[feature.at + 1]);
  const Matrix2<T> wrt_angles = h.wrt_ray * (feature.R_world_feature * m.wrt_angles);
  if (feature.kind == FeatureKind::kDirection) {
    state.camera.add_camera_run(state.x, rows, Matrix<T, 2, 3>::Zero(), h.wrt_q, h.wrt_focal);
    rows.add_run(feature.at, wrt_angles);
    return Status::kOk;
  }
  const int anchor = anchors_[feature.anchor].at;
  const Matrix<T, 2, 3> wrt_anchor = rho * h.wrt_ray;
  state.camera.add_camera_run(state.x, rows, -wrt_anchor, h.wrt_q, h.wrt_focal);
  rows.add_run(anchor, wrt_anchor);
  Matrix<T, 2, 3> wrt_feature;
  wrt_feature.template leftCols<2>() = wrt_angles;
  wrt_feature.col(2) = h.wrt_ray * (vector3_at(state.x, anchor) - state.position());
  rows.add_run(feature.at, wrt_feature);
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::point_rows(const State& state, const Feature& feature,
                                                        Vector3<T>& p_world, Rows3& rows) const {
  if (feature.kind == FeatureKind::kPoint) {
    p_world = vector3_at(state.x, feature.at);
    rows.add_run(feature.at, Matrix3<T>(Matrix3<T>::Identity()));
    return;
  }
  const T rho = state.x[feature.at + 2];
  const Direction<T> m = direction<T>(state.x[feature.at], state.x[feature.at + 1]);
  const Vector3<T> ray = feature.R_world_feature * m.m;
  const int anchor = anchors_[feature.anchor].at;
  p_world = vector3_at(state.x, anchor) + ray / rho;
  rows.add_run(anchor, Matrix3<T>(Matrix3<T>::Identity()));
  Matrix3<T> wrt_feature;
  wrt_feature.template leftCols<2>() = (feature.R_world_feature * m.wrt_angles) / rho;
  wrt_feature.col(2) = -ray / square(rho);
  rows.add_run(feature.at, wrt_feature);
}

/// Median inverse depth, seen from the present camera, of the features known to 30 %; both values
/// are left alone where fewer than eight are.
template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::expected_inverse_depth(const State& state,
                                                                    T& inverse_depth,
                                                                    T& sigma) const {
  constexpr int kEnough = 8;
  constexpr T kKnown = T(0.09);  // squared relative deviation
  T sorted[MaxFeatures];
  int count = 0;
  for (int slot = 0; slot < count_; ++slot) {
    const Feature& feature = features_[slot];
    if (feature.kind == FeatureKind::kDirection) continue;
    const bool point = feature.kind == FeatureKind::kPoint;
    const T rho = point ? T(1) : state.x[feature.at + 2];
    const Vector3<T> ray = ray_to(state, state.x, feature, rho);
    const T squared = ray.dot(ray);
    T variance = state.covariance(feature.at + 2, feature.at + 2);
    if (point) {
      for (int i = 0; i < 2; ++i) variance += state.covariance(feature.at + i, feature.at + i);
    }
    if (!(squared > T(1e-6)) || !(variance < kKnown * (point ? squared : rho * rho))) continue;
    const T value = rho / sqrt(squared);
    int at = count++;
    for (; at > 0 && sorted[at - 1] > value; --at) sorted[at] = sorted[at - 1];
    sorted[at] = value;
  }
  if (count < kEnough) return;
  inverse_depth = sorted[count / 2];
  sigma = T(0.5) * inverse_depth;
}

}  // namespace cairn::mono
