#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/fixed_landmark_sight.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/ground_check.hpp"
#include "cairn/tracking/landmark_measurement.hpp"
#include "cairn/tracking/planar_pose_search.hpp"
#include "cairn/tracking/vehicle_numbers.hpp"

namespace cairn {

/// When a landmark's height is compared with the floor.
struct FloorParameters {
  float sigma_m = 0.02F;             ///< unevenness of the floor; 0: heights are not used
  float height_sigma_max_m = 0.08F;  ///< largest height sigma at which a landmark is tested
  float gate = 3.84F;                ///< chi-square, 1 degree of freedom, 95 %

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good = is_finite(sigma_m) && sigma_m >= 0.0F && is_positive(height_sigma_max_m) &&
                      is_positive(gate);
    return good ? Status::kOk : Status::kBadConfig;
  }
};

namespace detail {
/// Whether a filter can use a camera: kOk of one that does not ask.
template <class Filter>
auto check_camera_of(const PinholeCamera<float>& camera, int)
    -> decltype(Filter::check_camera(camera)) {
  return Filter::check_camera(camera);
}
template <class Filter>
Status check_camera_of(const PinholeCamera<float>&, long) {
  return Status::kOk;
}
}  // namespace detail

/// A planar SLAM filter (EkfSlam, LiftedIekfSlam or GroupIekfSlam, LandmarkDim 3), the camera on
/// its vehicle, and the tracker's records of its landmarks, which come and go together.
///
/// Poses and points are in the filter's frame, `world`. Vehicle frame: x forward, y left, z up,
/// origin on the floor.
template <class Filter>
class VehicleEstimate {
 public:
  static constexpr int kMaxLandmarks = Filter::kMaxLandmarks;
  using Landmarks = TrackedLandmarks<kMaxLandmarks>;
  using Matches = FixedVector<PixelMatch<float>, kMaxLandmarks>;

  /// Starts anew without landmarks. Errors, nothing changed: as Filter::initialise(), and
  /// kBadConfig for a camera that the filter has no form of.
  Status initialise(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
                    const PlanarPose<float>& pose, const Matrix3<float>& covariance,
                    const PlanarParameters<float>& filter, float sigma_px,
                    const FloorParameters& floor);

  const Filter& filter() const { return filter_; }
  Filter& filter() { return filter_; }
  const PinholeCamera<float>& camera() const { return camera_; }
  const Rigid<float>& T_vehicle_camera() const { return T_vehicle_camera_; }
  /// The vehicle on the floor, level.
  Rigid<float> T_world_vehicle() const { return on_floor(filter_.mean_pose()); }
  /// The camera on the level vehicle, with the body's tilt.
  Rigid<float> T_level_camera() const {
    if (!filter_.tilts()) return T_vehicle_camera_;
    return filter_.tilt().T_level_vehicle() * T_vehicle_camera_;
  }
  Rigid<float> T_world_camera() const {
    if constexpr (VehicleNumbers<Filter>::kIntegers) {
      return float_of(VehicleNumbers<Filter>::T_world_camera(*this));
    } else {
      return T_world_vehicle() * T_level_camera();
    }
  }
  /// Covariance of the body's (pitch, roll), rad^2; zero for one that does not tilt.
  Matrix2<float> tilt_covariance() const { return filter_.tilt_covariance(); }
  /// Of the larger of the two, rad.
  float sigma_tilt() const {
    const Matrix2<float> covariance = tilt_covariance();
    return sqrt(covariance(0, 0) > covariance(1, 1) ? covariance(0, 0) : covariance(1, 1));
  }
  /// Variances that a step of `step_s` seconds adds to it.
  Vector2<float> tilt_noise(float step_s) const { return filter_.tilt_noise(step_s); }
  /// Whether the body tilts by more than its suspension allows.
  bool tilts_too_far() const;

  const Landmarks& landmarks() const { return landmarks_; }
  Landmarks& landmarks() { return landmarks_; }
  /// The first id that was not given out yet. Ids name landmarks and remembered positions.
  const LandmarkId& next_id() const { return next_id_; }
  LandmarkId& next_id() { return next_id_; }

