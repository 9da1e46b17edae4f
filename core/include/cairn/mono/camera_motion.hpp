#pragma once

#include "cairn/mono/mono_state.hpp"

namespace cairn::mono {

/// How the camera block moves on: x <- f(x), P <- F P F^T + Q, with velocity and rate held. Owns Q.
template <class T>
class CameraMotion {
 public:
  using Noise = PackedSymmetric<T, CameraBlock<T>::kMaxStates>;

  /// Without noise. `states`: of the camera block.
  void reset(int states) {
    noise_.resize(0);
    noise_.resize(states);
  }

  /// Moves state and covariance by `dt_s`, with noise for what F P F^T has rounded, by the size of
  /// its terms. Returns the step, for add_noise().
  template <int N>
  RotationStep<T> move(MonoState<T, N>& state, T dt_s) const;
  /// Adds the noise of that step: impulses of `velocity_noise` (m/s) and `rate_noise` (rad/s), each
  /// by the root of a second.
  template <int N>
  void add_noise(MonoState<T, N>& state, const RotationStep<T>& step, T velocity_noise,
                 T rate_noise, T dt_s);
  /// Q of the last step.
  const Noise& noise() const { return noise_; }

 private:
  static void apply(const CameraLayout& layout, const RotationStep<T>& step, T dt_s, T* v);
  template <int N>
  static void propagate(const CameraLayout& layout, const RotationStep<T>& step, T dt_s,
                        PackedSymmetric<T, N>& p);
  template <int N>
  static void add_rounding_noise(MonoState<T, N>& state, T dt_s);
  void set_noise(const CameraLayout& layout, const RotationStep<T>& step, T velocity_noise,
                 T rate_noise, T dt_s);

  Noise noise_;
};

template <class T>
template <int N>
RotationStep<T> CameraMotion<T>::move(MonoState<T, N>& state, T dt_s) const {
  const CameraLayout& layout = state.layout();
  const RotationStep<T> step =
      rotation_step<T>(state.quaternion(), vector3_at(state.x, layout.rate), dt_s);
  if (layout.position >= 0) {
    for (int i = 0; i < 3; ++i) {
      state.x[layout.position + i] += dt_s * state.x[layout.velocity + i];
    }
  }
  for (int i = 0; i < 4; ++i) state.x[layout.quaternion + i] = step.q(i);
  propagate(layout, step, dt_s, state.covariance);
  add_rounding_noise(state, dt_s);
  return step;
}

template <class T>
template <int N>
void CameraMotion<T>::add_noise(MonoState<T, N>& state, const RotationStep<T>& step,
                                T velocity_noise, T rate_noise, T dt_s) {
  const int size = state.layout().size;
  set_noise(state.layout(), step, velocity_noise, rate_noise, dt_s);
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j <= i; ++j) state.covariance.row(i)[j] += noise_.row(i)[j];
  }
}

/// v <- F v for a column of the camera block.
template <class T>
void CameraMotion<T>::apply(const CameraLayout& layout, const RotationStep<T>& step, T dt_s, T* v) {
  if (layout.position >= 0) {
    for (int i = 0; i < 3; ++i) v[layout.position + i] += dt_s * v[layout.velocity + i];
  }
  T* q = v + layout.quaternion;
  const T* w = v + layout.rate;
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
template <class T>
template <int N>
void CameraMotion<T>::propagate(const CameraLayout& layout, const RotationStep<T>& step, T dt_s,
                                PackedSymmetric<T, N>& p) {
  const int size = layout.size;
  T block[CameraBlock<T>::kMaxStates][CameraBlock<T>::kMaxStates];
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) block[i][j] = p(i, j);
    apply(layout, step, dt_s, block[i]);
  }
  for (int j = 0; j < size; ++j) {
    T column[CameraBlock<T>::kMaxStates];
    for (int i = 0; i < size; ++i) column[i] = block[i][j];
    apply(layout, step, dt_s, column);
    for (int i = j; i < size; ++i) p.row(i)[j] = column[i];
  }
  for (int i = size; i < p.size(); ++i) {
    apply(layout, step, dt_s, p.row(i));
  }
}

/// Of the sum, and of what the velocities bring.
template <class T>
template <int N>
void CameraMotion<T>::add_rounding_noise(MonoState<T, N>& state, T dt_s) {
  const CameraLayout& layout = state.layout();
  const T squared = dt_s * dt_s;
  T turned = state.attitude_variance();
  for (int i = 0; i < 3; ++i) {
    const int w = layout.rate + i;
    turned += squared * state.covariance.row(w)[w];
    if (layout.position < 0) continue;
    const int v = layout.velocity + i;
    T& position = state.covariance.row(layout.position + i)[layout.position + i];
    position += kRoundingNoise<T> * (position + squared * state.covariance.row(v)[v]);
  }
  state.inflate_attitude(turned);
}

/// Q = G diag(sigma_v^2 dt, sigma_w^2 dt) G^T: an impulse on velocity and rate at the start of the
/// step, so that position and attitude share it. Civera et al. 2008, eq. 3.
template <class T>
void CameraMotion<T>::set_noise(const CameraLayout& layout, const RotationStep<T>& step,
                                T velocity_noise, T rate_noise, T dt_s) {
  noise_.set_zero();
  if (layout.position >= 0) {
    const T variance = square(velocity_noise) * dt_s;
    for (int i = 0; i < 3; ++i) {
      const int r = layout.position + i;
      const int v = layout.velocity + i;
      noise_(r, r) = dt_s * dt_s * variance;
      noise_(v, r) = dt_s * variance;
      noise_(v, v) = variance;
    }
  }
  const T variance = square(rate_noise) * dt_s;
  for (int i = 0; i < 4; ++i) {
    const int q = layout.quaternion + i;
    for (int j = 0; j <= i; ++j) {
      T sum = T(0);
      for (int k = 0; k < 3; ++k) sum += step.wrt_rate(i, k) * step.wrt_rate(j, k);
      noise_(q, layout.quaternion + j) = variance * sum;
    }
    for (int k = 0; k < 3; ++k) noise_(layout.rate + k, q) = variance * step.wrt_rate(i, k);
  }
  for (int k = 0; k < 3; ++k) noise_(layout.rate + k, layout.rate + k) = variance;
}

}  // namespace cairn::mono
