#include "host_sim/experiments/turntable/turntable.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace cairn::host {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

struct NamedExperiment {
  const char* name;
  TurntableExperiment experiment;
};
constexpr NamedExperiment kExperiments[] = {
    {"yaw10", TurntableExperiment::kYaw10}, {"two-axis20", TurntableExperiment::kTwoAxis20},
    {"yaw70", TurntableExperiment::kYaw70}, {"static", TurntableExperiment::kStatic},
    {"swing", TurntableExperiment::kSwing},
};

/// Angles of a trapezoidal rate over `angle_deg`, with rest before and after.
std::vector<double> trapezoid(const TurntableMotion& motion, double angle_deg, double rate_dps) {
  const double acceleration = motion.acceleration_dps2;
  double ramp_s = rate_dps / acceleration;
  double ramp_deg = 0.5 * acceleration * ramp_s * ramp_s;
  if (2.0 * ramp_deg > angle_deg) {
    ramp_s = std::sqrt(angle_deg / acceleration);
    rate_dps = acceleration * ramp_s;
    ramp_deg = 0.5 * angle_deg;
  }
  const double cruise_s = (angle_deg - 2.0 * ramp_deg) / rate_dps;
  const double total_s = 2.0 * ramp_s + cruise_s;
  std::vector<double> angles(static_cast<std::size_t>(motion.static_frames), 0.0);
  for (int k = 1; k / motion.fps < total_s; ++k) {
    const double t = k / motion.fps;
    double angle = ramp_deg + rate_dps * (t - ramp_s);
    if (t < ramp_s) angle = 0.5 * acceleration * t * t;
    if (t >= ramp_s + cruise_s) {
      angle = angle_deg - 0.5 * acceleration * (total_s - t) * (total_s - t);
    }
    angles.push_back(angle);
  }
  angles.insert(angles.end(), static_cast<std::size_t>(motion.static_frames) + 1U, angle_deg);
  return angles;
}

TurntablePose pose_at(const TurntableMotion& motion, double yaw, double pitch) {
  TurntablePose pose;
  pose.rotation = (Eigen::AngleAxisd(yaw * kDegree, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(pitch * kDegree, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.position = pose.rotation * motion.lever_m;
  pose.yaw_deg = yaw;
  pose.pitch_deg = pitch;
  return pose;
}

std::vector<TurntablePose> swing_poses(const TurntableMotion& motion) {
  std::vector<TurntablePose> poses;
  for (int k = 0; k < 250; ++k) {
    const auto wave = [k](double period) { return std::sin(360.0 * kDegree * k / period); };
    TurntablePose pose = pose_at(motion, 25.0 * wave(125.0), 8.0 * wave(80.0));
    pose.position += Eigen::Vector3d(0.3 * wave(100.0), 0.05 * wave(60.0), 0.0);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace

std::vector<TurntablePose> turntable_poses(const TurntableMotion& motion) {
  std::vector<TurntablePose> poses;
  switch (motion.experiment) {
    case TurntableExperiment::kYaw10:
      for (const double a : trapezoid(motion, 10.0, 0.5 * motion.rate_dps)) {
        poses.push_back(pose_at(motion, a, 0.0));
      }
      break;
    case TurntableExperiment::kTwoAxis20:
      for (const double a : trapezoid(motion, 20.0, motion.rate_dps)) {
        poses.push_back(pose_at(motion, a, a));
      }
      break;
    case TurntableExperiment::kYaw70:
      for (const double a : trapezoid(motion, 70.0, motion.rate_dps)) {
        poses.push_back(pose_at(motion, a, 0.0));
      }
      break;
    case TurntableExperiment::kStatic:
      for (int k = 0; k < 300; ++k) poses.push_back(pose_at(motion, 0.0, 0.0));
      break;
    case TurntableExperiment::kSwing:
      poses = swing_poses(motion);
      break;
  }
  return poses;
}

double yaw_deg(const Eigen::Matrix3d& rotation) {
  return std::atan2(rotation(0, 2), rotation(2, 2)) / kDegree;
}

double pitch_deg(const Eigen::Matrix3d& rotation) {
  return std::asin(std::clamp(-rotation(1, 2), -1.0, 1.0)) / kDegree;
}

double rotation_angle_deg(const Eigen::Matrix3d& rotation) {
  return std::abs(Eigen::AngleAxisd(rotation).angle()) / kDegree;
}

bool parse_experiment(const std::string& name, TurntableExperiment& experiment) {
  for (const NamedExperiment& entry : kExperiments) {
    if (name != entry.name) continue;
    experiment = entry.experiment;
    return true;
  }
  return false;
}

std::string experiment_name(TurntableExperiment experiment) {
  for (const NamedExperiment& entry : kExperiments) {
    if (entry.experiment == experiment) return entry.name;
  }
  return "unknown";
}

}  // namespace cairn::host
