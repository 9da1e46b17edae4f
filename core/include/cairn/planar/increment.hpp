#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/geometry/types.hpp"

namespace cairn {

/// How an odometry increment moves the vehicle.
enum class IncrementModel : std::uint8_t {
  kEuler,     ///< paper A, (4) and (6): straight along the old heading, then turn
  kExactArc,  ///< along the chord of the arc, at half of the turn
};

/// One odometry step: the vehicle moves `distance_m` along the direction old heading + c turn_rad
/// and then points to old heading + turn_rad, with c = 0 (`kEuler`) or 1/2 (`kExactArc`, where the
/// distance is that of the chord). The model travels with the increment, so that filters, noise and
/// references integrate the same motion.
template <class T>
struct PlanarIncrement {
  T distance_m = T(0);
  T turn_rad = T(0);
  Matrix2<T> covariance = Matrix2<T>::Zero();  ///< of (distance, turn)
  IncrementModel model = IncrementModel::kEuler;
};

/// Increment of an Ackermann (car-like) vehicle, paper A (3) to (6): distance v dt, turn
/// v dt tan(phi) / wheelbase; noise of speed and steering to first order (a full 2x2: the speed
/// noise turns the vehicle too). Units: m/s, rad, s, m. Domain: |phi| <= 1.4, dt >= 0, wheelbase >
/// 0, sigmas >= 0; outside of it predict() refuses the increment. Variances are limited to
/// kMostPositionVariance and kMostHeadingVariance.
template <class T>
PlanarIncrement<T> ackermann_increment(T v, T phi, T dt, T wheelbase, T sigma_v, T sigma_phi,
                                       IncrementModel model = IncrementModel::kEuler);

/// Increment of a vehicle with speed v (m/s) and turn rate omega (rad/s) held for dt.
template <class T>
PlanarIncrement<T> twist_increment(T v, T omega, T dt, T sigma_v, T sigma_omega,
                                   IncrementModel model = IncrementModel::kEuler);

/// Displacement of an increment in the old vehicle frame and its derivatives.
template <class T>
struct Displacement {
  Vector2<T> u = Vector2<T>::Zero();            ///< m
  Vector2<T> by_distance = Vector2<T>::Zero();  ///< d u / d distance
  Vector2<T> by_turn = Vector2<T>::Zero();      ///< d u / d turn, m/rad
};
template <class T>
Displacement<T> displacement(const PlanarIncrement<T>& increment);

/// kNonFiniteInput, or kInvalidArgument when |distance| > 1e4 m, |turn| > pi, or the covariance is
/// not a symmetric positive semi-definite matrix up to kMostPositionVariance and
/// kMostHeadingVariance.
template <class T>
Status validate(const PlanarIncrement<T>& increment);

}  // namespace cairn
