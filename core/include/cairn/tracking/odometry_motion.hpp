#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/planar/increment.hpp"
#include "cairn/planar/reading_low_pass.hpp"
#include "cairn/tracking/frame_report.hpp"

namespace cairn {

struct OdometryNoise {
  float sigma_speed_mps = 0.1F;  ///< per sample
  float sigma_turn = 0.0873F;    ///< steering angle, rad, or yaw rate, rad/s, per sample
  float wheelbase_m = 0.5F;      ///< kAckermann only
  float sample_period_s = 0.1F;  ///< the period at which the noise above is stated
  float steady_s = 0.3F;  ///< time constant of the low-passed readings at which noise is linearised
  float max_acceleration_mps2 = 20.0F;  ///< a reading that changes faster counts as a glitch
  /// Lateral slip: how far before or behind the vehicle's origin the place lies that does not move
  /// sideways in a turn, standard deviation; 0: the vehicle never slips laterally.
  float turn_centre_m = 0.1F;
  /// Standard deviations of the motion while nothing is measured, or of the last reading's size
  /// where that is larger.
  float unknown_speed_mps = 1.0F;
  float unknown_yaw_rate_radps = 0.5F;

  /// kBadConfig for a value that is not finite or not above 0 (`steady_s` and `turn_centre_m` may
  /// be 0), and for a `turn_centre_m` beyond 10.
  Status validate() const;
};

/// The motion that a vehicle is believed to have between two samples of its odometry, and what that
/// makes of a time, with noise. It is held from the newest sample on, or is what the images show.
class OdometryMotion {
 public:
  static constexpr float kMaxSpeed_mps = 300.0F;
  static constexpr float kMaxSteering_rad = 1.4F;

  /// Distance and yaw increment of a time, without noise.
  struct Step {
    float distance_m = 0.0F;
    float yaw_rad = 0.0F;
  };
  /// Variances of position (m^2) and heading (rad^2).
  struct Drift {
    float position = 0.0F;
    float heading = 0.0F;
  };

  /// Starts anew, at rest at time `t_us`. Motion is held for at most `max_step_us`.
  void reset(const OdometryNoise& noise, std::int64_t max_step_us, std::int64_t t_us);

  const OdometryNoise& noise() const { return noise_; }
  std::int64_t max_step_us() const { return max_step_us_; }
  float max_step_s() const { return static_cast<float>(max_step_us_) * 1e-6F; }
  /// A sample's motion, or that of the images at a sample's time.
  const OdometrySample& held() const { return held_; }
  bool by_images() const { return by_images_; }
  /// Whether there was a sample since the start.
  bool has_sample() const { return has_sample_; }
  /// Whether the newest sample is exactly no motion.
  bool at_rest() const;
  /// Whether a reading of its kind can be that large.
  static bool is_possible(const OdometrySample& reading);
  /// 0 where `later_us` is no later.
  static float seconds_between(std::int64_t later_us, std::int64_t earlier_us);
  float seconds_since_sample(std::int64_t t_us) const;
  /// Since the sample, or the image, that tells the motion held.
  float seconds_since_known(std::int64_t t_us) const;

  /// The newest sample counts as of `t_us`: the clock was set, or one of that time is not believed.
  void count_from(std::int64_t t_us) { held_.t_us = t_us; }
  /// Holds the motion of a sample that is believed.
  void take(const OdometrySample& sample);
  /// From now on the low-passed motion: held for longer than a sample is meant for, one reading's
  /// noise would become a turn.
  void hold_steadily();
  /// From now on the motion is the images' to correct, as speed and yaw rate.
  void hold_by_images();
  void correct(float speed_mps, float yaw_rate, std::int64_t t_us);

  /// The low-passed readings, or what the images show.
  OdometrySample steady() const;
  /// The low pass begins anew with the next reading.
  void forget_steady() { steady_ = ReadingLowPass<float>(noise_.steady_s); }
  /// What they will be with `sample`.
  OdometrySample steady_with(const OdometrySample& sample) const;
  Step over(const OdometrySample& reading, float dt_s) const;
  /// The motion held, over `dt_s`, with its noise. `slip_mps`: standard deviation of the speed that
  /// wheels which slip add.
  PlanarIncrement<float> increment_over(float dt_s, float slip_mps) const;
  /// A reading's, with noise of `scale` times that of a sample.
  PlanarIncrement<float> increment_of(const OdometrySample& reading, float dt_s, float scale,
                                      float slip_mps) const;
  /// Variance of the lateral slip in a time, m^2.
  float lateral_slip_over(float dt_s) const;
  /// What the time since the motion was known adds between `from_s` and `to_s` after it.
  Drift drift_between(float from_s, float to_s) const;
  /// What `step_s` adds where only the samples before and after it are known.
  Drift drift_between_samples(const OdometrySample& first, const OdometrySample& last,
                              float step_s) const;

 private:
  float sigma_speed(float scale, float slip_mps) const;
  float yaw_outlier() const;

  std::int64_t max_step_us_ = 0;
  std::int64_t seen_us_ = 0;  ///< of the last image that corrected what is held
  OdometrySample held_;
  OdometryNoise noise_;
  ReadingLowPass<float> steady_;
  bool has_sample_ = false;
  bool by_images_ = false;
};

}  // namespace cairn
