#pragma once

#include <cstdint>

#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/frame_input.hpp"
#include "cairn/tracking/handheld_gyro.hpp"
#include "cairn/tracking/handheld_rotation.hpp"
#include "cairn/tracking/window_motion.hpp"
#include "cairn/window/window_pose.hpp"

namespace cairn {

/// How a camera moved to a frame, in its own axes. `known`: there is a frame before to tell it.
struct CameraMovement {
  bool known = false;
  Vector3<float> rate_radps = Vector3<float>::Zero();
  Vector3<float> velocity = Vector3<float>::Zero();  ///< as the translation of T_camera_world
};

/// The pose of a hand-held camera and how it goes on: constant velocity and rate, what turned the
/// whole picture, and a gyroscope. Poses are T_camera_world; lengths are in the map's unit.
class CameraTrack {
 public:
  struct Parameters {
    HandheldRotation::Parameters rotation;
    GyroParameters gyro;                 ///< of the samples, where there are any
    float velocity_change_sigma = 1.0F;  ///< from frame to frame, depths a second; 0: anything

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = ok(rotation.validate()) && ok(gyro.validate()) &&
                        is_finite(velocity_change_sigma) && velocity_change_sigma >= 0.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  /// Starts anew, at the world's origin. `inverse_depth`: of what it sees, while nothing is known
  /// of it. `covariance_factor`: sigmas are divided by it where they are weighed as landmarks are,
  /// whose errors count as independent.
  void reset(const Parameters& parameters, float inverse_depth, float covariance_factor);

  /// As GyroIntegrator::add().
  Status add(const AngularRateSample& sample, Health& health) { return gyro_.add(sample, health); }
  const HandheldGyro& gyro() const { return gyro_; }

  // A frame.
  /// Its picture, and the gyroscope's turn to it. Every frame.
  void take_frame(FrameContext& frame, std::int64_t t_us) {
    rotation_.take(frame);
    gyro_.take_frame(t_us);
  }
  /// Time goes on. Every frame that is tracked, then predict().
  void advance(const FrameStep& step) {
    age_s_ += step.seconds();
    unseen_s_ += step.seconds();
    gap_ = gap_ || step.gap;
  }
  /// With constant velocity and rate; where the whole picture turned otherwise, with its rotation.
  /// A gyroscope that agrees with the pictures takes the place of both, one that is not proven yet
  /// that of the constant rate.
  Rigid<float> predict(FrameContext& frame, const FrameStep& step);
  /// From where the frame's features are sought. The whole picture shows how what is in view moved,
  /// whatever moved it. Where that is farther than `reach_rad` from what `predicted` makes of it,
  /// the search would miss: there the camera is turned so that it does not. As a pose this would
  /// take a translation for a turn.
  Rigid<float> search_from(const Rigid<float>& predicted, const FrameStep& step,
                           float reach_rad) const;
  /// Where the camera was, turned by the gyroscope.
  Rigid<float> standing() const {
    return gyro_.predicts() ? motion_.turned(pose_, gyro_.turn().rotation) : pose_;
  }
  /// The movement that leads to a pose of the present frame; the turn is the gyroscope's, where it
  /// agrees.
  CameraMovement movement_to(const Rigid<float>& pose) const;
  /// What is known of the frame's pose without its landmarks, as observations of it. A hand keeps
  /// its velocity from frame to frame, nearly: where depths are unknown a movement explains a turn
  /// nearly as well, and this tells the two apart. With a gyroscope that agrees, the attitude that
  /// it predicts is one more observation. `attitude_variance`: of the pose before, each axis.
  void observe(const Rigid<float>& predicted, float attitude_variance,
               WindowPoseOptions<float>& options) const;
  /// Standard deviation of where the frame shows what it shows, rad; negative where none is known.
  float direction_sigma(const FrameStep& step) const;

  // What comes of it.
  /// The frame's landmarks show its pose.
  void move_to(const Rigid<float>& pose) {
    motion_.note(pose_, pose, gap_ ? 0.0F : age_s_);
    stand_at(pose);
  }
  /// They do not: what a gyroscope, or the whole picture, predicts is taken for it.
  void drift_to(const Rigid<float>& predicted) {
    if (!gyro_.predicts() && !by_picture_) return;
    pose_ = predicted;
    age_s_ = 0.0F;
  }
  /// The frame's pose is known, the movement to it is not.
  void stand_at(const Rigid<float>& pose) {
    pose_ = pose;
    age_s_ = unseen_s_ = 0.0F;
    gap_ = false;
  }
  /// The frame's pose is known better.
  void correct(const Rigid<float>& pose) {
    pose_ = pose;
    pose_.rotation.coeffs() *= 1.0F / sqrt(pose_.rotation.squaredNorm());
  }
  void forget_motion() { motion_.forget(); }
  void forget_velocity() { motion_.forget_velocity(); }
  /// Inverse depth of what is in view; 0: it is not known.
  void note_depth(float inverse_depth) {
    if (inverse_depth > 0.0F) typical_inverse_depth_ = inverse_depth;
  }
  void note_attitude(const SeenAttitude& seen) { gyro_.note_pose(seen); }
  void note_weak() { gyro_.note_weak(); }
  /// The frame becomes a keyframe. True where the gyroscope knows how it turned since the last one:
  /// R_last_present, and its variance, weighed as landmarks are.
  bool note_keyframe(Quaternion<float>& turned, float& variance) {
    const bool known = gyro_.since_keyframe(turned, variance);
    variance /= square(covariance_factor_);
    gyro_.note_keyframe();
    return known;
  }

