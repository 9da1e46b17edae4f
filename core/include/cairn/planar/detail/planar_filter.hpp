#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/base/health.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/planar/detail/landmark_table.hpp"
#include "cairn/planar/detail/low_rank.hpp"
#include "cairn/planar/detail/measurement.hpp"
#include "cairn/planar/detail/reacquisition.hpp"
#include "cairn/planar/increment.hpp"

namespace cairn::detail {

/// What the planar filters share: the map's bookkeeping, validation, gating, sequential updates,
/// 1-point RANSAC and re-acquisition. `Derived` holds the mean and knows how errors move:
///
///   frame(), relative(slot, out)         the relative vector landmark - vehicle
///   relative_of(slot, v, out)            C v, C the Jacobian of the relative vector
///   relative_covariance(slot, out)       C P C^T
///   relative_columns(slot, c0, c1, c2)   P C^T
///   begin_update(), pending...()         noise that is still to be added to P
///   begin_trial(d), relative_after(...)  the relative vector if d were applied
///   correct(d)                           applies d to the mean
///   propagate, widen_pose_by, widen_landmark_by, append_landmark, remove_slot
template <class Derived, class T, int MaxLandmarks, int LandmarkDim, int VehicleStates,
          int LandmarkStates>
class PlanarFilter {
  static_assert(MaxLandmarks > 0, "a map has room for one landmark at least");
  static_assert(LandmarkDim == 2 || LandmarkDim == 3, "landmarks lie on the plane or have height");

 public:
  using Scalar = T;
  static constexpr int kMaxLandmarks = MaxLandmarks;
  static constexpr int kLandmarkDim = LandmarkDim;
  static constexpr int kStates = VehicleStates + MaxLandmarks * LandmarkStates;
  /// Most observations in one update.
  static constexpr int kMaxObservations = MaxLandmarks < 32 ? 64 : 2 * MaxLandmarks;

  /// Moves the vehicle by one odometry increment. Errors: kNotInitialised; kNonFiniteInput,
  /// kInvalidArgument of validate(increment). After lasting rejections (see PlanarParameters) it
  /// also widens the pose.
  Status predict(const PlanarIncrement<T>& increment);

  /// Updates with Cartesian points in the vehicle frame. Observations of unknown landmarks are
  /// passed over, those outside the gate counted and left out; having used none is not an error.
  /// Errors: kNotInitialised; kInvalidArgument (more than kMaxObservations, a covariance that is
  /// not positive definite); kNonFiniteInput.
  /// Cost: per landmark n multiply-adds for each nonzero state and n (n + 1) for the covariance.
  Status update_points(Span<PointObservation<T>> observations, UpdateReport& report);

  /// Updates with ranges and bearings from a sensor `sensor_offset_m` ahead of the vehicle's
  /// centre; the two are used as they are, not turned into points. Errors: as update_points(),
  /// kInvalidArgument for a range or sigma that is not positive.
  Status update_range_bearing(Span<RangeBearingObservation<T>> observations, T sensor_offset_m,
                              UpdateReport& report);

  /// Where `slot` is expected by a sensor `sensor_offset_m` ahead of the vehicle's centre. Errors:
  /// kNotInitialised, kNotFound, kInvalidArgument (sigmas), kOutOfView (nearer than 5 cm);
  /// `prediction` untouched.
  Status predict_range_bearing(int slot, T sensor_offset_m, T sigma_range, T sigma_bearing,
                               RangeBearingPrediction<T>& prediction) const;

  /// Where `slot` is expected in the image of a camera fixed to the vehicle. Landmarks with height
  /// only. Errors: kNotInitialised, kNotFound, kInvalidArgument (sigma), kOutOfView (nearer than
  /// 0.3 m, behind, or outside the image); `prediction` untouched.
  /// What update_pixels() asks of a consensus from now on.
  void set_ransac(const OnePointRansacParameters& ransac) { parameters_.ransac = ransac; }
  Status predict_pixel(int slot, const PinholeCamera<T>& camera, const Rigid<T>& T_vehicle_camera,
                       T sigma_px, PixelPrediction<T>& prediction) const;

  /// Updates with landmarks found in the image: 1-point RANSAC, update with the supporters of the
  /// best hypothesis, rescue of the others at the new state, update with these. Sets `inlier` of
  /// each match. Landmarks with height only. Errors: kNotInitialised, kInvalidArgument,
  /// kNonFiniteInput, kNoConsensus (support below the limits of `ransac`, whatever the cause).
  /// Cost: at most max_hypotheses * 2 n sparse products, and the update's.
  /// Source: paper B section 2; research: predicted, never measured, pixel in the rows.
  Status update_pixels(const PinholeCamera<T>& camera, const Rigid<T>& T_vehicle_camera, T sigma_px,
                       PixelMatch<T>* matches, int count, Random& random, UpdateReport& report);

  /// Updates with the height of a landmark above the ground, m: what lies on the floor is at 0, and
  /// so tells the scale of what was measured together with it. Landmarks with height only. Errors:
  /// kNotInitialised, kNotFound, kInvalidArgument (sigma, gate), kNonFiniteInput; kGated
  /// (chi-square, 1 degree of freedom), kSingular. Cost: as one pixel.
  Status update_height(LandmarkId id, T height_m, T sigma_m, T gate);

