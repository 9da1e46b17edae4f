#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/planar_pose_search.hpp"

namespace cairn {

/// Random walk of the map-to-odom alignment: the map library and the filter's world drift apart as
/// the vehicle drives on.
struct MapDrift {
  float position_m = 0.03F;     ///< per root metre of distance travelled
  float heading_rad = 0.0006F;  ///< per root metre of distance travelled

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good = is_finite(position_m) && position_m >= 0.0F && is_finite(heading_rad) &&
                      heading_rad >= 0.0F;
    return good ? Status::kOk : Status::kBadConfig;
  }
};

/// The map-to-odom alignment: the transform T_world_map between the frame of the map library, in
/// which reports and archives are written, and the frame in which a planar filter estimates.
///
/// The landmarks of one earlier map share an error, so this is estimated with the rest of the
/// state: a translation and a rotation about the vertical, represented by two remembered positions
/// of the filter, one where the vehicle was when it recognised the map and one `kArm_m` ahead of
/// it. Landmarks of the map enter with the error of the alignment and an error of their own.
///
/// `Filter`: EkfSlam or GroupIekfSlam with LandmarkDim 3. Takes two of its landmarks' slots.
template <class Filter>
class MapAlignment {
 public:
  static constexpr float kArm_m = 10.0F;

  void reset() { origin_ = ahead_ = kNoLandmark; }
  /// Whether the alignment is part of the filter's state.
  bool estimated(const Filter& filter) const {
    return filter.find(origin_) >= 0 && filter.find(ahead_) >= 0;
  }

  /// Identity until the alignment is estimated. Cost: two look-ups in the filter, one atan2.
  Rigid<float> T_world_map(const Filter& filter) const;

  /// Adds the alignment to the filter's state: identity, with the `covariance` of the vehicle's
  /// pose (x, y, heading) and a variance of the height, m^2. Takes two ids from `next_id`. kFull
  /// when the filter has no room: nothing is added.
  Status begin(Filter& filter, LandmarkId& next_id, const Matrix3<float>& covariance,
               float height_variance);

  /// Adds the drift of the distance travelled since the last call. Cost: as Filter::widen_frame().
  void add_drift(Filter& filter, const MapDrift& drift);

  /// Covariance of the vehicle's pose in the map over (x, y, heading), in the map's axes, m and
  /// rad; beside the map's own error. Only while estimated(). Cost: as
  /// Filter::framed_pose_covariance().
  Matrix3<float> pose_covariance(const Filter& filter) const;
  /// Place of the map, m, where it was recognised.
  Vector2<float> recognised_at() const { return p_map_origin_.template head<2>(); }

  /// Adds a landmark of the map: position and own covariance in the map's frame, m, m^2. Errors and
  /// cost: as Filter::add_framed_landmark().
  Status add_landmark(Filter& filter, LandmarkId id, const Vector3<float>& p_map,
                      const Matrix3<float>& covariance) const;

 private:
  LandmarkId origin_ = kNoLandmark;
  LandmarkId ahead_ = kNoLandmark;
  Vector3<float> p_map_origin_ = Vector3<float>::Zero();
  Vector2<float> arm_map_ = Vector2<float>::Zero();     ///< from origin to ahead
  Vector2<float> drifted_at_ = Vector2<float>::Zero();  ///< vehicle position of the last drift
};

template <class Filter>
Rigid<float> MapAlignment<Filter>::T_world_map(const Filter& filter) const {
  Rigid<float> T_world_map;
  if (!estimated(filter)) return T_world_map;
  const Vector3<float> p_world_origin = filter.mean_landmark(filter.find(origin_));
  const Vector2<float> arm_world =
      (filter.mean_landmark(filter.find(ahead_)) - p_world_origin).template head<2>();
  PlanarPose<float> yaw;
  yaw.heading =
      atan2(arm_map_.x() * arm_world.y() - arm_map_.y() * arm_world.x(), arm_map_.dot(arm_world));
  T_world_map.rotation = on_floor(yaw).rotation;
  T_world_map.translation = p_world_origin - T_world_map.rotation * p_map_origin_;
  return T_world_map;
}

template <class Filter>
Status MapAlignment<Filter>::begin(Filter& filter, LandmarkId& next_id,
                                   const Matrix3<float>& covariance, float height_variance) {
  constexpr float kTiny = 1e-6F;
  const Rigid<float> T_world_vehicle = on_floor(filter.mean_pose());
  const Vector3<float> arm = T_world_vehicle.rotation * Vector3<float>(kArm_m, 0.0F, 0.0F);
  const Vector3<float> across = T_world_vehicle.rotation * Vector3<float>(0.0F, kArm_m, 0.0F);
  Matrix3<float> shared = Matrix3<float>::Identity() * (kTiny + height_variance);
  shared.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>();
  Status status = filter.add_frame_position(next_id, T_world_vehicle.translation, shared);
  if (!ok(status)) return status;
  Matrix3<float> by_heading = Matrix3<float>::Identity() * kTiny;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) by_heading(i, j) += covariance(2, 2) * across(i) * across(j);
  }
  status = filter.add_frame_position(next_id + 1, T_world_vehicle.translation + arm, by_heading,
                                     next_id);
  if (!ok(status)) {
    static_cast<void>(filter.remove_landmark(filter.find(next_id)));
    return status;
  }
  origin_ = next_id++;
  ahead_ = next_id++;
  p_map_origin_ = T_world_vehicle.translation;
  arm_map_ = arm.head<2>();
  drifted_at_ = p_map_origin_.template head<2>();
  return Status::kOk;
}

template <class Filter>
void MapAlignment<Filter>::add_drift(Filter& filter, const MapDrift& drift) {
  const Vector2<float> here = filter.mean_pose().position;
  const float distance_m = sqrt((here - drifted_at_).squaredNorm());
  drifted_at_ = here;
  static_cast<void>(filter.widen_frame(origin_, ahead_, square(drift.position_m) * distance_m,
                                       square(drift.heading_rad) * distance_m));
}

template <class Filter>
Matrix3<float> MapAlignment<Filter>::pose_covariance(const Filter& filter) const {
  const Matrix3<float> R = T_world_map(filter).rotation.toRotationMatrix();
  return R.transpose() * filter.framed_pose_covariance(origin_, ahead_) * R;
}

template <class Filter>
Status MapAlignment<Filter>::add_landmark(Filter& filter, LandmarkId id,
                                          const Vector3<float>& p_map,
                                          const Matrix3<float>& covariance) const {
  const Rigid<float> T = T_world_map(filter);
  const Matrix3<float> R = T.rotation.toRotationMatrix();
  const Matrix3<float> rotated = R * covariance * R.transpose();
  return filter.add_framed_landmark(id, T * p_map, 0.5F * (rotated + rotated.transpose()), origin_,
                                    ahead_);
}

}  // namespace cairn
