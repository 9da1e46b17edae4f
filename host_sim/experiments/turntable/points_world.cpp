#include "host_sim/experiments/turntable/points_world.hpp"

namespace cairn::host {

PointsWorld::PointsWorld(const PointsScenario& scenario)
    : scenario_(scenario), engine_(static_cast<std::uint32_t>(scenario.seed * 1000U + 17U)) {
  const Eigen::Vector3d half(3.0, 1.5, 2.8);
  while (points_.size() < 2600U) {
    const int face = static_cast<int>(engine_() % 6U);
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p(i) = (2.0 * uniform() - 1.0) * half(i);
    if (face == 5) {
      p *= 0.85;
    } else {
      const int axis = face == 4 ? 2 : face % 3;
      p(axis) = (face & 1) != 0 || face == 4 ? half(axis) : -half(axis);
    }
    if (p.norm() >= 0.8) points_.push_back(p);
  }
}

bool PointsWorld::see(int index, const TurntablePose& pose, Eigen::Vector2d& pixel) const {
  const Eigen::Vector3d p = pose.rotation.transpose() * (point(index) - pose.position);
  if (p.z() < 0.2) return false;
  pixel.x() = 0.5 * (scenario_.width - 1) + scenario_.focal_px * p.x() / p.z();
  pixel.y() = 0.5 * (scenario_.height - 1) + scenario_.focal_px * p.y() / p.z();
  return pixel.x() > 7.0 && pixel.x() < scenario_.width - 8.0 && pixel.y() > 7.0 &&
         pixel.y() < scenario_.height - 8.0;
}

Eigen::Vector2d PointsWorld::measure(int index, const Eigen::Vector2d& pixel) {
  Eigen::Vector2d measured = pixel;
  for (int i = 0; i < 2; ++i) measured(i) += scenario_.noise_px * normal_(engine_);
  if (scenario_.drift_px <= 0.0) return measured;
  Eigen::Vector2d& walk = drift_.emplace(index, Eigen::Vector2d::Zero()).first->second;
  for (int i = 0; i < 2; ++i) walk(i) += scenario_.drift_px * normal_(engine_);
  return measured + walk;
}

}  // namespace cairn::host
