#pragma once

#include <map>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "host_sim/experiments/turntable/points_simulation.hpp"

namespace cairn::host {

/// Random points on the walls of a room and a few inside it, seen by a true pinhole camera.
class PointsWorld {
 public:
  explicit PointsWorld(const PointsScenario& scenario);

  int point_count() const { return static_cast<int>(points_.size()); }
  const Eigen::Vector3d& point(int index) const { return points_[static_cast<std::size_t>(index)]; }
  /// True pixel of a point; false outside the image (less a margin of 7 px).
  bool see(int index, const TurntablePose& pose, Eigen::Vector2d& pixel) const;
  /// A measured pixel: noise and the point's own drift added.
  Eigen::Vector2d measure(int index, const Eigen::Vector2d& pixel);
  void forget_drift(int index) { drift_.erase(index); }
  double uniform() { return uniform_(engine_); }

 private:
  PointsScenario scenario_;
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  std::vector<Eigen::Vector3d> points_;
  std::map<int, Eigen::Vector2d> drift_;
};

}  // namespace cairn::host