  /// Of the last frame whose pose is known.
  const Rigid<float>& pose() const { return pose_; }
  /// Last that was noted, 0 before.
  float typical_inverse_depth() const { return typical_inverse_depth_; }
  float expected_inverse_depth() const {
    return typical_inverse_depth_ > 0.0F ? typical_inverse_depth_ : first_inverse_depth_;
  }

 private:
  HandheldRotation rotation_;
  HandheldGyro gyro_;
  WindowMotion motion_;
  Rigid<float> pose_;
  float velocity_change_sigma_ = 0.0F;
  float hand_speed_mps_ = 0.0F;
  float covariance_factor_ = 1.0F;
  float first_inverse_depth_ = 1.0F;
  float typical_inverse_depth_ = 0.0F;
  float age_s_ = 0.0F;       ///< of pose_, at the frame's time
  float unseen_s_ = 0.0F;    ///< since the landmarks last showed a pose
  bool gap_ = false;         ///< since then nothing is known of the movement for a while
  bool by_picture_ = false;  ///< the frame's prediction is that of the whole picture's turn
};

inline void CameraTrack::reset(const Parameters& parameters, float inverse_depth,
                               float covariance_factor) {
  rotation_.reset(parameters.rotation);
  gyro_.reset(parameters.gyro);
  motion_.reset();
  velocity_change_sigma_ = parameters.velocity_change_sigma;
  hand_speed_mps_ = parameters.rotation.hand_speed_mps;
  covariance_factor_ = covariance_factor;
  first_inverse_depth_ = inverse_depth;
  typical_inverse_depth_ = 0.0F;
  stand_at(Rigid<float>());
}

inline Rigid<float> CameraTrack::predict(FrameContext& frame, const FrameStep& step) {
  const float dt_s = step.seconds();
  by_picture_ = false;
  if (step.gap) motion_.forget();
  if (gyro_.sure()) return motion_.predict_turned(pose_, gyro_.turn().rotation, dt_s);
  const bool by_gyro = gyro_.predicts() && !step.gap && step.us > 0;
  const Vector3<float> rate =
      by_gyro ? Vector3<float>(gyro_.turn().rotation / dt_s) : motion_.rate_radps();
  if (!step.gap && rotation_.seek(frame, rate, motion_.speed(), expected_inverse_depth(), dt_s)) {
    by_picture_ = true;
    return motion_.predict_turned(pose_, rotation_.rotation(), dt_s);
  }
  if (by_gyro) return motion_.predict_turned(pose_, gyro_.turn().rotation, dt_s);
  return motion_.predict(pose_, dt_s);
}

inline Rigid<float> CameraTrack::search_from(const Rigid<float>& predicted, const FrameStep& step,
                                             float reach_rad) const {
  constexpr float kSigmas = 2.0F;
  if (by_picture_ || step.gap || gyro_.predicts() || !rotation_.aligned()) return predicted;
  const float dt_s = step.seconds();
  const Vector3<float> moved = expected_inverse_depth() * dt_s * motion_.velocity();
  const Vector3<float> turn =
      rotation_.rotation() - Vector3<float>(moved.y(), -moved.x(), 0.0F);  // what it looks like
  const Vector3<float> off = turn - motion_.rate_radps() * dt_s;
  bool far = false;
  for (int i = 0; i < 2; ++i) {
    far = far || (abs(off(i)) > reach_rad && abs(off(i)) > kSigmas * rotation_.alignment_rad()(i));
  }
  return far ? motion_.predict_turned(pose_, turn, dt_s) : predicted;
}

inline CameraMovement CameraTrack::movement_to(const Rigid<float>& pose) const {
  CameraMovement movement;
  if (gap_ || !(age_s_ > 0.0F)) return movement;
  WindowMotion motion;
  motion.note(pose_, pose, age_s_);
  movement.known = true;
  movement.rate_radps = gyro_.sure() ? gyro_.turn().rate_after : motion.rate_radps();
  movement.velocity = motion.velocity();
  return movement;
}

inline void CameraTrack::observe(const Rigid<float>& predicted, float attitude_variance,
                                 WindowPoseOptions<float>& options) const {
  const float centre_sigma =
      velocity_change_sigma_ * unseen_s_ / (expected_inverse_depth() * covariance_factor_);
  if (centre_sigma > 0.0F && !gap_) {
    options.centre = predicted.inverse().translation;
    options.centre_information = 1.0F / square(centre_sigma);
  }
  if (!gyro_.sure()) return;
  options.attitude = predicted.rotation;
  options.attitude_information = 1.0F / (gyro_.turn_variance() + attitude_variance);
}

inline float CameraTrack::direction_sigma(const FrameStep& step) const {
  if (!gyro_.sure() || !motion_.moves()) return -1.0F;
  const float moved = hand_speed_mps_ * typical_inverse_depth_ * step.seconds();
  return sqrt(gyro_.turn_variance() + square(moved));
}

}  // namespace cairn
