#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/base/health.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/planar/fixed/correction.hpp"
#include "cairn/planar/fixed/error.hpp"
#include "cairn/planar/fixed/pixel_model.hpp"
#include "cairn/planar/fixed/pixel_sighting.hpp"
#include "cairn/planar/fixed/rest.hpp"
#include "cairn/planar/fixed/sighting.hpp"
#include "cairn/planar/fixed/state.hpp"
#include "cairn/planar/fixed/tilt.hpp"
#include "cairn/planar/fixed/update_records.hpp"

namespace cairn {

namespace detail {
template <class Filter>
class FixedPixelUpdate;
}

/// PlanarSlam for cores without a floating-point unit: integers alone, of 32 and 64 bits. Use it as
/// FixedGroupSlam or, to compare with, FixedEkfSlam. The same error model, updates, gate,
/// re-acquisition and rest; the covariance is kept as a triangular factor with one scale for each
/// state (RowScaledFactor), so it is positive semi-definite whatever is rounded. Why in this form,
/// and what map, room and drive it holds: docs/explanation/fixed-point.md. LandmarkDim 2: points on
/// the plane; 3: with height, for the camera, and with the tilt of the vehicle's body where the
/// parameters have one.
///
/// Frames, slots and errors: as PlanarSlam. Every input is defined; what does not fit saturates,
/// counted by saturations(). Two instances are independent, all storage is inside.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
class FixedPlanarSlam {
  static_assert(LandmarkDim == 2 || (LandmarkDim == 3 && Error == FixedError::kGroup));

 public:
  static constexpr int kMaxLandmarks = MaxLandmarks;
  static constexpr int kLandmarkDim = LandmarkDim;
  static constexpr int kTiltState = 3;  ///< pitch, then roll, where the body tilts
  static constexpr int kStates = (LandmarkDim == 3 ? 5 : 3) + LandmarkDim * MaxLandmarks;
  /// Most observations in one update.
  static constexpr int kMaxObservations = kMaxLandmarks < 24 ? 48 : 2 * kMaxLandmarks;

  /// Starts an empty map at `pose` with `covariance`. Errors: kInvalidArgument (not positive
  /// semi-definite), kBadConfig.
  Status initialise(const FixedPose& pose, const FixedPoseCovariance& covariance,
                    const FixedPlanarParameters& parameters = FixedPlanarParameters{});

  /// As PlanarSlam::predict(). Errors: kNotInitialised; kInvalidArgument (|turn| > pi, covariance
  /// not positive semi-definite). Cost: O(1).
  Status predict(const FixedIncrement& increment);

  /// As PlanarSlam::predict_tilt(). Errors: kNotInitialised; kInvalidArgument (negative).
  Status predict_tilt(FixedOffset dt_s);

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

  /// Where `slot` is expected in a picture, as PlanarSlam::predict_pixel(). Takes in the
  /// odometry's noise before. Errors: kNotInitialised, kNotFound, kInvalidArgument (sigma,
  /// mounting), kBadConfig (camera), kOutOfView; `prediction` untouched. Cost: O(n), and as one
  /// landmark's update after odometry.
  Status predict_pixel(int slot, const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                       FixedPixel sigma_px, FixedPixelPrediction& prediction);

  /// The same with the odometry's noise counted, not taken in: nothing changes. Cost: O(n).
  Status expect_pixel(int slot, const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                      FixedPixel sigma_px, FixedPixelPrediction& prediction) const;

  /// The windows of a frame: predict_pixel() of every landmark that is expected 2 px or more inside
  /// the picture, the most uncertain first, as plan_searches() orders them. Errors: as
  /// predict_pixel(), `plan` untouched. Cost: predict_pixel() for each landmark, the camera's pose
  /// once, an insertion sort.
  Status plan_pixels(const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                     FixedPixel sigma_px, FixedVector<FixedPlannedPixel, MaxLandmarks>& plan);