  int size() const { return filter_.landmark_count(); }
  LandmarkId id(int slot) const { return filter_.landmark_id(slot); }
  template <class Prediction>
  Status predict(int slot, Prediction& prediction) const {
    return filter_.predict_pixel(slot, camera_, T_vehicle_camera_, sigma_px_, prediction);
  }

  /// Most units of work that update() takes with so many matches.
  int update_work(int matches) const;
  /// Units of work of one predict().
  int projection_work() const {
    return work::kProjection + (filter_.tilts() ? work::kTiltedProjection : 0);
  }
  /// Prepares the filter for an update at a pose that may have become unsure; the units of work
  /// that it took.
  int recentre() { return filter_.recentre() ? work::recentring(state_count()) : 0; }
  /// Least number of inliers that the filter's parameters ask for.
  int min_inliers() const { return ransac_.min_inliers; }

  /// Updates the filter with the matches that the frame can pay for; the last ones, which are the
  /// least informative, are left out first. Sets `inlier` of the others. `min_inliers`: inliers
  /// that RANSAC must find. Errors, in the result: as Filter::update_pixels(); no match is then an
  /// inlier.
  PixelUpdate update(FrameContext& frame, Matches& matches, int min_inliers);

  using Placement = typename Filter::Placement;
  /// Before the update of an unsure pose, over which pixels are not linear and false matches agree:
  /// finds the pose that the matches agree on and leaves those alone. False, all unchanged, where
  /// chance would agree as well or the frame cannot pay for it. `sightings`: memory for
  /// PlanarPoseOptions::kMaxSightings.
  bool find_agreed(FrameContext& frame, Matches& matches, PlanarSighting* sightings,
                   PlanarPose<float>& pose) const;
  /// Most units of work that find_agreed() takes.
  static constexpr int agreement_work(int matches) {
    return PlanarConsensusOptions::kMostPairs * (8 + 2 * matches);  // a unit a projection
  }

  /// Takes the patch of a landmark that has none, seen at `pixel`. False where it has one, or the
  /// frame cannot pay for it. Near the image border it stays without, until it is seen elsewhere.
  bool take_patch(FrameContext& frame, TrackedLandmark& landmark,
                  const Vector2<float>& pixel) const {
    if (landmark.appearance.has_patch || !frame.work.take(work::kAppearance)) return false;
    static_cast<void>(make_appearance(frame.image, round_to_int(pixel.x()), round_to_int(pixel.y()),
                                      T_world_camera(), landmark.appearance));
    return true;
  }

  /// Uses a landmark on the floor as a measurement of height 0, once its height is known well
  /// enough to distinguish the floor from what stands on it. The camera's height above the floor is
  /// the one length, beside odometry, that makes the map's scale observable. Landmarks of the
  /// library and those tested before are passed over. Where the body tilts the ground must first
  /// prove to be a floor (FloorProof).
  void constrain_to_floor(FrameContext& frame, TrackedLandmark& landmark);

  /// Notes how far below the camera the landmark lies, once, as soon as that is known well enough.
  /// Those of the library have the scale of another drive.
  void check_ground(FrameContext& frame, TrackedLandmark& landmark);
  /// The vehicle moved by `ahead_m` by odometry, and the image added `correction_m`: what that says
  /// of the floor's height, where the floor gives the map its scale.
  void check_ground(float ahead_m, float correction_m) {
    ground_.note_way(ahead_m);
    if (floor_.sigma_m > 0.0F && floor_proof_.proven()) ground_.note_step(ahead_m, correction_m);
  }
  const GroundCheck& ground() const { return ground_; }

  /// Removes a landmark from the filter and from the records.
  void remove(FrameContext& frame, int slot);

 private:
  /// Of a filter whose error is that of pose, tilt and landmarks.
  int state_count() const { return (filter_.tilts() ? 5 : 3) + 3 * filter_.landmark_count(); }

