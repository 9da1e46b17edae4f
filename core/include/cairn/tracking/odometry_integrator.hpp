#pragma once

#include <cstdint>

#include "cairn/base/health.hpp"
#include "cairn/base/status.hpp"
#include "cairn/planar/increment.hpp"
#include "cairn/planar/steady_ackermann.hpp"
#include "cairn/tracking/frame_report.hpp"

namespace cairn {

struct OdometryNoise {
  float sigma_speed_mps = 0.1F;  ///< per sample
  float sigma_turn = 0.0873F;    ///< steering angle, rad, or yaw rate, rad/s, per sample
  float wheelbase_m = 0.5F;      ///< kAckermann only
  float sample_period_s = 0.1F;  ///< the period at which the noise above is stated
  float steady_s = 0.3F;  ///< time constant of the low-passed readings at which noise is linearised
};

/// Moves a planar filter by odometry samples. The last motion is extrapolated beyond its sample, so
/// that the filter can predict the pose at a frame's time; its noise does not depend on the number
/// of steps.
class OdometryIntegrator {
 public:
  /// Starts anew, at rest at time `t_us`. A step longer than `max_step_us` is not integrated.
  void reset(const OdometryNoise& noise, std::int64_t max_step_us, std::int64_t t_us);

  /// Integrates up to the sample's time. kNonFiniteInput, kTimeBackwards: sample refused. Else as
  /// integrate_to().
  template <class Filter>
  Status add(const OdometrySample& sample, Filter& filter, Health& health);

  /// Integrates the last motion up to `t_us`; does nothing where the pose is at that time already.
  /// kTimeGap: time moved on, the motion was not integrated. Else as Filter::predict().
  template <class Filter>
  Status integrate_to(std::int64_t t_us, Filter& filter, Health& health);

  float speed_mps() const { return motion_.speed_mps; }
  /// Variance of the yaw increment since the last forget_yaw(), rad^2.
  float yaw_variance() const { return yaw_variance_; }
  void forget_yaw() { yaw_variance_ = 0.0F; }

 private:
  Status take(const OdometrySample& sample, Health& health);
  PlanarIncrement<float> increment_over(float dt_s) const;
  PlanarIncrement<float> increment_of(const OdometrySample& motion, float dt_s, float scale) const;

  OdometryNoise noise_;
  std::int64_t max_step_us_ = 0;
  std::int64_t time_us_ = 0;  ///< of the filter's pose
  OdometrySample motion_;
  SteadyReading<float> steady_;
  bool has_motion_ = false;
  float yaw_variance_ = 0.0F;
};

template <class Filter>
Status OdometryIntegrator::add(const OdometrySample& sample, Filter& filter, Health& health) {
  const Status taken = take(sample, health);
  // A frame may have moved the pose beyond this sample already: its motion then begins there.
  return ok(taken) ? integrate_to(sample.t_us, filter, health) : taken;
}

template <class Filter>
Status OdometryIntegrator::integrate_to(std::int64_t t_us, Filter& filter, Health& health) {
  const std::int64_t step_us = t_us - time_us_;
  if (step_us <= 0) return Status::kOk;
  time_us_ = t_us;
  if (!has_motion_) return Status::kOk;
  if (step_us > max_step_us_) {
    ++health.time_errors;
    return Status::kTimeGap;
  }
  const PlanarIncrement<float> increment = increment_over(static_cast<float>(step_us) * 1e-6F);
  const Status status = filter.predict(increment);
  if (ok(status)) yaw_variance_ += increment.covariance(1, 1);
  return status;
}

}  // namespace cairn