  /// Adds a landmark seen at `y_vehicle` (m, vehicle frame; third component: height above the
  /// ground) with noise covariance `R`. In a full map the landmark of PlanarParameters'
  /// replace_after makes room; `replaced`, if given, gets its id (or kNoLandmark). Errors:
  /// kNotInitialised, kInvalidArgument (id 0, R not positive definite, farther than 1e5 m),
  /// kNonFiniteInput, kDuplicate, kFull.
  Status add_landmark(LandmarkId id, const Vector<T, LandmarkDim>& y_vehicle,
                      const Matrix<T, LandmarkDim, LandmarkDim>& R, LandmarkId* replaced = nullptr);

  /// Forgets a landmark; the last one moves into its slot. kNotFound when there is no such slot.
  Status remove_landmark(int slot);

  /// Adds independent noise to the pose: variances in m^2 (per axis) and rad^2.
  Status widen_pose(T position_variance, T heading_variance);

  bool initialised() const { return initialised_; }
  int landmark_count() const { return table_.size(); }
  LandmarkId landmark_id(int slot) const { return table_.id(slot); }
  /// Slot of a landmark, -1 when it is not in the state. O(landmarks).
  int find(LandmarkId id) const { return id == kNoLandmark ? -1 : table_.find(id); }
  const LandmarkStatistics& landmark_statistics(int slot) const { return table_.statistics(slot); }
  /// Notes that a landmark was looked for and not found.
  void mark_missed(int slot) {
    if (slot >= 0 && slot < table_.size()) ++table_.statistics(slot).missed;
  }
  /// Updates that had a known landmark, since initialise().
  std::uint32_t update_count() const { return updates_; }
  const Health& health() const { return health_; }
  const PlanarParameters<T>& parameters() const { return parameters_; }
  int state_size() const { return P_.size(); }

 protected:
  using Pair = MeasurementPair<T, LandmarkDim>;

  Derived& derived() { return static_cast<Derived&>(*this); }
  const Derived& derived() const { return static_cast<const Derived&>(*this); }

  static int state_of(int slot) { return VehicleStates + slot * LandmarkStates; }

  Status begin(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
               const PlanarParameters<T>& parameters);
  void hash_common(Hash64& hash) const;
  Status check_landmark(const Vector<T, LandmarkDim>& p,
                        const Matrix<T, LandmarkDim, LandmarkDim>& covariance);
  Status make_room(LandmarkId id, LandmarkId* replaced);
  void enter(LandmarkId id);

  bool initialised_ = false;
  PlanarParameters<T> parameters_;
  LandmarkTable<MaxLandmarks> table_;
  PackedSymmetric<T, kStates> P_;
  Health health_;

 private:
  friend Derived;

  template <class Observation, class Check>
  Status check_observations(Span<Observation> observations, Check check);
  template <class Observation, class Linearise>
  void update_with(Span<Observation> observations, Linearise linearise, UpdateReport& report);
  bool admit(const Pair& pair, const RelativeCovariance<T>& relative, T gate, UpdateReport& report);
  void refuse(int slot, UpdateReport& report);
  void conclude(int used, UpdateReport& report);
  void widen_refused_landmarks();
  void use(int first, int count, UpdateReport& report, bool deviates = false);
  void move_to_hypothesis(int candidate);
  bool look_again(const CameraView<T>& view, const PixelMatch<T>* matches, Pair& pair,
                  RelativeCovariance<T>& covariance) const;
  int relinearise(CameraView<T>& view, const PixelMatch<T>* matches, int count);
  bool whiten(const Pair& pair, int rank, T& nis);
  void columns(const Pair& pair, T* g0, T* g1);
  void flush(int rank);
  int resolve(const PixelMatch<T>& match) const;
  Status check_pixels(const PinholeCamera<T>& camera, T sigma_px, const PixelMatch<T>* matches,
                      int count) const;
  int collect_pixels(const CameraView<T>& view, const PixelMatch<T>* matches, int count,
                     UpdateReport& report);
  int hypothesis(const CameraView<T>& view, const PixelMatch<T>* matches, int candidate, int count,
                 bool* supporters);
  int rescue(CameraView<T>& view, const PixelMatch<T>* matches, int first, int count,
             UpdateReport& report);

  std::uint32_t updates_ = 0;
  Reacquisition reacquisition_;

  // Scratch of one update: members, not locals, so that the stack stays small.
  Pair pairs_[kMaxObservations];
  InnovationCovariance<T> prior_[kMaxObservations];  ///< of the pixel candidates
  int refused_[kMaxObservations] = {};
  int refused_count_ = 0;
  T w_[kMostRank][kStates] = {};
  T third_[kStates] = {};
  T d_[kStates] = {};
};

}  // namespace cairn::detail

#include "cairn/planar/detail/planar_filter_impl.hpp"
#include "cairn/planar/detail/planar_pixels_impl.hpp"
#include "cairn/planar/detail/planar_update_impl.hpp"