  int pixel_work(int candidates, int hypotheses, int used) const {
    const int states = state_count();
    return work::planar_update(states, candidates, hypotheses, used) +
           (filter_.tilts() ? work::tilted_update(states, candidates, hypotheses, used) : 0);
  }

  Filter filter_;
  LandmarkId next_id_ = 1;
  Landmarks landmarks_;
  PinholeCamera<float> camera_;
  Rigid<float> T_vehicle_camera_;
  OnePointRansacParameters ransac_;
  FloorParameters floor_;
  FloorProof floor_proof_;
  GroundCheck ground_;
  float sigma_px_ = 0.5F;
};

template <class Filter>
Status VehicleEstimate<Filter>::initialise(const PinholeCamera<float>& camera,
                                           const Rigid<float>& T_vehicle_camera,
                                           const PlanarPose<float>& pose,
                                           const Matrix3<float>& covariance,
                                           const PlanarParameters<float>& filter, float sigma_px,
                                           const FloorParameters& floor) {
  Status status = detail::check_camera_of<Filter>(camera, 0);
  if (ok(status)) status = filter_.initialise(pose, covariance, filter);
  if (!ok(status)) return status;
  landmarks_.clear();
  next_id_ = 1;
  camera_ = camera;
  T_vehicle_camera_ = T_vehicle_camera;
  ransac_ = filter.ransac;
  floor_ = floor;
  floor_proof_.reset(filter.tilt.tilts());
  ground_.reset(T_vehicle_camera.translation.z());
  sigma_px_ = sigma_px;
  return Status::kOk;
}

template <class Filter>
int VehicleEstimate<Filter>::update_work(int matches) const {
  const int most = ransac_.max_hypotheses;
  return pixel_work(matches, matches < most ? matches : most, matches);
}

template <class Filter>
PixelUpdate VehicleEstimate<Filter>::update(FrameContext& frame, Matches& matches,
                                            int min_inliers) {
  PixelUpdate result;
  OnePointRansacParameters ransac = ransac_;
  ransac.min_inliers = min_inliers;
  filter_.set_ransac(ransac);
  const int used =
      affordable_matches(matches.size(), frame.work, [&](int n) { return update_work(n); });
  result.left_out = matches.size() - used;
  matches.resize(used);
  if (result.left_out > 0) frame.work.raise_cut(FrameCut::kFewerUpdates);
  result.status = filter_.update_pixels(camera_, T_vehicle_camera_, sigma_px_, matches.data(),
                                        matches.size(), frame.random, result.report);
  if (!matches.empty()) {
    frame.work.spend(
        pixel_work(matches.size(), result.report.hypotheses, result.report.nis_dof / 2));
  }
  for (PixelMatch<float>& match : matches) {
    if (!ok(result.status)) match.inlier = false;
    result.inliers += match.inlier ? 1 : 0;
  }
  return result;
}

template <class Filter>
bool VehicleEstimate<Filter>::find_agreed(FrameContext& frame, Matches& matches,
                                          PlanarSighting* sightings,
                                          PlanarPose<float>& pose) const {
  constexpr float kSigmas = 2.0F;       // of a pixel, with the landmark's own error
  constexpr float kMostChance = 1e-3F;  // a second look tells
  constexpr int kMost = PlanarPoseOptions::kMaxSightings;
  const int count = matches.size() < kMost ? matches.size() : kMost;
  if (!frame.work.take(agreement_work(count))) return false;
  const Rigid<float> T_level_camera = this->T_level_camera();
  const PlanarView view = {camera_, T_level_camera, sigma_tilt()};
  for (int i = 0; i < count; ++i) {
    sightings[i].p_map = filter_.mean_landmark(filter_.find(matches[i].id));
    sightings[i].pixel = matches[i].pixel;
    sightings[i].sigma_px = sqrt(square(kSigmas * sigma_px_) + square(view.tilt_px()));
  }
  PlanarConsensusOptions options;
  options.max_chance = kMostChance;
  bool inliers[kMost] = {};
  int inlier_count = 0;
  if (!ok(find_planar_consensus(view, {filter_.mean_pose(), filter_.own_pose_covariance()},
                                sightings, count, options, pose, inliers, inlier_count))) {
    return false;
  }
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    if (inliers[i]) matches[kept++] = matches[i];
  }
  matches.resize(kept);
  return true;
}

