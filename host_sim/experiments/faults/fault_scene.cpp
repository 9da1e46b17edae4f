#include "host_sim/experiments/faults/fault_scene.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include "host_sim/base/names.hpp"
#include "host_sim/reports/run_summary.hpp"

namespace cairn::host {
namespace {

constexpr int kLasting = 5;  // frames of tracking that count as a return

/// Of a landmark whose height the floor gives, one eigenvalue is 0 but for rounding.
bool positive_semidefinite(const Matrix3<double>& covariance) {
  if (!covariance.allFinite()) return false;
  constexpr double kRounding = 1e-5;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] >= -kRounding * solver.eigenvalues()[2];
}

bool positive_definite(const Matrix3<double>& covariance) {
  if (!covariance.allFinite()) return false;
  const Eigen::LLT<Eigen::Matrix3d> cholesky(covariance);
  return cholesky.info() == Eigen::Success;
}

/// Counters that grow in every run and say nothing about a fault.
bool is_routine(const std::string& name) {
  static const std::vector<std::string> routine = {
      "innovations_used",      "innovations_gated",  "landmarks_added",
      "landmarks_removed",     "candidates_dropped", "landmarks_archived",
      "landmarks_reactivated", "searches_deferred",  "corners_dropped"};
  return std::find(routine.begin(), routine.end(), name) != routine.end();
}

/// Follows one drive and gathers its figures.
class DriveRecorder {
 public:
  DriveRecorder(Tracker& tracker, int work_limit) : tracker_(tracker), work_limit_(work_limit) {
    before_ = tracker.health();
    last_.t_us = std::numeric_limits<std::int64_t>::min();  // no frame's
  }

  void odometry(const OdometrySample& sample) {
    const std::uint64_t state = tracker_.state_hash();
    const Status status = tracker_.add_odometry(sample);
    ++drive_.odometry_statuses[cairn::to_string(status)];
    const bool taken = status == Status::kOk || status == Status::kGated;
    if (taken || (status == Status::kTimeGap && tracker_.state_hash() != state)) return;
    ++drive_.refused_odometry;
    if (tracker_.state_hash() != state) ++drive_.refused_and_changed;
  }

  void picture(const Frame& frame, bool in_fault) {
    const std::uint64_t state = tracker_.state_hash();
    cv::Mat overlay = frame.grey.clone();
    Frame alone = frame;
    alone.odometry.clear();
    FrameReport report = last_;
    const Status status = tracker_.process(alone, overlay, report);
    ++drive_.frames;
    ++drive_.statuses[cairn::to_string(status)];
    if (report.t_us == last_.t_us) {
      ++drive_.refused;
      if (tracker_.state_hash() != state) ++drive_.refused_and_changed;
    } else {
      last_ = report;
      judge(frame, report, in_fault);
    }
  }

  FaultDrive finish() {
    const Health after = tracker_.health();
    drive_.counters = grown_counters(before_, after);
    drive_.losses = static_cast<int>(after.losses - before_.losses);
    drive_.relocalisations = static_cast<int>(after.relocalisations - before_.relocalisations);
    drive_.end_state = to_string(last_.state);
    drive_.grown.repeated_images = after.repeated_images - before_.repeated_images;
    drive_.grown.budget_exceeded = after.budget_exceeded - before_.budget_exceeded;
    drive_.grown.resets = after.resets - before_.resets;
    drive_.grown.odometry_glitches = after.odometry_glitches - before_.odometry_glitches;
    drive_.grown.odometry_timeouts = after.odometry_timeouts - before_.odometry_timeouts;
    drive_.grown.frame_gaps = after.frame_gaps - before_.frame_gaps;
    drive_.grown.low_texture_frames = after.low_texture_frames - before_.low_texture_frames;
    return std::move(drive_);
  }

 private:
  void judge(const Frame& frame, const FrameReport& report, bool in_fault) {
    ++drive_.states[to_string(report.state)];
    drive_.most_work = std::max(drive_.most_work, report.work);
    if (report.work > work_limit_) ++drive_.over_work;
    if (!report.T_map_camera.translation.allFinite() ||
        !report.T_map_camera.rotation.coeffs().allFinite()) {
      ++drive_.not_finite;
    }
    judge_covariance();
    judge_pose(frame, report);
    if (in_fault) {
      in_a_row_ = 0;
      after_fault_ = 0;
      return;
    }
    ++after_fault_;
    in_a_row_ = report.state == TrackingState::kTracking ? in_a_row_ + 1 : 0;
    if (in_a_row_ == kLasting && drive_.frames_to_return < 0) {
      drive_.frames_to_return = after_fault_ - kLasting;
    }
  }

  void judge_covariance() {
    bool good = true;
    if (const auto pose = tracker_.vehicle_pose()) good = positive_definite(pose->covariance);
    if (const auto attitude = tracker_.attitude_covariance()) good = positive_definite(*attitude);
    for (const MapLandmark& landmark : tracker_.landmarks()) {
      good = good && positive_semidefinite(landmark.covariance);
    }
    if (!good) ++drive_.not_positive;
  }

  void judge_pose(const Frame& frame, const FrameReport& report) {
    const auto pose = tracker_.vehicle_pose();
    if (!pose.has_value() || !frame.true_T_world_vehicle.has_value()) return;
    const Rigid<double>& truth = *frame.true_T_world_vehicle;
    const Vector3<double> forward = truth.rotation * Vector3<double>::UnitX();
    const Vector3<double> error(
        pose->x_m - truth.translation.x(), pose->y_m - truth.translation.y(),
        wrap_angle(pose->theta_rad - cairn::atan2(forward.y(), forward.x())));
    const double nees = error.dot(pose->covariance.inverse() * error);
    const double distance = error.head<2>().norm();
    drive_.worst_error_m = std::max(drive_.worst_error_m.value_or(0.0), distance);
    drive_.final_error_m = distance;
    drive_.worst_nees = std::max(drive_.worst_nees.value_or(0.0), nees);
    if (report.state == TrackingState::kTracking && !(nees <= kOutside9999Dof3)) {
      ++drive_.false_claims;
    }
  }

