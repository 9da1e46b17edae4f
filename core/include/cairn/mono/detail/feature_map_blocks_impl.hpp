#pragma once

#include "cairn/mono/feature_map.hpp"

namespace cairn::mono {

/// y = (anchor, theta, phi, rho) from the camera state and the pixel, P <- J diag(P, R,
/// sigma_rho^2) J^T: Civera et al. 2008, section IV.
template <class T, int MaxFeatures, int MaxAnchors>
Status FeatureMap<T, MaxFeatures, MaxAnchors>::add(State& state, const Parameters& parameters,
                                                   LandmarkId id, const Vector2<T>& pixel,
                                                   T inverse_depth, T sigma) {
  PixelRay<T> ray;
  const Status status =
      pixel_ray<T>(state.camera.camera(state.x), state.camera.focal_factor(state.x), pixel, ray);
  if (!ok(status)) return status;

  const bool with_depth = parameters.motion != MotionModel::kRotationOnly;
  Feature feature;
  feature.id = id;
  feature.kind = with_depth ? FeatureKind::kInverseDepth : FeatureKind::kDirection;
  feature.anchor = with_depth ? anchor_for_new_feature(state, parameters) : -1;
  feature.at = state.size();
  feature.first_inverse_depth = inverse_depth;
  const Vector<T, 4> q = state.quaternion();
  feature.R_world_feature = rotation_matrix<T>(q);
  const Angles<T> angles = angles_of<T>(ray.ray_camera);

  // Angles of B^T R(q) ray, where B is the present value of R and stays constant.
  const Matrix<T, 2, 4> wrt_q = angles.wrt_v * (feature.R_world_feature.transpose() *
                                                rotated_wrt_quaternion<T>(q, ray.ray_camera));
  const Matrix2<T> wrt_pixel = angles.wrt_v * ray.wrt_pixel;
  const Vector2<T> wrt_focal = angles.wrt_v * ray.wrt_focal;
  const Matrix2<T> noise = square(parameters.sigma_px) * (wrt_pixel * wrt_pixel.transpose());
  Rows3 rows;
  Matrix<T, 3, 4> wrt_q3 = Matrix<T, 3, 4>::Zero();
  wrt_q3.template topRows<2>() = wrt_q;
  rows.add_run(state.layout().quaternion, wrt_q3);
  if (state.layout().focal >= 0) {
    rows.add_run(state.layout().focal, Vector3<T>(wrt_focal.x(), wrt_focal.y(), T(0)));
  }
  Matrix3<T> noise3 = Matrix3<T>::Zero();
  noise3.template topLeftCorner<2, 2>() = noise;
  noise3(2, 2) = square(sigma);
  compose_block(state.covariance, state.size(), rows, noise3, state.scratch);
  if (!with_depth) state.covariance.resize(state.size() - 1);
  state.x[feature.at] = angles.theta;
  state.x[feature.at + 1] = angles.phi;
  if (with_depth) state.x[feature.at + 2] = inverse_depth;
  features_[count_++] = feature;
  return Status::kOk;
}

/// Anchor at the present camera position: the one of this frame, a new one, or the least used one
/// moved here.
template <class T, int MaxFeatures, int MaxAnchors>
int FeatureMap<T, MaxFeatures, MaxAnchors>::anchor_for_new_feature(State& state,
                                                                   const Parameters& parameters) {
  int anchor = parameters.share_anchors ? frame_anchor_ : -1;
  if (anchor < 0) {
    if (anchor_count_ < MaxAnchors) {
      anchor = anchor_count_++;
      anchors_[anchor] = Anchor{state.size(), 0};
    } else {
      anchor = 0;
      for (int i = 1; i < MaxAnchors; ++i) {
        if (anchors_[i].users < anchors_[anchor].users) anchor = i;
      }
      for (int i = 0; i < count_; ++i) {
        if (features_[i].anchor == anchor) move_to_camera(state, features_[i]);
      }
    }
    const int at = anchors_[anchor].at;
    Rows3 rows;
    state.camera.add_position_run(state.x, rows, Matrix3<T>(Matrix3<T>::Identity()));
    compose_block(state.covariance, at, rows, Matrix3<T>(Matrix3<T>::Zero()), state.scratch);
    const Vector3<T> position = state.position();
    for (int i = 0; i < 3; ++i) state.x[at + i] = position(i);
    frame_anchor_ = anchor;
  }
  ++anchors_[anchor].users;
  return anchor;
}

/// Rewrites an inverse-depth feature as seen from the present camera position r, exact in the mean
/// and of first order in the covariance, also for rho = 0: w = rho (a - r) + m, direction w / |w|,
/// inverse depth rho / |w|. The new axes have z along w, so that theta = phi = 0.
template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::move_to_camera(State& state, Feature& feature) {
  const T rho = state.x[feature.at + 2];
  const Vector3<T> offset = vector3_at(state.x, anchors_[feature.anchor].at) - state.position();
  const Direction<T> m = direction<T>(state.x[feature.at], state.x[feature.at + 1]);
  const Vector3<T> w = rho * offset + feature.R_world_feature * m.m;
  const T length = sqrt(w.dot(w));
  if (!(length > T(1e-3))) return;  // the point lies in the camera: leave its angles as they are

  const Vector3<T> z = w / length;
  const Vector3<T> up =
      abs(z.y()) < T(0.7) ? Vector3<T>(T(0), T(1), T(0)) : Vector3<T>(T(1), T(0), T(0));
  Vector3<T> x_axis = up.cross(z);
  x_axis /= sqrt(x_axis.dot(x_axis));
  const Vector3<T> y_axis = z.cross(x_axis);
  Matrix3<T> wrt_w;  // of theta, phi and rho
  wrt_w.row(0) = x_axis.transpose() / length;
  wrt_w.row(1) = -y_axis.transpose() / length;
  wrt_w.row(2) = z.transpose() * (-rho / (length * length));
  Rows3 rows;
  state.camera.add_position_run(state.x, rows, Matrix3<T>(-rho * wrt_w));
  rows.add_run(anchors_[feature.anchor].at, Matrix3<T>(rho * wrt_w));
  Matrix3<T> wrt_feature;
  wrt_feature.template leftCols<2>() = wrt_w * (feature.R_world_feature * m.wrt_angles);
  wrt_feature.col(2) = wrt_w * offset;
  wrt_feature(2, 2) += T(1) / length;
  rows.add_run(feature.at, wrt_feature);
  compose_block(state.covariance, feature.at, rows, Matrix3<T>(Matrix3<T>::Zero()), state.scratch);
  state.x[feature.at] = T(0);
  state.x[feature.at + 1] = T(0);
  state.x[feature.at + 2] = rho / length;
  feature.first_inverse_depth = rho / length;
  feature.R_world_feature.col(0) = x_axis;
  feature.R_world_feature.col(1) = y_axis;
  feature.R_world_feature.col(2) = z;
}

template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::remove(State& state, int slot) {
  const Feature removed = features_[slot];
  features_[slot] = features_[--count_];
  remove_block(state, removed.at);
  if (removed.anchor >= 0) release_anchor(state, removed.anchor);
}

template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::release_anchor(State& state, int anchor) {
  if (--anchors_[anchor].users > 0) return;
  const int at = anchors_[anchor].at;
  const int last = --anchor_count_;
  anchors_[anchor] = anchors_[last];
  for (int i = 0; i < count_; ++i) {
    if (features_[i].anchor == last) features_[i].anchor = anchor;
  }
  if (frame_anchor_ == anchor) {
    frame_anchor_ = -1;
  } else if (frame_anchor_ == last) {
    frame_anchor_ = anchor;
  }
  remove_block(state, at);
}

/// Takes a block out of the state; the last block moves into its place.
template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::remove_block(State& state, int at) {
  const int last = state.size() - state.layout().block;
  state.covariance.remove_block_unordered(at, state.layout().block);
  if (at == last) return;
  for (int i = 0; i < state.layout().block; ++i) state.x[at + i] = state.x[last + i];
  for (int i = 0; i < count_; ++i) {
    if (features_[i].at == last) features_[i].at = at;
  }
  for (int i = 0; i < anchor_count_; ++i) {
    if (anchors_[i].at == last) anchors_[i].at = at;
  }
}

/// Linearity index of the depth, L = 4 sigma_d |cos alpha| / d_1 with sigma_d = sigma_rho / rho^2,
/// alpha the parallax angle and d_1 the distance from the camera: Civera et al. 2008, eq. 31.
template <class T, int MaxFeatures, int MaxAnchors>
bool FeatureMap<T, MaxFeatures, MaxAnchors>::is_linear(const State& state,
                                                       const Parameters& parameters,
                                                       const Feature& feature) const {
  const T rho = state.x[feature.at + 2];
  const T variance = state.covariance(feature.at + 2, feature.at + 2);
  if (!(rho > parameters.min_inverse_depth) || !(variance > T(0))) return false;
  const Vector3<T> m =
      feature.R_world_feature * direction<T>(state.x[feature.at], state.x[feature.at + 1]).m;
  const Vector3<T> from_camera =
      vector3_at(state.x, anchors_[feature.anchor].at) + m / rho - state.position();
  const T distance_squared = from_camera.dot(from_camera);
  const T sigma_depth = sqrt(variance) / square(rho);
  // |cos alpha| / d_1 = |m . h| / d_1^2
  return T(4) * sigma_depth * abs(m.dot(from_camera)) <
         parameters.linearity_threshold * distance_squared;
}

template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::convert_linear_features(State& state,
                                                                     const Parameters& parameters) {
  int converted = 0;
  for (int k = 0; k < count_ && converted < parameters.max_conversions_per_update; ++k) {
    Feature& feature = features_[(next_conversion_ + k) % count_];
    if (feature.kind != FeatureKind::kInverseDepth || !is_linear(state, parameters, feature))
      continue;
    convert_to_point(state, feature);
    ++converted;
  }
  next_conversion_ = (next_conversion_ + converted) % MaxFeatures;
}

template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::convert_to_point(State& state, Feature& feature) {
  Vector3<T> p_world;
  Rows3 rows;
  point_rows(state, feature, p_world, rows);
  compose_block(state.covariance, feature.at, rows, Matrix3<T>(Matrix3<T>::Zero()), state.scratch);
  for (int i = 0; i < 3; ++i) state.x[feature.at + i] = p_world(i);
  feature.kind = FeatureKind::kPoint;
  const int anchor = feature.anchor;
  feature.anchor = -1;
  release_anchor(state, anchor);
}

template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::fading_limits(const Parameters& parameters,
                                                           T* limit) const {
  const FadingLimits<T> largest(parameters);
  const auto fill = [limit](int at, int count, T value) {
    for (int i = at; i < at + count; ++i) limit[i] = value;
  };
  for (int i = 0; i < anchor_count_; ++i) fill(anchors_[i].at, 3, largest.length);
  for (int i = 0; i < count_; ++i) {
    const Feature& feature = features_[i];
    if (feature.kind == FeatureKind::kPoint) {
      fill(feature.at, 3, largest.length);
      continue;
    }
    fill(feature.at, 2, largest.angle);
    if (feature.kind == FeatureKind::kInverseDepth) {
      limit[feature.at + 2] = square(parameters.initial_inverse_depth_sigma);
    }
  }
}

template <class T, int MaxFeatures, int MaxAnchors>
void FeatureMap<T, MaxFeatures, MaxAnchors>::hash(Hash64& hash) const {
  for (int i = 0; i < count_; ++i) {
    hash.add(features_[i].id);
    hash.add(static_cast<std::int32_t>(features_[i].at));
  }
}

}  // namespace cairn::mono
