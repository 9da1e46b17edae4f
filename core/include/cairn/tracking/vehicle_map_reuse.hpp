#pragma once

#include <new>

#include "cairn/tracking/live_landmarks.hpp"
#include "cairn/tracking/unsure_pose.hpp"
#include "cairn/tracking/vehicle_archive.hpp"
#include "cairn/tracking/vehicle_local_map.hpp"
#include "cairn/tracking/vehicle_relocalisation.hpp"

namespace cairn {

/// What verifying a recognised place came to.
struct PlaceVerification {
  bool updated = false;  ///< the filter was given matches; what follows is of that update
  bool confirmed = false;
  int matches = 0;
  PixelUpdate update;
};

/// Reuse of the map library by a vehicle: while it tracks, landmarks that come into view are
/// reactivated; while it does not, the place is recognised, and verified before the filter takes
/// it. Never goes on from a guess: a pose found must agree with the filter's covariance, and with
/// the image of the frame after.
template <class Config, class Filter>
class VehicleMapReuse {
 public:
  static constexpr int kMaxLandmarks = Config::kMaxLandmarks;
  using Archive = VehicleArchive<Config, Filter>;
  using Relocalisation = VehicleRelocalisation<Config>;
  using Estimate = VehicleEstimate<Filter>;
  using LocalMap = VehicleLocalMap<Config, Filter>;
  using Frame = VehicleFrame<Config>;
  using Library = typename SharedMap<Config>::Library;

  struct Parameters {
    typename Archive::Parameters archive;
    typename Relocalisation::Parameters relocalisation;
    int library_slots_per_frame = 48;  ///< looked through for landmarks that come into view
    int max_reactivations_per_frame = 3;
    int min_expected_in_view = 4;  ///< library landmarks near odometry's pose: a known place

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = ok(archive.validate()) && ok(relocalisation.validate()) &&
                        library_slots_per_frame >= 0 && library_slots_per_frame <= 1000000 &&
                        max_reactivations_per_frame >= 0 && min_expected_in_view >= 1;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  /// Starts anew at a pose with `covariance`. `search`: how landmarks of the library are searched.
  void reset(const Parameters& parameters, const SearchParameters& search,
             const Matrix3<float>& covariance) {
    parameters_ = parameters;
    search_ = search;
    archive_.reset(parameters.archive, covariance);
    relocalisation_.reset(parameters.relocalisation);
    next_library_slot_ = 0;
    usable_ = false;
  }

  Archive& archive() { return archive_; }
  const Archive& archive() const { return archive_; }

  /// Begins a frame after `weak_frames` weak ones.
  void begin_frame(int weak_frames) { relocalisation_.begin_frame(relocalises(weak_frames)); }
  /// Whether the library is usable: not empty, and the filter can hold its landmarks.
  bool usable(const Library* library) {
    usable_ = Archive::kReactivates && library != nullptr && !library->empty();
    return usable_;
  }
  bool relocalises(int weak_frames) const { return usable_ && relocalisation_.wanted(weak_frames); }
  /// The frame's image is for the relocalisation: no landmark is to be searched.
  bool takes_image() const { return relocalisation_.image_wanted(); }
  /// Whether an image showed nothing of the map since the place was last known.
  bool looked() const { return relocalisation_.looked(); }
  /// Units of work to be kept for relocalise().
  int next_work() const { return relocalisation_.next_work(); }
  /// The place is known again.
  void end_relocalisation() { relocalisation_.end(); }
  /// The vehicle is at a place that the library does not have.
  bool place_unknown() const { return relocalisation_.unknown(); }

  /// Looks through a slice of the library for landmarks that come into view, and adds them to the
  /// filter: the next frames search them in the windows that their covariance gives. Cost:
  /// library_slots_per_frame projections.
  void reactivate(Frame& frame, Estimate& estimate, const Library& library);

  /// One step of the relocalisation. `monitor` says how many matches confirm a place; `unsure`: the
  /// pose does not say which landmarks of the library are in view.
  PlaceVerification relocalise(Frame& frame, Estimate& estimate, LocalMap& local_map,
                               const TrackingMonitor& monitor, const Library& library, bool unsure);

