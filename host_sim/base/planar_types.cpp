#include "host_sim/base/planar_types.hpp"

#include <cmath>

#include "cairn/numeric/math.hpp"

namespace cairn::host {

Pose2 advance(const Pose2& pose, double distance_m, double turn_rad) {
  Pose2 moved = pose;
  moved.position += distance_m * Eigen::Vector2d(std::cos(pose.heading), std::sin(pose.heading));
  moved.heading = wrap_angle(pose.heading + turn_rad);
  return moved;
}

Eigen::Matrix2d se2_left_jacobian(double angle) {
  const bool small = std::fabs(angle) < 1e-9;
  const double a = small ? 1.0 : std::sin(angle) / angle;
  const double b = small ? 0.5 * angle : (1.0 - std::cos(angle)) / angle;
  Eigen::Matrix2d v;
  v << a, -b, b, a;
  return v;
}

}  // namespace cairn::host
