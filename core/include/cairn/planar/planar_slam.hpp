#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/base/health.hpp"
#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/planar/detail/covariance_guard.hpp"
#include "cairn/planar/detail/landmark_slots.hpp"
#include "cairn/planar/detail/reacquisition.hpp"
#include "cairn/planar/detail/rest.hpp"
#include "cairn/planar/detail/whitened_update.hpp"
#include "cairn/planar/increment.hpp"
#include "cairn/planar/observation/camera_view.hpp"
#include "cairn/planar/observation/point.hpp"
#include "cairn/planar/observation/range_bearing.hpp"
#include "cairn/planar/types.hpp"

namespace cairn {

namespace detail {
template <class Filter>
class PixelUpdate;
}

/// A planar SLAM filter: the pose of a vehicle on a plane and the landmarks around it, moved by
/// odometry, corrected by sightings of landmarks. Use it as GroupIekfSlam (the default), EkfSlam or
/// LiftedIekfSlam (to compare with).
///
/// Frames: world; vehicle, x forward, y left, z up, origin on the ground. Landmarks are points of
/// LandmarkDim coordinates, m: on the plane, or with a height. They lie in slots 0 ..
/// landmark_count() - 1; a removal moves the last one into the gap.
///
/// All storage is inside, copies are independent. An error leaves the state unchanged to the bit.
/// With n states, a prediction costs O(1) or O(n), an update see update().
///
/// ErrorModel holds mean and covariance and says what "error" means. It has the constants Scalar,
/// kMaxLandmarks, kLandmarkDim, kVehicleStates, kStates, kHasWorldLandmarks, kDefersNoise,
/// kTurnsAboutAnchor, and
///   start, propagate, widen..., slip... the vehicle: at a known pose, by odometry, with more noise
///   frame, relative                   the relative vector landmark - vehicle, in frame()'s axes
///   relative_of, relative_columns,    with C its Jacobian by the error: C v, P C^T (x and y; the
///   height_state, relative_covariance height is a state of its own), C P C^T
///   relative_scale                    and the variances that it is a difference of
///   retraction, relative_after        the relative vector if a correction d were applied
///   correct                           applies d to the mean
///   append_..., remove_..., widen_... the map; see error_model/landmark_insertion.hpp
///   mean_..., pose..., landmark_...   what is read out
/// A model with kDefersNoise holds noise back: deferred_noise(), deferred_noise_absorbed(). One
/// with kTurnsAboutAnchor has errors about an anchor, which can be moved: bends(), move_anchor().
template <class ErrorModel>
class PlanarSlam {
 public:
  using Scalar = typename ErrorModel::Scalar;
  static constexpr int kMaxLandmarks = ErrorModel::kMaxLandmarks;
  static constexpr int kLandmarkDim = ErrorModel::kLandmarkDim;
  static constexpr int kStates = ErrorModel::kStates;
  /// Most observations in one update.
  static constexpr int kMaxObservations = kMaxLandmarks < 24 ? 48 : 2 * kMaxLandmarks;
  /// Whether landmarks known in the world can be added. Where not, add_world_landmark(),
  /// add_frame_position(), add_framed_landmark() and widen_frame() return kInvalidArgument.
  static constexpr bool kHasWorldLandmarks = ErrorModel::kHasWorldLandmarks;
  /// Whether the vehicle's body can tilt (PlanarParameters::tilt). A body that cannot is level:
  /// predict_tilt() does nothing, and initialise() refuses a tilt.
  static constexpr bool kTilts = ErrorModel::kTiltStates > 0;
  using LandmarkVector = Vector<Scalar, kLandmarkDim>;
  using LandmarkMatrix = Matrix<Scalar, kLandmarkDim, kLandmarkDim>;

  /// Starts an empty map at `pose` with `covariance` over (x, y, heading) in m^2, m rad, rad^2.
  /// Errors: kNonFiniteInput, kInvalidArgument (not symmetric or positive semi-definite, heading
  /// beyond 1e4 rad, others beyond kMostPosition and most variances), kBadConfig.
  Status initialise(const PlanarPose<Scalar>& pose, const Matrix3<Scalar>& covariance,
                    const PlanarParameters<Scalar>& parameters = PlanarParameters<Scalar>{});