template <class Filter>
bool VehicleEstimate<Filter>::tilts_too_far() const {
  constexpr float kSigmas = 5.0F;
  if (!filter_.tilts()) return false;
  const VehicleTilt<float> tilt = filter_.tilt();
  const TiltParameters<float>& usual = filter_.parameters().tilt;
  return abs(tilt.pitch) > kSigmas * usual.sigma_pitch_rad ||
         abs(tilt.roll) > kSigmas * usual.sigma_roll_rad;
}

template <class Filter>
void VehicleEstimate<Filter>::constrain_to_floor(FrameContext& frame, TrackedLandmark& landmark) {
  if (landmark.floor == FloorTest::kDone || landmark.from_library) return;
  if (!(floor_.sigma_m > 0.0F)) return;
  if (landmark.floor == FloorTest::kCounted && !floor_proof_.proven()) return;
  const int slot = filter_.find(landmark.id);
  const float variance = filter_.landmark_covariance(slot)(2, 2);
  if (variance > square(floor_.height_sigma_max_m)) return;
  const int most = work::height_update(state_count());
  if (!frame.work.affords(most)) return;
  if (landmark.floor == FloorTest::kOpen && filter_.tilts()) {
    const float height_m = filter_.mean_landmark(slot)(2);
    floor_proof_.note(height_m, square(height_m) / (variance + square(floor_.sigma_m)),
                      floor_.gate);
    landmark.floor = FloorTest::kCounted;
    if (!floor_proof_.proven()) return frame.work.spend(work::kProjection);
  }
  landmark.floor = FloorTest::kDone;
  const Status used = filter_.update_height(landmark.id, 0.0F, floor_.sigma_m, floor_.gate);
  frame.work.spend(ok(used) ? most : work::kProjection);
}

template <class Filter>
void VehicleEstimate<Filter>::check_ground(FrameContext& frame, TrackedLandmark& landmark) {
  constexpr float kMostSigma = 0.08F;  // of what it lies below the camera
  constexpr float kFlattest = 0.2F;    // a hundredth of pitch, or of slope, is 5 % of that here,
  constexpr float kNoSlope = 1.5F;     // and so far below no slope reaches
  if (landmark.in_ground_check || landmark.from_library) return;
  if (!frame.work.take(work::kProjection)) return;
  const int slot = filter_.find(landmark.id);
  const Vector3<float> place = filter_.mean_landmark(slot);
  const float height_m = T_vehicle_camera_.translation.z();
  const float below_m = height_m - place.z();
  const Vector2<float> away =
      place.template head<2>() - T_world_camera().translation.template head<2>();
  const bool steep = below_m > kFlattest * away.norm();
  if (!(steep || below_m > kNoSlope * height_m)) return;
  if (filter_.landmark_covariance(slot)(2, 2) > square(kMostSigma * below_m)) return;
  landmark.in_ground_check = true;
  ground_.note_landmark(below_m);
  constexpr float kHalfWay = 0.5F;  // of the camera's height
  const Vector3<float> ahead = T_world_vehicle().inverse() * place;
  if (ahead.x() > 0.0F && abs(ahead.y()) < kHalfWay * height_m) ground_.note_on_way(below_m);
}

template <class Filter>
void VehicleEstimate<Filter>::remove(FrameContext& frame, int slot) {
  const LandmarkId id = filter_.landmark_id(slot);
  if (!ok(filter_.remove_landmark(slot))) return;
  landmarks_.remove(id);
  ++frame.report.removed;
  ++frame.health.landmarks_removed;
}

}  // namespace cairn
