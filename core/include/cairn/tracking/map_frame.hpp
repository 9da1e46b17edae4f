#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/planar_pose_search.hpp"

namespace cairn {

/// How sure an old map's frame is beside the filter's world, as the vehicle goes along.
struct MapDrift {
  float position_m = 0.03F;     ///< per root metre of way
  float heading_rad = 0.0006F;  ///< per root metre of way
};

/// The frame of the map library in the world of a planar filter. The landmarks of one old map err
/// together, so what they share is estimated: an offset and a turn about the vertical, held by two
/// remembered positions of the filter, one where the vehicle was when the map was met again and one
/// `kArm_m` ahead of it. Landmarks of the map enter with the error that the frame gives them and a
/// part of their own.
///
/// `Filter`: EkfSlam or GroupIekfSlam with LandmarkDim 3. Takes two of its landmarks' slots.
template <class Filter>
class MapFrame {
 public:
  static constexpr float kArm_m = 10.0F;

  void reset() { origin_ = ahead_ = kNoLandmark; }
  bool entered(const Filter& filter) const {
    return filter.find(origin_) >= 0 && filter.find(ahead_) >= 0;
  }

  /// Identity until the map has entered. Cost: two look-ups in the filter, one atan2.
  Rigid<float> T_world_map(const Filter& filter) const;

  /// Puts the frame into the filter, as sure as the pose (x, y, heading) has `covariance`, its
  /// height as `height_variance`, m^2. Takes two ids from `next_id`. kFull when the filter has no
  /// room: nothing is added.
  Status enter(Filter& filter, LandmarkId& next_id, const Matrix3<float>& covariance,
               float height_variance);

  /// Lets the frame drift by the way made since the last call. Cost: as Filter::widen_frame().
  void follow(Filter& filter, const MapDrift& drift);

  /// Adds a landmark of the map: position and own covariance in the map's frame, m, m^2. Errors and
  /// cost: as Filter::add_framed_landmark().
  Status add(Filter& filter, LandmarkId id, const Vector3<float>& p_map,
             const Matrix3<float>& covariance) const;

 private:
  LandmarkId origin_ = kNoLandmark;
  LandmarkId ahead_ = kNoLandmark;
  Vector3<float> p_map_origin_ = Vector3<float>::Zero();
  Vector2<float> arm_map_ = Vector2<float>::Zero();  ///< from origin to ahead
  Vector2<float> followed_to_ = Vector2<float>::Zero();
};

template <class Filter>
Rigid<float> MapFrame<Filter>::T_world_map(const Filter& filter) const {
  Rigid<float> T_world_map;
  if (!entered(filter)) return T_world_map;
  const Vector3<float> origin = filter.mean_landmark(filter.find(origin_));
  const Vector2<float> arm =
      (filter.mean_landmark(filter.find(ahead_)) - origin).template head<2>();
  PlanarPose<float> turn;
  turn.heading = atan2(arm_map_.x() * arm.y() - arm_map_.y() * arm.x(), arm_map_.dot(arm));
  T_world_map.rotation = on_floor(turn).rotation;
  T_world_map.translation = origin - T_world_map.rotation * p_map_origin_;
  return T_world_map;
}

template <class Filter>
Status MapFrame<Filter>::enter(Filter& filter, LandmarkId& next_id,
                               const Matrix3<float>& covariance, float height_variance) {
  constexpr float kTiny = 1e-6F;
  const Rigid<float> T_world_vehicle = on_floor(filter.mean_pose());
  const Vector3<float> arm = T_world_vehicle.rotation * Vector3<float>(kArm_m, 0.0F, 0.0F);
  const Vector3<float> across = T_world_vehicle.rotation * Vector3<float>(0.0F, kArm_m, 0.0F);
  Matrix3<float> shared = Matrix3<float>::Identity() * (kTiny + height_variance);
  shared.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>();
  Status status = filter.add_world_position(next_id, T_world_vehicle.translation, shared);
  if (!ok(status)) return status;
  Matrix3<float> turned = Matrix3<float>::Identity() * kTiny;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) turned(i, j) += covariance(2, 2) * across(i) * across(j);
  }
  status =
      filter.add_world_position(next_id + 1, T_world_vehicle.translation + arm, turned, next_id);
  if (!ok(status)) {
    static_cast<void>(filter.remove_landmark(filter.find(next_id)));
    return status;
  }
  origin_ = next_id++;
  ahead_ = next_id++;
  p_map_origin_ = T_world_vehicle.translation;
  arm_map_ = arm.head<2>();
  followed_to_ = p_map_origin_.template head<2>();
  return Status::kOk;
}

template <class Filter>
void MapFrame<Filter>::follow(Filter& filter, const MapDrift& drift) {
  const Vector2<float> here = filter.mean_pose().position;
  const float way = sqrt((here - followed_to_).squaredNorm());
  followed_to_ = here;
  static_cast<void>(filter.widen_frame(origin_, ahead_, square(drift.position_m) * way,
                                       square(drift.heading_rad) * way));
}

template <class Filter>
Status MapFrame<Filter>::add(Filter& filter, LandmarkId id, const Vector3<float>& p_map,
                             const Matrix3<float>& covariance) const {
  const Rigid<float> frame = T_world_map(filter);
  const Matrix3<float> R = frame.rotation.toRotationMatrix();
  const Matrix3<float> turned = R * covariance * R.transpose();
  return filter.add_framed_landmark(id, frame * p_map, 0.5F * (turned + turned.transpose()),
                                    origin_, ahead_);
}

}  // namespace cairn
