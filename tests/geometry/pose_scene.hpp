#pragma once

#include <random>
#include <vector>

#include "cairn/base/hash.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/pose_refinement.hpp"
#include "cairn/geometry/rigid.hpp"

namespace cairn::test {

/// Of every bit of a pose.
template <class T>
std::uint64_t hash_of(const Rigid<T>& pose) {
  Hash64 hash;
  for (int i = 0; i < 4; ++i) hash.add(pose.rotation.coeffs()(i));
  for (int i = 0; i < 3; ++i) hash.add(pose.translation(i));
  return hash.value();
}

/// Random poses, points and noisy pixels for the tests of pose estimation.
template <class T>
class PoseScene {
 public:
  explicit PoseScene(unsigned seed) : engine_(seed) {
    camera.fx = T(520);
    camera.fy = T(515);
    camera.cx = T(318);
    camera.cy = T(243);
    camera.k1 = T(-0.08);
    camera.k2 = T(0.02);
    camera.p1 = T(5e-4);
    camera.p2 = T(-3e-4);
    camera.width = 640;
    camera.height = 480;
    T_world_camera = random_pose();
  }

  T uniform(double low, double high) {
    return static_cast<T>(std::uniform_real_distribution<double>(low, high)(engine_));
  }
  T gauss(double sigma) {
    return static_cast<T>(std::normal_distribution<double>(0, sigma)(engine_));
  }
  Vector3<T> random_vector(double half_width) {
    const T x = uniform(-half_width, half_width);
    const T y = uniform(-half_width, half_width);
    const T z = uniform(-half_width, half_width);
    return {x, y, z};
  }
  Rigid<T> random_pose() {
    Rigid<T> pose;
    pose.rotation = rotation_exp(random_vector(1.7));
    pose.translation = random_vector(8);
    return pose;
  }

  /// `count` points seen between `near` and `far` metres, with pixel noise.
  std::vector<PoseObservation<T>> observe(int count, double noise_px, double near_m = 1.5,
                                          double far_m = 8) {
    std::vector<PoseObservation<T>> observations;
    for (int i = 0; i < count; ++i) {
      const T u = uniform(10, 630);
      const T v = uniform(10, 470);
      const T depth = uniform(near_m, far_m);
      PoseObservation<T> o;
      o.p_world = T_world_camera * Vector3<T>(depth * camera.unproject({u, v}));
      const T du = gauss(1);
      const T dv = gauss(1);
      o.pixel = Vector2<T>(u, v) + static_cast<T>(noise_px) * Vector2<T>(du, dv);
      o.sigma_px = noise_px > 0 ? static_cast<T>(noise_px) : T(0.5);
      observations.push_back(o);
    }
    return observations;
  }

  /// Replaces the pixels of the first `count` observations by random ones.
  void corrupt(std::vector<PoseObservation<T>>& observations, int count) {
    for (int i = 0; i < count; ++i) {
      const T u = uniform(0, 639);
      const T v = uniform(0, 479);
      observations[static_cast<std::size_t>(i)].pixel = Vector2<T>(u, v);
    }
  }

  Rigid<T> disturbed(double rotation_rad, double translation_m) {
    Rigid<T> pose = T_world_camera;
    const Vector3<T> axis = random_vector(1).normalized();
    const Vector3<T> direction = random_vector(1).normalized();
    pose.rotation = pose.rotation * rotation_exp(Vector3<T>(static_cast<T>(rotation_rad) * axis));
    pose.translation += static_cast<T>(translation_m) * direction;
    return pose;
  }

  PinholeCamera<T> camera;
  Rigid<T> T_world_camera;

 private:
  std::mt19937 engine_;
};

/// Tangent (rho, phi) that takes `from` to `to`: the error in the sense of refine_pose.
template <class T>
Vector<T, 6> pose_difference(const Rigid<T>& from, const Rigid<T>& to) {
  Vector<T, 6> d;
  d << from.rotation.conjugate() * Vector3<T>(to.translation - from.translation),
      rotation_log(Quaternion<T>(from.rotation.conjugate() * to.rotation));
  return d;
}

}  // namespace cairn::test