  /// Moves the vehicle by one odometry increment. Errors: kNotInitialised; kNonFiniteInput,
  /// kInvalidArgument of validate(increment). After lasting rejections (see PlanarParameters) it
  /// also widens the pose. At rest the noise is held until an update drops it (rest_sigmas) or it
  /// grows beyond 2 cm or 10 mrad; until then no covariance shows it.
  Status predict(const PlanarIncrement<Scalar>& increment);

  /// Lets the body's tilt return to zero for `dt_s` seconds, with its noise, and the map turn about
  /// the vehicle so that no pixel moves; once a frame suffices. At rest this is held as odometry's.
  /// Errors: kNotInitialised, kInvalidArgument (negative, not finite).
  Status predict_tilt(Scalar dt_s);

  /// Updates with observations of landmarks by any sensor. `Sensor` is an observation model over
  /// some `Observation` with an `id`:
  ///   Status check(observation) const   kOk, or why it cannot be used
  ///   bool linearise(observation, frame, relative, covariance, out) const   fills `out`
  ///     (LinearisedObservation) at the relative vector and its covariance; false: cannot be used
  /// Observations of unknown landmarks are passed over, those outside the gate counted and left
  /// out; having used none is not an error. The covariance is kept positive semi-definite: by noise
  /// for the arithmetic, by repairs and at last by a reset that forgets correlations, which
  /// health() counts. Errors: kNotInitialised; kInvalidArgument (more than
  /// kMaxObservations); those of check(): nothing is used then.
  /// Cost: per landmark n multiply-adds for each nonzero state and n (n + 1) for the covariance.
  template <class Observation, class Sensor>
  Status update(Span<Observation> observations, const Sensor& sensor, UpdateReport& report);

  /// update() with Cartesian points in the vehicle frame.
  Status update_points(Span<PointObservation<Scalar>> observations, UpdateReport& report) {
    return update(observations, PointSensor<Scalar>{}, report);
  }

  /// update() with ranges and bearings from a sensor `sensor_offset_m` ahead of the vehicle's
  /// centre; the two are used as they are, not turned into points.
  Status update_range_bearing(Span<RangeBearingObservation<Scalar>> observations,
                              Scalar sensor_offset_m, UpdateReport& report) {
    return update(observations, RangeBearingSensor<Scalar>{sensor_offset_m}, report);
  }

  /// Where `slot` is expected by a sensor `sensor_offset_m` ahead of the vehicle's centre. Errors:
  /// kNotInitialised, kNotFound, kInvalidArgument (sigmas), kOutOfView (nearer than 5 cm);
  /// `prediction` untouched. Cost: O(1).
  Status predict_range_bearing(int slot, Scalar sensor_offset_m, Scalar sigma_range,
                               Scalar sigma_bearing,
                               RangeBearingPrediction<Scalar>& prediction) const;

  /// Where `slot` is expected in the image of a camera fixed to the vehicle. Landmarks with height
  /// only. Errors: kNotInitialised, kNotFound, kInvalidArgument (sigma), kOutOfView (nearer than
  /// 0.3 m, behind, or outside the image); `prediction` untouched. Cost: O(1).
  Status predict_pixel(int slot, const PinholeCamera<Scalar>& camera,
                       const Rigid<Scalar>& T_vehicle_camera, Scalar sigma_px,
                       PixelPrediction<Scalar>& prediction) const;

  /// Updates with landmarks found in the image: 1-point RANSAC, update with the inliers of the best
  /// hypothesis, rescue of the others at the new state, update with these. Sets `inlier` of each
  /// match. Landmarks with height only. Errors: kNotInitialised, kInvalidArgument, kNonFiniteInput,
  /// kNoConsensus (fewer inliers than the limits of `ransac`; a rest may end, its noise counts).
  /// Cost: at most max_hypotheses * 2 n sparse products, and the update's.
  /// Source: paper B section 2; pixels are predicted, never measured, in the rows.
  Status update_pixels(const PinholeCamera<Scalar>& camera, const Rigid<Scalar>& T_vehicle_camera,
                       Scalar sigma_px, PixelMatch<Scalar>* matches, int count, Random& random,
                       UpdateReport& report);

  /// What update_pixels() asks of a consensus from now on.
  void set_ransac(const OnePointRansacParameters& ransac) { parameters_.ransac = ransac; }

