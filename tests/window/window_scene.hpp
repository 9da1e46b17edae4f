#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {

/// Points in front of a camera that moves sideways and turns a little; the first view is the world.
template <class T>
struct WindowScene {
  static constexpr int kPoints = 40;
  Vector3<T> points[kPoints];

  explicit WindowScene(std::uint64_t seed = 1) {
    Random random(seed);
    const auto within = [&](double low, double high) {
      return static_cast<T>(low + (high - low) * 1e-6 * random.below(1000000));
    };
    for (Vector3<T>& p : points) {
      const T z = within(0.6, 1.8);
      // One after the other: compilers evaluate arguments in orders of their own.
      const T y = z * within(-0.4, 0.4);
      const T x = z * within(-0.5, 0.5);
      p = Vector3<T>(x, y, z);
    }
  }
  static Rigid<T> pose(int frame) {  // T_camera_world
    const T t = static_cast<T>(frame);
    Rigid<T> T_world_camera;
    T_world_camera.rotation = rotation_exp(Vector3<T>(T(0.004) * t, T(-0.01) * t, T(0.006) * t));
    T_world_camera.translation = Vector3<T>(T(0.03) * t, T(0.012) * t, T(-0.008) * t);
    return T_world_camera.inverse();
  }
  Vector2<T> seen(int point, const Rigid<T>& T_camera_world) const {
    const Vector3<T> p = T_camera_world * points[point];
    return Vector2<T>(p.x() / p.z(), p.y() / p.z());
  }
};

}  // namespace cairn
