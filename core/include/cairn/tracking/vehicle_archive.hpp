#pragma once

#include "cairn/tracking/map_alignment.hpp"
#include "cairn/tracking/map_archive.hpp"
#include "cairn/tracking/reactivation_policy.hpp"
#include "cairn/tracking/vehicle_estimate.hpp"
#include "cairn/tracking/vehicle_frame.hpp"

namespace cairn {

/// The passage of single landmarks between a vehicle's filter and the map library: archived ones go
/// out as messages to the map builder, reactivated ones come in. Owns the map-to-odom alignment,
/// which converts between the two frames.
template <class Config, class Filter>
class VehicleArchive {
 public:
  using Estimate = VehicleEstimate<Filter>;
  using Frame = VehicleFrame<Config>;
  using Message = typename SharedMap<Config>::Message;
  using Archived = typename SharedMap<Config>::Landmark;
  /// Whether this filter can hold landmarks of a library.
  static constexpr bool kReactivates = Filter::kHasWorldLandmarks;

  struct Parameters {
    int mature_sightings = 12;         ///< from then on a landmark is also in the library
    float inflation = 4.0F;            ///< of the variances of reactivated landmarks
    float map_height_sigma_m = 0.02F;  ///< of the library as a whole
    MapDrift drift;

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = mature_sightings >= 1 && is_finite(inflation) && inflation >= 1.0F &&
                        is_positive(map_height_sigma_m) && ok(drift.validate());
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  /// Starts anew at a pose with `covariance` of (x, y, heading).
  void reset(const Parameters& parameters, const Matrix3<float>& covariance) {
    parameters_ = parameters;
    alignment_.reset();
    policy_.reset();
    tracked_covariance_ = covariance;
  }
  /// The alignment begins with the pose's covariance of the last frame that tracked: as much may
  /// the map be wrong by where it is recognised.
  void note_tracked(const Estimate& estimate) {
    if (recognised(estimate)) return;
    tracked_covariance_ = estimate.filter().pose_covariance();
  }
  ReactivationPolicy& policy() { return policy_; }
  const ReactivationPolicy& policy() const { return policy_; }

  /// The map's frame in the filter's.
  Rigid<float> T_world_map(const Filter& filter) const {
    if constexpr (kReactivates) {
      return alignment_.T_world_map(filter);
    } else {
      return {};
    }
  }
  Rigid<float> T_map_camera(const Estimate& estimate) const {
    return T_world_map(estimate.filter()).inverse() * estimate.T_world_camera();
  }
  /// The vehicle's pose in the map.
  PlanarPose<float> pose_in_map(const Estimate& estimate) const;
  /// Its covariance over (x, y, heading), m and rad, in the map's axes: how well the vehicle's
  /// place in the map is known, whatever the map is wrong by.
  Matrix3<float> covariance_in_map(const Estimate& estimate) const;
  /// What the map itself may be wrong by where the vehicle is: the error that the pose had when the
  /// map was recognised, which turns the map about that place. Zero until then: the map's error is
  /// the pose's.
  Matrix3<float> map_covariance(const Estimate& estimate) const;

  /// Sends the landmark in the filter's `slot` to the map builder; not one without a descriptor, by
  /// which a place is recognised, and none where the library shows the place already.
  void archive(Frame& frame, const Estimate& estimate, int slot, const TrackedLandmark& landmark);
  /// The same for a landmark that has become mature, once.
  void archive_mature(Frame& frame, const Estimate& estimate, TrackedLandmark& landmark) {
    if (landmark.stored || landmark.measured < parameters_.mature_sightings) return;
    if (!landmark.appearance.has_descriptor || known_here(estimate)) return;
    archive(frame, estimate, estimate.filter().find(landmark.id), landmark);
    landmark.stored = true;
  }
  /// Reports to the map builder that a landmark of the library was found where it was expected.
  void report_found(Frame& frame, LandmarkId id) { send(frame, Message::Kind::kFound, id); }
  /// The same for one that was not found; it is not reactivated again for a while.
  void report_not_found(Frame& frame, LandmarkId id) {
    send(frame, Message::Kind::kNotFound, id);
    policy_.refuse(id);
  }

  /// Records that the filter used a match. A landmark of the library gets its patch, one on the
  /// floor its height, and one that has become mature its place in the library.
  void note_inlier(Frame& frame, Estimate& estimate, const PixelMatch<float>& match);

  /// Adds a landmark of the library to the filter. False when the filter has no room or holds none.
  bool reactivate(Frame& frame, Estimate& estimate, const Archived& archived);

 private:
  void send(Frame& frame, typename Message::Kind kind, LandmarkId id);
  /// Whether the library shows enough here: twice as many landmarks as hold a pose.
  static bool known_here(const Estimate& estimate) {
    constexpr int kEnough = 8;
    int found = 0;
    for (const TrackedLandmark& landmark : estimate.landmarks()) {
      const bool seen = landmark.from_library && landmark.measured > 0 && landmark.searched;
      found += seen && landmark.misses == 0 ? 1 : 0;
    }
    return found >= kEnough;
  }
  /// Whether the alignment is estimated.
  bool recognised(const Estimate& estimate) const {
    if constexpr (kReactivates) return alignment_.estimated(estimate.filter());
    return false;
  }

