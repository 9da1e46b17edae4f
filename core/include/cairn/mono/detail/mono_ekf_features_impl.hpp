#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

template <class T, int MaxFeatures, int MaxAnchors>
int MonoEkf<T, MaxFeatures, MaxAnchors>::find(LandmarkId id) const {
  for (int i = 0; i < feature_count_; ++i) {
    if (features_[i].id == id) return i;
  }
  return -1;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::add_feature(LandmarkId id, const Vector2<T>& pixel) {
  T inverse_depth = first_inverse_depth_;
  T sigma = first_inverse_depth_sigma_;
  if (parameters_.depth_from_map) expected_inverse_depth(inverse_depth, sigma);
  return add_feature(id, pixel, inverse_depth, sigma);
}

/// Median inverse depth, seen from the present camera, of the features known to 30 %; both values
/// are left alone where fewer than eight are.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::expected_inverse_depth(T& inverse_depth, T& sigma) const {
  constexpr int kEnough = 8;
  constexpr T kKnown = T(0.09);  // squared relative deviation
  T sorted[MaxFeatures];
  int count = 0;
  for (int slot = 0; slot < feature_count_; ++slot) {
    const Feature& feature = features_[slot];
    if (feature.kind == FeatureKind::kDirection) continue;
    const bool point = feature.kind == FeatureKind::kPoint;
    const T rho = point ? T(1) : x_[feature.at + 2];
    const Vector3<T> ray = ray_at(x_, feature, rho);
    const T squared = ray.dot(ray);
    T variance = covariance_(feature.at + 2, feature.at + 2);
    if (point) {
      for (int i = 0; i < 2; ++i) variance += covariance_(feature.at + i, feature.at + i);
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

/// y = (anchor, theta, phi, rho) from the camera state and the pixel, P <- J diag(P, R,
/// sigma_rho^2) J^T: Civera et al. 2008, section IV.
template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::add_feature(LandmarkId id, const Vector2<T>& pixel,
                                                        T inverse_depth, T sigma) {
  if (!initialised_) return Status::kNotInitialised;
  if (!is_finite(pixel.x()) || !is_finite(pixel.y())) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (id == kNoLandmark || !is_finite(inverse_depth) || !(inverse_depth > T(0)) ||
      !is_finite(sigma) || !(sigma > T(0))) {
    return Status::kInvalidArgument;
  }
  if (find(id) >= 0) return Status::kDuplicate;
  if (feature_count_ == MaxFeatures) {
    ++health_.landmarks_refused;
    return Status::kFull;
  }
  if (!camera_.contains(pixel)) return Status::kOutOfView;
  mono::PixelRay<T> ray;
  const Status status = mono::pixel_ray<T>(camera_at(x_), focal_factor_at(x_), pixel, ray);
  if (!ok(status)) return status;

  const bool with_depth = parameters_.motion != MotionModel::kRotationOnly;
  Feature feature;
  feature.id = id;
  feature.kind = with_depth ? FeatureKind::kInverseDepth : FeatureKind::kDirection;
  feature.anchor = with_depth ? anchor_for_new_feature() : -1;
  feature.at = covariance_.size();
  feature.first_inverse_depth = inverse_depth;
  const Vector<T, 4> q = quaternion_at(x_);
  feature.R_world_feature = mono::rotation_matrix<T>(q);
  const mono::Angles<T> angles = mono::angles_of<T>(ray.ray_camera);

  // Angles of B^T R(q) ray, where B is the present value of R and stays constant.
  const Matrix<T, 2, 4> wrt_q = angles.wrt_v * (feature.R_world_feature.transpose() *
                                                mono::rotated_wrt_quaternion<T>(q, ray.ray_camera));
  const Matrix2<T> wrt_pixel = angles.wrt_v * ray.wrt_pixel;
  const Vector2<T> wrt_focal = angles.wrt_v * ray.wrt_focal;
  const Matrix2<T> noise = square(parameters_.sigma_px) * (wrt_pixel * wrt_pixel.transpose());
  Rows3 rows;
  Matrix<T, 3, 4> wrt_q3 = Matrix<T, 3, 4>::Zero();
  wrt_q3.template topRows<2>() = wrt_q;
  rows.add_run(layout_.quaternion, wrt_q3);
  if (layout_.focal >= 0) {
    rows.add_run(layout_.focal, Vector3<T>(wrt_focal.x(), wrt_focal.y(), T(0)));
  }
  append_feature(rows, noise, sigma, with_depth);
  x_[feature.at] = angles.theta;
  x_[feature.at + 1] = angles.phi;
  if (with_depth) x_[feature.at + 2] = inverse_depth;
  features_[feature_count_++] = feature;
  ++health_.landmarks_added;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::append_feature(const Rows3& rows, const Matrix2<T>& noise,
                                                         T sigma, bool with_depth) {
  Matrix3<T> noise3 = Matrix3<T>::Zero();
  noise3.template topLeftCorner<2, 2>() = noise;
  noise3(2, 2) = square(sigma);
  mono::compose_block(covariance_, covariance_.size(), rows, noise3, scratch_);
  if (!with_depth) covariance_.resize(covariance_.size() - 1);
}

/// Anchor at the present camera position: the one of this frame, a new one, or the least used one
/// moved here.
template <class T, int MaxFeatures, int MaxAnchors>
int MonoEkf<T, MaxFeatures, MaxAnchors>::anchor_for_new_feature() {
  int anchor = parameters_.share_anchors ? frame_anchor_ : -1;
  if (anchor < 0) {
    if (anchor_count_ < MaxAnchors) {
      anchor = anchor_count_++;
      anchors_[anchor] = Anchor{covariance_.size(), 0};
    } else {
      anchor = 0;
      for (int i = 1; i < MaxAnchors; ++i) {
        if (anchors_[i].users < anchors_[anchor].users) anchor = i;
      }
      for (int i = 0; i < feature_count_; ++i) {
        if (features_[i].anchor == anchor) move_to_camera(features_[i]);
      }
    }
    const int at = anchors_[anchor].at;
    Rows3 rows;
    add_position_run(rows, Matrix3<T>(Matrix3<T>::Identity()));
    mono::compose_block(covariance_, at, rows, Matrix3<T>(Matrix3<T>::Zero()), scratch_);
    const Vector3<T> position = position_at(x_);
    for (int i = 0; i < 3; ++i) x_[at + i] = position(i);
    frame_anchor_ = anchor;
  }
  ++anchors_[anchor].users;
  return anchor;
}

/// Rewrites an inverse-depth feature as seen from the present camera position r, exact in the mean
/// and of first order in the covariance, also for rho = 0: w = rho (a - r) + m, direction w / |w|,
/// inverse depth rho / |w|. The new axes have z along w, so that theta = phi = 0.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::move_to_camera(Feature& feature) {
  const T rho = x_[feature.at + 2];
  const Vector3<T> offset = vector3_at(x_, anchors_[feature.anchor].at) - position_at(x_);
  const mono::Direction<T> m = mono::direction<T>(x_[feature.at], x_[feature.at + 1]);
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
  add_position_run(rows, Matrix3<T>(-rho * wrt_w));
  rows.add_run(anchors_[feature.anchor].at, Matrix3<T>(rho * wrt_w));
  Matrix3<T> wrt_feature;
  wrt_feature.template leftCols<2>() = wrt_w * (feature.R_world_feature * m.wrt_angles);
  wrt_feature.col(2) = wrt_w * offset;
  wrt_feature(2, 2) += T(1) / length;
  rows.add_run(feature.at, wrt_feature);
  mono::compose_block(covariance_, feature.at, rows, Matrix3<T>(Matrix3<T>::Zero()), scratch_);
  x_[feature.at] = T(0);
  x_[feature.at + 1] = T(0);
  x_[feature.at + 2] = rho / length;
  feature.first_inverse_depth = rho / length;
  feature.R_world_feature.col(0) = x_axis;
  feature.R_world_feature.col(1) = y_axis;
  feature.R_world_feature.col(2) = z;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::remove_feature(int slot) {
  if (slot < 0 || slot >= feature_count_) return Status::kInvalidArgument;
  const Feature removed = features_[slot];
  features_[slot] = features_[--feature_count_];
  remove_block(removed.at);
  if (removed.anchor >= 0) release_anchor(removed.anchor);
  ++health_.landmarks_removed;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
int MonoEkf<T, MaxFeatures, MaxAnchors>::prune(const FeaturePolicy& policy, int room,
                                               LandmarkId* removed) {
  int count = 0;
  const auto remove = [&](int slot) {
    if (removed != nullptr) removed[count] = features_[slot].id;
    if (ok(remove_feature(slot))) ++count;
  };
  for (int slot = feature_count_ - 1; slot >= 0; --slot) {
    const FeatureStatistics& s = features_[slot].statistics;
    const bool poor = s.predicted >= policy.min_predicted &&
                      static_cast<float>(s.measured) <
                          policy.min_measured_share * static_cast<float>(s.predicted);
    if (poor || s.out_of_view > policy.max_out_of_view) remove(slot);
  }
  const int wanted = room < MaxFeatures ? room : MaxFeatures;
  for (int k = 0; k < MaxFeatures && MaxFeatures - feature_count_ < wanted; ++k) {
    int worst = -1;
    int longest = 0;
    for (int slot = 0; slot < feature_count_; ++slot) {
      if (features_[slot].statistics.out_of_view <= longest) continue;
      longest = features_[slot].statistics.out_of_view;
      worst = slot;
    }
    if (worst < 0) break;
    remove(worst);
  }
  return count;
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::release_anchor(int anchor) {
  if (--anchors_[anchor].users > 0) return;
  const int at = anchors_[anchor].at;
  const int last = --anchor_count_;
  anchors_[anchor] = anchors_[last];
  for (int i = 0; i < feature_count_; ++i) {
    if (features_[i].anchor == last) features_[i].anchor = anchor;
  }
  if (frame_anchor_ == anchor) {
    frame_anchor_ = -1;
  } else if (frame_anchor_ == last) {
    frame_anchor_ = anchor;
  }
  remove_block(at);
}

/// Takes a block out of the state; the last block moves into its place.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::remove_block(int at) {
  const int last = covariance_.size() - layout_.block;
  covariance_.remove_block_unordered(at, layout_.block);
  if (at == last) return;
  for (int i = 0; i < layout_.block; ++i) x_[at + i] = x_[last + i];
  for (int i = 0; i < feature_count_; ++i) {
    if (features_[i].at == last) features_[i].at = at;
  }
  for (int i = 0; i < anchor_count_; ++i) {
    if (anchors_[i].at == last) anchors_[i].at = at;
  }
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::hash(Hash64& hash) const {
  const int n = covariance_.size();
  hash.add(static_cast<std::int32_t>(n));
  for (int i = 0; i < n; ++i) hash.add(x_[i]);
  const int elements = n * (n + 1) / 2;
  for (int i = 0; i < elements; ++i) hash.add(covariance_.data()[i]);
  for (int i = 0; i < feature_count_; ++i) {
    hash.add(features_[i].id);
    hash.add(static_cast<std::int32_t>(features_[i].at));
  }
}

}  // namespace cairn