  /// Updates with landmarks of the image that lie inside their gates, all linearised at one mean,
  /// and marks those used. Landmarks with height only. Errors: kNotInitialised, kInvalidArgument
  /// (too many, sigma, mounting), kBadConfig (camera): nothing is used then. Cost: update_points().
  Status update_pixels(const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                       FixedPixel sigma_px, FixedPixelMatch* matches, int count,
                       FixedUpdateReport& report);
  /// As PlanarSlam::update_pixels(), with the same draws of `random`: 1-point RANSAC, update with
  /// the inliers of the best hypothesis, rescue of the others. Errors: as above; kNoConsensus.
  /// Cost: as update_points(), and for each of at most max_hypotheses hypotheses n (n + 1)
  /// multiply-adds and a projection for each match.
  Status update_pixels(const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                       FixedPixel sigma_px, FixedPixelMatch* matches, int count, Random& random,
                       FixedUpdateReport& report);
  /// What update_pixels() asks of a consensus from now on. kInvalidArgument outside its domain.
  Status set_ransac(const FixedRansacParameters& ransac) {
    if (!ransac.valid()) return Status::kInvalidArgument;
    parameters_.ransac = ransac;
    return Status::kOk;
  }

  /// As PlanarSlam::update_height(). Errors: kNotInitialised, kNotFound, kInvalidArgument (sigma,
  /// gate); kGated. Cost: as one pixel.
  Status update_height(LandmarkId id, FixedLength height, FixedLength sigma, FixedScore gate);

  /// Adds a landmark seen at (x, y) in the vehicle frame with `noise`. Errors and `replaced`: as
  /// PlanarSlam::add_landmark(). Cost: as one landmark's update.
  Status add_landmark(LandmarkId id, FixedLength x, FixedLength y, const FixedCovariance2& noise,
                      LandmarkId* replaced = nullptr);
  /// Adds a landmark with height, seen at `y` in the vehicle's axes (z: above the ground), tilted
  /// with it. Errors: as add_landmark().
  Status add_landmark(LandmarkId id, const FixedLength (&y)[3], const FixedCovariance3& noise,
                      LandmarkId* replaced = nullptr);
  /// Of landmarks with height alone, as PlanarSlam's. Cost: of a landmark n sums of seven terms for
  /// each coordinate and the odometry's noise; of widen_frame() 4 n^2 turned elements.
  Status add_position(LandmarkId id);
  Status add_landmark_on_path(LandmarkId id, const FixedLength (&y)[3],
                              const FixedCovariance3& noise, LandmarkId past,
                              const FixedLength (&by_path)[3][2], LandmarkId* replaced = nullptr);
  Status add_frame_position(LandmarkId id, const FixedCoordinate (&p_world)[3],
                            const FixedCovariance3& covariance, LandmarkId reference = kNoLandmark);
  Status add_framed_landmark(LandmarkId id, const FixedCoordinate (&p_world)[3],
                             const FixedCovariance3& covariance, LandmarkId origin,
                             LandmarkId ahead, LandmarkId* replaced = nullptr);
  Status widen_frame(LandmarkId origin, LandmarkId ahead, FixedVariance position,
                     FixedVariance heading);
  /// Errors: kNotInitialised, kNotFound. Cost: as one landmark's update.
  Status remove_landmark(int slot);
  /// As PlanarSlam's. Errors: kNotInitialised, kInvalidArgument (negative).
  Status drift_world(FixedVariance position, FixedVariance heading);
  Status widen_pose(FixedVariance position, FixedVariance heading);
  Status slip_laterally(FixedVariance variance);
  /// As PlanarSlam::place() and put_back().
  struct Placement {
    FixedPose pose;
    detail::FixedMotionNoise waiting_noise;
  };
  Placement place(const FixedPose& pose, FixedVariance position, FixedVariance heading);
  void put_back(const Placement& before);
  /// As PlanarSlam::recentre(). Cost: then 2 n multiply-adds for each landmark.
  bool recentre();

  bool initialised() const { return initialised_; }
  int landmark_count() const { return state_.count(); }
  int state_size() const { return errors_.factor().size(); }
  LandmarkId landmark_id(int slot) const { return state_.slots().id(slot); }
  /// Slot of a landmark, -1 where there is none.
  int find(LandmarkId id) const { return state_.find(id); }

  /// Mean, the point of linearisation.
  FixedPose mean_pose() const { return state_.pose(); }
  FixedLandmark mean_landmark(int slot) const;  ///< its covariance is zero
  /// Exact moments of the Gaussian error, as GroupIekfSlam's; EkfSlam's are the mean's. Cost: O(1);
  /// O(n) for a landmark.
  void pose(FixedPose& mean, FixedPoseCovariance& covariance) const;
  FixedLandmark landmark(int slot) const;

  /// As PlanarSlam's of these names. Cost: O(n).
  FixedPoseCovariance own_pose_covariance() const;
  FixedPoseCovariance framed_pose_covariance(LandmarkId origin, LandmarkId ahead) const;
  FixedCovariance3 relative_landmark_covariance(int slot) const;
  FixedCovariance3 landmark_covariance(int slot) const;