  /// Updates with the height of a landmark above the ground, m: what lies on the floor is at 0, and
  /// so determines the scale of what was measured together with it. Landmarks with height only.
  /// Errors: kNotInitialised, kNotFound, kInvalidArgument (sigma, gate), kNonFiniteInput; kGated
  /// (chi-square, 1 degree of freedom), kSingular. Cost: as one pixel.
  Status update_height(LandmarkId id, Scalar height_m, Scalar sigma_m, Scalar gate);

  /// Adds a landmark seen at `y_vehicle` (m, vehicle frame; third component: height above the
  /// ground) with noise covariance `R`. In a full map the landmark of PlanarParameters'
  /// replace_after makes room; `replaced`, if given, gets its id (or kNoLandmark). Errors:
  /// kNotInitialised, kInvalidArgument (id 0, R not positive definite, a variance of it beyond
  /// 1e10 m^2, farther than 1e5 m), kNonFiniteInput, kDuplicate, kFull. Cost: 6 n a coordinate.
  Status add_landmark(LandmarkId id, const LandmarkVector& y_vehicle, const LandmarkMatrix& R,
                      LandmarkId* replaced = nullptr);

  /// Remembers where the vehicle is now as a state of its own, fully correlated with the pose, for
  /// add_landmark_on_path(). It takes a landmark's slot, is never replaced, and leaves by
  /// remove_landmark(). Errors: kNotInitialised, kInvalidArgument (id 0), kDuplicate, kFull.
  Status add_position(LandmarkId id);

  /// Adds a landmark that was triangulated over the path since a remembered position, so that its
  /// place in the vehicle frame depends on that path: d y / d (x - x_past) = `by_path`, all in the
  /// vehicle frame; R is the noise that does not. The error of the path, which all landmarks
  /// triangulated over it share, enters through the states' covariance. Errors: as add_landmark(),
  /// kInvalidArgument (`by_path` beyond 1e5), kNotFound (no such position).
  Status add_landmark_on_path(LandmarkId id, const LandmarkVector& y_vehicle,
                              const LandmarkMatrix& R, LandmarkId past,
                              const Matrix<Scalar, kLandmarkDim, 2>& by_path,
                              LandmarkId* replaced = nullptr);

  /// Adds a landmark known in the world, m, from elsewhere than this filter: its error is that of
  /// `reference`, a landmark known in the world too, plus an independent part. Without
  /// a reference all of it is taken as independent, although landmarks of one old map have
  /// correlated errors. Errors: as add_landmark(), kNotFound (no such reference).
  Status add_world_landmark(LandmarkId id, const LandmarkVector& p_world,
                            const LandmarkMatrix& covariance, LandmarkId reference = kNoLandmark,
                            LandmarkId* replaced = nullptr);

  /// Adds a place of an old map as a state of its own, to hold the frame of that map with a second
  /// one. `covariance`, m^2, is of where it lies seen from the vehicle, or from `reference`, the
  /// first of the two: what the vehicle's pose is wrong by moves both, so that seeing the old map
  /// tells where the vehicle is in it, and not where the two are. Kept and removed as those of
  /// add_position(). Errors: as add_world_landmark().
  Status add_frame_position(LandmarkId id, const LandmarkVector& p_world,
                            const LandmarkMatrix& covariance, LandmarkId reference = kNoLandmark);

  /// Adds a landmark of an old map whose frame is held by two positions of add_frame_position(),
  /// `ahead` referring to `origin`: its error is what turn and offset of that frame make of it plus
  /// an independent part. With p = origin + lambda (ahead - origin) in complex numbers of the plane
  /// it is (1 - lambda) that of origin + lambda that of ahead, the height's is origin's. Errors: as
  /// add_world_landmark(), kInvalidArgument (both in one place). Cost: 12 multiply-adds a state.
  Status add_framed_landmark(LandmarkId id, const LandmarkVector& p_world,
                             const LandmarkMatrix& covariance, LandmarkId origin, LandmarkId ahead,
                             LandmarkId* replaced = nullptr);

  /// Adds noise to such a frame: an offset of `position_variance` m^2 per axis, and a turn about
  /// where the vehicle is of `heading_variance` rad^2. kInvalidArgument, kNotFound. Cost: 10
  /// elements of the covariance.
  Status widen_frame(LandmarkId origin, LandmarkId ahead, Scalar position_variance,
                     Scalar heading_variance);

