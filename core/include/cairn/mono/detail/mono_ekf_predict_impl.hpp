#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::initialise(const PinholeCamera<T>& camera,
                                                       const Parameters& parameters) {
  const Status camera_status = camera.validate();
  if (!ok(camera_status)) return camera_status;
  const Status status = parameters.validate();
  if (!ok(status)) return status;

  parameters_ = parameters;
  state_.camera.reset(camera, parameters);
  features_.clear();
  guard_.reset();
  memory_.reset();
  first_inverse_depth_ = parameters.initial_inverse_depth;
  first_inverse_depth_sigma_ = parameters.initial_inverse_depth_sigma;
  health_ = Health{};
  for (int i = 0; i < kMaxStates; ++i) state_.x[i] = T(0);
  state_.x[layout().quaternion] = T(1);
  state_.covariance.resize(0);
  state_.covariance.resize(layout().size);
  motion_.reset(layout().size);
  const auto set_variance = [this](int at, T sigma) {
    for (int i = at; i < at + 3; ++i) state_.covariance(i, i) = sigma * sigma;
  };
  if (layout().velocity >= 0)
    set_variance(layout().velocity, parameters.initial_velocity_sigma_mps);
  set_variance(layout().rate, parameters.initial_rate_sigma_radps);
  if (layout().lever >= 0) {
    for (int i = 0; i < 3; ++i) state_.x[layout().lever + i] = parameters.lever_m(i);
    set_variance(layout().lever, parameters.lever_sigma_m);
  }
  if (layout().focal >= 0) {
    state_.covariance(layout().focal, layout().focal) = square(parameters.focal_sigma);
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
  const PinholeCamera<T> camera = state_.camera.told();
  const Status status = initialise(camera, parameters);
  if (!ok(status)) return status;
  health_ = kept;
  ++health_.resets;
  const T attitude[4] = {q.w(), q.x(), q.y(), q.z()};
  for (int i = 0; i < 4; ++i) state_.x[layout().quaternion + i] = attitude[i] / norm;
  if (layout().position >= 0) {
    for (int i = 0; i < 3; ++i) state_.x[layout().position + i] = r(i);
  }
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::restart_moving(const Rigid<T>& T_world_camera) {
  const Vector3<T> velocity = velocity_mps();
  const Vector3<T> rate = rate_radps();
  T inverse_depth = first_inverse_depth_;
  T sigma = first_inverse_depth_sigma_;
  features_.expected_inverse_depth(state_, inverse_depth, sigma);
  const Status status = restart(T_world_camera);
  if (!ok(status)) return status;
  for (int i = 0; i < 3; ++i) {
    if (layout().velocity >= 0) state_.x[layout().velocity + i] = velocity(i);
    state_.x[layout().rate + i] = rate(i);
  }
  first_inverse_depth_ = inverse_depth;
  first_inverse_depth_sigma_ = sigma;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::set_motion_noise(T velocity_noise, T rate_noise) {
  if (!is_finite(velocity_noise) || !is_finite(rate_noise)) return Status::kNonFiniteInput;
  const auto in_domain = [](T noise) {
    return noise >= T(0) && noise <= MonoParameters<T>::kLargest;
  };
  if (!in_domain(velocity_noise) || !in_domain(rate_noise)) return Status::kInvalidArgument;
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
  const mono::RotationStep<T> step = motion_.move(state_, dt_s);
  if (parameters_.fading == FadingMode::kFixed) fade(parameters_.fading_factor, false);
  motion_.add_noise(state_, step, parameters_.velocity_noise, parameters_.rate_noise, dt_s);
  features_.leave_anchor();
  return Status::kOk;
}

/// One axis after the other: the rate is measured, and the attitude follows by what the noise of
/// the step made common to both.
template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::observe_rotation(const Vector3<T>& rotation,
                                                             const Vector3<T>& sigma_rad, T dt_s) {
  if (!initialised_) return Status::kNotInitialised;
  bool finite = is_finite(dt_s);
  bool positive = dt_s > T(0);
  for (int k = 0; k < 3; ++k) {
    finite = finite && is_finite(rotation(k)) && is_finite(sigma_rad(k));
    positive = positive && sigma_rad(k) > T(0);
  }
  if (!finite) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (!positive) return Status::kInvalidArgument;
  const int n = state_.size();
  T delta[kMaxStates] = {};
  T* const gain = state_.scratch[0];
  state_.covariance.inflate_diagonal(kRoundingNoise<T>);
  for (int k = 0; k < 3; ++k) {
    const int w = layout().rate + k;
    for (int i = 0; i < n; ++i) gain[i] = state_.covariance(i, w);
    const T s = (T(1) + kRoundingNoise<T>)*gain[w] + square(sigma_rad(k) / dt_s);
    const T step = (rotation(k) / dt_s - state_.x[w] - delta[w]) / s;
    for (int i = 0; i < n; ++i) delta[i] += gain[i] * step;
    state_.covariance.downdate(gain, T(1) / s);
  }
  correct_state(delta);
  guard_.check(state_, features_, health_);
  return Status::kOk;
}

/// With `keep_process_noise` the Q of the last prediction is left out.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::fade(T factor, bool keep_process_noise) {
  memory_.note_factor(factor);
  if (factor == T(1)) return;
  T limit[kMaxStates];
  state_.camera.fading_limits(parameters_, limit);
  features_.fading_limits(parameters_, limit);
  mono::FadingMemory<T>::fade(factor, state_.covariance, limit,
                              keep_process_noise ? &motion_.noise() : nullptr);
}

}  // namespace cairn
