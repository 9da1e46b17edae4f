#pragma once

namespace cairn {

/// First-order low pass of odometry readings (speed in m/s; steering angle in rad, or yaw rate in
/// rad/s): where the noise of an increment is linearised. See SteadyAckermann.
template <class T>
class ReadingLowPass {
 public:
  /// `time_constant_s` >= 0; 0 follows the readings.
  explicit ReadingLowPass(T time_constant_s = T(0)) : time_constant_s_(time_constant_s) {}

  /// A reading `dt_s` after the one before; the first one is taken as it is.
  void add(T speed, T turn, T dt_s) {
    const T share = !has_reading_ ? T(1) : dt_s > T(0) ? dt_s / (dt_s + time_constant_s_) : T(0);
    speed_ += share * (speed - speed_);
    turn_ += share * (turn - turn_);
    has_reading_ = true;
  }

  T speed() const { return speed_; }
  T turn() const { return turn_; }

 private:
  T time_constant_s_;
  T speed_ = T(0);
  T turn_ = T(0);
  bool has_reading_ = false;
};

}  // namespace cairn