  /// Covariance over (x, y, heading), m and rad, of the pose in such a frame, in the world's axes.
  /// Cost: 50 elements of the covariance. Domain: `origin` and `ahead` are such a frame.
  Matrix3<Scalar> framed_pose_covariance(LandmarkId origin, LandmarkId ahead) const;

  /// Pose and landmarks together move by independent offsets of `position_variance` m^2 per axis
  /// and turn about the vehicle by `heading_variance` rad^2: what a map that is seen piece after
  /// piece drifts by. No sighting shows it, and none counts as one of it. Group filter alone,
  /// others do nothing. kNotInitialised, kInvalidArgument. Cost: O(1).
  Status drift_world(Scalar position_variance, Scalar heading_variance);

  /// Forgets a landmark; the last one moves into its slot. kNotFound when there is no such slot.
  Status remove_landmark(int slot);

  /// Adds independent noise to the pose: variances in m^2 (per axis) and rad^2, the most at most.
  Status widen_pose(Scalar position_variance, Scalar heading_variance);
  Status slip_laterally(Scalar variance);  ///< the same across the vehicle's heading alone, m^2

  /// A pose as odometry left it: what place() changes.
  struct Placement {
    PlanarPose<Scalar> pose;
    Matrix3<Scalar> waiting_noise = Matrix3<Scalar>::Zero();
  };
  /// Puts the mean of the pose, m and rad, where the vehicle was recognised, before the update with
  /// what was seen there. Noise of odometry that waits to enter the covariance is bounded by these
  /// variances, m^2 and rad^2, which must allow for the error of `pose`; the landmarks stay. What
  /// was before: for put_back(), as long as nothing else has changed. Without world landmarks: does
  /// nothing.
  Placement place(const PlanarPose<Scalar>& pose, Scalar position_variance,
                  Scalar heading_variance);
  void put_back(const Placement& before);

  /// Where the heading has become so unsure that a turn about the error's distant centre would not
  /// be linear, moves that centre to the vehicle; the estimate stays. Before an update, after what
  /// widened the pose. Whether it moved. Cost: then n (n + 1) multiply-adds.
  bool recentre();

  bool initialised() const { return initialised_; }
  /// Whether the tilt is part of the state, its mean, and its covariance over (pitch, roll), rad^2.
  bool tilts() const {
    if constexpr (kTilts) return model_.tilts();
    return false;
  }
  VehicleTilt<Scalar> tilt() const {
    if constexpr (kTilts) return model_.tilt();
    return {};
  }
  Matrix2<Scalar> tilt_covariance() const {
    if constexpr (kTilts) return model_.tilt_covariance();
    return Matrix2<Scalar>::Zero();
  }
  DirectionOfTravel<Scalar> travel() const { return model_.travel(); }
  /// Variances of what `dt_s` seconds add to (pitch, roll), rad^2.
  Vector2<Scalar> tilt_noise(Scalar dt_s) const;
  /// Mean pose, the point of linearisation: what images are registered with.
  PlanarPose<Scalar> mean_pose() const { return model_.mean_pose(); }
  /// Mean landmark, the partner of mean_pose(), m.
  LandmarkVector mean_landmark(int slot) const { return model_.mean_landmark(slot); }
  /// Expected pose given the error's distribution, and its covariance over (x, y, heading).
  PlanarPose<Scalar> pose() const { return model_.pose(); }
  Matrix3<Scalar> pose_covariance() const { return model_.pose_covariance(); }
  /// Of the pose beside the error that it shares with all landmarks, which no sighting shows, where
  /// the model keeps that apart (GroupIekfSlam); as pose_covariance() elsewhere.
  Matrix3<Scalar> own_pose_covariance() const;
  /// Expected landmark, the partner of pose(), m; and its covariance, m^2.
  LandmarkVector landmark_position(int slot) const { return model_.landmark_position(slot); }
  LandmarkMatrix landmark_covariance(int slot) const { return model_.landmark_covariance(slot); }
  /// Covariance of a landmark as seen from the vehicle, m^2, without the vehicle's own error, in
  /// the world's axes (LiftedIekfSlam: the vehicle's). Rounding may leave a variance below 0.
  LandmarkMatrix relative_landmark_covariance(int slot) const;
  /// Element of the covariance of the error model's own error, deferred noise included: EkfSlam (x,
  /// y, heading, landmarks), GroupIekfSlam (heading, xi_x, xi_landmarks), both with pitch and roll
  /// before the landmarks where the body tilts, then the direction of travel; LiftedIekfSlam its
  /// lifted state. i, j < state_size().
  Scalar error_covariance(int i, int j) const { return model_.error_covariance(i, j); }

