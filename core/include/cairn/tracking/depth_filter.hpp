#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/numeric/positive_definite.hpp"

namespace cairn {

/// Depth filter of a pool of seeds: a Kalman filter over the errors of the present camera's
/// rotation, of the keyframes' rotations (pitch and yaw, each in its camera's own axes), and of
/// each seed's inverse depth. Rotation and depth are estimated together because a yaw error moves
/// the points on one side of the image as parallax does: a depth filtered alone would be wrong by
/// more than its variance. Camera translation counts as known.
///
/// State: 2 for the camera, 2 for each keyframe, 1 for each seed; a slot that is not in use has
/// variance zero. The means are the caller's; this class returns corrections to them.
template <int Keyframes, int Seeds>
class DepthFilter {
 public:
  static constexpr int kStates = 2 + 2 * Keyframes + Seeds;

  DepthFilter() { P_.resize(kStates); }

  /// Corrections of the means: rotations in rad about camera x and y, inverse depths in 1/m.
  struct Correction {
    float state[kStates] = {};
    Vector3<float> camera() const { return {state[0], state[1], 0.0F}; }
    Vector3<float> keyframe(int k) const { return {state[2 + 2 * k], state[3 + 2 * k], 0.0F}; }
    float depth(int slot) const { return state[2 + 2 * Keyframes + slot]; }
  };

  /// Residual of one seed: measured minus predicted pixel, and the Jacobians of the prediction.
  struct Residual {
    int slot = 0;
    int keyframe = 0;
    Vector2<float> pixel;
    Matrix2<float> by_camera;
    Matrix2<float> by_keyframe;
    Vector2<float> by_depth;
    Vector2<float> unmodelled = Vector2<float>::Zero();  ///< one sigma of what is not estimated
  };

  void clear() {
    P_.resize(0);
    P_.resize(kStates);
  }

  /// Adds the uncertainty of the camera's rotation since the frame before, rad per axis.
  void predict(float sigma_pitch, float sigma_yaw) {
    P_(0, 0) += square(sigma_pitch);
    P_(1, 1) += square(sigma_yaw);
  }

  /// Makes the current camera keyframe k. Cost: one pass over two rows.
  void begin_keyframe(int k) {
    const int first = 2 + 2 * k;
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < kStates; ++j) {
        if (j != first && j != first + 1) P_(first + i, j) = P_(i, j);
      }
    }
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j <= i; ++j) P_(first + i, first + j) = P_(i, j);
    }
  }

  void begin_seed(int slot, float variance) {
    end(state_of(slot), 1);
    P_(state_of(slot), state_of(slot)) = variance;
  }
  void end_keyframe(int k) { end(2 + 2 * k, 2); }
  void end_seed(int slot) { end(state_of(slot), 1); }
  /// Moves a seed's state from slot `from` to slot `to`, whose own is lost.
  void move_seed(int from, int to) {
    if (from == to) return;
    const int a = state_of(from);
    const int b = state_of(to);
    for (int j = 0; j < kStates; ++j) {
      if (j != a && j != b) P_(b, j) = P_(a, j);
    }
    P_(b, b) = P_(a, a);
    end(a, 1);
  }

  /// Of the camera's yaw since keyframe k, rad^2; at least what a hundredth of a pixel tells: looks
  /// at a yaw that was unknown leave a difference of which rounding makes anything.
  float yaw_variance(int k) const {
    constexpr float kLeast = 1e-9F;
    const int yaw = 3 + 2 * k;
    const float difference = P_(1, 1) - 2.0F * P_(yaw, 1) + P_(yaw, yaw);
    return difference > kLeast ? difference : kLeast;
  }
  float variance(int slot) const { return P_(state_of(slot), state_of(slot)); }

  /// Innovation covariance of a residual, px^2.
  Matrix2<float> innovation_covariance(const Residual& residual, float sigma_px) const {
    int index[kTerms];
    Vector2<float> h[kTerms];
    terms(residual, index, h);
    Matrix2<float> s = square(sigma_px) * Matrix2<float>::Identity();
    s += residual.unmodelled * residual.unmodelled.transpose();
    for (int a = 0; a < kTerms; ++a) {
      for (int b = 0; b < kTerms; ++b) s += P_(index[a], index[b]) * (h[a] * h[b].transpose());
    }
    return s;
  }

  /// Uses a residual, taken at the predicted state, after the corrections that this frame has
  /// gathered so far in `correction`, to which its own is added. False, and nothing changed, when
  /// it is outside the gate. Cost: 2 kStates^2 multiply-adds.
  bool update(const Residual& residual, float sigma_px, float gate, Correction& correction) {
    int index[kTerms];
    Vector2<float> h[kTerms];
    terms(residual, index, h);
    Vector2<float> innovation = residual.pixel;
    for (int a = 0; a < kTerms; ++a) innovation -= correction.state[index[a]] * h[a];
    const Matrix2<float> s = innovation_covariance(residual, sigma_px);
    float i00 = 0.0F;
    float i01 = 0.0F;
    float i11 = 0.0F;
    if (!invert_spd2(s(0, 0), s(0, 1), s(1, 1), i00, i01, i11)) return false;
    const float w0 = i00 * innovation.x() + i01 * innovation.y();
    const float w1 = i01 * innovation.x() + i11 * innovation.y();
    if (!(innovation.x() * w0 + innovation.y() * w1 <= gate)) return false;
    float a[kStates];
    float b[kStates];
    float coefficients[2][kTerms];
    for (int k = 0; k < kTerms; ++k) {
      coefficients[0][k] = h[k].x();
      coefficients[1][k] = h[k].y();
    }
    P_.multiply_sparse(index, coefficients[0], kTerms, a);
    P_.multiply_sparse(index, coefficients[1], kTerms, b);
    for (int j = 0; j < kStates; ++j) correction.state[j] += a[j] * w0 + b[j] * w1;
    float resolved[kTerms];
    for (int k = 0; k < kTerms; ++k) {
      resolved[k] = kRoundingNoise<float> * P_(index[k], index[k]);
    }
    P_.downdate(a, b, i00, i01, i11);
    for (int k = 0; k < kTerms; ++k) {
      float& variance = P_(index[k], index[k]);
      if (!(variance > resolved[k])) variance = resolved[k];
    }
    return true;
  }

 private:
  static constexpr int kTerms = 5;

  static int state_of(int slot) { return 2 + 2 * Keyframes + slot; }

  void end(int first, int count) {
    for (int i = first; i < first + count; ++i) {
      for (int j = 0; j < kStates; ++j) P_(i, j) = 0.0F;
    }
  }

  static void terms(const Residual& residual, int* index, Vector2<float>* h) {
    index[0] = 0;
    index[1] = 1;
    index[2] = 2 + 2 * residual.keyframe;
    index[3] = index[2] + 1;
    index[4] = state_of(residual.slot);
    for (int k = 0; k < 2; ++k) {
      h[k] = residual.by_camera.col(k);
      h[2 + k] = residual.by_keyframe.col(k);
    }
    h[4] = residual.by_depth;
  }

  PackedSymmetric<float, kStates> P_;
};

}  // namespace cairn
