#pragma once

#include "cairn/planar/fixed/covariance3.hpp"
#include "cairn/planar/fixed/types.hpp"

namespace cairn::detail {

/// A sighting as two independent measurements of the vector from vehicle to landmark, along a
/// direction of the world and across it: all rows are unit vectors, all units metres.
struct FixedSighting {
  static constexpr int rows = 2;
  int slot = -1;
  FixedRatio cosine;  ///< of the direction; across it lies (-sine, cosine)
  FixedRatio sine;
  FixedOffset innovation[2];
  FixedOffset sigma[2];  ///< above 0

  /// Its noise, along the direction and across it, in the world's axes.
  FixedCholesky3 noise() const;
};

/// Axes of the vehicle in the world.
struct FixedAxes {
  FixedAngle heading;
  FixedRatio cosine;
  FixedRatio sine;

  explicit FixedAxes(FixedAngle heading_rad) : heading(heading_rad) {
    sin_cos(heading, sine, cosine);
  }
  /// Vehicle's axes to the world's.
  void turn(FixedLength x, FixedLength y, FixedLength& world_x, FixedLength& world_y,
            std::uint32_t& saturations) const;
};

/// Noise of a point as two independent ones along and across a direction of the vehicle frame.
struct FixedPrincipalNoise {
  FixedAngle direction;
  FixedOffset sigma[2];
};
FixedPrincipalNoise principal_noise(const FixedCovariance2& noise, std::uint32_t& saturations);

/// kInvalidArgument when the noise is not positive definite.
Status check(const FixedPointObservation& observation);
/// kInvalidArgument for a range or sigma that is not positive.
Status check(const FixedRangeBearingObservation& observation);

/// The sighting of a landmark at (x, y) from the vehicle, in the world's axes.
bool linearise(const FixedPointObservation& observation, const FixedAxes& axes, FixedLength x,
               FixedLength y, FixedLength sensor_offset, FixedSighting& out,
               std::uint32_t& saturations);
/// The same; false when the predicted range is below 5 cm: no bearing there.
bool linearise(const FixedRangeBearingObservation& observation, const FixedAxes& axes,
               FixedLength x, FixedLength y, FixedLength sensor_offset, FixedSighting& out,
               std::uint32_t& saturations);

/// Range and bearing at which a landmark is expected; false below 5 cm. `cosine` and `sine` of its
/// direction in the world.
bool expected_range_bearing(const FixedAxes& axes, FixedLength x, FixedLength y,
                            FixedLength sensor_offset, FixedRangeBearingPrediction& out,
                            FixedRatio& cosine, FixedRatio& sine, std::uint32_t& saturations);

/// Covariance of the vector from vehicle to landmark, turned to a sighting's direction and across
/// it, in m^2.
FixedCovariance2 along_direction(const FixedCovariance2& covariance, FixedRatio cosine,
                                 FixedRatio sine, std::uint32_t& saturations);

/// Squared Mahalanobis distance of two innovations with `bits` fraction bits, S = `own` + their
/// independent noise.
FixedScore mahalanobis(const FixedCovariance2& own, const FixedVariance (&noise)[2],
                       const std::int64_t (&innovation)[2], int bits, std::uint32_t& saturations);

/// Squared Mahalanobis distance of a sighting's innovations, S = relative covariance + noise.
FixedScore score(const FixedSighting& sighting, const FixedCovariance2& relative,
                 std::uint32_t& saturations);

/// Exact moments of R(e) p + xi with e ~ N(0, heading), as turned_point_moments(): the factor by
/// which the mean shrinks, Cov and Cov with e. `covariance`: of (xi, e).
struct FixedMoments {
  FixedVariance shrink;
  FixedPoseCovariance covariance;
};
FixedMoments turned_point_moments(FixedLength x, FixedLength y,
                                  const FixedPoseCovariance& covariance,
                                  std::uint32_t& saturations);

/// Exponential of the planar group, as PlanarExponential.
class FixedExponential {
 public:
  FixedExponential(FixedAngle turn, std::uint32_t& saturations);
  FixedAngle angle() const { return angle_; }
  /// Moves the point (x, y) by xi.
  void move(FixedCoordinate& x, FixedCoordinate& y, FixedOffset xi_x, FixedOffset xi_y,
            std::uint32_t& saturations) const;

 private:
  FixedAngle angle_;
  FixedRatio v00_;
  FixedRatio v01_;
  FixedRatio same_;
  FixedRatio turn_;
};

}  // namespace cairn::detail
