#include "host_sim/reports/run_trajectory.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/io/pose_file.hpp"

namespace cairn::host {
namespace {

Rigid<double> planar_rigid(const PlanarPoseEstimate& pose) {
  return {rotation_exp(Vector3<double>(0.0, 0.0, wrap_angle(pose.theta_rad))),
          Vector3<double>(pose.x_m, pose.y_m, 0.0)};
}

/// The pose that the trajectory files hold: the vehicle as the filter has it, or the camera.
std::optional<Rigid<double>> estimated_pose(const FrameRecord& frame, Mode mode) {
  if (mode == Mode::kVehicle) {
    if (!frame.vehicle.has_value()) return std::nullopt;
    return planar_rigid(*frame.vehicle);
  }
  if (!frame.has_pose()) return std::nullopt;
  return to_double(frame.report.T_map_camera);
}

const std::optional<Rigid<double>>& true_pose(const FrameRecord& frame, Mode mode) {
  return mode == Mode::kVehicle ? frame.true_T_world_vehicle : frame.true_T_world_camera;
}

}  // namespace

RunTrajectory evaluate_run(const RunRecord& record, Mode mode) {
  RunTrajectory trajectory;
  trajectory.planar = mode == Mode::kVehicle;
  trajectory.alignment = mode == Mode::kVehicle ? Alignment::kStart : Alignment::kSim3;
  std::vector<Rigid<double>> estimate, truth;
  for (std::size_t i = 0; i < record.frames.size(); ++i) {
    const FrameRecord& frame = record.frames[i];
    const std::optional<Rigid<double>> pose = estimated_pose(frame, mode);
    std::optional<Rigid<double>> real = true_pose(frame, mode);
    if (!pose.has_value() || !real.has_value()) continue;
    if (mode == Mode::kVehicle) {  // compared in the plane of the estimate
      const Vector3<double> forward = real->rotation * Vector3<double>::UnitX();
      real = planar_rigid({real->translation.x(), real->translation.y(),
                           cairn::atan2(forward.y(), forward.x()), Matrix3<double>::Zero()});
    }
    estimate.push_back(*pose);
    truth.push_back(*real);
    trajectory.compared.push_back(i);
  }
  trajectory.evaluation = evaluate_trajectory(estimate, truth, trajectory.alignment);
  return trajectory;
}

void write_trajectories(const std::filesystem::path& folder, const RunRecord& record, Mode mode) {
  std::vector<TimedPose> estimate, truth, estimate_of_both, truth_of_both;
  for (const FrameRecord& frame : record.frames) {
    const std::int64_t t_us = frame.report.t_us;
    const auto pose = estimated_pose(frame, mode);
    const auto& real = true_pose(frame, mode);
    if (pose) estimate.push_back({t_us, *pose});
    if (real) truth.push_back({t_us, *real});
    if (!pose || !real) continue;
    estimate_of_both.push_back({t_us, *pose});
    truth_of_both.push_back({t_us, *real});
  }
  write_tum(folder / "trajectory.tum", estimate);
  // Rows of this format have no time: they are compared one by one.
  write_kitti(folder / "trajectory_kitti.txt", truth.empty() ? estimate : estimate_of_both);
  if (truth.empty()) return;
  write_tum(folder / "truth.tum", truth);
  write_kitti(folder / "truth_kitti.txt", truth_of_both);
}

}  // namespace cairn::host
