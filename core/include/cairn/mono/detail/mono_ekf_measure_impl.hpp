#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::predict_feature(int slot,
                                                            PixelPrediction<T>& prediction) const {
  if (slot < 0 || slot >= features_.size()) return Status::kInvalidArgument;
  Vector2<T> pixel;
  Rows2 rows;
  const Status status = features_.linearise(state_, parameters_, slot, pixel, rows);
  if (!ok(status)) return status;
  if (!state_.camera.told().contains(pixel)) return Status::kOutOfView;
  const auto& feature = features_[slot];
  const T rho = Features::inverse_depth(state_.x, feature);
  const Matrix3<T> R_world_camera = mono::rotation_matrix<T>(state_.quaternion());
  prediction.id = feature.id;
  prediction.slot = slot;
  prediction.pixel = pixel;
  prediction.covariance = mono::quadratic(rows, state_.covariance);
  prediction.covariance(0, 0) += square(parameters_.sigma_px);
  prediction.covariance(1, 1) += square(parameters_.sigma_px);
  prediction.p_camera =
      R_world_camera.transpose() * features_.ray_to(state_, state_.x, feature, rho);
  if (rho > T(0)) prediction.p_camera /= rho;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Rigid<T> MonoEkf<T, MaxFeatures, MaxAnchors>::T_world_camera() const {
  if (!initialised_) return {};
  const Vector<T, 4> q = state_.quaternion();
  return {Quaternion<T>(q(0), q(1), q(2), q(3)).normalized(), state_.position()};
}

template <class T, int MaxFeatures, int MaxAnchors>
Matrix<T, 6, 6> MonoEkf<T, MaxFeatures, MaxAnchors>::pose_covariance() const {
  Matrix<T, 6, 6> out = Matrix<T, 6, 6>::Zero();
  if (!initialised_) return out;
  mono::SparseRows<T, 6> rows;
  Matrix<T, 6, 3> wrt_position = Matrix<T, 6, 3>::Zero();
  wrt_position.template topRows<3>().setIdentity();
  state_.camera.add_position_run(state_.x, rows, wrt_position);
  const Vector<T, 4> q = state_.quaternion();
  Matrix<T, 6, 4> wrt_q = Matrix<T, 6, 4>::Zero();
  wrt_q.template bottomRows<3>() << -q(1), q(0), q(3), -q(2), -q(2), -q(3), q(0), q(1), -q(3), q(2),
      -q(1), q(0);
  rows.add_run(layout().quaternion, Matrix<T, 6, 4>(T(2) * wrt_q));
  return mono::quadratic(rows, state_.covariance);
}

template <class T, int MaxFeatures, int MaxAnchors>
Vector3<T> MonoEkf<T, MaxFeatures, MaxAnchors>::velocity_mps() const {
  if (layout().velocity < 0) return Vector3<T>::Zero();
  return mono::vector3_at(state_.x, layout().velocity);
}

template <class T, int MaxFeatures, int MaxAnchors>
Vector3<T> MonoEkf<T, MaxFeatures, MaxAnchors>::rate_radps() const {
  return mono::vector3_at(state_.x, layout().rate);
}

template <class T, int MaxFeatures, int MaxAnchors>
T MonoEkf<T, MaxFeatures, MaxAnchors>::focal_sigma() const {
  if (!initialised_ || layout().focal < 0) return T(0);
  const T variance = state_.covariance(layout().focal, layout().focal);
  return variance > T(0) ? sqrt(variance) : T(0);
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::feature_position(int slot, Vector3<T>& p_world,
                                                             Matrix3<T>& covariance) const {
  if (slot < 0 || slot >= features_.size()) return Status::kInvalidArgument;
  if (features_[slot].kind == FeatureKind::kDirection) return Status::kDegenerate;
  Rows3 rows;
  features_.point_rows(state_, features_[slot], p_world, rows);
  covariance = mono::quadratic(rows, state_.covariance);
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::feature_inverse_depth(int slot, T& inverse_depth,
                                                                  T& sigma) const {
  Vector3<T> p_world;
  Matrix3<T> covariance;
  const Status status = feature_position(slot, p_world, covariance);
  if (!ok(status)) return status;
  const auto& feature = features_[slot];
  T variance = T(0);
  if (feature.kind == FeatureKind::kInverseDepth) {
    inverse_depth = state_.x[feature.at + 2];
    variance = state_.covariance(feature.at + 2, feature.at + 2);
  } else {
    const Vector3<T> ray = p_world - state_.position();
    const T squared = ray.dot(ray);
    if (!(squared > T(1e-6))) return Status::kDegenerate;
    inverse_depth = T(1) / sqrt(squared);
    variance = ray.dot(covariance * ray) / (squared * squared * squared);
  }
  sigma = variance > T(0) ? sqrt(variance) : T(0);
  return Status::kOk;
}

}  // namespace cairn
