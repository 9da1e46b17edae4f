#include "cairn/planar/increment.hpp"

#include "cairn/numeric/math.hpp"
#include "cairn/planar/types.hpp"

namespace cairn {
namespace {

template <class T>
constexpr T kLargestSteering = T(1.4);

/// What is said to be less sure than the filters reckon with counts as that; not finite, it stays.
template <class T>
void limit_covariance(Matrix2<T>& covariance) {
  const T most[2] = {kMostPositionVariance<T>, kMostHeadingVariance<T>};
  for (int i = 0; i < 2; ++i) {
    if (!(covariance(i, i) > most[i]) || !is_finite(covariance(i, i))) continue;
    covariance(0, 1) *= sqrt(most[i] / covariance(i, i));
    covariance(1, 0) = covariance(0, 1);
    covariance(i, i) = most[i];
  }
}

/// Turns (v, omega) noise into (distance, turn) noise; for the exact arc the distance becomes that
/// of the chord, d sin(a/2) / (a/2), and its noise follows.
template <class T>
PlanarIncrement<T> finish(T distance, T turn, const Matrix2<T>& covariance, IncrementModel model) {
  PlanarIncrement<T> increment;
  increment.distance_m = distance;
  increment.turn_rad = turn;
  increment.covariance = covariance;
  increment.model = model;
  if (model == IncrementModel::kEuler) {
    limit_covariance(increment.covariance);
    return increment;
  }

  const T half = T(0.5) * turn;
  T ratio = T(1) - half * half / T(6);
  T slope = -half / T(3);  // d ratio / d half
  if (abs(half) > T(1e-2)) {
    T sine = T(0);
    T cosine = T(1);
    sin_cos(half, sine, cosine);
    ratio = sine / half;
    slope = (cosine - ratio) / half;
  } else {
    slope += half * half * half / T(30);
    ratio += half * half * half * half / T(120);
  }
  increment.distance_m = distance * ratio;
  Matrix2<T> jacobian;
  jacobian << ratio, T(0.5) * distance * slope, T(0), T(1);
  const Matrix2<T> scaled = jacobian * covariance;
  increment.covariance = scaled * jacobian.transpose();
  increment.covariance(1, 0) = increment.covariance(0, 1);
  limit_covariance(increment.covariance);
  return increment;
}

}  // namespace

template <class T>
PlanarIncrement<T> ackermann_increment(T v, T phi, T dt, T wheelbase, T sigma_v, T sigma_phi,
                                       IncrementModel model) {
  PlanarIncrement<T> refused;
  refused.covariance(0, 0) = T(-1);
  if (!(abs(phi) <= kLargestSteering<T>) || !(wheelbase > T(0)) || !(dt >= T(0))) return refused;

  T sine = T(0);
  T cosine = T(1);
  sin_cos(phi, sine, cosine);
  const T tangent = sine / cosine;
  const T distance = v * dt;
  const T turn = distance * tangent / wheelbase;
  const T distance_by_v = dt;
  const T turn_by_v = dt * tangent / wheelbase;
  const T turn_by_phi = distance / (wheelbase * cosine * cosine);
  const T variance_v = sigma_v * sigma_v;
  Matrix2<T> covariance;
  covariance(0, 0) = distance_by_v * distance_by_v * variance_v;
  covariance(0, 1) = distance_by_v * turn_by_v * variance_v;
  covariance(1, 0) = covariance(0, 1);
  covariance(1, 1) =
      turn_by_v * turn_by_v * variance_v + turn_by_phi * turn_by_phi * sigma_phi * sigma_phi;
  return finish(distance, turn, covariance, model);
}

template <class T>
PlanarIncrement<T> twist_increment(T v, T omega, T dt, T sigma_v, T sigma_omega,
                                   IncrementModel model) {
  PlanarIncrement<T> refused;
  refused.covariance(0, 0) = T(-1);
  if (!(dt >= T(0))) return refused;
  Matrix2<T> covariance = Matrix2<T>::Zero();
  covariance(0, 0) = dt * dt * sigma_v * sigma_v;
  covariance(1, 1) = dt * dt * sigma_omega * sigma_omega;
  return finish(v * dt, omega * dt, covariance, model);
}

template <class T>
Displacement<T> displacement(const PlanarIncrement<T>& increment) {
  Displacement<T> d;
  T sine = T(0);
  T cosine = T(1);
  const bool arc = increment.model == IncrementModel::kExactArc;
  if (arc) sin_cos(T(0.5) * increment.turn_rad, sine, cosine);
  d.by_distance = {cosine, sine};
  d.u = {increment.distance_m * cosine, increment.distance_m * sine};
  if (arc) d.by_turn = {T(-0.5) * d.u.y(), T(0.5) * d.u.x()};
  return d;
}

template <class T>
Status validate(const PlanarIncrement<T>& increment) {
  const Matrix2<T>& q = increment.covariance;
  if (!is_finite(increment.distance_m) || !is_finite(increment.turn_rad) || !is_finite(q(0, 0)) ||
      !is_finite(q(0, 1)) || !is_finite(q(1, 0)) || !is_finite(q(1, 1))) {
    return Status::kNonFiniteInput;
  }
  if (abs(increment.distance_m) > T(1e4) || abs(increment.turn_rad) > kPi<T>) {
    return Status::kInvalidArgument;
  }
  const T product = q(0, 0) * q(1, 1);
  if (q(0, 0) < T(0) || q(1, 1) < T(0) || q(0, 0) > kMostPositionVariance<T> ||
      q(1, 1) > kMostHeadingVariance<T> || q(0, 1) != q(1, 0) ||
      q(0, 1) * q(0, 1) > product * T(1.0001)) {
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

#define CAIRN_INSTANTIATE(T)                                                         \
  template PlanarIncrement<T> ackermann_increment(T, T, T, T, T, T, IncrementModel); \
  template PlanarIncrement<T> twist_increment(T, T, T, T, T, IncrementModel);        \
  template Displacement<T> displacement(const PlanarIncrement<T>&);                  \
  template Status validate(const PlanarIncrement<T>&);
CAIRN_INSTANTIATE(float)
CAIRN_INSTANTIATE(double)
#undef CAIRN_INSTANTIATE

}  // namespace cairn
