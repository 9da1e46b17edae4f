#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "cairn/geometry/rigid.hpp"

namespace cairn::host {

/// How an estimated trajectory is laid over the true one before it is compared.
enum class Alignment {
  kStart,  ///< as estimated: the run started from the true pose
  kSe2,    ///< best planar motion
  kSe3,    ///< best rigid motion (Umeyama 1991)
  kSim3,   ///< best rigid motion and scale (Umeyama 1991)
};

const char* to_string(Alignment alignment);

struct TrajectoryEvaluation {
  Alignment alignment = Alignment::kStart;
  double scale = 1.0;  ///< true length of one unit of the estimate
  /// With `scale` the alignment: p_truth = rotation (scale p_estimate) + translation.
  Rigid<double> T_truth_estimate;
  double ate_rmse_m = 0.0;
  double rotation_rmse_deg = 0.0;  ///< after the rotation that is best for the rotations
  double heading_rmse_deg = 0.0;   ///< yaw about z, aligned as the positions
  double final_drift_m = 0.0;
  std::vector<Rigid<double>> aligned;  ///< the estimate, laid over the truth
};

/// Compares poses of equal index. Nothing for fewer than 3 poses, or when the positions do not
/// determine the alignment.
std::optional<TrajectoryEvaluation> evaluate_trajectory(const std::vector<Rigid<double>>& estimate,
                                                        const std::vector<Rigid<double>>& truth,
                                                        Alignment alignment);

/// `trajectory` of summary.json: aligned, ate_rmse_m, ...; nulls where there is no evaluation.
nlohmann::json to_json(const std::optional<TrajectoryEvaluation>& evaluation, bool has_heading);

}  // namespace cairn::host
