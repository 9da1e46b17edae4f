#pragma once

#include <cstdint>

#include "cairn/base/health.hpp"
#include "cairn/base/status.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/tracking/frame_report.hpp"

namespace cairn {

/// What happened to a tracker: one counter of Health, or a change of its state.
enum class HealthEvent : std::uint8_t {
  kNonFiniteInput,
  kTimeError,
  kImageRefused,
  kFrameGap,
  kOdometryRefused,
  kOdometryGlitch,
  kOdometryTimeout,
  kRepeatedImage,
  kLoss,
  kRelocalisation,
  kFalseRelocalisationRefused,
  kReacquisition,
  kCovarianceRepair,
  kReset,
  kMapMessageDropped,
};
inline constexpr int kHealthEventCount = 15;
const char* to_string(HealthEvent event);

/// One entry of the list of last events.
struct HealthRecord {
  std::int64_t t_us = 0;  ///< of the first
  HealthEvent event = HealthEvent::kNonFiniteInput;
  std::uint32_t count = 0;  ///< how many of them followed one another
};

/// What the application can live with. Defaults: a vehicle that steers by the pose.
struct HealthLimits {
  float window_s = 1.0F;              ///< time constant of the averages
  float max_blind_s = 0.5F;           ///< longest time without a frame that tracks
  float max_position_sigma_m = 0.5F;  ///< of the pose; hand-held mode: the filter's unit
  float max_heading_sigma_rad = 0.1F;
  float max_outlier_share = 0.5F;  ///< of the matches

  /// kBadConfig unless every value is finite and above 0.
  Status validate() const;
};

/// Uncertainty of the reported pose, standard deviations.
struct PoseSigma {
  float position_m = 0.0F;  ///< square root of the summed variances
  float heading_rad = 0.0F;
};
/// Of a vehicle's covariance of (x, y, heading); negative variances give NaN.
PoseSigma pose_sigma(const Matrix3<float>& covariance);

/// Judges a tracker by one rule, beside it and without a part in tracking: healthy() is
/// score() < 1. The score is the largest of
///   blind time / max_blind_s,
///   sigma / limit, of position and heading,
///   outlier share / max_outlier_share, over the window,
///   NIS / its 99.99 % bound for the degrees of freedom in the window,
/// and at least 1 for one window after the filter was repaired or reset, or time after time was
/// refused. A score that is not a number is unhealthy too.
///
/// Call note() after each frame, refused or not. Cost: some 200 operations.
class HealthMonitor {
 public:
  static constexpr int kRecords = 16;

  /// Starts anew. kBadConfig: impossible limits; nothing is changed.
  Status reset(const HealthLimits& limits);

  /// After process_frame() at time `t_us` returned `status`. `report` is not looked at where the
  /// frame was refused.
  void note(std::int64_t t_us, Status status, const FrameReport& report, const Health& health,
            const PoseSigma& sigma);

  float score() const { return score_; }
  bool healthy() const { return score_ < 1.0F; }

  /// Sums over the window: normalised innovation squared over degrees of freedom (1 where the
  /// filter's noise is right), and over its 99.99 % bound.
  float nis_ratio() const { return dof_ > 0.0F ? nis_ / dof_ : 0.0F; }
  float nis_test_ratio() const;
  float outlier_share() const { return matches_ > 0.0F ? outliers_ / matches_ : 0.0F; }
  float blind_s() const { return blind_s_; }

  /// The last events, the newest first; events of one kind that follow one another are one entry.
  int record_count() const { return count_; }
  /// Domain: 0 <= i < record_count().
  const HealthRecord& record(int i) const;

 private:
  void note_events(std::int64_t t_us, const Health& health);
  void push(std::int64_t t_us, HealthEvent event, std::uint32_t count);
  void note_frame(float step_s, const FrameReport& report);
  float judge(const PoseSigma& sigma) const;

  HealthLimits limits_;
  Health health_;
  HealthRecord records_[kRecords];
  int newest_ = 0;
  int count_ = 0;
  bool begun_ = false;
  std::int64_t t_us_ = 0;
  float nis_ = 0.0F;
  float dof_ = 0.0F;
  float matches_ = 0.0F;
  float outliers_ = 0.0F;
  float blind_s_ = 0.0F;
  float since_repair_s_ = 0.0F;
  float refused_share_ = 0.0F;
  float score_ = 1.0F;
};

}  // namespace cairn