  Tracker& tracker_;
  int work_limit_;
  Health before_;
  FaultDrive drive_;
  FrameReport last_;
  int in_a_row_ = 0;
  int after_fault_ = 0;
};

}  // namespace

FaultScene::FaultScene(SourceInfo info, std::vector<Frame> frames, const TrackerOptions& options,
                       const FaultSettings& settings)
    : info_(std::move(info)), frames_(std::move(frames)), options_(options), settings_(settings) {
  if (vehicle()) return;
  for (Frame& frame : frames_) frame.odometry.clear();
}

bool FaultScene::ackermann() const {
  return vehicle() && info_.odometry->kind == OdometrySample::Kind::kAckermann;
}

std::unique_ptr<Tracker> FaultScene::tracker() const {
  if (before_ == nullptr) {
    before_ = make_tracker(options_, info_);
    FrameReport report;
    for (int i = 0; i < settings_.from; ++i) {
      cv::Mat overlay = frames_[static_cast<std::size_t>(i)].grey.clone();
      static_cast<void>(before_->process(frames_[static_cast<std::size_t>(i)], overlay, report));
    }
  }
  return before_->clone();
}

FaultDrive FaultScene::drive(int length, const Injection& injection) const {
  const std::unique_ptr<Tracker> ready = tracker();
  return drive(*ready, settings_.from, length, injection);
}

FaultDrive FaultScene::drive(Tracker& tracker, int first, int length,
                             const Injection& injection) const {
  DriveRecorder recorder(tracker, settings_.work_limit);
  for (int k = 0; first + k < static_cast<int>(frames_.size()); ++k) {
    FaultStep step{frames_[static_cast<std::size_t>(first + k)]};
    if (k < length) injection(k, step);
    for (const OdometrySample& sample : step.frame.odometry) recorder.odometry(sample);
    if (step.dropped) continue;
    recorder.picture(step.frame, k < length);
    if (step.repeated) recorder.picture(step.frame, k < length);
  }
  return recorder.finish();
}

void start_at(const Frame& first, TrackerOptions& options) {
  if (!first.true_T_world_vehicle.has_value()) return;
  const Rigid<double>& truth = *first.true_T_world_vehicle;
  const Vector3<double> forward = truth.rotation * Vector3<double>::UnitX();
  options.start_x_m = truth.translation.x();
  options.start_y_m = truth.translation.y();
  options.start_theta_rad = cairn::atan2(forward.y(), forward.x());
}

std::string grown_counters(const Health& before, const Health& after) {
  const nlohmann::json old_values = to_json(before);
  const nlohmann::json new_values = to_json(after);
  std::string list;
  for (const auto& [name, value] : new_values.items()) {
    const std::uint32_t grown = value.get<std::uint32_t>() - old_values[name].get<std::uint32_t>();
    if (grown == 0 || is_routine(name)) continue;
    list += fmt::format("{}{} +{}", list.empty() ? "" : " ", name, grown);
  }
  return list;
}

FaultJudge& expect_honest(FaultJudge& judge, const FaultDrive& drive) {
  judge.expect(drive.not_finite == 0,
               fmt::format("pose not finite in {} frames", drive.not_finite));
  judge.expect(drive.not_positive == 0,
               fmt::format("covariance not positive definite in {} frames", drive.not_positive));
  judge.expect(drive.refused_and_changed == 0,
               fmt::format("{} refused inputs changed the estimate", drive.refused_and_changed));
  judge.expect(drive.over_work == 0, fmt::format("{} frames over the work limit, {} units",
                                                 drive.over_work, drive.most_work));
  judge.expect(drive.false_claims == 0,
               fmt::format("{} frames say tracking outside 99.99 % (NEES up to {:.0f})",
                           drive.false_claims, drive.worst_nees.value_or(0.0)));
  return judge;
}

FaultJudge& describe(FaultJudge& judge, const FaultDrive& drive) {
  std::string states;
  for (const auto& [state, count] : drive.states) {
    states += fmt::format("{}{} {}", states.empty() ? "" : " ", state, count);
  }
  judge.saw(states);
  std::string statuses;
  for (const auto& [status, count] : drive.statuses) {
    if (status != "ok")
      statuses += fmt::format("{}{} {}", statuses.empty() ? "" : " ", status, count);
  }
  if (!statuses.empty()) judge.saw("frames " + statuses);
  std::string odometry;
  for (const auto& [status, count] : drive.odometry_statuses) {
    if (status != "ok")
      odometry += fmt::format("{}{} {}", odometry.empty() ? "" : " ", status, count);
  }
  if (!odometry.empty()) judge.saw("odometry " + odometry);
  if (drive.worst_error_m.has_value()) {
    judge.saw(fmt::format("error up to {:.2f} m, {:.2f} m at the end, NEES up to {:.0f}",
                          *drive.worst_error_m, *drive.final_error_m, *drive.worst_nees));
  }
  judge.saw(drive.frames_to_return >= 0
                ? fmt::format("back {} frames after the fault", drive.frames_to_return)
                : fmt::format("not back, {} at the end", drive.end_state));
  return judge.counted(drive.counters);
}

}  // namespace cairn::host