  int landmark_count() const { return slots_.size(); }
  LandmarkId landmark_id(int slot) const { return slots_.id(slot); }
  /// Slot of a landmark, -1 when it is not in the state. O(landmarks).
  int find(LandmarkId id) const { return id == kNoLandmark ? -1 : slots_.find(id); }
  const LandmarkStatistics& landmark_statistics(int slot) const { return slots_.statistics(slot); }
  /// Updates that had a known landmark, since initialise().
  std::uint32_t update_count() const { return updates_; }
  const Health& health() const { return health_; }
  const PlanarParameters<Scalar>& parameters() const { return parameters_; }
  int state_size() const { return model_.covariance().size(); }
  /// Fingerprint of mean and covariance.
  void hash(Hash64& hash) const;

 protected:
  using T = Scalar;
  static Status check_start(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                            const PlanarParameters<T>& parameters);

  ErrorModel model_;

 private:
  friend class detail::PixelUpdate<PlanarSlam>;
  using Linearised = LinearisedObservation<T, kLandmarkDim>;

  template <class Observation, class Sensor>
  Status check_observations(Span<Observation> observations, const Sensor& sensor);
  template <class Observation, class Sensor>
  int collect(Span<Observation> observations, const Sensor& sensor, UpdateReport& report);
  bool admit(const Linearised& observation, const InnovationCovariance<T>& s, T gate,
             UpdateReport& report);
  InnovationCovariance<T> innovation_of(const Linearised& observation,
                                        const RelativeCovariance<T>& covariance,
                                        const RelativeFrame<T>& frame) const;
  CameraView<T> camera_view(const PinholeCamera<T>& camera, const Rigid<T>& T_vehicle_camera,
                            T sigma_px) const;
  bool tells_nothing_new(int count, UpdateReport& report);
  void end_rest();
  void refuse(int slot, UpdateReport& report);
  void apply_update(int first, int count, UpdateReport& report, bool deviates = false);
  void finish_update(int used, UpdateReport& report);
  void widen_refused_landmarks();

  /// Not inlined: GCC would split it, and its call graph would lose the part that it splits off.
  __attribute__((noinline)) Status check_landmark(const LandmarkVector& p,
                                                  const LandmarkMatrix& covariance);
  Status make_room(LandmarkId id, LandmarkId* replaced, detail::NeededLandmarks needed = {});
  Status make_room_in_world(LandmarkId id, const LandmarkVector& p_world,
                            const LandmarkMatrix& covariance, LandmarkId reference,
                            LandmarkId* replaced);
  void enter(LandmarkId id, bool pinned = false);

  bool initialised_ = false;
  PlanarParameters<T> parameters_;
  detail::LandmarkSlots<kMaxLandmarks> slots_;
  Health health_;
  std::uint32_t updates_ = 0;
  detail::Reacquisition reacquisition_;
  detail::Rest<T> rest_;
  detail::CovarianceGuard<ErrorModel> guard_;

  // Scratch of one update: members, not locals, so that the stack stays small.
  Linearised observations_[kMaxObservations];
  InnovationCovariance<T> prior_[kMaxObservations];  ///< of the pixel candidates
  std::int16_t refused_[kMaxObservations] = {};
  int refused_count_ = 0;
  T admitted_nis_ = T(0);  ///< of the observations inside their gates, before the update
  bool singular_ = false;  ///< an innovation covariance was not positive definite
  detail::WhitenedUpdate<ErrorModel> update_;
};

}  // namespace cairn

#include "cairn/planar/detail/planar_slam_impl.hpp"
#include "cairn/planar/detail/planar_slam_map_impl.hpp"
#include "cairn/planar/detail/planar_slam_update_impl.hpp"
