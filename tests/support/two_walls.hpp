#pragma once

#include <cstdint>
#include <vector>

#include "plane_scene.hpp"

namespace cairn::test {

/// Frame `k` of a hand-held camera that starts at rest and then moves, turning, before two
/// textured planes, one behind the other.
inline Rigid<double> two_walls_pose(int k) {
  const double t = k < 20 ? 0.001 * k * k / 20.0 : 0.001 * (2.0 * k - 20.0);
  return {rotation_exp(Vector3<double>(0, t, 0)), {-4 * t, t, 0}};
}

/// What small_camera() sees there: the nearer plane, at 1.2 m, fills the left half.
inline std::vector<std::uint8_t> render_walls(const Rigid<double>& pose, const PlaneScene& far_wall,
                                              const PlaneScene& near_wall) {
  const PinholeCamera<double> camera = small_camera();
  std::vector<std::uint8_t> image = far_wall.render(camera, pose);
  const std::vector<std::uint8_t> front = near_wall.render(camera, pose);
  Vector2<double> edge;
  static_cast<void>(camera.project(pose.inverse() * Vector3<double>(-0.1, 0.0, 1.2), edge));
  const int columns = clamp(static_cast<int>(edge.x()), 0, camera.width);
  for (int v = 0; v < camera.height; ++v) {
    const std::size_t row = static_cast<std::size_t>(v) * static_cast<std::size_t>(camera.width);
    for (std::size_t i = row; i < row + static_cast<std::size_t>(columns); ++i) image[i] = front[i];
  }
  return image;
}

inline std::vector<std::uint8_t> render_two_walls(const Rigid<double>& pose) {
  static const PlaneScene far_wall(2.5, 0.28);
  static const PlaneScene near_wall(1.2, 0.13, 7);
  return render_walls(pose, far_wall, near_wall);
}

/// The same by number, rendered once in a process.
inline const std::vector<std::uint8_t>& two_walls(int k) {
  static std::vector<std::vector<std::uint8_t>> images;
  while (static_cast<int>(images.size()) <= k) {
    images.push_back(render_two_walls(two_walls_pose(static_cast<int>(images.size()))));
  }
  return images[static_cast<std::size_t>(k)];
}

}  // namespace cairn::test
