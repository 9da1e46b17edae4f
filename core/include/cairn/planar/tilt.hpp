#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// How a vehicle's body tilts on its suspension and an uneven floor: pitch and roll, each a
/// first-order Gauss-Markov process about zero (docs/explanation/tilt.md).
template <class T>
struct TiltParameters {
  T sigma_pitch_rad = T(0);  ///< stationary standard deviation; both 0: the body does not tilt
  T sigma_roll_rad = T(0);
  T time_constant_s = T(1);  ///< in which a tilt returns to 1/e: what lasts is the road's slope

  /// A hall's or a laboratory's floor, and a vehicle that is stiff.
  static TiltParameters flat_floor() { return {}; }
  /// A car on roads: springs, and roads that slope to their sides.
  static TiltParameters car() { return {T(0.01), T(0.02), T(1)}; }
  /// A small vehicle on rough ground.
  static TiltParameters rover() { return {T(0.012), T(0.02), T(2)}; }

  bool tilts() const { return sigma_pitch_rad > T(0) && sigma_roll_rad > T(0); }
  /// Whether every value is finite and in its domain: both sigmas 0, or both above 0 and at most
  /// 0.3 rad.
  bool valid() const {
    const bool finite = is_finite(sigma_pitch_rad) && is_finite(sigma_roll_rad);
    const bool none = sigma_pitch_rad == T(0) && sigma_roll_rad == T(0);
    return finite && (none || tilts()) && sigma_pitch_rad <= T(0.3) && sigma_roll_rad <= T(0.3) &&
           is_finite(time_constant_s) && time_constant_s > T(0);
  }
  /// Share of a tilt that is left after `dt_s` seconds.
  T decay(T dt_s) const { return exp(-dt_s / time_constant_s); }
  /// Variances of what is new of (pitch, roll) then, rad^2.
  Vector2<T> noise(T decay) const {
    const T share = T(1) - decay * decay;
    return {share * sigma_pitch_rad * sigma_pitch_rad, share * sigma_roll_rad * sigma_roll_rad};
  }
};

/// Tilt of a vehicle's body against the floor: first a roll about its x axis, then a pitch about
/// the floor's y axis, rad; positive ones lower the right side and the nose. `level` are the axes
/// that have the vehicle's heading and stand on the floor.
template <class T>
struct VehicleTilt {
  T pitch = T(0);
  T roll = T(0);

  Quaternion<T> R_level_vehicle() const {
    T sp = T(0);
    T cp = T(1);
    T sr = T(0);
    T cr = T(1);
    sin_cos(T(0.5) * pitch, sp, cp);
    sin_cos(T(0.5) * roll, sr, cr);
    return {cp * cr, cp * sr, sp * cr, -sp * sr};
  }
  Rigid<T> T_level_vehicle() const { return {R_level_vehicle(), Vector3<T>::Zero()}; }
};

/// Axes about which an error of the two angles turns what is fixed to the vehicle, in the axes in
/// which a filter writes relative vectors: p -> p + d_pitch (pitch x p) + d_roll (roll x p).
template <class T>
struct TiltAxes {
  T pitch[3] = {};
  T roll[3] = {};

  const T* axis(int k) const { return k == 0 ? pitch : roll; }
};

}  // namespace cairn
