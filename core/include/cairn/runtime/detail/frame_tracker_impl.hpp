#pragma once

namespace cairn {

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::initialise(const PinholeCamera<float>& camera,
                                                const Rigid<float>& T_vehicle_camera,
                                                const Start& start, const Parameters& parameters) {
  Status status = camera.validate();
  if (!ok(status)) return status;
  if (camera.width > Config::kMaxImageWidth || camera.height > Config::kMaxImageHeight) {
    return Status::kBadConfig;
  }
  status = filter_.initialise(start.pose, start.covariance, parameters.filter);
  if (!ok(status)) return status;
  camera_ = camera;
  T_vehicle_camera_ = T_vehicle_camera;
  parameters_ = parameters;
  table_.clear();
  pool_.clear();
  supply_ = Supply{};
  random_ = Random(parameters.seed);
  health_ = Health{};
  initialised_ = true;
  has_frame_ = false;
  odometry_.reset(parameters.odometry, parameters.max_step_us, start.t_us);
  evidence_.reset(parameters.evidence);
  next_id_ = 1;
  keyframes_.clear();
  frames_since_keyframe_ = parameters.keyframe_interval;
  map_frame_.reset();
  tracked_covariance_ = start.covariance;
  next_library_slot_ = 0;
  reentry_.reset();
  look_up_.reset();
  has_library_ = false;
  work_.reset(parameters.work_limit, parameters.max_frames_without_mapping);
  return Status::kOk;
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::augment(Augmenter& augmenter, const MutableImageView& overlay,
                                           const TickSource& ticks, FrameReport& report) {
  const std::uint32_t start = ticks.now();
  if (state() == TrackingState::kTracking && augmenter.wants_object()) {
    Rigid<float> T_map_object = T_world_map().inverse() * on_floor(filter_.mean_pose());
    T_map_object.translation = T_map_object * Vector3<float>(3.5F, 0.7F, 0.0F);
    static_cast<void>(augmenter.place(T_map_object));
  }
  if (state() != TrackingState::kLost) augmenter.draw(camera_, report.T_world_camera, overlay);
  report.stage_ticks[static_cast<int>(Stage::kRender)] = ticks.now() - start;
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::add_odometry(const OdometrySample& sample) {
  if (!initialised_) return Status::kNotInitialised;
  return odometry_.add(sample, filter_, health_);
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::check_input(const ImageView& image, std::int64_t t_us) {
  if (!initialised_) return Status::kNotInitialised;
  if (!image.valid() || image.width != camera_.width || image.height != camera_.height) {
    return Status::kInvalidArgument;
  }
  if (has_frame_ && t_us <= last_frame_us_) {
    ++health_.time_errors;
    return t_us == last_frame_us_ ? Status::kDuplicate : Status::kTimeBackwards;
  }
  return Status::kOk;
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::process_frame(const ImageView& image, std::int64_t t_us,
                                                   const TickSource& ticks, Map& map,
                                                   FrameReport& report) {
  const Status accepted = check_input(image, t_us);
  if (!ok(accepted)) return accepted;
  report = FrameReport{};
  report.t_us = t_us;
  const std::uint32_t start = ticks.now();
  supply_.begin(image.width, image.height);
  begin_work();
  const std::uint32_t prepared = ticks.now();

  report.status = odometry_.integrate_to(t_us, filter_, health_);
  frame_step_s_ = has_frame_ ? static_cast<float>(t_us - last_frame_us_) * 1e-6F : 0.0F;
  last_frame_us_ = t_us;
  has_frame_ = true;
  const std::uint32_t predicted = ticks.now();

  FixedVector<PixelMatch<float>, kMaxLandmarks>& matches = matches_;
  matches.clear();
  SearchTotals totals;
  WorkBudget searching(searching_work());
  search_landmarks(image, View{*this}, SearchPass::kAll, SearchOrder::kMostUncertain, table_,
                   parameters_.search, searches_planned(), scratch_.search, matches, totals,
                   searching);
  work_.spend(searching.spent());
  if (totals.deferred > 0 && totals.searched < searches_planned()) {
    report.cut = totals.searched > 0 ? FrameCut::kFewerUpdates : FrameCut::kPredictionOnly;
  }
  report.corners = totals.corners;
  report.candidates = totals.descriptors;
  report.searched = totals.searched;
  report.matches = matches.size();
  report.deferred = totals.deferred;
  health_.corners_dropped += static_cast<std::uint32_t>(totals.corners_dropped);
  const std::uint32_t searched = ticks.now();

  update(matches, report);
  note_matches(image, map, matches, report);
  keep_map(image, map, report);
  evidence_.judge(report, health_);
  if (evidence_.consistent(report)) tracked_covariance_ = filter_.pose_covariance();
  report.T_world_camera = T_world_map().inverse() * T_world_camera();
  reentry_.move_on(abs(odometry_.speed_mps()) * frame_step_s_, next_id_);
  report.landmarks = filter_.landmark_count();
  work_.end(report, health_);
  const std::uint32_t updated = ticks.now();

  report.stage_ticks[static_cast<int>(Stage::kPreprocess)] = prepared - start;
  report.stage_ticks[static_cast<int>(Stage::kPosePrediction)] = predicted - prepared;
  report.stage_ticks[static_cast<int>(Stage::kFeatures)] = searched - predicted;
  report.stage_ticks[static_cast<int>(Stage::kPoseUpdate)] = updated - searched;
  return report.status;
}

/// Grows the map while the pose is known, looks for the place while it is not. An unknown place is
/// mapped from the odometry's pose once the library does not know it.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::keep_map(const ImageView& image, Map& map, FrameReport& report) {
  const Library* library = map.exchange.acquire();
  const bool known = evidence_.consistent(report) || state() == TrackingState::kInitialising;
  const bool can_recognise = kTakesLandmarksBack && library != nullptr && !library->empty();
  has_library_ = can_recognise;
  if (known) {
    remove_landmarks(map, report);
    look_up_.end();
  } else if (can_recognise && looks_for_place()) {
    pool_.clear();
    relocalise(image, *library, map, report);
  }
  const bool anew = !can_recognise || look_up_.unknown(parameters_.look_up);
  if (anew && !known) evidence_.forget_usual();
  build_map(image, known || evidence_.consistent(report) || anew, report);
  if (known && can_recognise) reenter_landmarks(*library, report);
  if (library != nullptr) map.exchange.release();
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::update(FixedVector<PixelMatch<float>, kMaxLandmarks>& matches,
                                          FrameReport& report) {
  if (matches.empty()) return;
  const bool looked_up = matches.data() != matches_.data();
  if (!looked_up && !evidence_.worth_an_update(report, matches.size())) return;
  OnePointRansacParameters ransac = parameters_.filter.ransac;
  ransac.min_support = looked_up ? evidence_.support_of_place(matches.size())
                                 : evidence_.support_wanted(report, ransac.min_support);
  filter_.set_ransac(ransac);
  const int found = matches.size();
  afford_update(matches, report);
  if (matches.size() < found && report.cut < FrameCut::kFewerUpdates) {
    report.cut = FrameCut::kFewerUpdates;
  }
  const Status status =
      filter_.update_pixels(camera_, T_vehicle_camera_, parameters_.sigma_px, matches.data(),
                            matches.size(), random_, report.update);
  work_.spend(work::planar_update(3 + 3 * filter_.landmark_count(), matches.size(),
                                  report.update.hypotheses, report.update.nis_dof / 2));
  if (!ok(status)) {
    if (ok(report.status)) report.status = status;
    for (PixelMatch<float>& match : matches) match.inlier = false;
    return;
  }
  for (const PixelMatch<float>& match : matches) report.inliers += match.inlier ? 1 : 0;
}

/// A frame in which nothing fits together says nothing against a landmark that was not found.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::note_matches(
    const ImageView& image, Map& map, const FixedVector<PixelMatch<float>, kMaxLandmarks>& matches,
    FrameReport& report) {
  if (!evidence_.consistent(report) && state() != TrackingState::kInitialising) {
    for (TrackedLandmark& landmark : table_) {
      if (landmark.searched) --landmark.predicted;
    }
    return;
  }
  for (const PixelMatch<float>& match : matches) {
    if (!match.inlier) continue;
    TrackedLandmark* landmark = table_.find(match.id);
    if (landmark == nullptr) continue;
    ++landmark->measured;
    landmark->misses = 0;
    report.from_library += landmark->from_library ? 1 : 0;
    if (!landmark->appearance.has_patch && work_.take(work::kAppearance)) {
      if (landmark->measured == 1) tell(map, Map::Message::Kind::kFound, match.id);
      // Near the border it is tried again with the next match.
      static_cast<void>(make_appearance(image, round_to_int(match.pixel.x()),
                                        round_to_int(match.pixel.y()), T_world_camera(),
                                        landmark->appearance));
    }
    use_floor(*landmark);
    if (!landmark->stored && landmark->measured >= parameters_.mature_sightings) {
      store(filter_.find(match.id), *landmark, map);
      landmark->stored = true;
    }
  }
}

/// The camera's height is the one length that the vehicle knows beside its way: a landmark on the
/// floor tells the scale of the map. Once its height is known well enough to tell it from what
/// stands on the floor, it counts as a measurement of height 0, or as something else.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::use_floor(TrackedLandmark& landmark) {
  if (landmark.height_told || landmark.from_library) return;
  if (!(parameters_.floor_sigma_m > 0.0F)) return;
  const int slot = filter_.find(landmark.id);
  const float variance = filter_.landmark_covariance(slot)(2, 2);
  if (variance > square(parameters_.floor_told_m)) return;
  const int most = work::height_update(3 + 3 * filter_.landmark_count());
  if (!work_.affords(most)) return;
  landmark.height_told = true;
  const Status told =
      filter_.update_height(landmark.id, 0.0F, parameters_.floor_sigma_m, parameters_.floor_gate);
  work_.spend(ok(told) ? most : work::kProjection);
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::hash(Hash64& hash) const {
  filter_.hash(hash);
  hash.add(static_cast<std::uint8_t>(state()));
  hash.add(health_.landmarks_added);
  hash.add(health_.landmarks_removed);
  hash.add(static_cast<std::int32_t>(pool_.size()));
  for (const TrackedLandmark& landmark : table_) {
    hash.add(landmark.id);
    hash.add_bytes(landmark.appearance.descriptor.bytes, Descriptor::kBytes);
  }
}

}  // namespace cairn
