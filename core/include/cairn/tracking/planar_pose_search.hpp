#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/planar/types.hpp"

namespace cairn {

/// Pose of a vehicle in the map before a measurement, with the covariance of (x, y, heading): m^2,
/// m rad, rad^2, additive.
struct PlanarPrior {
  PlanarPose<float> pose;
  Matrix3<float> covariance = Matrix3<float>::Zero();
};

/// A vehicle on the floor, as a pose in space.
Rigid<float> on_floor(const PlanarPose<float>& pose);

/// A point of the map and a pixel that may show it.
struct PlanarSighting {
  Vector3<float> p_map = Vector3<float>::Zero();  ///< m
  Vector2<float> pixel = Vector2<float>::Zero();
  float sigma_px = 1.5F;  ///< of the pixel, with the point's own error
};

/// A vehicle's camera on the floor of the map.
struct PlanarView {
  const PinholeCamera<float>& camera;
  const Rigid<float>& T_vehicle_camera;  ///< against the level vehicle
  float sigma_tilt_rad = 0.0F;           ///< of the body's pitch and roll

  /// How far the tilt moves a pixel, one standard deviation.
  float tilt_px() const { return sigma_tilt_rad * camera.fx; }

  /// Pixel of a map point and its Jacobian by (x, y, heading). kOutOfView as project().
  Status predict(const PlanarPose<float>& pose, const Vector3<float>& p_map, Vector2<float>& pixel,
                 Matrix<float, 2, 3>& jacobian) const;
};

struct PlanarPoseOptions {
  static constexpr int kMaxSightings = 48;
  float gate = 9.21F;  ///< of a sighting, under a hypothesis' covariance (99 %)
  float inlier_px =
      4.0F;  ///< largest reprojection error at the end, beside three sigmas of the tilt
  int min_inliers = 4;
};

/// Pose of a vehicle from sightings of which many may be wrong, near a prior: 1-point RANSAC over
/// all of them (Civera et al. 2010) with the three states of a vehicle on a floor, so that fewer
/// sightings suffice than for a free camera. Each sighting in turn corrects the prior; those that
/// agree within the covariance that it then has are its inliers; the pose with most inliers is
/// refined by Gauss-Newton with the prior.
///
/// kInvalidArgument: count outside [0, kMaxSightings]; kSingular: covariance not positive definite;
/// kNoConsensus: fewer than min_inliers sightings within inlier_px. `pose`, `inlier_count`
/// unchanged on an error. Cost: count hypotheses of count projections each, about 250 operations a
/// projection.
Status find_planar_pose(const PlanarView& view, const PlanarPrior& prior,
                        const PlanarSighting* sightings, int count,
                        const PlanarPoseOptions& options, PlanarPose<float>& pose,
                        int& inlier_count);

/// The same from a prior so unsure that one sighting leaves wide places for the others, where false
/// ones agree as well: hypotheses of two sightings, which leave nothing open. `max_chance`: largest
/// chance that false sightings, anywhere in their ellipses under the prior or in `most_window_px2`,
/// agree as the inliers do; more is kNoConsensus. Cost: kMostPairs hypotheses of count + 8
/// projections.
struct PlanarConsensusOptions {
  static constexpr int kMostPairs = 16;
  PlanarPoseOptions pose;
  float window_gate = 18.42F;
  float most_window_px2 = 2560.0F;
  float max_chance = 1e-6F;
};
Status find_planar_consensus(const PlanarView& view, const PlanarPrior& prior,
                             const PlanarSighting* sightings, int count,
                             const PlanarConsensusOptions& options, PlanarPose<float>& pose,
                             bool* inliers, int& inlier_count);

}  // namespace cairn
