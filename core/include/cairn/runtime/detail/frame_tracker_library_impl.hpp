#pragma once

#include "cairn/runtime/frame_tracker.hpp"

namespace cairn {

template <class Config, class Filter>
void FrameTracker<Config, Filter>::tell(Map& map, typename Map::Message::Kind kind, LandmarkId id) {
  typename Map::Message message;
  message.kind = kind;
  message.id = id;
  if (!map.messages.push(message)) ++health_.map_messages_dropped;
}

/// Hands a landmark to the map builder, in the coordinates of the library, as sure as it is beside
/// the vehicle: what the vehicle's pose is wrong by, it shares with the map around it.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::store(int slot, const TrackedLandmark& landmark, Map& map) {
  const Rigid<float> T_map_world = T_world_map().inverse();
  const Matrix3<float> R = T_map_world.rotation.toRotationMatrix();
  typename Map::Message message;
  message.kind = Map::Message::Kind::kStore;
  LibraryLandmark& archived = message.landmark;
  archived.id = landmark.id;
  archived.p_world = T_map_world * filter_.mean_landmark(slot);
  Matrix3<float> covariance;
  if constexpr (kTakesLandmarksBack) {
    covariance = filter_.relative_landmark_covariance(slot);
  } else {
    covariance = filter_.landmark_covariance(slot);
  }
  const Matrix3<float> turned = R * covariance * R.transpose();
  archived.covariance = 0.5F * (turned + turned.transpose());
  archived.searches = static_cast<std::uint16_t>(clamp(landmark.predicted, 0, 0xFFFF));
  archived.sightings =
      static_cast<std::uint16_t>(clamp(landmark.measured, 0, int{archived.searches}));
  archived.view_count = 1;
  LandmarkView<float>& view = archived.views[0];
  view.descriptor = landmark.appearance.descriptor;
  view.pose.scale_index = landmark.appearance.scale_index;
  view.focal_px = 0.5F * (camera_.fx + camera_.fy);
  view.T_world_reference = T_map_world * landmark.appearance.T_world_reference;
  if (map.messages.push(message)) {
    ++health_.landmarks_archived;
  } else {
    ++health_.map_messages_dropped;
  }
}

/// The library's frame in the filter's world.
template <class Config, class Filter>
Rigid<float> FrameTracker<Config, Filter>::T_world_map() const {
  if constexpr (kTakesLandmarksBack) {
    return map_frame_.T_world_map(filter_);
  } else {
    return {};
  }
}

template <class Config, class Filter>
PlanarPose<float> FrameTracker<Config, Filter>::in_map(const PlanarPose<float>& pose) const {
  const Rigid<float> T_map_vehicle = T_world_map().inverse() * on_floor(pose);
  const Vector3<float> ahead = T_map_vehicle.rotation * Vector3<float>(1.0F, 0.0F, 0.0F);
  PlanarPose<float> out;
  out.position = T_map_vehicle.translation.template head<2>();
  out.heading = atan2(ahead.y(), ahead.x());
  return out;
}

/// Looks through a slice of the library for landmarks that come into view and takes them back into
/// the filter, where the next frames look for them in the windows that their covariance gives.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::reenter_landmarks(const Library& library, FrameReport& report) {
  constexpr int kReserve = kMaxLandmarks / 12;
  constexpr float kMargin = 40.0F;
  if (!work_.take(parameters_.library_slots_per_frame * work::kLibrarySlot)) return;
  LandmarkId active[kMaxLandmarks];
  for (int slot = 0; slot < filter_.landmark_count(); ++slot) {
    active[slot] = filter_.landmark_id(slot);
  }
  VisibilityOptions<float> options;
  options.margin_px = kMargin;
  options.min_scale = 0.75F;
  options.max_scale = 2.0F;
  options.min_cosine = 0.9F;
  if (next_library_slot_ >= library.size()) next_library_slot_ = 0;
  const LibrarySlice slice{next_library_slot_, parameters_.library_slots_per_frame};
  next_library_slot_ += slice.count;
  const Rigid<float> T_map_camera = T_world_map().inverse() * T_world_camera();
  VisibleLandmark<float>* visible = (new (&scratch_.coming_back) ComingBack())->visible;
  const int count =
      find_visible(library, slice, camera_, T_map_camera, options,
                   Span<LandmarkId>{active, filter_.landmark_count()}, visible, kReentryCandidates);
  for (int i = 0; i < count && report.reentered < parameters_.max_reentries_per_frame; ++i) {
    if (filter_.landmark_count() + kReserve >= kMaxLandmarks) return;
    if (!reentry_.allows(visible[i].id)) continue;
    if (!work_.take(work::kPromotion)) return;
    reenter(library[visible[i].slot], report);
  }
}

