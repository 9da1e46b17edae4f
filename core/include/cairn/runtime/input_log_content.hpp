#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/planar/tilt.hpp"
#include "cairn/tracking/angular_rate.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/rolling_shutter.hpp"

namespace cairn {

/// Input log: everything that a run's result depends on, in one stream of bytes that replays on any
/// target. Little endian. "CAIRNLOG", then records of {u8 type, u8[3] zero, u32 payload bytes,
/// payload, u32 CRC-32 (IEEE 802.3) of all before it in the record}: one header, then odometry and
/// frames in time order, then one end record with their counts. A log of a rational or a fisheye
/// lens has a header with 16 bytes more and version kInputLogLensVersion; one whose focal length is
/// estimated, with either header, has kInputLogFocalVersion; one with a gyroscope has
/// 48 bytes more behind either, its samples among the odometry's and frames, and
/// kInputLogGyroVersion; one of a rolling shutter has 8 bytes more behind all of these and
/// kInputLogReadoutVersion, with a gyroscope or without.
inline constexpr std::uint16_t kInputLogVersion = 3;
inline constexpr std::uint16_t kInputLogLensVersion = 4;
inline constexpr std::uint16_t kInputLogFocalVersion = 5;
inline constexpr std::uint16_t kInputLogGyroVersion = 6;
inline constexpr std::uint16_t kInputLogReadoutVersion = 7;

enum class LogMode : std::uint8_t { kVehicle = 0, kHandheld = 1 };
enum class LogFilter : std::uint8_t {
  kGroupIekf = 0,
  kLiftedIekf = 1,
  kEkf = 2,
  kMono = 3,
  kWindow = 4,
  kGroupIekfFixed = 5
};

/// What a tracker is set up with. Float throughout: the host rounds once, when it writes the log,
/// so that boards without double read the same numbers.
struct InputLogHeader {
  LogMode mode = LogMode::kVehicle;
  LogFilter filter = LogFilter::kGroupIekf;
  OdometrySample::Kind odometry_kind = OdometrySample::Kind::kTwist;
  bool adaptive_fading = false;
  float fading = 1.0F;  ///< fading-memory factor S, 1 <= S <= 2
  /// Of the focal length, in 1/10,000 of it, at most 10,000. kWindow alone.
  std::uint16_t focal_sigma_e4 = 0;
  std::uint64_t seed = 1;
  std::int64_t start_t_us = 0;  ///< time of the start pose: the first frame's
  PinholeCamera<float> camera;
  Rigid<float> T_vehicle_camera;
  float speed_sigma_mps = 0.0F;
  float turn_sigma = 0.0F;   ///< rad/s (kTwist) or rad (kAckermann)
  float wheelbase_m = 0.0F;  ///< kAckermann alone
  float odometry_period_s = 0.1F;
  float frame_rate_hz = 30.0F;
  float start_x_m = 0.0F;
  float start_y_m = 0.0F;
  float start_theta_rad = 0.0F;
  float start_position_variance = 0.0F;
  float start_heading_variance = 0.0F;
  TiltParameters<float> tilt;  ///< of the vehicle's body
  bool with_gyro = false;      ///< the log has samples of a gyroscope
  GyroParameters gyro;
  ReadoutTimes readout;  ///< kWindow alone

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const;
};

struct LogFrame {
  static constexpr std::int32_t kOwnWorkLimit = -1;

  std::uint32_t number = 0;
  std::int64_t t_us = 0;
  std::int32_t work_limit = kOwnWorkLimit;  ///< units (WorkBudget), or the tracker's own
};

enum class LogEvent : std::uint8_t { kOdometry, kFrame, kEnd, kAngularRate };

}  // namespace cairn