  Parameters parameters_;
  MapAlignment<Filter> alignment_;
  ReactivationPolicy policy_;
  Matrix3<float> tracked_covariance_ = Matrix3<float>::Zero();
};

template <class Config, class Filter>
PlanarPose<float> VehicleArchive<Config, Filter>::pose_in_map(const Estimate& estimate) const {
  const Rigid<float> T_map_vehicle =
      T_world_map(estimate.filter()).inverse() * estimate.T_world_vehicle();
  const Vector3<float> forward = T_map_vehicle.rotation * Vector3<float>(1.0F, 0.0F, 0.0F);
  PlanarPose<float> pose;
  pose.position = T_map_vehicle.translation.template head<2>();
  pose.heading = atan2(forward.y(), forward.x());
  return pose;
}

template <class Config, class Filter>
Matrix3<float> VehicleArchive<Config, Filter>::covariance_in_map(const Estimate& estimate) const {
  if constexpr (kReactivates) {
    if (recognised(estimate)) return alignment_.pose_covariance(estimate.filter());
  }
  return estimate.filter().pose_covariance();
}

template <class Config, class Filter>
Matrix3<float> VehicleArchive<Config, Filter>::map_covariance(const Estimate& estimate) const {
  if (!recognised(estimate)) return Matrix3<float>::Zero();
  const Vector2<float> away = pose_in_map(estimate).position - alignment_.recognised_at();
  Matrix3<float> turned = Matrix3<float>::Identity();
  turned(0, 2) = -away.y();
  turned(1, 2) = away.x();
  return turned * tracked_covariance_ * turned.transpose();
}

template <class Config, class Filter>
void VehicleArchive<Config, Filter>::send(Frame& frame, typename Message::Kind kind,
                                          LandmarkId id) {
  Message message;
  message.kind = kind;
  message.id = id;
  if (!frame.map.messages.push(message)) ++frame.health.map_messages_dropped;
}

template <class Config, class Filter>
void VehicleArchive<Config, Filter>::note_inlier(Frame& frame, Estimate& estimate,
                                                 const PixelMatch<float>& match) {
  TrackedLandmark* landmark = estimate.landmarks().find(match.id);
  if (landmark == nullptr) return;
  LandmarkMeasurement<Estimate::kMaxLandmarks>::note_inlier(*landmark, frame.report);
  if (estimate.take_patch(frame, *landmark, match.pixel) && landmark->measured == 1) {
    report_found(frame, match.id);
  }
  estimate.check_ground(frame, *landmark);
  estimate.constrain_to_floor(frame, *landmark);
  archive_mature(frame, estimate, *landmark);
}

/// With its covariance relative to the vehicle: the pose's own error is shared with the map around
/// it and left out. A landmark of the library stays in the place that it has there: the filter's
/// estimate of it is made of that place, and to store it again would count that twice and let the
/// map drift from visit to visit. So would new landmarks that replace old ones where the library
/// already shows the place.
template <class Config, class Filter>
void VehicleArchive<Config, Filter>::archive(Frame& frame, const Estimate& estimate, int slot,
                                             const TrackedLandmark& landmark) {
  if (!landmark.appearance.has_descriptor) return;
  if (landmark.from_library || known_here(estimate)) return;
  const Filter& filter = estimate.filter();
  const Rigid<float> T_map_world = T_world_map(filter).inverse();
  const Matrix3<float> R = T_map_world.rotation.toRotationMatrix();
  Message message;
  message.kind = Message::Kind::kStore;
  Archived& archived = message.landmark;
  archived.p_map = T_map_world * filter.mean_landmark(slot);
  Matrix3<float> covariance;
  if constexpr (kReactivates) {
    covariance = filter.relative_landmark_covariance(slot);
  } else {
    covariance = filter.landmark_covariance(slot);
  }
  const Matrix3<float> rotated = R * covariance * R.transpose();
  archived.covariance = 0.5F * (rotated + rotated.transpose());
  fill_archived(landmark, frame.camera, T_map_world * landmark.appearance.T_world_reference,
                archived);
  if (frame.map.messages.push(message)) {
    ++frame.health.landmarks_archived;
  } else {
    ++frame.health.map_messages_dropped;
  }
}

template <class Config, class Filter>
bool VehicleArchive<Config, Filter>::reactivate(Frame& frame, Estimate& estimate,
                                                const Archived& archived) {
  if constexpr (kReactivates) {
    Filter& filter = estimate.filter();
    if (alignment_.estimated(filter)) {
      alignment_.add_drift(filter, parameters_.drift);
    } else if (!ok(alignment_.begin(filter, estimate.next_id(), tracked_covariance_,
                                    square(parameters_.map_height_sigma_m)))) {
      return false;
    }
    if (!ok(alignment_.add_landmark(filter, archived.id, archived.p_map,
                                    parameters_.inflation * archived.covariance))) {
      return false;
    }
    TrackedLandmark landmark = reactivated_landmark(archived.id);
    Appearance& appearance = landmark.appearance;
    appearance.descriptor = archived.views[0].descriptor;
    appearance.scale_index = archived.views[0].pose.scale_index;
    appearance.T_world_reference = T_world_map(filter) * archived.views[0].T_map_reference;
    appearance.has_patch = false;
    estimate.landmarks().add(landmark);
    ++frame.report.reactivated;
    ++frame.health.landmarks_reactivated;
    return true;
  } else {
    static_cast<void>(frame);
    static_cast<void>(estimate);
    static_cast<void>(archived);
    return false;
  }
}

}  // namespace cairn
