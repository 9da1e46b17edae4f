#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

template <class T, int MaxFeatures, int MaxAnchors>
typename MonoEkf<T, MaxFeatures, MaxAnchors>::Layout
MonoEkf<T, MaxFeatures, MaxAnchors>::make_layout(const Parameters& parameters) {
  Layout layout;
  int next = 0;
  if (parameters.motion == MotionModel::kSixDof) {
    layout.position = next;
    next += 3;
  }
  if (parameters.motion == MotionModel::kPivot) {
    layout.lever = next;
    next += 3;
  }
  layout.quaternion = next;
  next += 4;
  if (parameters.estimate_focal_length) layout.focal = next++;
  layout.measured = next;
  if (parameters.motion == MotionModel::kSixDof) {
    layout.velocity = next;
    next += 3;
  }
  layout.rate = next;
  layout.size = next + 3;
  layout.block = parameters.motion == MotionModel::kRotationOnly ? 2 : 3;
  return layout;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::initialise(const PinholeCamera<T>& camera,
                                                       const Parameters& parameters) {
  const Status camera_status = camera.validate();
  if (!ok(camera_status)) return camera_status;
  const Status status = parameters.validate();
  if (!ok(status)) return status;

  parameters_ = parameters;
  camera_ = camera;
  layout_ = make_layout(parameters);
  feature_count_ = 0;
  anchor_count_ = 0;
  frame_anchor_ = -1;
  next_conversion_ = 0;
  next_check_ = 0;
  unsound_ = false;
  innovation_memory_ = T(-1);
  last_fading_factor_ = T(1);
  first_inverse_depth_ = parameters.initial_inverse_depth;
  first_inverse_depth_sigma_ = parameters.initial_inverse_depth_sigma;
  health_ = Health{};
  for (int i = 0; i < kMaxStates; ++i) x_[i] = T(0);
  x_[layout_.quaternion] = T(1);
  covariance_.resize(0);
  covariance_.resize(layout_.size);
  process_noise_.resize(0);
  process_noise_.resize(layout_.size);
  const auto set_variance = [this](int at, T sigma) {
    for (int i = at; i < at + 3; ++i) covariance_(i, i) = sigma * sigma;
  };
  if (layout_.velocity >= 0) set_variance(layout_.velocity, parameters.initial_velocity_sigma_mps);
  set_variance(layout_.rate, parameters.initial_rate_sigma_radps);
  if (layout_.lever >= 0) {
    for (int i = 0; i < 3; ++i) x_[layout_.lever + i] = parameters.lever_m(i);
    set_variance(layout_.lever, parameters.lever_sigma_m);
  }
  if (layout_.focal >= 0) {
    covariance_(layout_.focal, layout_.focal) = square(parameters.focal_sigma);
  }
  initialised_ = true;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::restart(const Rigid<T>& T_world_camera) {
  if (!initialised_) return Status::kNotInitialised;
  if (parameters_.motion == MotionModel::kPivot) return Status::kBadConfig;
  const Vector3<T>& r = T_world_camera.translation;
  const Quaternion<T>& q = T_world_camera.rotation;
  const T norm = sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  if (!is_finite(r.x()) || !is_finite(r.y()) || !is_finite(r.z()) || !is_finite(norm) ||
      !(abs(norm - T(1)) < T(0.01))) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  const Health kept = health_;
  const Parameters parameters = parameters_;
  const PinholeCamera<T> camera = camera_;
  const Status status = initialise(camera, parameters);
  if (!ok(status)) return status;
  health_ = kept;
  ++health_.resets;
  const T attitude[4] = {q.w(), q.x(), q.y(), q.z()};
  for (int i = 0; i < 4; ++i) x_[layout_.quaternion + i] = attitude[i] / norm;
  if (layout_.position >= 0) {
    for (int i = 0; i < 3; ++i) x_[layout_.position + i] = r(i);
  }
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::restart_moving(const Rigid<T>& T_world_camera) {
  const Vector3<T> velocity = velocity_mps();
  const Vector3<T> rate = rate_radps();
  T inverse_depth = first_inverse_depth_;
  T sigma = first_inverse_depth_sigma_;
  expected_inverse_depth(inverse_depth, sigma);
  const Status status = restart(T_world_camera);
  if (!ok(status)) return status;
  for (int i = 0; i < 3; ++i) {
    if (layout_.velocity >= 0) x_[layout_.velocity + i] = velocity(i);
    x_[layout_.rate + i] = rate(i);
  }
  first_inverse_depth_ = inverse_depth;
  first_inverse_depth_sigma_ = sigma;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Vector<T, 4> MonoEkf<T, MaxFeatures, MaxAnchors>::quaternion_at(const T* x) const {
  const T* q = x + layout_.quaternion;
  return {q[0], q[1], q[2], q[3]};
}

template <class T, int MaxFeatures, int MaxAnchors>
Vector3<T> MonoEkf<T, MaxFeatures, MaxAnchors>::position_at(const T* x) const {
  if (layout_.position >= 0) return vector3_at(x, layout_.position);
  if (layout_.lever < 0) return Vector3<T>::Zero();
  const Vector3<T> lever = vector3_at(x, layout_.lever);
  return mono::rotation_matrix<T>(quaternion_at(x)) * lever - lever;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::set_motion_noise(T velocity_noise, T rate_noise) {
  if (!is_finite(velocity_noise) || !is_finite(rate_noise)) return Status::kNonFiniteInput;
  if (velocity_noise < T(0) || rate_noise < T(0)) return Status::kInvalidArgument;
  parameters_.velocity_noise = velocity_noise;
  parameters_.rate_noise = rate_noise;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::predict(T dt_s) {
  if (!initialised_) return Status::kNotInitialised;
  if (!is_finite(dt_s)) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (!(dt_s > T(0)) || dt_s > parameters_.max_step_s) {
    ++health_.time_errors;
    if (dt_s == T(0)) return Status::kDuplicate;
    return dt_s < T(0) ? Status::kTimeBackwards : Status::kTimeGap;
  }
  const mono::RotationStep<T> step =
      mono::rotation_step<T>(quaternion_at(x_), vector3_at(x_, layout_.rate), dt_s);
  if (layout_.position >= 0) {
    for (int i = 0; i < 3; ++i) x_[layout_.position + i] += dt_s * x_[layout_.velocity + i];
  }
  for (int i = 0; i < 4; ++i) x_[layout_.quaternion + i] = step.q(i);
  propagate(step, dt_s);
  add_rounding_noise(dt_s);
  if (parameters_.fading == FadingMode::kFixed) fade(parameters_.fading_factor, false);
  set_process_noise(step, dt_s);
  add_process_noise();
  frame_anchor_ = -1;
  return Status::kOk;
}

/// v <- F v for a column of the camera block.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::apply_transition(const mono::RotationStep<T>& step,
                                                           T dt_s, T* v) const {
  if (layout_.position >= 0) {
    for (int i = 0; i < 3; ++i) v[layout_.position + i] += dt_s * v[layout_.velocity + i];
  }
  T* q = v + layout_.quaternion;
  const T* w = v + layout_.rate;
  T moved[4];
  for (int i = 0; i < 4; ++i) {
    T sum = T(0);
    for (int k = 0; k < 4; ++k) sum += step.wrt_q(i, k) * q[k];
    for (int k = 0; k < 3; ++k) sum += step.wrt_rate(i, k) * w[k];
    moved[i] = sum;
  }
  for (int i = 0; i < 4; ++i) q[i] = moved[i];
}

/// P <- F P F^T; F is the identity outside the camera block, so only its rows and columns change.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::propagate(const mono::RotationStep<T>& step, T dt_s) {
  const int size = layout_.size;
  T block[kMaxCameraStates][kMaxCameraStates];
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) block[i][j] = covariance_(i, j);
    apply_transition(step, dt_s, block[i]);
  }
  for (int j = 0; j < size; ++j) {
    T column[kMaxCameraStates];
    for (int i = 0; i < size; ++i) column[i] = block[i][j];
    apply_transition(step, dt_s, column);
    for (int i = j; i < size; ++i) covariance_.row(i)[j] = column[i];
  }
  for (int i = size; i < covariance_.size(); ++i) {
    apply_transition(step, dt_s, covariance_.row(i));
  }
}

/// Q = G diag(sigma_v^2 dt, sigma_w^2 dt) G^T: an impulse on velocity and rate at the start of the
/// step, so that position and attitude share it. Civera et al. 2008, eq. 3.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::set_process_noise(const mono::RotationStep<T>& step,
                                                            T dt_s) {
  process_noise_.set_zero();
  if (layout_.position >= 0) {
    const T variance = square(parameters_.velocity_noise) * dt_s;
    for (int i = 0; i < 3; ++i) {
      const int r = layout_.position + i;
      const int v = layout_.velocity + i;
      process_noise_(r, r) = dt_s * dt_s * variance;
      process_noise_(v, r) = dt_s * variance;
      process_noise_(v, v) = variance;
    }
  }
  const T variance = square(parameters_.rate_noise) * dt_s;
  for (int i = 0; i < 4; ++i) {
    const int q = layout_.quaternion + i;
    for (int j = 0; j <= i; ++j) {
      T sum = T(0);
      for (int k = 0; k < 3; ++k) sum += step.wrt_rate(i, k) * step.wrt_rate(j, k);
      process_noise_(q, layout_.quaternion + j) = variance * sum;
    }
    for (int k = 0; k < 3; ++k)
      process_noise_(layout_.rate + k, q) = variance * step.wrt_rate(i, k);
  }
  for (int k = 0; k < 3; ++k) process_noise_(layout_.rate + k, layout_.rate + k) = variance;
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::add_process_noise() {
  for (int i = 0; i < layout_.size; ++i) {
    for (int j = 0; j <= i; ++j) covariance_.row(i)[j] += process_noise_.row(i)[j];
  }
}

/// Largest variance that fading may reach, per state. Without it the directions that no image can
/// observe (scale, absolute position and heading) would grow as S^k without bound; the inverse
/// depth never needs more than its prior, and the focal length does not move at all.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::fading_limits(T* limit) const {
  const T length = T(100) / square(parameters_.initial_inverse_depth);  // 10 typical depths
  const T angle = T(0.25);
  const T speed = T(100) * length;
  const auto fill = [limit](int at, int count, T value) {
    for (int i = at; i < at + count; ++i) limit[i] = value;
  };
  if (layout_.position >= 0) fill(layout_.position, 3, length);
  if (layout_.lever >= 0) fill(layout_.lever, 3, square(parameters_.lever_sigma_m));
  fill(layout_.quaternion, 4, angle);
  if (layout_.focal >= 0) fill(layout_.focal, 1, T(0));
  if (layout_.velocity >= 0) fill(layout_.velocity, 3, speed);
  fill(layout_.rate, 3, T(100));
  for (int i = 0; i < anchor_count_; ++i) fill(anchors_[i].at, 3, length);
  for (int i = 0; i < feature_count_; ++i) {
    const Feature& feature = features_[i];
    if (feature.kind == FeatureKind::kPoint) {
      fill(feature.at, 3, length);
      continue;
    }
    fill(feature.at, 2, angle);
    if (feature.kind == FeatureKind::kInverseDepth) {
      limit[feature.at + 2] = square(parameters_.initial_inverse_depth_sigma);
    }
  }
}

/// P <- S P, capped: a state at its limit is scaled by less, as a congruence, so that P stays
/// positive semidefinite. With `keep_process_noise` the Q of the last prediction is left out.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::fade(T factor, bool keep_process_noise) {
  last_fading_factor_ = factor;
  if (factor == T(1)) return;
  const int n = covariance_.size();
  T scale[kMaxStates];
  bool free[kMaxStates];
  fading_limits(scale);
  const T root = sqrt(factor);
  for (int i = 0; i < n; ++i) {
    const T variance = covariance_.row(i)[i];
    const T limit = scale[i];
    free[i] = variance * factor <= limit;
    scale[i] = free[i] ? root : (variance < limit ? sqrt(limit / variance) : T(1));
  }
  for (int i = 0; i < n; ++i) {
    T* row = covariance_.row(i);
    for (int j = 0; j <= i; ++j) {
      const T both = free[i] && free[j] ? factor : scale[i] * scale[j];
      row[j] *= both;
      if (keep_process_noise && i < layout_.size) {
        row[j] -= (both - T(1)) * process_noise_.row(i)[j];
      }
    }
  }
}

}  // namespace cairn
