#pragma once

#include <cstdint>
#include <vector>

#include "cairn/mono/parameters.hpp"

#include "host_sim/experiments/turntable/turntable.hpp"

namespace cairn::host {

/// World and sensor of a points-only run: no images, the pixels of random points in a room of 6 m x
/// 3 m x 5.6 m around the rotation centre.
struct PointsScenario {
  TurntableMotion motion;
  int width = 360;
  int height = 240;
  double focal_px = 300.0;
  double focal_error = 0.0;         ///< share by which the filter's focal length is wrong
  double principal_error_px = 0.0;  ///< of the filter's cx
  double noise_px = 0.5;
  double drift_px = 0.0;        ///< random walk of each feature's pixel, per frame
  double outlier_share = 0.05;  ///< wrong matches inside the search ellipse
  int wanted_features = 25;
  std::uint64_t seed = 1;
};

/// One frame of a points-only run.
struct PointsFrame {
  double t_s = 0.0;
  double true_yaw_deg = 0.0;
  double yaw_error_deg = 0.0;
  double pitch_error_deg = 0.0;
  double attitude_error_deg = 0.0;
  double attitude_nees = 0.0;  ///< 3 degrees of freedom
  double nis = 0.0;
  int nis_dof = 0;
  int features = 0;
  int inliers = 0;
  double fading_factor = 1.0;
};

struct PointsResult {
  std::vector<PointsFrame> frames;
  double max_yaw_error_deg = 0.0;   ///< the paper's three measures: largest,
  double mean_yaw_error_deg = 0.0;  ///< mean absolute
  double mse_yaw_error_deg2 = 0.0;  ///< and mean square error
  double final_yaw_error_deg = 0.0;
  double mean_pitch_error_deg = 0.0;
  double mean_attitude_error_deg = 0.0;
  double max_attitude_error_deg = 0.0;
  double mean_nees = 0.0;  ///< attitude, 3 degrees of freedom
  double mean_nis = 0.0;   ///< per degree of freedom
  double focal_factor = 1.0;
  double mean_hypotheses = 0.0;
  double mean_features = 0.0;
  double mean_filter_us = 0.0;    ///< predict, search regions, update and map, wall clock
  double final_distance_m = 0.0;  ///< of the estimated camera position from its start
  /// Estimated displacement along the true one, relative to it; negative is the mirrored solution.
  double displacement_ratio = 0.0;
  int no_consensus = 0;  ///< frames
  bool lost = false;     ///< attitude error above 20 deg at any frame, or not finite
};

/// Runs the filter of scalar T over the scenario; with `bank` two of them, for a lever of unknown
/// sign (MonoBank).
template <class T>
PointsResult run_points(const PointsScenario& scenario, const MonoParameters<T>& parameters,
                        bool bank = false);

extern template PointsResult run_points<float>(const PointsScenario&, const MonoParameters<float>&,
                                               bool);
extern template PointsResult run_points<double>(const PointsScenario&,
                                                const MonoParameters<double>&, bool);

}  // namespace cairn::host
