#include "cairn/runtime/health_monitor.hpp"

#include "cairn/base/time.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

namespace {

struct CountedEvent {
  HealthEvent event;
  std::uint32_t Health::*counter;
  char name[32];
};

constexpr CountedEvent kCounted[] = {
    {HealthEvent::kNonFiniteInput, &Health::non_finite_inputs, "non-finite input"},
    {HealthEvent::kTimeError, &Health::time_errors, "time error"},
    {HealthEvent::kImageRefused, &Health::images_refused, "image refused"},
    {HealthEvent::kFrameGap, &Health::frame_gaps, "frame gap"},
    {HealthEvent::kOdometryRefused, &Health::odometry_refused, "odometry refused"},
    {HealthEvent::kOdometryGlitch, &Health::odometry_glitches, "odometry glitch"},
    {HealthEvent::kOdometryTimeout, &Health::odometry_timeouts, "odometry timeout"},
    {HealthEvent::kRepeatedImage, &Health::repeated_images, "repeated image"},
    {HealthEvent::kLoss, &Health::losses, "loss"},
    {HealthEvent::kRelocalisation, &Health::relocalisations, "relocalisation"},
    {HealthEvent::kFalseRelocalisationRefused, &Health::false_relocalisations_refused,
     "false relocalisation refused"},
    {HealthEvent::kReacquisition, &Health::reacquisitions, "re-acquisition"},
    {HealthEvent::kCovarianceRepair, &Health::covariance_repairs, "covariance repair"},
    {HealthEvent::kReset, &Health::resets, "filter reset"},
    {HealthEvent::kMapMessageDropped, &Health::map_messages_dropped, "map message dropped"},
};
static_assert(sizeof kCounted / sizeof kCounted[0] == kHealthEventCount, "one counter an event");

bool concerns_filter(HealthEvent event) {
  return event == HealthEvent::kCovarianceRepair || event == HealthEvent::kReset;
}

/// A refused frame leaves the report of an earlier one.
bool was_refused(Status status, const FrameReport& report, std::int64_t t_us) {
  return report.t_us != t_us || report.status != status;
}

/// The larger of the two; not a number where one of them is none.
float worse(float a, float b) {
  return !is_finite(a) || a >= b ? a : b;
}

/// 99.99 % quantile of chi-square by Wilson and Hilferty's approximation: 5 % too large for 2
/// degrees of freedom, less than 1 % from 20 on.
float chi_square_bound(float dof) {
  constexpr float kNormalQuantile = 3.719F;
  const float variance = 2.0F / (9.0F * dof);
  const float root = 1.0F - variance + kNormalQuantile * sqrt(variance);
  return dof * root * root * root;
}

}  // namespace

const char* to_string(HealthEvent event) {
  return kCounted[static_cast<int>(event)].name;
}

Status HealthLimits::validate() const {
  const bool good = is_positive(window_s) && is_positive(max_blind_s) &&
                    is_positive(max_position_sigma_m) && is_positive(max_heading_sigma_rad) &&
                    is_positive(max_outlier_share);
  return good ? Status::kOk : Status::kBadConfig;
}

PoseSigma pose_sigma(const Matrix3<float>& covariance) {
  return {sqrt(covariance(0, 0) + covariance(1, 1)), sqrt(covariance(2, 2))};
}

Status HealthMonitor::reset(const HealthLimits& limits) {
  const Status status = limits.validate();
  if (!ok(status)) return status;
  *this = HealthMonitor();
  limits_ = limits;
  since_repair_s_ = limits.window_s;
  return Status::kOk;
}

void HealthMonitor::note(std::int64_t t_us, Status status, const FrameReport& report,
                         const Health& health, const PoseSigma& sigma) {
  const bool refused = was_refused(status, report, t_us);
  const std::int64_t step_us = begun_ ? difference_us(t_us, t_us_) : 0;
  const float step_s = refused || step_us < 0 ? 0.0F : static_cast<float>(step_us) * 1e-6F;
  since_repair_s_ += step_s;
  note_events(t_us, health);
  // The share is half after 17 refusals in a row.
  constexpr float kFrames = 24.0F;
  refused_share_ += ((refused ? 1.0F : 0.0F) - refused_share_) / kFrames;
  if (!refused) {
    note_frame(step_s, report);
    t_us_ = t_us;
    begun_ = true;
  }
  score_ = judge(sigma);
}

void HealthMonitor::note_events(std::int64_t t_us, const Health& health) {
  for (const CountedEvent& counted : kCounted) {
    const std::uint32_t grown = health.*counted.counter - health_.*counted.counter;
    if (grown == 0) continue;
    push(t_us, counted.event, grown);
    if (concerns_filter(counted.event)) since_repair_s_ = 0.0F;
  }
  health_ = health;
}

void HealthMonitor::push(std::int64_t t_us, HealthEvent event, std::uint32_t count) {
  if (count_ > 0 && records_[newest_].event == event) {
    records_[newest_].count += count;
    return;
  }
  newest_ = (newest_ + 1) % kRecords;
  records_[newest_] = {t_us, event, count};
  if (count_ < kRecords) ++count_;
}

const HealthRecord& HealthMonitor::record(int i) const {
  return records_[(newest_ + kRecords - i) % kRecords];
}

void HealthMonitor::note_frame(float step_s, const FrameReport& report) {
  const float keep = limits_.window_s / (limits_.window_s + step_s);
  nis_ = keep * nis_ + report.update.nis;
  dof_ = keep * dof_ + static_cast<float>(report.update.nis_dof);
  matches_ = keep * matches_ + static_cast<float>(report.matches);
  outliers_ = keep * outliers_ + static_cast<float>(report.matches - report.inliers);
  const bool tracks = report.state == TrackingState::kTracking;
  blind_s_ = tracks ? 0.0F : blind_s_ + (begun_ ? step_s : limits_.max_blind_s);
}

float HealthMonitor::nis_test_ratio() const {
  constexpr float kLeastDof = 2.0F;
  return dof_ >= kLeastDof ? nis_ / chi_square_bound(dof_) : 0.0F;
}

float HealthMonitor::judge(const PoseSigma& sigma) const {
  constexpr float kMaxRefusedShare = 0.5F;
  float score = blind_s_ / limits_.max_blind_s;
  score = worse(score, sigma.position_m / limits_.max_position_sigma_m);
  score = worse(score, sigma.heading_rad / limits_.max_heading_sigma_rad);
  score = worse(score, outlier_share() / limits_.max_outlier_share);
  score = worse(score, nis_test_ratio());
  score = worse(score, refused_share_ / kMaxRefusedShare);
  if (since_repair_s_ < limits_.window_s) score = worse(score, 1.0F);
  return score;
}

}  // namespace cairn
