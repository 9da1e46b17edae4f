#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace cairn::host {

/// Paper B's experiments on a turntable, and two more that show where its options hurt.
enum class TurntableExperiment {
  kYaw10,      ///< 10 deg of yaw
  kTwoAxis20,  ///< 20 deg of yaw and of pitch at the same time
  kYaw70,      ///< 70 deg of yaw
  kStatic,     ///< 12 s at rest
  kSwing,      ///< hand-held: swings about two axes and translates
};

/// One true pose: camera to turntable frame (x right, y down, z forward, origin on both axes).
struct TurntablePose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d position;
  double yaw_deg = 0.0;
  double pitch_deg = 0.0;
};

struct TurntableMotion {
  TurntableExperiment experiment = TurntableExperiment::kYaw70;
  double rate_dps = 10.0;
  double acceleration_dps2 = 20.0;
  double fps = 25.0;
  int static_frames = 15;  ///< at rest before and after
  /// Camera position from the rotation centre, camera frame, m.
  Eigen::Vector3d lever_m = Eigen::Vector3d::Zero();
};

/// The 8 cm lever of the experiments off the axis: 8 cm ahead of it and 3 cm above.
inline Eigen::Vector3d default_lever() {
  return {0.0, -0.03, 0.08};
}

/// Poses at the frame times: rest, trapezoidal rate, rest.
std::vector<TurntablePose> turntable_poses(const TurntableMotion& motion);

/// Yaw and pitch of a camera's optical axis, deg.
double yaw_deg(const Eigen::Matrix3d& rotation);
double pitch_deg(const Eigen::Matrix3d& rotation);
/// Angle of a rotation, deg.
double rotation_angle_deg(const Eigen::Matrix3d& rotation);

/// Experiment of the name used on the command line; false if there is none.
bool parse_experiment(const std::string& name, TurntableExperiment& experiment);
std::string experiment_name(TurntableExperiment experiment);

}  // namespace cairn::host
