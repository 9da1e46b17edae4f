#include "host_sim/evaluation/trajectory_evaluation.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace cairn::host {
namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979323846;

struct Similarity {
  double scale = 1.0;
  Matrix3<double> rotation = Matrix3<double>::Identity();
  Vector3<double> translation = Vector3<double>::Zero();
};

template <int N>
Eigen::Matrix<double, N, Eigen::Dynamic> positions(const std::vector<Rigid<double>>& poses) {
  Eigen::Matrix<double, N, Eigen::Dynamic> matrix(N, static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    matrix.col(static_cast<Eigen::Index>(i)) = poses[i].translation.template head<N>();
  }
  return matrix;
}

template <int N>
Similarity umeyama(const std::vector<Rigid<double>>& estimate,
                   const std::vector<Rigid<double>>& truth, bool with_scale) {
  const Eigen::Matrix<double, N + 1, N + 1> T =
      Eigen::umeyama(positions<N>(estimate), positions<N>(truth), with_scale);
  Similarity s;
  s.scale = with_scale ? std::cbrt(T.template topLeftCorner<N, N>().determinant()) : 1.0;
  s.rotation.template topLeftCorner<N, N>() = T.template topLeftCorner<N, N>() / s.scale;
  s.translation.template head<N>() = T.template topRightCorner<N, 1>();
  return s;
}

Similarity align(const std::vector<Rigid<double>>& estimate,
                 const std::vector<Rigid<double>>& truth, Alignment alignment) {
  switch (alignment) {
    case Alignment::kSe2:
      return umeyama<2>(estimate, truth, false);
    case Alignment::kSe3:
      return umeyama<3>(estimate, truth, false);
    case Alignment::kSim3:
      return umeyama<3>(estimate, truth, true);
    default:
      return {};
  }
}

/// Rotation R for which R * estimate is nearest to the truth in the chordal sense.
Matrix3<double> best_rotation(const std::vector<Rigid<double>>& estimate,
                              const std::vector<Rigid<double>>& truth) {
  Matrix3<double> sum = Matrix3<double>::Zero();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (truth[i].rotation * estimate[i].rotation.conjugate()).toRotationMatrix();
  }
  const Eigen::JacobiSVD<Matrix3<double>> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3<double> signs(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

double heading(const Quaternion<double>& rotation) {
  const Vector3<double> forward = rotation * Vector3<double>::UnitX();
  return atan2(forward.y(), forward.x());
}

}  // namespace

const char* to_string(Alignment alignment) {
  switch (alignment) {
    case Alignment::kSe2:
      return "se2";
    case Alignment::kSe3:
      return "se3";
    case Alignment::kSim3:
      return "sim3";
    default:
      return "start";
  }
}

std::optional<TrajectoryEvaluation> evaluate_trajectory(const std::vector<Rigid<double>>& estimate,
                                                        const std::vector<Rigid<double>>& truth,
                                                        Alignment alignment) {
  if (estimate.size() < 3 || estimate.size() != truth.size()) return std::nullopt;
  const Similarity s = align(estimate, truth, alignment);
  if (!std::isfinite(s.scale) || !(s.scale > 0.0) || !s.rotation.allFinite()) return std::nullopt;
  const Quaternion<double> rotation_to_truth(best_rotation(estimate, truth));
  const Quaternion<double> rotation(s.rotation);
  TrajectoryEvaluation evaluation;
  evaluation.alignment = alignment;
  evaluation.scale = s.scale;
  evaluation.T_truth_estimate = {rotation, s.translation};
  double position_sum = 0.0, rotation_sum = 0.0, heading_sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    Rigid<double> aligned;
    aligned.rotation = rotation * estimate[i].rotation;
    aligned.translation = s.scale * (s.rotation * estimate[i].translation) + s.translation;
    const double distance = (aligned.translation - truth[i].translation).norm();
    position_sum += distance * distance;
    const Quaternion<double> rest =
        truth[i].rotation.conjugate() * rotation_to_truth * estimate[i].rotation;
    rotation_sum += rotation_log(rest).squaredNorm();
    const double turn = wrap_angle(heading(aligned.rotation) - heading(truth[i].rotation));
    heading_sum += turn * turn;
    evaluation.final_drift_m = distance;
    evaluation.aligned.push_back(aligned);
  }
  const auto n = static_cast<double>(truth.size());
  evaluation.ate_rmse_m = std::sqrt(position_sum / n);
  evaluation.rotation_rmse_deg = kDegrees * std::sqrt(rotation_sum / n);
  evaluation.heading_rmse_deg = kDegrees * std::sqrt(heading_sum / n);
  return evaluation;
}

nlohmann::json to_json(const std::optional<TrajectoryEvaluation>& evaluation, bool has_heading) {
  nlohmann::json json = {{"aligned", nullptr},          {"ate_rmse_m", nullptr},
                         {"heading_rmse_deg", nullptr}, {"rotation_rmse_deg", nullptr},
                         {"final_drift_m", nullptr},    {"scale", nullptr},
                         {"similarity", nullptr}};
  if (!evaluation.has_value()) return json;
  json["aligned"] = to_string(evaluation->alignment);
  json["ate_rmse_m"] = evaluation->ate_rmse_m;
  if (has_heading) json["heading_rmse_deg"] = evaluation->heading_rmse_deg;
  json["rotation_rmse_deg"] = evaluation->rotation_rmse_deg;
  json["final_drift_m"] = evaluation->final_drift_m;
  json["scale"] = evaluation->scale;
  const Rigid<double>& T = evaluation->T_truth_estimate;
  json["similarity"] = {
      {"scale", evaluation->scale},
      {"rotation", {T.rotation.w(), T.rotation.x(), T.rotation.y(), T.rotation.z()}},
      {"translation", {T.translation.x(), T.translation.y(), T.translation.z()}}};
  return json;
}

}  // namespace cairn::host
