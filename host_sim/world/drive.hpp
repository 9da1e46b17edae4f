#pragma once

#include <vector>

#include "cairn/geometry/rigid.hpp"

namespace cairn::host {

/// A vehicle's planar pose: the centre of its rear axle and its heading.
struct PlanarPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;  ///< not wrapped: grows by 2 pi a lap
};

Rigid<double> to_rigid(const PlanarPose& pose);

/// Laps of a rounded square about the origin, driven counter-clockwise at constant speed. Corners
/// are entered and left with a linear curvature ramp, so that the steering angle has no jump.
class LapDrive {
 public:
  struct Shape {
    double lap_length_m = 44.0;
    double lap_time_s = 80.0;
    double corner_radius_m = 2.0;
    double ramp_length_m = 1.0;
  };

  LapDrive() : LapDrive(Shape{}) {}
  explicit LapDrive(const Shape& shape);

  double speed_mps() const { return shape_.lap_length_m / shape_.lap_time_s; }
  /// Pose after `s_m` metres of driving, s_m >= 0. The start is the middle of the south side,
  /// heading east. Position exact to 1e-6 m.
  PlanarPose pose_at_distance(double s_m) const;
  PlanarPose pose_at_time(double t_s) const { return pose_at_distance(speed_mps() * t_s); }

 private:
  double heading_in_quarter(double s_m) const;

  Shape shape_;
  double quarter_length_m_;
  double straight_half_m_;
  std::vector<Vector2<double>> knots_;  ///< quarter lap from the start, one every kStep
  Vector2<double> centre_;
};

}  // namespace cairn::host
