#pragma once

#include <cstdint>

#include "cairn/base/config.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/tracking/frame_input.hpp"
#include "cairn/tracking/mounting.hpp"
#include "cairn/tracking/odometry_integrator.hpp"
#include "cairn/tracking/picture_drift.hpp"
#include "cairn/tracking/repeated_image.hpp"
#include "cairn/tracking/stage_timer.hpp"
#include "cairn/tracking/systematic_error.hpp"
#include "cairn/tracking/unsure_pose.hpp"
#include "cairn/tracking/vehicle_doubt.hpp"
#include "cairn/tracking/vehicle_map_reuse.hpp"
#include "cairn/tracking/vehicle_numbers.hpp"

namespace cairn {

/// Camera tracking on a planar vehicle from video and odometry (paper A): a planar SLAM filter with
/// camera landmarks (`Filter`: EkfSlam, LiftedIekfSlam or GroupIekfSlam with LandmarkDim 3) behind
/// the vision front end. Vehicle frame: x forward, y left, z up, origin on the floor.
///
/// This is the module "tracking and registration" of the paper. Each frame: predict the pose by
/// odometry, measure the landmarks that it expects in view, update the filter with the matches,
/// judge whether the pose holds, keep the map, report. The active landmarks are in the filter,
/// correlated with the pose; the long memory is the map library, which this module reads through a
/// snapshot and which a MapBuilder keeps from the messages that it sends (SharedMap).
///
/// All storage is inside; the caller decides where an instance lies. One frame costs at most
/// `max_searches` landmark searches, one filter update of as many matches, one step of the seed
/// pool, `cells_per_frame` cells of corner detection and `library_slots_per_frame` projections;
/// while lost, one step of the relocaliser and at most two passes over the library in place of the
/// map's growth.
///
/// All of it stays within set_work_limit(). Work beyond the limit is left out from the end of this
/// list:
///   1. prediction and the plan of the searches: always done;
///   2. searches, the most informative landmarks first, as long as their update is within it too;
///   3. the update, without the least informative matches;
///   4. relocalisation, or else seeds, new landmarks, new seeds and reactivation;
///   5. the mount check.
template <class Config, class Filter>
class FrameTracker {
 public:
  static constexpr int kMaxLandmarks = Config::kMaxLandmarks;
  static constexpr int kMaxKeyframes = Config::kMaxKeyframes;
  using Estimate = VehicleEstimate<Filter>;
  using Measurement = LandmarkMeasurement<kMaxLandmarks>;
  using LocalMap = VehicleLocalMap<Config, Filter>;
  using MapReuse = VehicleMapReuse<Config, Filter>;
  using Supply = typename LocalMap::Supply;
  using Map = SharedMap<Config>;
  using Library = typename Map::Library;

  /// The heading error is common to all landmarks, so a 99 % gate would reject all of them in one
  /// frame of a hundred: windows and gates are at 99.99 % (chi-square, 2 degrees of freedom).
  static constexpr float kWideGate = 18.42F;

  struct Parameters {
    /// The filter's re-acquisition is off: it widens the pose at every prediction, which at frame
    /// rate would make the search windows grow too fast; the tracking states take its place. Two
    /// inliers are enough for a young map, because odometry bounds what they can change. The
    /// camera's yaw against the direction of travel is known to 0.2 degrees. In
    /// pictures of less than 240 rows seeds begin nearer to the border than a descriptor needs:
    /// they are found by their patch, and 29 px would leave 22 of 80 rows.
    Parameters() {
      filter.reacquire_after = 0;
      filter.ransac.min_inliers = 2;
      filter.gate = kWideGate;
      filter.travel_sigma_rad = 0.0035F;
      measurement.search.method = SearchMethod::kPatch;
      measurement.search.gate = kWideGate;
      measurement.search.patch.gate = kWideGate;
      local_map.seeds.gate = kWideGate;
      local_map.supply.most_margin_share = 0.121F;
      measurement.search.patch.max_half_window_px = PatchSearchParameters::kMaxHalfWindow;
      measurement.max_searches = 40;
    }

    PlanarParameters<float> filter;
    OdometryNoise odometry;
    SystematicError systematic;
    float sigma_px = 0.8F;
    FloorParameters floor;
    typename Measurement::Parameters measurement;
    TrackingMonitor::Parameters monitor;
    typename LocalMap::Parameters local_map;
    typename MapReuse::Parameters map_reuse;
    int work_limit = 10000;              ///< units of WorkBudget a frame, drawing apart
    int max_frames_without_mapping = 8;  ///< then mapping gets half of a frame's work
    std::int64_t max_step_us = 1000000;  ///< longer without odometry: the motion is unknown
    std::uint64_t seed = 1;

