#include "host_sim/world/hand_motion.hpp"

#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

struct Sway {
  double amplitude;
  double rate_hz;
};

constexpr Sway kPosition_m[3][2] = {
    {{0.16, 0.19}, {0.006, 1.7}}, {{0.12, 0.13}, {0.006, 2.1}}, {{0.08, 0.23}, {0.006, 1.9}}};
constexpr Sway kTurn_rad[3][2] = {
    {{0.12, 0.27}, {0.03, 2.0}}, {{0.30, 0.21}, {0.04, 1.8}}, {{0.08, 0.17}, {0.02, 1.6}}};

}  // namespace

HandMotion::HandMotion(std::uint64_t seed) {
  GaussianRandom random(stream_seed(seed, 0xa4d));
  const auto drawn = [&](const Sway& sway) {
    return Sine{sway.amplitude, kTwoPi<double> * sway.rate_hz, random.uniform(0.0, kTwoPi<double>)};
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < 2; ++i) {
      position_[axis][i] = drawn(kPosition_m[axis][i]);
      turn_[axis][i] = drawn(kTurn_rad[axis][i]);
    }
  }
}

double HandMotion::at(const Axis& axis, double t_s) {
  double sum = 0.0;
  for (const Sine& sine : axis) {
    double s = 0.0;
    double c = 0.0;
    sin_cos(sine.rate_radps * t_s + sine.phase_rad, s, c);
    sum += sine.amplitude * s;
  }
  return sum;
}

Rigid<double> HandMotion::pose_at_time(double t_s) const {
  Matrix3<double> R_world_level;   // columns: image right, image down, optical axis
  R_world_level << 1.0, 0.0, 0.0,  //
      0.0, 0.0, 1.0,               //
      0.0, -1.0, 0.0;
  const Vector3<double> stand(-2.2, -5.2, 1.5);
  const Vector3<double> turn(at(turn_[0], t_s), at(turn_[1], t_s), at(turn_[2], t_s));
  Rigid<double> T_world_camera;
  T_world_camera.rotation = Quaternion<double>(R_world_level) * rotation_exp(turn);
  T_world_camera.translation =
      stand + Vector3<double>(at(position_[0], t_s), at(position_[1], t_s), at(position_[2], t_s));
  return T_world_camera;
}

}  // namespace cairn::host
