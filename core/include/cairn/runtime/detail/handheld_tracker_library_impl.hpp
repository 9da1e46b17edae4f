#pragma once

#include "cairn/runtime/handheld_tracker.hpp"

namespace cairn {

template <class Config>
Status HandheldTracker<Config>::load_map(const ByteSource& source, MapFileInfo& info) {
  if (!initialised_) return Status::kNotInitialised;
  const Status status = cairn::load_map(source, library_, info);
  if (!ok(status)) return status;
  if (info.next_id > next_id_) next_id_ = info.next_id;
  static_cast<void>(filter_.restart(Rigid<float>()));
  table_.clear();
  places_.reset();
  place_found_ = false;
  weak_frames_ = 0;
  probation_ = 0;
  start_.frames = parameters_.start_blocks * parameters_.start_block_frames;
  state_ = TrackingState::kLost;
  return Status::kOk;
}

/// Landmarks that have become well known also go to the library, once the start is over: a map that
/// may yet begin anew is none to come back to.
template <class Config>
void HandheldTracker<Config>::archive(const FixedVector<PixelMatch<float>, kMaxFeatures>& matches) {
  constexpr int kMaxStored = 4;  // a frame; the others follow in the next
  if (!start_is_over() || state_ != TrackingState::kTracking) return;
  float shared = -1.0F;
  int stored = 0;
  for (const PixelMatch<float>& match : matches) {
    TrackedLandmark* landmark = match.inlier ? table_.find(match.id) : nullptr;
    if (landmark == nullptr || stored == kMaxStored || !is_due(*landmark)) continue;
    if (!work_.take(work::kArchiving)) return;
    if (shared < 0.0F) shared = shared_depth_variance();
    store(filter_.find(match.id), *landmark, shared);
    ++stored;
  }
}

/// Whether a landmark's record in the library is to be made or renewed: at the first mature
/// sighting, and at twice as many, four times as many, and so on.
template <class Config>
bool HandheldTracker<Config>::is_due(const TrackedLandmark& landmark) const {
  const int mature = parameters_.mature_sightings;
  if (!landmark.stored) return landmark.measured >= mature;
  int next = mature;
  while (next < landmark.measured) next *= 2;
  return next == landmark.measured;
}

/// The squared share by which all depths may be wrong together, the map's free scale among it: at
/// most that of the best known one.
template <class Config>
float HandheldTracker<Config>::shared_depth_variance() const {
  float least = 1.0F;
  for (int slot = 0; slot < filter_.feature_count(); ++slot) {
    float inverse_depth = 0.0F;
    float sigma = 0.0F;
    if (!ok(filter_.feature_inverse_depth(slot, inverse_depth, sigma))) continue;
    const float share = square(sigma / inverse_depth);
    if (share < least) least = share;
  }
  return least;
}

/// Covariance: what a landmark's place is wrong by beside the map as a whole, across the ray by the
/// pixel's noise and along it by the depth's.
template <class Config>
void HandheldTracker<Config>::store(int slot, TrackedLandmark& landmark, float shared_variance) {
  constexpr float kLeastShare = 0.01F;
  LibraryLandmark archived;
  Matrix3<float> covariance;
  float inverse_depth = 0.0F;
  float sigma = 0.0F;
  if (!ok(filter_.feature_position(slot, archived.p_world, covariance)) ||
      !ok(filter_.feature_inverse_depth(slot, inverse_depth, sigma))) {
    return;
  }
  const float own = square(sigma / inverse_depth) - shared_variance;
  if (!(own < square(parameters_.max_depth_sigma))) return;
  const Rigid<float> T_world_camera = filter_.T_world_camera();
  const Vector3<float> from_camera = archived.p_world - T_world_camera.translation;
  const float squared = from_camera.squaredNorm();
  const float focal_px = 0.5F * (camera_.fx + camera_.fy);
  if (!(squared > 0.0F)) return;
  const float across = square(parameters_.filter.sigma_px / focal_px) * squared;
  const float along = (own > square(kLeastShare) ? own : square(kLeastShare)) * squared;
  archived.covariance = across * Matrix3<float>::Identity() +
                        ((along - across) / squared) * (from_camera * from_camera.transpose());
  archived.id = landmark.id;
  archived.searches = static_cast<std::uint16_t>(clamp(landmark.predicted, 0, 0xFFFF));
  archived.sightings =
      static_cast<std::uint16_t>(clamp(landmark.measured, 0, int{archived.searches}));
  archived.view_count = 1;
  LandmarkView<float>& view = archived.views[0];
  view.descriptor = landmark.appearance.descriptor;
  view.pose.scale_index = landmark.appearance.scale_index;
  view.focal_px = focal_px;
  view.T_world_reference = landmark.appearance.T_world_reference;
  const Status status = library_.find(archived.id) < 0 ? library_.insert(archived, library_health_)
                                                       : library_.update(archived);
  if (ok(status)) ++health_.landmarks_archived;
  landmark.stored = true;
}

/// Steps towards the place, as many as the frame's work affords: an image is taken and compared
/// with the library, and a pose that comes of it must be confirmed by the image of a later frame.
template <class Config>
void HandheldTracker<Config>::look_up(const ImageView& image, FrameReport& report) {
  report.state = state_;
  if (library_.size() < parameters_.min_known) {
    begin_anew(image, report);
    return;
  }
  constexpr int kConfirmation = 6000;  // units that are worth a try: most confirmations take less
  const typename Places::Parameters& p = parameters_.places;
  const bool resumed = places_.working() || place_found_;
  if (!resumed) {
    if (!work_.affords(Places::least_capture_work(image))) return;
    static_cast<void>(places_.capture(image, p, scratch_.places, work_.budget()));
  }
  while (places_.working() && work_.affords(Places::step_work(p))) {
    place_found_ = places_.step(camera_, library_, p, random_, scratch_.places, work_.budget()) ==
                   Places::Outcome::kFound;
  }
  if (!resumed || !place_found_ || !work_.affords(kConfirmation)) return;
  place_found_ = false;
  if (!come_back(image, report)) ++health_.false_relocalisations_refused;
}

/// A map too small to be found again is given up, once there is something to see.
template <class Config>
void HandheldTracker<Config>::begin_anew(const ImageView& image, FrameReport& report) {
  if (filter_.feature_count() > 0 && !ok(filter_.restart(filter_.T_world_camera()))) return;
  table_.clear();
  library_.clear();
  add_features(image, report);
  if (report.added == 0) return;
  state_ = TrackingState::kInitialising;
  weak_frames_ = 0;
  start_.frames = 0;
  start_.misfit = start_.dof = 0.0F;
}

/// Looks in the present image for what the map should show from the pose found, widely first, then
/// closely about the pose that these landmarks agree on: where a texture repeats, the wide look
/// finds enough by chance, the close one does not.
template <class Config>
bool HandheldTracker<Config>::come_back(const ImageView& image, FrameReport& report) {
  constexpr float kWide = 60.0F;  // px^2: what the hand moves from frame to frame
  constexpr float kClose = 2.0F;
  Rigid<float> T_world_camera = places_.T_map_camera();
  ComingBack& work = *new (&scratch_.coming_back) ComingBack();
  if (!confirm(image, kWide, T_world_camera, work) ||
      !confirm(image, kClose, T_world_camera, work) || !ok(filter_.restart(T_world_camera))) {
    return false;
  }
  take_back(image, T_world_camera, work, report);
  return true;
}

/// Whether enough of the landmarks in view are found in windows of `variance` and agree on a pose,
/// which T_world_camera then is; `work` then has them.
template <class Config>
bool HandheldTracker<Config>::confirm(const ImageView& image, float variance,
                                      Rigid<float>& T_world_camera, ComingBack& work) {
  VisibilityOptions<float> options;
  options.margin_px = 30.0F;
  options.min_scale = 0.75F;
  options.max_scale = 2.0F;
  options.min_cosine = 0.85F;
  const int count = find_visible(library_, camera_, T_world_camera, options, Span<LandmarkId>{},
                                 work.visible, kReturning);
  SearchParameters search = parameters_.search;
  search.method = SearchMethod::kDescriptor;
  search.fast_threshold = parameters_.places.fast_threshold;
  search.max_distance = parameters_.max_confirm_distance;
  work.matches.clear();
  const int looked_for =
      search_expected(image, camera_, T_world_camera, library_, work.visible, count, variance,
                      search, work.search, work.matches, work_.budget());
  const int found = work.matches.size();
  const float least = parameters_.min_found_share * static_cast<float>(looked_for);
  if (found < parameters_.min_found || static_cast<float>(found) < least) return false;
  for (int i = 0; i < found; ++i) {
    const LibraryLandmark& landmark = library_[work.matches[i].slot];
    work.observations[i] = {landmark.p_world, landmark.covariance, work.matches[i].pixel, 1.0F};
  }
  PoseRefinementOptions<float> refinement;
  refinement.max_iterations = 8;
  refinement.min_inliers = parameters_.min_found;
  PoseEstimate<float> estimate;
  work_.spend(work::kRefinement);
  return ok(refine_pose(camera_, work.observations, found, refinement, T_world_camera, estimate,
                        work.inlier)) &&
         static_cast<float>(estimate.inliers) >= least;
}

/// Puts the landmarks found into the filter, at their distance in the map: its scale goes on.
template <class Config>
void HandheldTracker<Config>::take_back(const ImageView& image, const Rigid<float>& T_world_camera,
                                        const ComingBack& work, FrameReport& report) {
  constexpr float kInflation = 2.0F;  // of the deviation: neighbours err together
  constexpr float kLeastShare = 0.02F;
  table_.clear();
  for (int i = 0; i < work.matches.size(); ++i) {
    if (work.inlier[i] == 0) continue;
    if (!work_.take(work::kAppearance + work::kBirth)) break;
    const PixelMatch<float>& match = work.matches[i];
    const LibraryLandmark& archived = library_[match.slot];
    const Vector3<float> ray = archived.p_world - T_world_camera.translation;
    const float squared = ray.squaredNorm();
    const float distance = sqrt(squared);
    const float along = sqrt(ray.dot(archived.covariance * ray) / squared) / distance;
    const float share = kInflation * (along > kLeastShare ? along : kLeastShare);
    TrackedLandmark landmark;
    landmark.id = archived.id;
    landmark.from_library = true;
    landmark.stored = true;
    if (!ok(make_appearance(image, round_to_int(match.pixel.x()), round_to_int(match.pixel.y()),
                            T_world_camera, landmark.appearance)) ||
        !ok(filter_.add_feature(archived.id, match.pixel, 1.0F / distance, share / distance))) {
      continue;
    }
    table_.add(landmark);
    static_cast<void>(library_.record(archived.id, true));
    ++report.reentered;
    ++health_.landmarks_reentered;
  }
  weak_frames_ = 0;
  probation_ = parameters_.probation_frames;
  state_ = TrackingState::kUncertain;
  report.state = state_;
  report.status = Status::kOk;
  report.relocalised = true;
  report.matches = work.matches.size();
  report.inliers = report.reentered;
  ++health_.relocalisations;
}

}  // namespace cairn
