#pragma once

#include <cstdint>

#include "cairn/geometry/rigid.hpp"
#include "cairn/tracking/angular_rate.hpp"

namespace cairn {

/// Whether a gyroscope turns as the pictures do.
enum class GyroTrust : std::uint8_t {
  kUnproven,     ///< the camera has not turned enough, or the two agree badly
  kAgrees,       ///< its turns are those of the pictures
  kContradicted  ///< they are not: it is mounted otherwise than told, or its stamps are wrong
};

/// A camera's attitude by the pictures at a frame.
struct SeenAttitude {
  Quaternion<float> R_world_camera = Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F);
  float variance = 0.0F;     ///< of each axis, relative to the landmarks, rad^2
  float focal_sigma = 0.0F;  ///< of the focal length, relative: of all turns alike
  float lens_sigma = 0.0F;   ///< of a turn, relative: what else the calibration gets wrong
};

/// Bias and time offset of a gyroscope, and whether it can be right at all, from how the camera
/// turned by the pictures over stretches of half a second.
///
/// What the gyroscope's turn R_g over a stretch leaves of the pictures' is linear in the errors of
/// bias and offset: Log(R_g^T R_seen) = -J db + (w_end - R_g^T w_start) dt + t ds, J the integral
/// of the rotations to the stretch's end. The last part is the turn t times what the focal length,
/// the lens and the gyroscope's scale get wrong of turns, ds. A Kalman filter of these five states
/// takes one such measurement a stretch; those beyond 5 sigma are not taken.
///
/// Trust: over ways of some 20 mrad, the square of the difference of the two turns over that of the
/// larger. 0: they agree; 1: no better than nothing; 4: opposite. Smoothed over sixteen ways.
class GyroCalibration {
 public:
  static constexpr float kStretch_s = 0.5F;

  /// Starts anew. Domain: valid parameters.
  void reset(const GyroParameters& parameters);

  /// A frame whose pose the pictures tell. True where bias and offset changed. Cost: some 300
  /// multiply-adds, 500 more at a stretch's end.
  bool add(const GyroTurn& turn, const SeenAttitude& seen);
  /// The frame's pose, or its turn, is not known: stretches begin anew.
  void skip();
  /// Time passes.
  void age(float seconds);

  const Vector3<float>& bias() const { return bias_; }  ///< camera axes, rad/s
  float bias_sigma() const { return sqrt(largest_bias_variance()); }
  float time_offset_s() const { return offset_s_; }
  float time_offset_sigma_s() const { return sqrt(covariance_(3, 3)); }
  /// Of each axis of a turn: the samples' noise, bias, offset and scale, rad^2.
  float variance_of(const GyroTurn& turn) const {
    return variance_of(turn.variance, turn.rotation, turn.seconds,
                       turn.rate_after - turn.rate_before);
  }
  float variance_of(float noise, const Vector3<float>& rotation, float seconds,
                    const Vector3<float>& rate_change) const {
    return noise + largest_bias_variance() * square(seconds) +
           covariance_(3, 3) * rate_change.squaredNorm() +
           square(parameters_.scale_sigma) * rotation.squaredNorm();
  }
  GyroTrust trust() const { return trust_; }
  /// Ways compared so far, and their smoothed difference (0: equal, 1: no better than nothing).
  int ways() const { return ways_; }
  float difference() const { return difference_; }
  /// Sum of v g^T over them, v by the pictures and g by the gyroscope, faded: its rotation is what
  /// the mounting is wrong by.
  const Matrix3<float>& products() const { return products_; }

 private:
  struct Stretch {
    bool begun = false;
    Quaternion<float> seen = Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F);    ///< R_world_camera then
    Quaternion<float> turned = Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F);  ///< since, by the gyro
    Matrix3<float> by_bias = Matrix3<float>::Zero();
    Vector3<float> rate = Vector3<float>::Zero();  ///< at its start
    float seconds = 0.0F;
    float noise = 0.0F;
    float variance = 0.0F;  ///< of `seen`

    void begin(const SeenAttitude& at, const Vector3<float>& rate_then);
    void add(const GyroTurn& turn);
  };

  float largest_bias_variance() const;
  void compare(const SeenAttitude& seen);
  bool estimate(const GyroTurn& turn, const SeenAttitude& seen);
  void judge();

  GyroParameters parameters_;
  Vector3<float> bias_ = Vector3<float>::Zero();
  float offset_s_ = 0.0F;
  bool scaled_ = false;  ///< the scale's variance is that of the pictures
  float scale_ = 0.0F;   ///< by which the pictures' turns are larger, relative
  Matrix<float, 5, 5> covariance_ = Matrix<float, 5, 5>::Zero();  ///< bias, offset, scale
  Stretch stretch_;
  Stretch way_;
  Matrix3<float> products_ = Matrix3<float>::Zero();
  float difference_ = 0.0F;
  int ways_ = 0;
  GyroTrust trust_ = GyroTrust::kUnproven;
};

}  // namespace cairn
