#pragma once

#include <cstdint>

#include "cairn/estimation/observation.hpp"
#include "cairn/estimation/one_point_ransac.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/planar/tilt.hpp"

namespace cairn {

/// Variances up to which the planar filters reckon, m^2 and rad^2: far beyond what a vehicle or its
/// map can be unsure by, and so small that no product of them overflows.
template <class T>
inline constexpr T kMostPositionVariance = T(1e10);
template <class T>
inline constexpr T kMostHeadingVariance = T(1e4);
/// How far from the world's origin, m, a filter may start, in each axis: squares of it are sums'
/// parts. A float has no metre left there.
template <class T>
inline constexpr T kMostPosition = T(1e8);

namespace detail {
template <class T>
constexpr T at_most(T variance, T most) {
  return variance > most ? most : variance;
}
}  // namespace detail

/// Pose of the vehicle in the world: position in m (x east, y north), heading in rad, wrapped to
/// (-pi, pi], zero along x, positive to the left.
template <class T>
struct PlanarPose {
  Vector2<T> position = Vector2<T>::Zero();
  T heading = T(0);
};

/// Direction in which a vehicle travels beside its x axis, positive to the left, rad, and its
/// variance; zero where it is the axis.
template <class T>
struct DirectionOfTravel {
  T angle_rad = T(0);
  T variance = T(0);
};

/// What a filter remembers of each landmark.
struct LandmarkStatistics {
  std::uint32_t measured = 0;         ///< observations used
  std::uint32_t rejected = 0;         ///< observations refused by the gate or by RANSAC
  std::uint32_t rejected_in_row = 0;  ///< of these, since the last one used
  std::uint32_t last_measured = 0;    ///< update that used it last, counted as update_count()
  bool pinned = false;                ///< a remembered position: never replaced
};

/// Settings of PlanarSlam. The defaults fit a small indoor vehicle.
template <class T>
struct PlanarParameters {
  /// Mahalanobis gate of one landmark's two innovations (chi-square, 2 degrees of freedom, 99.9 %).
  T gate = T(13.82);

  /// Re-acquisition: after this many updates in a row that refused, again, more landmarks than they
  /// used, the next prediction adds pose noise; twice the standard deviation after each further
  /// one, until as many in a row are accepted. 0 switches it off, for landmarks too.
  int reacquire_after = 10;
  int reacquire_steps = 6;            ///< doublings at most
  T reacquire_position_m = T(0.05);   ///< first step, standard deviation per axis
  T reacquire_heading_rad = T(0.01);  ///< first step, standard deviation
  /// A landmark refused this many times in a row by updates that are accepted was moved: it gets
  /// position noise in the same way.
  int reacquire_landmark_after = 40;
  T reacquire_landmark_m = T(0.05);  ///< first step, standard deviation per axis

  /// A full map replaces the landmark that was not used for the largest number of updates, when
  /// that number is at least this (then the one used least, then the lowest slot). 0: never.
  int replace_after = 20;

  /// At rest (odometry of exactly no motion since the last update) the same picture again tells
  /// nothing new. An update whose normalised innovations stay within this many standard deviations
  /// of what is expected confirms that the vehicle rests: it counts, changes nothing, and the
  /// odometry noise since the last one is dropped. 0: every update is applied.
  T rest_sigmas = T(4);

  /// None by default: the floor is flat and the vehicle has no suspension.
  TiltParameters<T> tilt;

  /// How far the vehicle may travel beside its x axis, as a constant of the drive that the filter
  /// estimates, standard deviation, at most 0.3 rad; 0: along the axis. A camera whose yaw on the
  /// vehicle is told wrong does the same. GroupIekfSlam with TravelStates alone, others travel
  /// along the axis.
  T travel_sigma_rad = T(0);

  /// A vehicle with odometry needs fewer inliers than a hand-held camera.
  OnePointRansacParameters ransac = {0.99F, 16, 3, 0.5F};
  /// Inlier: chi-square of a candidate's residual after the hypothesis, under the covariance that
  /// it has then (95 %). Counts the landmarks' own uncertainty, so that a young map finds
  /// consensus.
  T ransac_threshold = T(5.991464547107979);
  T rescue_gate = T(9.210340371976182);  ///< chi-square of a rescued match (99 %)
};

}  // namespace cairn
