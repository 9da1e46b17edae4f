#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/base/health.hpp"
#include "cairn/planar/detail/landmark_slots.hpp"
#include "cairn/planar/detail/reacquisition.hpp"
#include "cairn/planar/fixed/motion.hpp"
#include "cairn/planar/fixed/rest.hpp"
#include "cairn/planar/fixed/row_scaled_factor.hpp"
#include "cairn/planar/fixed/sighting.hpp"

namespace cairn {

/// GroupIekfSlam in the plane for cores without a floating-point unit: integers alone, of 32 and 64
/// bits. The same error model, updates, gate, re-acquisition and rest; the covariance is kept as a
/// triangular factor with one scale for each state (RowScaledFactor), so it is positive
/// semi-definite whatever is rounded. Why in this form, and what map, room and drive it holds:
/// docs/explanation/fixed-point.md.
///
/// Frames, slots and errors: as PlanarSlam. Every input is defined; what does not fit its format
/// saturates, and saturations() counts it. Two instances are independent, all storage is inside.
template <int MaxLandmarks>
class FixedGroupSlam {
 public:
  static constexpr int kMaxLandmarks = MaxLandmarks;
  static constexpr int kStates = 3 + 2 * MaxLandmarks;
  /// Most observations in one update.
  static constexpr int kMaxObservations = kMaxLandmarks < 24 ? 48 : 2 * kMaxLandmarks;

  /// Starts an empty map at `pose` with `covariance`. Errors: kInvalidArgument (not positive
  /// semi-definite), kBadConfig.
  Status initialise(const FixedPose& pose, const FixedPoseCovariance& covariance,
                    const FixedPlanarParameters& parameters = FixedPlanarParameters{});

  /// As PlanarSlam::predict(). Errors: kNotInitialised; kInvalidArgument (|turn| > pi, covariance
  /// not positive semi-definite). Cost: O(1).
  Status predict(const FixedIncrement& increment);

  /// As PlanarSlam::update_points(). Errors: kNotInitialised; kInvalidArgument (too many, noise not
  /// positive definite): nothing is used then. Cost: with n states and m landmarks used at most (2
  /// m + 3) n^2 turned elements.
  Status update_points(Span<FixedPointObservation> observations, FixedUpdateReport& report) {
    return update(observations, FixedLength{}, report);
  }
  /// As PlanarSlam::update_range_bearing(). Errors and cost: as update_points().
  Status update_range_bearing(Span<FixedRangeBearingObservation> observations,
                              FixedLength sensor_offset, FixedUpdateReport& report) {
    return update(observations, sensor_offset, report);
  }

  /// As PlanarSlam::predict_range_bearing(). Cost: O(n).
  Status predict_range_bearing(int slot, FixedLength sensor_offset, FixedLength sigma_range,
                               FixedAngle sigma_bearing,
                               FixedRangeBearingPrediction& prediction) const;

  /// Adds a landmark seen at (x, y) in the vehicle frame with `noise`. Errors and `replaced`: as
  /// PlanarSlam::add_landmark(). Cost: as one landmark's update.
  Status add_landmark(LandmarkId id, FixedLength x, FixedLength y, const FixedCovariance2& noise,
                      LandmarkId* replaced = nullptr);
  /// Errors: kNotInitialised, kNotFound. Cost: as one landmark's update.
  Status remove_landmark(int slot);
  /// Adds noise to the pose. Errors: kNotInitialised, kInvalidArgument (negative).
  Status widen_pose(FixedVariance position, FixedVariance heading);

  bool initialised() const { return initialised_; }
  int landmark_count() const { return slots_.size(); }
  int state_size() const { return factor_.size(); }
  LandmarkId landmark_id(int slot) const { return slots_.id(slot); }
  /// Slot of a landmark, -1 where there is none.
  int find(LandmarkId id) const { return slots_.find(id); }

  /// Mean, the point of linearisation.
  FixedPose mean_pose() const;
  FixedLandmark mean_landmark(int slot) const;  ///< its covariance is zero
  /// Exact moments of the Gaussian error, as GroupIekfSlam's. Cost: O(1); O(n) for a landmark.
  void pose(FixedPose& mean, FixedPoseCovariance& covariance) const;
  FixedLandmark landmark(int slot) const;

  const Health& health() const { return health_; }
  /// Results that did not fit their format, divisions by zero among them, since initialise().
  std::uint32_t saturations() const { return saturations_; }
  /// Of every value that a result depends on.
  void hash(Hash64& hash) const;

 private:
  static constexpr int kPoseStates = 3;  // heading, x, y, then x and y of each landmark

  template <class Observation>
  Status update(Span<Observation> observations, FixedLength sensor_offset,
                FixedUpdateReport& report);
  template <class Observation>
  int collect(Span<Observation> observations, FixedLength sensor_offset, FixedUpdateReport& report);
  bool tells_nothing_new(int count, FixedUpdateReport& report);
  void apply(int count, FixedUpdateReport& report);
  std::int64_t apply_row(const detail::FixedSighting& sighting, int row);
  void correct();
  void finish_update(int used, FixedUpdateReport& report);
  void widen_landmark(int slot, int doublings);
  void end_rest();
  void propagate(const FixedIncrement& increment);
  void absorb_motion();
  void share_pose_error();
  Status make_room(LandmarkId id, LandmarkId* replaced);
  void remove_states(int slot);
  void append_row(int from, std::int64_t first, std::int64_t second, int fraction);

  int state_of(int slot) const { return kPoseStates + 2 * order_[slot]; }
  FixedLength vehicle(int axis) const { return local(x_[axis]); }
  FixedLength landmark_local(int slot, int axis) const { return local(p_[slot][axis]); }
  static FixedLength local(FixedCoordinate coordinate) {
    std::uint32_t none = 0;
    return convert<FixedLength>(coordinate, none);
  }
  FixedLength relative(int slot, int axis) const {
    std::uint32_t none = 0;
    return convert<FixedLength>(subtract(p_[slot][axis], x_[axis], none), none);
  }
  FixedCovariance2 relative_covariance(int slot, std::uint32_t& saturations) const;
  FixedPoseCovariance error_covariance(std::uint32_t& saturations) const;

  FixedPlanarParameters parameters_;
  Health health_;
  std::uint32_t saturations_ = 0;
  bool initialised_ = false;
  std::uint32_t updates_ = 0;
  detail::LandmarkSlots<MaxLandmarks> slots_;
  detail::Reacquisition reacquisition_;
  detail::FixedRest rest_;

  // The mean, m from the anchor, and the order of the landmarks' states.
  FixedAngle heading_;
  FixedCoordinate x_[2];
  FixedCoordinate anchor_[2];
  FixedCoordinate p_[MaxLandmarks][2];
  std::int16_t order_[MaxLandmarks] = {};

  // Its error: what the factor holds, what odometry added since, and what the pose was unsure by
  // when the first landmark came.
  RowScaledFactor<kStates> factor_;
  detail::FixedMotionNoise motion_;
  FixedPoseCovariance shared_;

  // Of one update.
  detail::FixedSighting sightings_[kMaxObservations];
  std::int16_t refused_[kMaxObservations] = {};
  int refused_count_ = 0;
  std::int64_t admitted_score_ = 0;
  std::int32_t correction_[kStates] = {};
  std::int32_t scratch_[2 * kStates] = {};
};

}  // namespace cairn

#include "cairn/planar/fixed/fixed_group_slam_impl.hpp"
#include "cairn/planar/fixed/fixed_group_slam_read_out.hpp"
#include "cairn/planar/fixed/fixed_group_slam_update_impl.hpp"
