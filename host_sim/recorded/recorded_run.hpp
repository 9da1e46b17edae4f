#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/options/run_options.hpp"
#include "host_sim/recorded/association.hpp"
#include "host_sim/recorded/recorded_filter.hpp"
#include "host_sim/recorded/recording.hpp"

namespace cairn::host {

struct RecordedRunOptions {
  std::string filter = kDefaultVehicleFilter;
  std::uint64_t seed = 1;
  /// Given: the start error is drawn from them. Absent: the true start, with kKnownStartVariance.
  std::optional<double> start_position_variance;
  std::optional<double> start_heading_variance;
  std::optional<double> longest_s;
  double budget_ms = kDefaultBudgetMs;  ///< of a step, for the summary
  double noise_scale = 1.0;             ///< of the sightings' sigmas, to test wrong settings
  PlanarParameters<double> parameters;
  AssociationParameters association;
};

/// Estimate at one instant of the 10 Hz grid, after what happened at it.
struct RecordedSample {
  double t_s = 0.0;
  Pose2 pose;
  std::optional<RecordedTruth> truth;
  double nees = 0.0;  ///< 0 without a true heading
};

/// One scan and the odometry before it: a row of frames.csv.
struct RecordedStep {
  double t_s = 0.0;
  Status status = Status::kOk;  ///< of the last call that the filter refused, if any
  double predict_us = 0.0;      ///< odometry since the scan before
  double scan_us = 0.0;         ///< association, update and new landmarks
  int sightings = 0;
  int matches = 0;  ///< sightings of landmarks in the state
  int used = 0;     ///< of these, inside the gate
  int landmarks = 0;
};

/// Wall time of one kind of step, microseconds.
struct StepTimes {
  std::vector<float> values_us;
  double mean() const;
  double quantile(double q) const;
};

struct RecordedRun {
  std::vector<RecordedSample> samples;
  std::vector<RecordedStep> steps;
  std::vector<MappedLandmark> landmarks;
  double nis_sum = 0.0;
  std::int64_t nis_dof = 0;
  std::int64_t sightings = 0;
  std::int64_t ambiguous = 0;
  std::uint64_t tentative_dropped = 0;
  int refused_calls = 0;  ///< calls that the filter refused with an error
  StepTimes predict;
  StepTimes scan;  ///< association, update and new landmarks
  Health health;
  std::uint32_t saturations = 0;  ///< of a filter in fixed point
};

RecordedRun run_recorded(const Recording& recording, const RecordedRunOptions& options);

/// Errors against the truth.
struct RecordedErrors {
  int samples = 0;
  double position_rmse_m = 0.0;  ///< in the true frame, as started
  double aligned_rmse_m = 0.0;   ///< after the best SE(2) alignment
  double aligned_median_m = 0.0;
  double aligned_p95_m = 0.0;
  double heading_rmse_rad = 0.0;
  double final_drift_m = 0.0;
  double nees_mean = 0.0;
  double nees_inside_percent = 0.0;  ///< samples inside the 95 % interval of 3 dof
  int map_landmarks = 0;
  double map_rmse_m = 0.0;          ///< in the true frame
  double map_aligned_rmse_m = 0.0;  ///< after the map's own best SE(2) alignment
  double map_nees_mean = 0.0;       ///< of the landmarks at the end, 2 degrees of freedom
};
RecordedErrors recorded_errors(const Recording& recording, const RecordedRun& run);

/// Best rotation and translation from `from` to `to` in the least-squares sense (Umeyama without
/// scale).
void align_se2(const std::vector<Eigen::Vector2d>& from, const std::vector<Eigen::Vector2d>& to,
               Eigen::Matrix2d& rotation, Eigen::Vector2d& translation);

}  // namespace cairn::host