  /// Height of a landmark and its variance; 0 of points on the plane.
  FixedCoordinate landmark_height(int slot) const { return state_.height(slot); }
  FixedVariance landmark_height_variance(int slot) const;
  /// Whether the tilt is part of the state, its mean, and its covariance.
  bool tilts() const { return state_.tilts(); }
  FixedTilt tilt() const { return state_.tilt(); }
  FixedCovariance2 tilt_covariance() const {
    return tilts() ? errors_.tilt_covariance() : FixedCovariance2();
  }
  /// Variances of what `dt_s` seconds add to it.
  FixedCovariance2 tilt_noise(FixedOffset dt_s) const {
    return detail::tilt_noise(parameters_.tilt, dt_s);
  }
  /// Covariance of two elements of the error without the odometry that no update has taken in yet:
  /// heading, xi_x, xi_y, pitch and roll where the body tilts, landmarks. Cost: O(n).
  FixedVariance factor_covariance(int i, int j) const { return errors_.covariance(i, j); }
  int state_of(int slot) const { return state_.state_of(slot); }

  const Health& health() const { return health_; }
  /// Results that did not fit their format, divisions by zero among them, since initialise().
  std::uint32_t saturations() const { return saturations_; }
  /// Of every value that a result depends on.
  void hash(Hash64& hash) const;

 private:
  static constexpr FixedError kError = Error;
  static constexpr bool kWorld = Error == FixedError::kWorld;
  using State = detail::FixedPlanarState<MaxLandmarks, LandmarkDim>;
  using Errors = detail::FixedPlanarError<State, Error>;
  using PixelModel = detail::FixedPixelModel<State, Errors>;
  friend class detail::FixedPixelUpdate<FixedPlanarSlam>;

  template <class Observation>
  Status update(Span<Observation> observations, FixedLength sensor_offset,
                FixedUpdateReport& report);
  template <class Observation>
  int collect(Span<Observation> observations, FixedLength sensor_offset, FixedUpdateReport& report);
  template <class Sighting>
  bool tells_nothing_new(const Sighting* sightings, int count, FixedUpdateReport& report);
  template <class Sighting>
  void apply(const Sighting* sightings, int count, FixedUpdateReport& report,
             bool deviates = false);
  template <class Sighting>
  void finish_update(const Sighting* sightings, int used, FixedUpdateReport& report);
  Status check_camera(const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                      FixedPixel sigma_px) const;
  void end_rest();
  void propagate(const FixedIncrement& increment);
  void absorb_motion() { errors_.absorb_motion(state_, saturations_); }
  Status make_room(LandmarkId id, LandmarkId* replaced, detail::NeededLandmarks needed = {});
  void remove_states(int slot);
  void prepare_to_append(bool shares);
  void enter(LandmarkId id, const detail::FixedStateRow (&rows)[3],
             const detail::FixedCholesky3& noise, int spare, bool pinned = false);
  Status add_seen(LandmarkId id, const FixedLength (&y)[3], const FixedCovariance3& noise,
                  LandmarkId past, const FixedLength (*by_path)[2], LandmarkId* replaced);
  std::int64_t height_score(const detail::FixedPixelSighting& seen, FixedLength sigma,
                            std::uint32_t& lost);

  FixedPlanarParameters parameters_;
  Health health_;
  std::uint32_t saturations_ = 0;
  bool initialised_ = false;
  State state_;
  Errors errors_;
  detail::FixedRest rest_;
  detail::FixedUpdateRecords<kMaxObservations> records_;
  detail::FixedCorrection<State, Error> correction_;
  // Of one update.
  detail::FixedSighting sightings_[kMaxObservations];
  detail::FixedPixelSighting pixels_[LandmarkDim == 3 ? kMaxObservations : 1];
};

}  // namespace cairn

#include "cairn/planar/fixed/fixed_planar_slam_impl.hpp"
#include "cairn/planar/fixed/fixed_planar_slam_map_impl.hpp"
#include "cairn/planar/fixed/fixed_planar_slam_pixel_impl.hpp"
#include "cairn/planar/fixed/fixed_planar_slam_read_out.hpp"
#include "cairn/planar/fixed/fixed_planar_slam_update_impl.hpp"
#include "cairn/planar/fixed/pixel_update.hpp"
