#pragma once

#include <cstdint>

#include "cairn/geometry/observation.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/numeric/status.hpp"

namespace cairn {

/// Most points that a plane is fitted to or an object hangs on.
inline constexpr int kMaxAnchorPoints = 64;

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
/// kInvalidArgument: null, count outside [3, kMaxAnchorPoints], an option outside its domain.
/// kNonFiniteInput. kDegenerate: the inliers lie on a line. kNoConsensus: fewer than min_inliers.
/// On an error `plane` is unchanged; `random` advances by three numbers a triple.
/// Cost: samples + 6 passes over the points.
Status fit_plane(const Vector3<float>* p_world, int count, const Vector3<float>& toward,
                 const PlaneFitOptions& options, Random& random, PlaneFit& plane);

/// Pose of an object that stands on the plane at the foot of the perpendicular from `p_world`, its
/// z axis along the normal and its x axis as near to `facing` (world direction) as the plane
/// allows. kDegenerate: `facing` is (nearly) parallel to the normal.
Status pose_on_plane(const PlaneFit& plane, const Vector3<float>& p_world,
                     const Vector3<float>& facing, Rigid<float>& T_world_object);

/// Ties a virtual object to landmarks: when the map moves them (refinement, loop closure), the
/// object moves with them. With no landmarks it is tied to a fixed pose in the map.
class ObjectAnchor {
 public:
  /// Fixes the object at a pose in the map.
  void attach(const Rigid<float>& T_world_object) {
    T_world_object_ = T_world_object;
    count_ = 0;
  }
  /// Ties it to landmarks at their present positions. kInvalidArgument: null or count outside
  /// [3, kMaxAnchorPoints]. kNonFiniteInput. On an error the anchor is unchanged.
  Status attach(const Rigid<float>& T_world_object, const LandmarkId* ids,
                const Vector3<float>* p_world, int count);

  int count() const { return count_; }
  LandmarkId id(int index) const { return ids_[index]; }
  const Rigid<float>& T_world_object() const { return T_world_object_; }

  /// Moves the object with its landmarks: `p_world[i]` is where landmark id(i) is now, `known[i]`
  /// is 0 where the map does not hold it any more. Rigid alignment by at most six Gauss-Newton
  /// steps with Huber weights (threshold 5 cm). kInvalidArgument: null. kNonFiniteInput.
  /// kDegenerate: fewer than three known or all on a line; the object then stays where it is.
  /// Always kOk for an object at a fixed pose.
  Status update(const Vector3<float>* p_world, const std::uint8_t* known);

 private:
  Rigid<float> T_world_object_;
  LandmarkId ids_[kMaxAnchorPoints] = {};
  Vector3<float> p_object_[kMaxAnchorPoints];
  int count_ = 0;
};

}  // namespace cairn