template <class Config, class Filter>
bool FrameTracker<Config, Filter>::reenter(const LibraryLandmark& archived, FrameReport& report) {
  if constexpr (kTakesLandmarksBack) {
    if (map_frame_.entered(filter_)) {
      map_frame_.follow(filter_, parameters_.map_drift);
    } else if (!ok(map_frame_.enter(filter_, next_id_, tracked_covariance_,
                                    square(parameters_.map_height_sigma_m)))) {
      return false;
    }
    if (!ok(map_frame_.add(filter_, archived.id, archived.p_world,
                           parameters_.library_inflation * archived.covariance))) {
      return false;
    }
    TrackedLandmark landmark;
    landmark.id = archived.id;
    landmark.from_library = true;
    landmark.stored = true;
    Appearance& appearance = landmark.appearance;
    appearance.descriptor = archived.views[0].descriptor;
    appearance.scale_index = archived.views[0].pose.scale_index;
    appearance.T_world_reference = T_world_map() * archived.views[0].T_world_reference;
    appearance.has_patch = false;
    table_.add(landmark);
    ++report.reentered;
    ++health_.landmarks_reentered;
    return true;
  } else {
    static_cast<void>(archived);
    static_cast<void>(report);
    return false;
  }
}

/// One step towards the place. A pose found must agree with the filter's and, in the frame after,
/// with the image of that time.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::relocalise(const ImageView& image, const Library& library,
                                              Map& map, FrameReport& report) {
  if (look_up_.take_found()) {
    if (come_back(image, library, map, report)) {
      report.relocalised = true;
      evidence_.forget_usual();  // landmarks of the time without sight are among those looked for
      ++health_.relocalisations;
    } else {
      refuse_place();
    }
    return;
  }
  if (!look_up_.working()) {
    if (!look_up_.takes_image(image, work_.budget())) return;
    look_up_.capture(image, T_world_camera(),
                     {in_map(filter_.mean_pose()), filter_.pose_covariance()}, parameters_.look_up,
                     scratch_.places, work_.budget());
    return;
  }
  const typename Places::Outcome outcome =
      look_up_.look({camera_, T_vehicle_camera_}, library, parameters_.look_up, random_,
                    scratch_.places, work_.budget());
  if (outcome == Places::Outcome::kFound && !plausible(look_up_.T_map_camera())) refuse_place();
  // A camera that shows nothing of a known place is covered, or shows another: no map is made.
  if (outcome == Places::Outcome::kUnrecognised && !in_known_place(library)) {
    look_up_.note_unknown();
  }
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::refuse_place() {
  ++health_.false_relocalisations_refused;
  look_up_.refuse(parameters_.look_up);
}

/// Whether the library has something to show near where odometry says the vehicle is.
template <class Config, class Filter>
bool FrameTracker<Config, Filter>::in_known_place(const Library& library) {
  const Rigid<float> T_map_camera = T_world_map().inverse() * T_world_camera();
  VisibleLandmark<float>* visible = (new (&scratch_.coming_back) ComingBack())->visible;
  VisibilityOptions<float> options;
  options.margin_px = -80.0F;
  options.min_cosine = 0.7F;
  work_.spend(library.size() * work::kLibrarySlot);
  return find_visible(library, camera_, T_map_camera, options, Span<LandmarkId>{}, visible,
                      kReentryCandidates) >= parameters_.expected_in_view;
}

/// Whether a pose in the map could be where the filter believed to be when the image was taken.
template <class Config, class Filter>
bool FrameTracker<Config, Filter>::plausible(const Rigid<float>& T_map_camera) const {
  constexpr float kMaxTilt = 0.1F;
  constexpr float kMaxHeight_m = 0.3F;
  constexpr float kMapVariance = 0.01F;  // m^2, rad^2: of a pose told by one image
  constexpr float kGateDof3 = 21.11F;    // 99.99 %
  const Rigid<float> T_world_camera = T_world_map() * T_map_camera;
  const Rigid<float> T_expected_found =
      (look_up_.T_world_camera() * T_vehicle_camera_.inverse()).inverse() *
      (T_world_camera * T_vehicle_camera_.inverse());
  const Vector3<float> turn = rotation_log(T_expected_found.rotation);
  const Vector3<float>& moved = T_expected_found.translation;
  if (abs(turn.x()) > kMaxTilt || abs(turn.y()) > kMaxTilt || abs(moved.z()) > kMaxHeight_m) {
    return false;
  }
  const Vector3<float> in_world =
      (look_up_.T_world_camera() * T_vehicle_camera_.inverse()).rotation * moved;
  const Vector3<float> error(in_world.x(), in_world.y(), turn.z());
  Matrix3<float> S = filter_.pose_covariance();
  for (int i = 0; i < 3; ++i) S(i, i) += i < 2 ? kMapVariance : 0.1F * kMapVariance;
  return error.dot(S.inverse() * error) <= kGateDof3;
}

/// Looks in the present image for what the map should show from the pose found, and gives it to the
/// filter, whose own gates decide. False, and the landmarks forgotten again, when it refuses.
template <class Config, class Filter>
bool FrameTracker<Config, Filter>::come_back(const ImageView& image, const Library& library,
                                             Map& map, FrameReport& report) {
  constexpr float kWindowVariance = 16.0F;  // px^2: the pose found, and the way made since
  const Rigid<float> T_map_camera =
      look_up_.T_map_camera() * (look_up_.T_world_camera().inverse() * T_world_camera());
  VisibilityOptions<float> options;
  options.margin_px = 30.0F;
  options.min_cosine = 0.9F;
  ComingBack& memory = *new (&scratch_.coming_back) ComingBack();
  work_.spend(library.size() * work::kLibrarySlot);
  const int count = find_visible(library, camera_, T_map_camera, options, Span<LandmarkId>{},
                                 memory.visible, kReentryCandidates);
  static_cast<void>(search_expected(image, camera_, T_map_camera, library, memory.visible, count,
                                    kWindowVariance, parameters_.search, memory.search,
                                    memory.matches, work_.budget()));
  if (!evidence_.tells_place(memory.matches.size(), count)) return false;

  make_room(map, memory.matches.size() + 2, kMaxLandmarks, report);
  for (int i = memory.matches.size() - 1; i >= 0; --i) {
    PixelMatch<float>& match = memory.matches[i];
    if (filter_.find(match.id) >= 0) continue;
    if (work_.take(work::kPromotion) && reenter(library[match.slot], report)) {
      memory.entered.push_back(match.id);
    } else {
      memory.matches.remove_unordered(i);
    }
  }
  for (PixelMatch<float>& match : memory.matches) match.slot = filter_.find(match.id);
  report.inliers = 0;
  report.matches = memory.matches.size();
  report.status = Status::kOk;
  update(memory.matches, report);
  if (report.inliers > 0) {
    note_matches(image, map, memory.matches, report);
    return true;
  }
  report.inliers = 0;
  for (const LandmarkId id : memory.entered) remove_landmark(filter_.find(id), report);
  return false;
}

}  // namespace cairn