    /// kBadConfig unless every value is finite and in its domain; those of the filter it checks
    /// itself.
    Status validate() const {
      const bool parts = ok(odometry.validate()) && ok(systematic.validate()) &&
                         ok(floor.validate()) && ok(measurement.validate()) &&
                         ok(monitor.validate()) && ok(local_map.validate()) &&
                         ok(map_reuse.validate());
      const bool good = parts && is_positive(sigma_px) && work_limit >= 0 &&
                        max_frames_without_mapping >= 0 && max_step_us > 0 &&
                        max_step_us <= FrameInput::kLongestStepUs;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  struct Start {
    PlanarPose<float> pose;
    Matrix3<float> covariance = Matrix3<float>::Zero();  ///< of (x, y, heading)
    std::int64_t t_us = 0;
  };

  /// Starts anew at a known pose. The tracker is unchanged on an error: kBadConfig for an
  /// impossible camera, mounting or parameter; kNonFiniteInput; kInvalidArgument for a covariance
  /// that is none.
  Status initialise(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
                    const Start& start, const Parameters& parameters);

  /// Integrates odometry up to the sample's time. Refused and counted, the pose unchanged:
  /// kNonFiniteInput, kInvalidArgument, kTimeBackwards, and kTimeGap for a stamp that InputClock
  /// does not believe. Taken: kGated and kTimeGap as OdometryIntegrator::add().
  Status add_odometry(const OdometrySample& sample);

  /// Tracks one frame; odometry up to its time should have been added, the rest is extrapolated.
  /// Refused and counted, `report` untouched: kInvalidArgument (wrong size), kDuplicate,
  /// kTimeBackwards, and kTimeGap for a stamp that InputClock does not believe. Tracked:
  /// report.status is kTimeGap where frames or odometry were missing for longer than the largest
  /// step; the pose is then as uncertain as that leaves it. kRepeatedImage: the picture is the one
  /// before, and the pose odometry's.
  Status process_frame(const ImageView& image, std::int64_t t_us, const TickSource& ticks, Map& map,
                       FrameReport& report);

  /// Units of work that each frame may take from now on (FrameCut says what it left out for it). An
  /// input like any other: logs record it. kInvalidArgument for a negative one.
  Status set_work_limit(int units) { return work_.set_limit(units); }

  /// Ids below `next` are taken: after a library came from elsewhere.
  void reserve_ids(LandmarkId next) {
    if (next <= estimate_.next_id()) return;
    estimate_.next_id() = next;
    map_reuse_.archive().policy().allow_below(next);
  }
  LandmarkId next_id() const { return estimate_.next_id(); }

  const Filter& filter() const { return estimate_.filter(); }
  const PinholeCamera<float>& camera() const { return estimate_.camera(); }
  const Rigid<float>& T_vehicle_camera() const { return estimate_.T_vehicle_camera(); }
  /// Covariance of filter().pose() over (x, y, heading), m and rad: the filter's own, which says
  /// how well the pose and the map agree, and the systematic errors, which move both.
  Matrix3<float> pose_covariance() const {
    return filter().pose_covariance() + systematic_.covariance(filter().pose().position - start_);
  }
  /// Covariance of T_map_vehicle() over (x, y, heading), m and rad, in the map's axes: of the
  /// vehicle's place in the map, what the map itself may be wrong by, and the systematic errors.
  Matrix3<float> map_pose_covariance() const {
    const auto& archive = map_reuse_.archive();
    return covariance_in_map() + archive.map_covariance(estimate_) +
           systematic_.covariance(archive.pose_in_map(estimate_).position - start_);
  }
  /// The same without what pose and map are wrong by together: how well the two agree.
  Matrix3<float> covariance_in_map() const {
    return map_reuse_.archive().covariance_in_map(estimate_);
  }
  /// In the filter's frame.
  Rigid<float> T_world_camera() const { return estimate_.T_world_camera(); }
  /// The map's frame in the filter's: identity until landmarks of the library were reactivated.
  Rigid<float> T_world_map() const { return map_reuse_.archive().T_world_map(filter()); }
  /// The vehicle on the floor of the map.
  Rigid<float> T_map_vehicle() const {
    return T_world_map().inverse() * estimate_.T_world_vehicle();
  }
  const TrackedLandmarks<kMaxLandmarks>& landmarks() const { return estimate_.landmarks(); }
  /// Of the tracker and of its filter.
  Health health() const { return with_filter(health_, filter().health()); }
  /// Results that did not fit their format, of a tracker in fixed point; 0 of others.
  std::uint32_t saturations() const {
    return VehicleNumbers<Filter>::saturations(filter(), local_map_.seeds());
  }
  TrackingState state() const;
  /// How far the mount and the focal length seem to be from what initialise() was told.
  const MountOffset& mount_offset() const { return doubt_.mount_offset(); }
  /// Whether speed and camera height fit the height of the ground in the pictures.
  const GroundCheck& ground() const { return estimate_.ground(); }
  /// Whether odometry turns as the pictures do.
  const YawCheck& yaw() const { return doubt_.yaw(); }
  void hash(Hash64& hash) const;

 private:
  using Frame = VehicleFrame<Config>;

  void begin(const ImageView& image);
  void restart_clock(std::int64_t t_us);
  Status predict(std::int64_t t_us);
  Status pass_over(Status status);
  void measure(Frame& frame);
  Status update(Frame& frame, Status status);
  Status keep_map(Frame& frame, Status status);
  Status relocalise(Frame& frame, const Library& library, Status status);
  void note_correction(const PlanarPose<float>& predicted);
  void note_matches(Frame& frame, const typename Measurement::Matches& matches);
  void report(Status status, FrameReport& report);
  bool unsure() const;
  PixelUpdate update_estimate(Frame& frame, typename Measurement::Matches& matches);
  void begin_anew(Frame& frame);
  bool relocalises() const;

  Estimate estimate_;
  Measurement measurement_;
  TrackingMonitor monitor_;
  LocalMap local_map_;
  MapReuse map_reuse_;
  OdometryIntegrator odometry_;
  SystematicError systematic_;
  Vector2<float> start_ = Vector2<float>::Zero();
  FrameInput input_;
  InputClock clock_;
  RepeatedImage repeated_;
  VehicleDoubt doubt_;
  FrameWork work_;
  Random random_;
  Health health_;
  VehicleScratch<Config> scratch_;
  float frame_step_s_ = 0.0F;
  bool thin_map_ = false;  ///< the last frame was weak for want of landmarks in view
};

}  // namespace cairn

#include "cairn/runtime/detail/frame_tracker_impl.hpp"