 private:
  static constexpr int kMaxVisible = ExpectedScratch<kMaxLandmarks>::kMaxVisible;
  using Scratch = ExpectedScratch<kMaxLandmarks>;

  static Scratch& begin_scratch(Frame& frame) { return *new (&frame.scratch.expected) Scratch(); }
  void refuse(Frame& frame) {
    ++frame.health.false_relocalisations_refused;
    relocalisation_.refuse();
  }
  bool plausible(const Estimate& estimate, const Rigid<float>& T_map_camera) const;
  bool in_known_place(Frame& frame, const Estimate& estimate, const Library& library) const;
  /// Where the pose is unsure the filter's own landmarks show the place too.
  LiveLandmarks<Filter> live_landmarks(const Estimate& estimate, bool unsure) const {
    return {estimate, archive_.T_world_map(estimate.filter()), unsure};
  }
  PlaceVerification verify(Frame& frame, Estimate& estimate, LocalMap& local_map,
                           const TrackingMonitor& monitor, const Library& library, bool unsure);
  int search_place(Frame& frame, const Estimate& estimate, const Library& library, bool unsure,
                   Scratch& scratch) const;
  Rigid<float> T_map_camera_found(const Estimate& estimate) const {
    return relocalisation_.T_map_camera() *
           (relocalisation_.T_world_camera().inverse() * estimate.T_world_camera());
  }
  PlanarPose<float> pose_found(const Estimate& estimate) const;
  void reactivate_matches(Frame& frame, Estimate& estimate, const Library& library,
                          Scratch& scratch, FixedVector<LandmarkId, kMaxVisible>& reactivated);

