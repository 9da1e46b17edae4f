#pragma once

#include <cstdint>

#include "cairn/estimation/observation.hpp"
#include "cairn/estimation/one_point_ransac.hpp"
#include "cairn/geometry/types.hpp"

namespace cairn {

/// Pose of the vehicle in the world: position in m (x east, y north), heading in rad, wrapped to
/// (-pi, pi], zero along x, positive to the left.
template <class T>
struct PlanarPose {
  Vector2<T> position = Vector2<T>::Zero();
  T heading = T(0);
};

/// A landmark seen as a Cartesian point in the vehicle frame (x forward, y left), m. Paper A's
/// observation, its equation (20).
template <class T>
struct PointObservation {
  LandmarkId id = kNoLandmark;
  Vector2<T> y = Vector2<T>::Zero();
  Matrix2<T> R = Matrix2<T>::Identity();  ///< noise covariance, vehicle frame, m^2
};

/// A landmark seen in range (m) and bearing (rad, positive to the left) from a sensor on the
/// vehicle's x axis.
template <class T>
struct RangeBearingObservation {
  LandmarkId id = kNoLandmark;
  T range = T(0);
  T bearing = T(0);
  T sigma_range = T(0);
  T sigma_bearing = T(0);
};

/// Range and bearing at which a landmark is expected, and how surely: the input of a data
/// association.
template <class T>
struct RangeBearingPrediction {
  T range = T(0);
  T bearing = T(0);
  Matrix2<T> covariance = Matrix2<T>::Zero();  ///< innovation covariance, m^2, m rad, rad^2
};

/// What a filter remembers of each landmark.
struct LandmarkStatistics {
  std::uint32_t seen = 0;             ///< observations used
  std::uint32_t missed = 0;           ///< searched for in vain: mark_missed()
  std::uint32_t rejected = 0;         ///< observations refused by the gate or by RANSAC
  std::uint32_t rejected_in_row = 0;  ///< of these, since the last one used
  std::uint32_t last_seen = 0;        ///< number of the update that used it last: update_count()
  bool pinned = false;                ///< a remembered position: never replaced
};

/// Settings shared by the planar filters. The defaults fit a small indoor vehicle.
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
  /// that number is at least this (then the one seen least, then the lowest slot). 0: never.
  int replace_after = 20;

  /// A vehicle with odometry needs fewer supporters than a camera in the hand.
  OnePointRansacParameters ransac = {0.99F, 16, 3, 0.5F};
  /// Supporter: chi-square of a candidate's residual after the hypothesis, under the covariance
  /// that it has then (95 %). Counts the landmarks' own uncertainty, so that a young map finds
  /// consensus.
  T ransac_threshold = T(5.991464547107979);
  T rescue_gate = T(9.210340371976182);  ///< chi-square of a rescued match (99 %)

  /// `LiftedIekfSlam` only: exact trigonometric moments of the noise instead of the printed
  /// Jacobians.
  bool exact_moments = false;
  /// `LiftedIekfSlam` only, for the errata tests: bits of `Misprint` put back into the equations.
  unsigned misprints = 0;
};

/// Misprints of paper A that can be put back. Errata: docs/explanation/errata-paper-a.md.
enum Misprint : unsigned {
  kMisprint18Row6 = 1U,  ///< (18) row 6: + z_i5 u2 instead of - z_i5 u2
  kMisprint26Row5 = 2U,  ///< (26) row 5: - y_new z11 instead of + y_new z11
};

}  // namespace cairn
