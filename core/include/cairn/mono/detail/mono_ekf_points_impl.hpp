#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

/// Linearity index of the depth, L = 4 sigma_d |cos alpha| / d_1 with sigma_d = sigma_rho / rho^2,
/// alpha the parallax angle and d_1 the distance from the camera: Civera et al. 2008, eq. 31.
template <class T, int MaxFeatures, int MaxAnchors>
bool MonoEkf<T, MaxFeatures, MaxAnchors>::is_linear(const Feature& feature) const {
  const T rho = x_[feature.at + 2];
  const T variance = covariance_(feature.at + 2, feature.at + 2);
  if (!(rho > parameters_.min_inverse_depth) || !(variance > T(0))) return false;
  const Vector3<T> m =
      feature.R_world_feature * mono::direction<T>(x_[feature.at], x_[feature.at + 1]).m;
  const Vector3<T> from_camera =
      vector3_at(x_, anchors_[feature.anchor].at) + m / rho - position_at(x_);
  const T distance_squared = from_camera.dot(from_camera);
  const T sigma_depth = sqrt(variance) / square(rho);
  // |cos alpha| / d_1 = |m . h| / d_1^2
  return T(4) * sigma_depth * abs(m.dot(from_camera)) <
         parameters_.linearity_threshold * distance_squared;
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::convert_linear_features() {
  int converted = 0;
  for (int k = 0; k < feature_count_ && converted < parameters_.max_conversions_per_update; ++k) {
    Feature& feature = features_[(next_conversion_ + k) % feature_count_];
    if (feature.kind != FeatureKind::kInverseDepth || !is_linear(feature)) continue;
    convert_to_point(feature);
    ++converted;
  }
  next_conversion_ = (next_conversion_ + converted) % MaxFeatures;
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::point_rows(const Feature& feature, Vector3<T>& p_world,
                                                     Rows3& rows) const {
  if (feature.kind == FeatureKind::kPoint) {
    p_world = vector3_at(x_, feature.at);
    rows.add_run(feature.at, Matrix3<T>(Matrix3<T>::Identity()));
    return;
  }
  const T rho = x_[feature.at + 2];
  const mono::Direction<T> m = mono::direction<T>(x_[feature.at], x_[feature.at + 1]);
  const Vector3<T> ray = feature.R_world_feature * m.m;
  const int anchor = anchors_[feature.anchor].at;
  p_world = vector3_at(x_, anchor) + ray / rho;
  rows.add_run(anchor, Matrix3<T>(Matrix3<T>::Identity()));
  Matrix3<T> wrt_feature;
  wrt_feature.template leftCols<2>() = (feature.R_world_feature * m.wrt_angles) / rho;
  wrt_feature.col(2) = -ray / square(rho);
  rows.add_run(feature.at, wrt_feature);
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::convert_to_point(Feature& feature) {
  Vector3<T> p_world;
  Rows3 rows;
  point_rows(feature, p_world, rows);
  mono::compose_block(covariance_, feature.at, rows, Matrix3<T>(Matrix3<T>::Zero()), scratch_);
  for (int i = 0; i < 3; ++i) x_[feature.at + i] = p_world(i);
  feature.kind = FeatureKind::kPoint;
  const int anchor = feature.anchor;
  feature.anchor = -1;
  release_anchor(anchor);
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::feature_position(int slot, Vector3<T>& p_world,
                                                             Matrix3<T>& covariance) const {
  if (slot < 0 || slot >= feature_count_) return Status::kInvalidArgument;
  if (features_[slot].kind == FeatureKind::kDirection) return Status::kDegenerate;
  Rows3 rows;
  point_rows(features_[slot], p_world, rows);
  covariance = mono::quadratic(rows, covariance_);
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::feature_inverse_depth(int slot, T& inverse_depth,
                                                                  T& sigma) const {
  Vector3<T> p_world;
  Matrix3<T> covariance;
  const Status status = feature_position(slot, p_world, covariance);
  if (!ok(status)) return status;
  const Feature& feature = features_[slot];
  T variance = T(0);
  if (feature.kind == FeatureKind::kInverseDepth) {
    inverse_depth = x_[feature.at + 2];
    variance = covariance_(feature.at + 2, feature.at + 2);
  } else {
    const Vector3<T> ray = p_world - position_at(x_);
    const T squared = ray.dot(ray);
    if (!(squared > T(1e-6))) return Status::kDegenerate;
    inverse_depth = T(1) / sqrt(squared);
    variance = ray.dot(covariance * ray) / (squared * squared * squared);
  }
  sigma = variance > T(0) ? sqrt(variance) : T(0);
  return Status::kOk;
}

}  // namespace cairn
