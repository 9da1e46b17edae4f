#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

template <class T, int MaxFeatures, int MaxAnchors>
PinholeCamera<T> MonoEkf<T, MaxFeatures, MaxAnchors>::camera_at(const T* x) const {
  PinholeCamera<T> camera = camera_;
  const T factor = focal_factor_at(x);
  camera.fx *= factor;
  camera.fy *= factor;
  return camera;
}

template <class T, int MaxFeatures, int MaxAnchors>
T MonoEkf<T, MaxFeatures, MaxAnchors>::inverse_depth_at(const T* x, const Feature& feature) const {
  return feature.kind == FeatureKind::kInverseDepth ? x[feature.at + 2] : T(0);
}

/// World vector from the camera towards the feature: rho (a - r) + m, p - r, or m.
template <class T, int MaxFeatures, int MaxAnchors>
Vector3<T> MonoEkf<T, MaxFeatures, MaxAnchors>::ray_at(const T* x, const Feature& feature,
                                                       T inverse_depth) const {
  if (feature.kind == FeatureKind::kPoint) return vector3_at(x, feature.at) - position_at(x);
  const Vector3<T> m =
      feature.R_world_feature * mono::direction<T>(x[feature.at], x[feature.at + 1]).m;
  if (feature.kind == FeatureKind::kDirection) return m;
  const Vector3<T> anchor = vector3_at(x, anchors_[feature.anchor].at);
  return inverse_depth * (anchor - position_at(x)) + m;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::pixel_at(const T* x, int slot,
                                                     Vector2<T>& pixel) const {
  const Feature& feature = features_[slot];
  const Vector3<T> ray = ray_at(x, feature, inverse_depth_at(x, feature));
  const Vector<T, 4> q = quaternion_at(x);
  return camera_at(x).project(mono::rotation_matrix<T>(q).transpose() * ray, pixel);
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::add_camera_run(Rows2& rows,
                                                         const Matrix<T, 2, 3>& wrt_position,
                                                         const Matrix<T, 2, 4>& wrt_q,
                                                         const Vector2<T>& wrt_focal) const {
  Matrix<T, 2, 8> block = Matrix<T, 2, 8>::Zero();
  const int q = layout_.quaternion;
  block.template block<2, 4>(0, q) = wrt_q;
  if (layout_.position >= 0) block.template block<2, 3>(0, layout_.position) = wrt_position;
  if (layout_.lever >= 0) {
    const Vector<T, 4> attitude = quaternion_at(x_);
    const Matrix3<T> turn = mono::rotation_matrix<T>(attitude) - Matrix3<T>::Identity();
    block.template block<2, 3>(0, layout_.lever) = wrt_position * turn;
    block.template block<2, 4>(0, q) +=
        wrt_position * mono::rotated_wrt_quaternion<T>(attitude, vector3_at(x_, layout_.lever));
  }
  if (layout_.focal >= 0) block.col(layout_.focal) = wrt_focal;
  rows.add_run(0, layout_.measured, block);
}

template <class T, int MaxFeatures, int MaxAnchors>
template <int Rows>
void MonoEkf<T, MaxFeatures, MaxAnchors>::add_position_run(
    mono::SparseRows<T, Rows>& rows, const Matrix<T, Rows, 3>& wrt_position) const {
  if (layout_.position >= 0) rows.add_run(layout_.position, wrt_position);
  if (layout_.lever < 0) return;
  const Vector<T, 4> attitude = quaternion_at(x_);
  const Matrix3<T> turn = mono::rotation_matrix<T>(attitude) - Matrix3<T>::Identity();
  rows.add_run(layout_.lever, Matrix<T, Rows, 3>(wrt_position * turn));
  const Vector3<T> lever = vector3_at(x_, layout_.lever);
  rows.add_run(layout_.quaternion,
               Matrix<T, Rows, 4>(wrt_position * mono::rotated_wrt_quaternion<T>(attitude, lever)));
}

/// Predicted pixel of a feature and H, its derivative by the state. Legend (Civera et al. 2008): r
/// camera position, a anchor, m direction, rho inverse depth, h = project(R^T (rho (a - r) + m)).
template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::linearise(int slot, Vector2<T>& pixel,
                                                      Rows2& rows) const {
  const Feature& feature = features_[slot];
  const PinholeCamera<T> camera = camera_at(x_);
  const T factor = focal_factor_at(x_);
  const Vector<T, 4> q = quaternion_at(x_);
  T rho = inverse_depth_at(x_, feature);
  mono::RayPixel<T> h;
  const Status status = mono::project_ray<T>(camera, factor, q, ray_at(x_, feature, rho), h);
  if (!ok(status)) return status;
  pixel = h.pixel;
  if (parameters_.first_estimate_inverse_depth && feature.kind == FeatureKind::kInverseDepth) {
    mono::RayPixel<T> first;
    const T first_rho = feature.first_inverse_depth;
    if (ok(mono::project_ray<T>(camera, factor, q, ray_at(x_, feature, first_rho), first))) {
      h = first;
      rho = first_rho;
    }
  }

  rows = Rows2{};
  if (feature.kind == FeatureKind::kPoint) {
    add_camera_run(rows, -h.wrt_ray, h.wrt_q, h.wrt_focal);
    rows.add_run(feature.at, h.wrt_ray);
    return Status::kOk;
  }
  const mono::Direction<T> m = mono::direction<T>(x_[feature.at], x_[feature.at + 1]);
  const Matrix2<T> wrt_angles = h.wrt_ray * (feature.R_world_feature * m.wrt_angles);
  if (feature.kind == FeatureKind::kDirection) {
    add_camera_run(rows, Matrix<T, 2, 3>::Zero(), h.wrt_q, h.wrt_focal);
    rows.add_run(feature.at, wrt_angles);
    return Status::kOk;
  }
  const int anchor = anchors_[feature.anchor].at;
  const Matrix<T, 2, 3> wrt_anchor = rho * h.wrt_ray;
  add_camera_run(rows, -wrt_anchor, h.wrt_q, h.wrt_focal);
  rows.add_run(anchor, wrt_anchor);
  Matrix<T, 2, 3> wrt_feature;
  wrt_feature.template leftCols<2>() = wrt_angles;
  wrt_feature.col(2) = h.wrt_ray * (vector3_at(x_, anchor) - position_at(x_));
  rows.add_run(feature.at, wrt_feature);
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::predict_feature(int slot,
                                                            PixelPrediction<T>& prediction) const {
  if (slot < 0 || slot >= feature_count_) return Status::kInvalidArgument;
  Vector2<T> pixel;
  Rows2 rows;
  const Status status = linearise(slot, pixel, rows);
  if (!ok(status)) return status;
  if (!camera_.contains(pixel)) return Status::kOutOfView;
  const Feature& feature = features_[slot];
  const T rho = inverse_depth_at(x_, feature);
  const Matrix3<T> R_world_camera = mono::rotation_matrix<T>(quaternion_at(x_));
  prediction.id = feature.id;
  prediction.slot = slot;
  prediction.pixel = pixel;
  prediction.covariance = mono::quadratic(rows, covariance_);
  prediction.covariance(0, 0) += square(parameters_.sigma_px);
  prediction.covariance(1, 1) += square(parameters_.sigma_px);
  prediction.p_camera = R_world_camera.transpose() * ray_at(x_, feature, rho);
  if (rho > T(0)) prediction.p_camera /= rho;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Rigid<T> MonoEkf<T, MaxFeatures, MaxAnchors>::T_world_camera() const {
  if (!initialised_) return {};
  const Vector<T, 4> q = quaternion_at(x_);
  return {Quaternion<T>(q(0), q(1), q(2), q(3)).normalized(), position_at(x_)};
}

template <class T, int MaxFeatures, int MaxAnchors>
Matrix<T, 6, 6> MonoEkf<T, MaxFeatures, MaxAnchors>::pose_covariance() const {
  Matrix<T, 6, 6> out = Matrix<T, 6, 6>::Zero();
  if (!initialised_) return out;
  mono::SparseRows<T, 6> rows;
  Matrix<T, 6, 3> wrt_position = Matrix<T, 6, 3>::Zero();
  wrt_position.template topRows<3>().setIdentity();
  add_position_run(rows, wrt_position);
  const Vector<T, 4> q = quaternion_at(x_);
  Matrix<T, 6, 4> wrt_q = Matrix<T, 6, 4>::Zero();
  wrt_q.template bottomRows<3>() << -q(1), q(0), q(3), -q(2), -q(2), -q(3), q(0), q(1), -q(3), q(2),
      -q(1), q(0);
  rows.add_run(layout_.quaternion, Matrix<T, 6, 4>(T(2) * wrt_q));
  return mono::quadratic(rows, covariance_);
}

template <class T, int MaxFeatures, int MaxAnchors>
Vector3<T> MonoEkf<T, MaxFeatures, MaxAnchors>::velocity_mps() const {
  if (layout_.velocity < 0) return Vector3<T>::Zero();
  return vector3_at(x_, layout_.velocity);
}

template <class T, int MaxFeatures, int MaxAnchors>
Vector3<T> MonoEkf<T, MaxFeatures, MaxAnchors>::rate_radps() const {
  return vector3_at(x_, layout_.rate);
}

template <class T, int MaxFeatures, int MaxAnchors>
T MonoEkf<T, MaxFeatures, MaxAnchors>::focal_sigma() const {
  if (!initialised_ || layout_.focal < 0) return T(0);
  const T variance = covariance_(layout_.focal, layout_.focal);
  return variance > T(0) ? sqrt(variance) : T(0);
}

}  // namespace cairn
