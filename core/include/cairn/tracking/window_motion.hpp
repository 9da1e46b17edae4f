#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// How a hand-held camera moves from frame to frame: constant velocity and rate, in the axes of the
/// camera, and the pose that follows from them. Poses are T_camera_world.
class WindowMotion {
 public:
  void reset() { *this = WindowMotion(); }
  /// The camera went from one pose to the other in `dt_s`.
  void note(const Rigid<float>& before, const Rigid<float>& after, float dt_s) {
    if (!(dt_s > 0.0F)) return;
    const Rigid<float> moved = after * before.inverse();
    phi_ = rotation_log(moved.rotation) / dt_s;
    velocity_ = moved.translation / dt_s;
  }
  /// Nothing is known: the camera is expected to stand.
  void forget() { phi_ = velocity_ = Vector3<float>::Zero(); }
  /// The world has another scale.
  void forget_velocity() { velocity_ = Vector3<float>::Zero(); }

  Rigid<float> predict(const Rigid<float>& T_camera_world, float dt_s) const {
    return moved(T_camera_world, phi_ * dt_s, dt_s);
  }
  /// The same, where the camera turned by `rotation`: R_previous_present = Exp(rotation).
  Rigid<float> predict_turned(const Rigid<float>& T_camera_world, const Vector3<float>& rotation,
                              float dt_s) const {
    return moved(T_camera_world, -rotation, dt_s);
  }
  /// Turned as predict_turned(), from where the camera was.
  static Rigid<float> turned(const Rigid<float>& T_camera_world, const Vector3<float>& rotation) {
    return WindowMotion().moved(T_camera_world, -rotation, 0.0F);
  }
  /// Whether a velocity is known.
  bool moves() const { return velocity_.squaredNorm() > 0.0F; }
  /// In the axes of the camera, rad/s.
  Vector3<float> rate_radps() const { return -phi_; }
  /// In depths a second, as the translation of T_camera_world changes.
  const Vector3<float>& velocity() const { return velocity_; }
  float speed() const { return sqrt(velocity_.squaredNorm()); }

 private:
  Rigid<float> moved(const Rigid<float>& from, const Vector3<float>& turn, float dt_s) const {
    const Rigid<float> step{rotation_exp(turn), velocity_ * dt_s};
    Rigid<float> to = step * from;
    to.rotation.coeffs() *= 1.0F / sqrt(to.rotation.squaredNorm());
    return to;
  }

  Vector3<float> phi_ = Vector3<float>::Zero();
  Vector3<float> velocity_ = Vector3<float>::Zero();
};

}  // namespace cairn
