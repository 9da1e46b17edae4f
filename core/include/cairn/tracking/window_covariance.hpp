#pragma once

#include "cairn/base/status.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/handheld_gyro.hpp"
#include "cairn/window/keyframe_window.hpp"
#include "cairn/window/window_bounds.hpp"

namespace cairn {

/// Covariance of the pose that a WindowTracker hands out. The window's is relative to its fixed
/// keyframes; the attitude's is carried on from keyframe to keyframe, over losses too, so that it
/// is relative to the first camera.
class WindowCovariance {
 public:
  using Window = KeyframeWindow<float, WindowBounds>;
  struct Parameters {
    float lens_sigma = 0.03F;  ///< of turns, relative: what else the calibration gets wrong
    /// Of the sigma: the square root of 64 landmarks, as if they shared all of their errors.
    float covariance_factor = 8.0F;
    float blind_rate_radps = 1.0F;  ///< sigma of a turn while too few landmarks are seen

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = is_finite(lens_sigma) && lens_sigma >= 0.0F &&
                        is_positive(covariance_factor) && is_finite(blind_rate_radps) &&
                        blind_rate_radps >= 0.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    covariance_.setZero();
    for (Matrix3<float>& attitude : attitude_) attitude.setZero();
    lost_attitude_.setZero();
    note_seen();
  }
  const Parameters& parameters() const { return parameters_; }

  /// The time to the frame is one of which nothing is known, or the gyroscope's turn.
  void note_frame(float seconds, const HandheldGyro& gyro) {
    if (gyro.sure()) {
      blind_variance_ += gyro.turn_variance();
    } else {
      blind_s_ += seconds;
    }
  }
  /// The landmarks show the frame's pose.
  void note_seen() { blind_s_ = blind_variance_ = 0.0F; }
  /// Tracking is lost: the attitude goes on from what is known of it now.
  void note_loss(const Window& window, const Rigid<float>& T_camera_world) {
    lost_attitude_ = attitude_[window.newest()] + by_focal(window, T_camera_world);
  }
  /// The first keyframe of a new map, where the camera is believed to be.
  void begin(int keyframe) {
    attitude_[keyframe] = lost_attitude_ + blind_variance() * Matrix3<float>::Identity();
    note_seen();
  }
  /// The same of one whose pose in the map is recognised.
  void resume(int keyframe) {
    attitude_[keyframe] = lost_attitude_;
    note_seen();
  }

  /// The attitude's error is that of the window's reference when it was the newest keyframe, of the
  /// newest keyframe relative to it, of the frame relative to the landmarks (`frame`, as
  /// estimate_window_pose() gives it), what the focal length's error makes of them, and the rest of
  /// the calibration of all turns. Domain: the window has a keyframe.
  void update(const Window& window, const Rigid<float>& T_camera_world,
              const Matrix<float, 6, 6>& frame);
  /// Of the pose, tangent (translation, rotation rad) in the axes of the camera: of the attitude
  /// relative to the first camera, of the position relative to the window's fixed keyframes.
  const Matrix<float, 6, 6>& value() const { return covariance_; }

 private:
  float blind_variance() const {
    return square(parameters_.blind_rate_radps * blind_s_) + blind_variance_;
  }
  static Matrix3<float> by_focal(const Window& window, const Rigid<float>& T_camera_world);

  Parameters parameters_;
  Matrix<float, 6, 6> covariance_ = Matrix<float, 6, 6>::Zero();
  Matrix3<float> attitude_[WindowBounds::kPoses];          ///< of keyframes, in world axes
  Matrix3<float> lost_attitude_ = Matrix3<float>::Zero();  ///< when tracking was lost
  float blind_s_ = 0.0F;
  float blind_variance_ = 0.0F;  ///< of the turn while a gyroscope told it, rad^2
};

inline void WindowCovariance::update(const Window& window, const Rigid<float>& T_camera_world,
                                     const Matrix<float, 6, 6>& frame) {
  const float inflation = square(parameters_.covariance_factor);
  const Matrix<float, 6, 6>& newest = window.newest_covariance();
  const Matrix3<float> newest_axes = window.newest_pose().rotation.conjugate().toRotationMatrix();
  const int reference = window.reference();
  if (window.newest() != reference) {
    attitude_[window.newest()] =
        attitude_[reference] +
        inflation * (newest_axes * newest.topLeftCorner<3, 3>() * newest_axes.transpose());
  }
  const Matrix3<float> R_world_camera = T_camera_world.rotation.conjugate().toRotationMatrix();
  const Vector3<float> turned = rotation_log(T_camera_world.rotation);
  const float unknown = square(parameters_.lens_sigma) * turned.squaredNorm() +
                        square(parameters_.blind_rate_radps * blind_s_) + blind_variance_;
  covariance_ = Matrix<float, 6, 6>::Zero();
  const Matrix<float, 6, 6> own = inflation * (frame + newest);
  covariance_.topLeftCorner<3, 3>() = own.bottomRightCorner<3, 3>();
  covariance_.bottomRightCorner<3, 3>() =
      R_world_camera.transpose() * (attitude_[window.newest()] + by_focal(window, T_camera_world)) *
          R_world_camera +
      inflation * frame.topLeftCorner<3, 3>() + unknown * Matrix3<float>::Identity();
}

/// The attitude's covariance from the focal length's, in world axes: the newest keyframe follows it
/// as the window says, and what the camera turned since shrinks as it grows.
inline Matrix3<float> WindowCovariance::by_focal(const Window& window,
                                                 const Rigid<float>& T_camera_world) {
  const Quaternion<float> since =
      T_camera_world.rotation * window.newest_pose().rotation.conjugate();
  const Vector3<float> follows =
      window.newest_pose().rotation.conjugate() * window.newest_by_focal().head<3>() -
      T_camera_world.rotation.conjugate() * rotation_log(since) / window.focal_scale();
  return square(window.focal_sigma()) * (follows * follows.transpose());
}

}  // namespace cairn