  Parameters parameters_;
  SearchParameters search_;
  Archive archive_;
  Relocalisation relocalisation_;
  int next_library_slot_ = 0;
  bool usable_ = false;
};

template <class Config, class Filter>
void VehicleMapReuse<Config, Filter>::reactivate(Frame& frame, Estimate& estimate,
                                                 const Library& library) {
  constexpr int kReserve = kMaxLandmarks / 12;
  constexpr float kMargin_px = 40.0F;
  if (!frame.work.take(parameters_.library_slots_per_frame * work::kLibrarySlot)) return;
  LandmarkId active[kMaxLandmarks];
  for (int slot = 0; slot < estimate.size(); ++slot) active[slot] = estimate.id(slot);
  VisibilityOptions<float> options;
  options.margin_px = kMargin_px;
  options.min_scale = 0.75F;
  options.max_scale = 2.0F;
  options.min_cosine = 0.9F;
  if (next_library_slot_ >= library.size()) next_library_slot_ = 0;
  const LibrarySlice slice{next_library_slot_, parameters_.library_slots_per_frame};
  next_library_slot_ += slice.count;
  VisibleLandmark<float>* visible = begin_scratch(frame).visible;
  const Rigid<float> T_map_camera = archive_.T_map_camera(estimate);
  const typename VehicleNumbers<Filter>::LandmarkViews sees{frame.camera, T_map_camera, options};
  const int count = find_visible(library, slice, sees, Span<LandmarkId>{active, estimate.size()},
                                 visible, kMaxVisible);
  int reactivated = 0;
  for (int i = 0; i < count && reactivated < parameters_.max_reactivations_per_frame; ++i) {
    if (estimate.size() + kReserve >= kMaxLandmarks) return;
    if (!archive_.policy().allows(visible[i].id)) continue;
    if (!frame.work.take(work::kLandmarkInitialisation)) return;
    reactivated += archive_.reactivate(frame, estimate, library[visible[i].slot]) ? 1 : 0;
  }
}

template <class Config, class Filter>
PlaceVerification VehicleMapReuse<Config, Filter>::relocalise(Frame& frame, Estimate& estimate,
                                                              LocalMap& local_map,
                                                              const TrackingMonitor& monitor,
                                                              const Library& library, bool unsure) {
  using Outcome = typename Relocalisation::Outcome;
  PlaceVerification result;
  WorkBudget& budget = frame.work.budget();
  if (relocalisation_.take_found()) {
    result = verify(frame, estimate, local_map, monitor, library, unsure);
    if (result.confirmed) {
      frame.report.relocalised = true;
      ++frame.health.relocalisations;
    } else {
      refuse(frame);
    }
    return result;
  }
  if (!relocalisation_.working()) {
    if (!relocalisation_.takes_image(frame.image, budget)) return result;
    relocalisation_.capture(frame.image, estimate.T_world_camera(),
                            {archive_.pose_in_map(estimate), archive_.covariance_in_map(estimate)},
                            frame.scratch.relocaliser, budget);
    return result;
  }
  const Outcome outcome = relocalisation_.step(
      {frame.camera, estimate.T_level_camera(), estimate.sigma_tilt()}, library,
      live_landmarks(estimate, unsure), frame.random, frame.scratch.relocaliser, budget);
  if (outcome == Outcome::kFound && !plausible(estimate, relocalisation_.T_map_camera())) {
    refuse(frame);
  }
  // Where the library should be seen and is not, the camera is covered: no map begins there.
  const bool nowhere = unsure || !in_known_place(frame, estimate, library);
  if (outcome == Outcome::kUnrecognised && nowhere) {
    relocalisation_.note_unknown();
  }
  return result;
}

/// Whether the library has landmarks to be seen from odometry's pose.
template <class Config, class Filter>
bool VehicleMapReuse<Config, Filter>::in_known_place(Frame& frame, const Estimate& estimate,
                                                     const Library& library) const {
  VisibilityOptions<float> options;
  options.margin_px = -80.0F;
  options.min_cosine = 0.7F;
  frame.work.spend(library.size() * work::kLibrarySlot);
  return find_visible(library, frame.camera, archive_.T_map_camera(estimate), options,
                      Span<LandmarkId>{}, begin_scratch(frame).visible,
                      kMaxVisible) >= parameters_.min_expected_in_view;
}

/// Whether a camera pose in the map lies within the filter's covariance at the captured image, and
/// the vehicle on the floor.
template <class Config, class Filter>
bool VehicleMapReuse<Config, Filter>::plausible(const Estimate& estimate,
                                                const Rigid<float>& T_map_camera) const {
  constexpr float kMaxTilt = 0.1F;
  constexpr float kMaxHeight_m = 0.3F;
  constexpr float kPoseVariance = 0.01F;  // m^2; a tenth of it in rad^2: of a pose from one image
  constexpr float kGateDof3 = 21.11F;     // 99.99 %
  const Rigid<float> T_camera_vehicle = estimate.T_vehicle_camera().inverse();
  const Rigid<float> T_map_found = T_map_camera * T_camera_vehicle;
  const Rigid<float> T_map_expected = archive_.T_world_map(estimate.filter()).inverse() *
                                      relocalisation_.T_world_camera() * T_camera_vehicle;
  const Rigid<float> T_expected_found = T_map_expected.inverse() * T_map_found;
  const Vector3<float> rotation = rotation_log(T_expected_found.rotation);
  const Vector3<float>& moved = T_expected_found.translation;
  if (abs(rotation.x()) > kMaxTilt || abs(rotation.y()) > kMaxTilt ||
      abs(moved.z()) > kMaxHeight_m) {
    return false;
  }
  const Vector3<float> moved_map = T_map_expected.rotation * moved;
  const Vector3<float> error(moved_map.x(), moved_map.y(), rotation.z());
  Matrix3<float> S = archive_.covariance_in_map(estimate);
  for (int i = 0; i < 3; ++i) S(i, i) += i < 2 ? kPoseVariance : 0.1F * kPoseVariance;
  return error.dot(S.inverse() * error) <= kGateDof3;
}

/// Searches the present image for the landmarks that the pose found predicts, and updates the
/// filter with them; the filter's own gates decide. When it refuses them, the landmarks that were
/// reactivated for it are removed again. From an unsure pose measurements are not linear: the
/// filter is placed at the pose found first, and put back where it is refused.
template <class Config, class Filter>
PlaceVerification VehicleMapReuse<Config, Filter>::verify(Frame& frame, Estimate& estimate,
                                                          LocalMap& local_map,
                                                          const TrackingMonitor& monitor,
                                                          const Library& library, bool unsure) {
  PlaceVerification result;
  Scratch& scratch = begin_scratch(frame);
  const int expected = search_place(frame, estimate, library, unsure, scratch);
  if (!monitor.confirms_place(scratch.matches.size(), expected)) return result;
  local_map.make_room(frame, estimate, archive_, scratch.matches.size() + 2, kMaxLandmarks);
  FixedVector<LandmarkId, kMaxVisible> reactivated;
  reactivate_matches(frame, estimate, library, scratch, reactivated);
  result.matches = scratch.matches.size();
  const typename Estimate::Placement before =
      unsure ? place_at(estimate, pose_found(estimate), scratch.matches)
             : typename Estimate::Placement{};
  if (result.matches > 0) {
    result.update = estimate.update(frame, scratch.matches,
                                    monitor.min_relocalisation_inliers(scratch.matches.size()));
  }
  result.updated = true;
  result.confirmed = result.update.inliers > 0;
  if (result.confirmed) {
    if (unsure) keep_pose_error(estimate.filter());
    return result;
  }
  if (unsure) estimate.filter().put_back(before);
  for (const LandmarkId id : reactivated) estimate.remove(frame, estimate.filter().find(id));
  return result;
}

template <class Config, class Filter>
PlanarPose<float> VehicleMapReuse<Config, Filter>::pose_found(const Estimate& estimate) const {
  const Rigid<float> T_world_vehicle = archive_.T_world_map(estimate.filter()) *
                                       T_map_camera_found(estimate) *
                                       estimate.T_level_camera().inverse();
  const Vector3<float> forward = T_world_vehicle.rotation * Vector3<float>::UnitX();
  PlanarPose<float> pose;
  pose.position = T_world_vehicle.translation.template head<2>();
  pose.heading = atan2(forward.y(), forward.x());
  return pose;
}

/// Returns how many landmarks were expected.
template <class Config, class Filter>
int VehicleMapReuse<Config, Filter>::search_place(Frame& frame, const Estimate& estimate,
                                                  const Library& library, bool unsure,
                                                  Scratch& scratch) const {
  const Rigid<float> T_map_camera = T_map_camera_found(estimate);
  ExpectedSearch how;
  how.visibility.margin_px = 30.0F;
  how.visibility.min_cosine = 0.9F;
  how.search = search_;
  how.variance_px2 = 16.0F;  // of the pose found, and of odometry since its image
  frame.work.spend(library.size() * work::kLibrarySlot);
  const int in_library = search_expected(frame.image, frame.camera, T_map_camera, library, how,
                                         scratch, frame.work.budget())
                             .visible;
  return in_library + search_live(frame.image, frame.camera, T_map_camera,
                                  live_landmarks(estimate, unsure), how, scratch,
                                  frame.work.budget());
}

/// Leaves the matches of landmarks that are in the filter, with its slots.
template <class Config, class Filter>
void VehicleMapReuse<Config, Filter>::reactivate_matches(
    Frame& frame, Estimate& estimate, const Library& library, Scratch& scratch,
    FixedVector<LandmarkId, kMaxVisible>& reactivated) {
  for (int i = scratch.matches.size() - 1; i >= 0; --i) {
    PixelMatch<float>& match = scratch.matches[i];
    if (estimate.filter().find(match.id) >= 0) continue;
    if (frame.work.take(work::kLandmarkInitialisation) &&
        archive_.reactivate(frame, estimate, library[match.slot])) {
      reactivated.push_back(match.id);
    } else {
      scratch.matches.remove_unordered(i);
    }
  }
  for (PixelMatch<float>& match : scratch.matches) match.slot = estimate.filter().find(match.id);
}

}  // namespace cairn
