#pragma once

#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/numeric/fixed_math.hpp"
#include "cairn/planar/fixed/ransac.hpp"
#include "cairn/planar/increment.hpp"

namespace cairn {

// Formats and messages of the planar filter without floating point; why these formats:
// docs/explanation/fixed-point.md.

using FixedCoordinate = Fixed<std::int64_t, 32>;  ///< m
using FixedLength = Fixed<std::int32_t, 20>;      ///< m, +-2048
using FixedOffset = Fixed<std::int32_t, 24>;      ///< m, +-128
using FixedVariance = Fixed<std::int64_t, 44>;    ///< m^2, m rad, rad^2, up to 524288
using FixedScore = Fixed<std::int32_t, 16>;       ///< squared Mahalanobis distance, up to 32768

/// Error of the states: GroupErrorModel's or WorldErrorModel's.
enum class FixedError : std::uint8_t { kGroup, kWorld };

/// Pose in the world, as PlanarPose.
struct FixedPose {
  FixedCoordinate x;
  FixedCoordinate y;
  FixedAngle heading;
};

/// Covariance of (x, y), m^2.
struct FixedCovariance2 {
  FixedVariance xx;
  FixedVariance xy;
  FixedVariance yy;
};

/// Covariance of (x, y, heading).
struct FixedPoseCovariance {
  FixedCovariance2 position;
  FixedVariance x_heading;
  FixedVariance y_heading;
  FixedVariance heading;
};

/// Covariance of three coordinates, m^2.
struct FixedCovariance3 {
  FixedVariance xx;
  FixedVariance xy;
  FixedVariance yy;
  FixedVariance xz;
  FixedVariance yz;
  FixedVariance zz;
};

/// Position and covariance of a landmark in the world.
struct FixedLandmark {
  FixedCoordinate x;
  FixedCoordinate y;
  FixedCovariance2 covariance;
};

/// One odometry step, as PlanarIncrement.
struct FixedIncrement {
  FixedOffset distance;
  FixedAngle turn;
  FixedVariance distance_variance;
  FixedVariance distance_turn;  ///< covariance
  FixedVariance turn_variance;
  IncrementModel model = IncrementModel::kEuler;
};

/// As PointObservation.
struct FixedPointObservation {
  LandmarkId id = kNoLandmark;
  FixedLength x;  ///< forward
  FixedLength y;  ///< left
  FixedCovariance2 noise;
};

/// As RangeBearingObservation.
struct FixedRangeBearingObservation {
  LandmarkId id = kNoLandmark;
  FixedLength range;
  FixedAngle bearing;
  FixedLength sigma_range;
  FixedAngle sigma_bearing;
};

/// As RangeBearingPrediction.
struct FixedRangeBearingPrediction {
  FixedLength range;
  FixedAngle bearing;
  FixedVariance range_variance;
  FixedVariance range_bearing;  ///< covariance
  FixedVariance bearing_variance;
};

/// As TiltParameters. Domain: both sigmas 0, or both above 0 and at most 0.3 rad.
struct FixedTiltParameters {
  FixedAngle sigma_pitch;
  FixedAngle sigma_roll;
  FixedOffset time_constant = kTimeConstant;  ///< s

  bool tilts() const { return sigma_pitch.raw() > 0 && sigma_roll.raw() > 0; }
  bool valid() const {
    const bool none = sigma_pitch.raw() == 0 && sigma_roll.raw() == 0;
    return (none || tilts()) && sigma_pitch <= kMost && sigma_roll <= kMost &&
           time_constant.raw() > 0;
  }

 private:
  static constexpr FixedOffset kTimeConstant = FixedOffset::nearest(1.0);
  static constexpr FixedAngle kMost = FixedAngle::nearest(0.3);
};

/// Settings, as those of PlanarParameters of the same names, with their defaults.
struct FixedPlanarParameters {
  FixedScore gate = kGate;  ///< FixedScore::most(): none
  int reacquire_after = 10;
  int reacquire_steps = 6;
  FixedLength reacquire_position = kReacquireDistance;
  FixedAngle reacquire_heading = kReacquireHeading;
  int reacquire_landmark_after = 40;
  FixedLength reacquire_landmark = kReacquireDistance;
  int replace_after = 20;
  FixedScore rest_sigmas = kRestSigmas;
  FixedTiltParameters tilt;  ///< for a filter of landmarks with height
  FixedRansacParameters ransac;
  FixedScore ransac_threshold = kInlier;
  FixedScore rescue_gate = kRescue;

  bool valid() const {
    return gate.raw() > 0 && reacquire_after >= 0 && reacquire_steps >= 0 &&
           reacquire_steps <= 20 && reacquire_position.raw() >= 0 && reacquire_heading.raw() >= 0 &&
           reacquire_landmark_after >= 1 && reacquire_landmark.raw() >= 0 && replace_after >= 0 &&
           rest_sigmas.raw() >= 0 && tilt.valid() && ransac.valid() && ransac_threshold.raw() > 0 &&
           rescue_gate.raw() > 0;
  }

 private:
  static constexpr FixedScore kGate = FixedScore::nearest(13.82);
  static constexpr FixedLength kReacquireDistance = FixedLength::nearest(0.05);
  static constexpr FixedAngle kReacquireHeading = FixedAngle::nearest(0.01);
  static constexpr FixedScore kRestSigmas = FixedScore::nearest(4.0);
  static constexpr FixedScore kInlier = FixedScore::nearest(5.991464547107979);
  static constexpr FixedScore kRescue = FixedScore::nearest(9.210340371976182);
};

/// What an update did, as UpdateReport.
struct FixedUpdateReport {
  int matches = 0;
  int gated = 0;
  int low_innovation = 0;   ///< inliers of the best hypothesis
  int high_innovation = 0;  ///< rescued after the first update
  int hypotheses = 0;
  FixedCoordinate nis;  ///< of the used matches, summed
  int nis_dof = 0;
};

}  // namespace cairn
