#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {

/// Most points that a plane is fitted to.
inline constexpr int kMaxPlanePoints = 64;

struct PlaneFitOptions {
  float inlier_m = 0.05F;  ///< largest distance of a point that supports the plane
  int samples = 32;        ///< triples tried; clamped to [1, 128]
  int min_inliers = 4;
};

/// Plane normal . p = offset.
struct PlaneFit {
  Vector3<float> normal = Vector3<float>::Zero();    ///< unit
  float offset = 0.0F;                               ///< m
  Vector3<float> centroid = Vector3<float>::Zero();  ///< of the inliers, on the plane
  float rms_m = 0.0F;                                ///< of the inliers' distances
  int inliers = 0;
};

/// Plane through most of the points: the best of a fixed number of triples (truncated quadratic
/// score), then three rounds of principal axes over its inliers. The normal points to the side of
/// `toward` (for example the camera's centre).
/// kInvalidArgument: null, count outside [3, kMaxPlanePoints], an option outside its domain.
/// kNonFiniteInput. kDegenerate: the inliers lie on a line. kNoConsensus: fewer than min_inliers.
/// On an error `plane` is unchanged; `random` advances by three numbers a triple.
/// Cost: samples + 6 passes over the points.
Status fit_plane(const Vector3<float>* p_world, int count, const Vector3<float>& toward,
                 const PlaneFitOptions& options, Random& random, PlaneFit& plane);

/// Pose of an object that stands on the plane at the foot of the perpendicular from `p_world`, its
/// z axis along the normal and its x axis as near to `facing` (world direction) as the plane
/// allows. kDegenerate: `facing` is (nearly) parallel to the normal, or none. kNonFiniteInput: a
/// direction or a foot that is no number. The pose is then unchanged.
Status pose_on_plane(const PlaneFit& plane, const Vector3<float>& p_world,
                     const Vector3<float>& facing, Rigid<float>& T_world_object);

}  // namespace cairn
