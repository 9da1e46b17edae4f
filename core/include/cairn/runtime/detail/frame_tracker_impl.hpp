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
  state_ = TrackingState::kInitialising;
  initialised_ = true;
  has_frame_ = false;
  has_motion_ = false;
  time_us_ = start.t_us;
  turn_variance_ = 0.0F;
  next_id_ = 1;
  first_own_id_ = 1;
  keyframes_.clear();
  frames_since_keyframe_ = parameters.keyframe_interval;
  weak_frames_ = 0;
  usual_share_ = 0.0F;
  map_frame_.reset();
  tracked_covariance_ = start.covariance;
  next_library_slot_ = 0;
  way_m_ = 0.0F;
  for (LandmarkId& id : milestones_) id = kNoLandmark;
  passed_milestones_ = 0;
  for (LandmarkId& id : refused_) id = kNoLandmark;
  next_refused_ = 0;
  places_.reset();
  unrecognised_ = 0;
  has_library_ = false;
  captured_ = false;
  place_found_ = false;
  looks_ = 0;
  image_for_place_ = false;
  work_.reset(parameters.work_limit, parameters.max_frames_without_mapping);
  return Status::kOk;
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::augment(Augmenter& augmenter, const MutableImageView& overlay,
                                           const TickSource& ticks, FrameReport& report) {
  const std::uint32_t start = ticks.now();
  if (state_ == TrackingState::kTracking && augmenter.wants_object()) {
    Rigid<float> T_map_object = T_world_map().inverse() * on_floor(filter_.mean_pose());
    T_map_object.translation = T_map_object * Vector3<float>(3.5F, 0.7F, 0.0F);
    static_cast<void>(augmenter.place(T_map_object));
  }
  if (state_ != TrackingState::kLost) augmenter.draw(camera_, report.T_world_camera, overlay);
  report.stage_ticks[static_cast<int>(Stage::kRender)] = ticks.now() - start;
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::add_odometry(const OdometrySample& sample) {
  if (!initialised_) return Status::kNotInitialised;
  if (!is_finite(sample.speed_mps) || !is_finite(sample.turn)) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (sample.t_us < time_us_ && has_motion_ && sample.t_us <= motion_.t_us) {
    ++health_.time_errors;
    return Status::kTimeBackwards;
  }
  steady_motion_ = has_motion_ ? steadied(sample) : sample;
  motion_ = sample;
  has_motion_ = true;
  // A frame may have taken the pose beyond this sample already: the sample then counts from there.
  return sample.t_us > time_us_ ? integrate_to(sample.t_us) : Status::kOk;
}

/// Low pass of the readings over `steady_s`.
template <class Config, class Filter>
OdometrySample FrameTracker<Config, Filter>::steadied(const OdometrySample& sample) const {
  const float dt = static_cast<float>(sample.t_us - motion_.t_us) * 1e-6F;
  const float share = dt > 0.0F ? dt / (dt + parameters_.odometry.steady_s) : 0.0F;
  OdometrySample steady = sample;
  steady.speed_mps =
      steady_motion_.speed_mps + share * (sample.speed_mps - steady_motion_.speed_mps);
  steady.turn = steady_motion_.turn + share * (sample.turn - steady_motion_.turn);
  return steady;
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::integrate_to(std::int64_t t_us) {
  const std::int64_t step_us = t_us - time_us_;
  if (step_us <= 0) return Status::kOk;
  time_us_ = t_us;
  if (!has_motion_) return Status::kOk;
  if (step_us > parameters_.max_step_us) {
    ++health_.time_errors;
    return Status::kTimeGap;
  }
  const OdometryNoise& noise = parameters_.odometry;
  const float dt = static_cast<float>(step_us) * 1e-6F;
  // The sample's noise is stated per sample_period: cut into shorter steps its sum must stay the
  // same.
  const float scale = sqrt(noise.sample_period_s / dt);
  PlanarIncrement<float> increment = increment_of(motion_, dt, scale);
  // Noise linearised at the reading would correlate with the reading's own error: a steering error
  // would each time be taken for a slower vehicle. Only the size of the speed may come from it.
  OdometrySample linearised = steady_motion_;
  if (abs(motion_.speed_mps) > abs(linearised.speed_mps)) linearised.speed_mps = motion_.speed_mps;
  increment.covariance = increment_of(linearised, dt, scale).covariance;
  const Status status = filter_.predict(increment);
  if (ok(status)) turn_variance_ += increment.covariance(1, 1);
  return status;
}

template <class Config, class Filter>
PlanarIncrement<float> FrameTracker<Config, Filter>::increment_of(const OdometrySample& motion,
                                                                  float dt, float scale) const {
  const OdometryNoise& noise = parameters_.odometry;
  // The windows must hold what a wild reading says too: one that lies far off those before it.
  constexpr float kFarInSigmas = 3.0F;
  const float off = abs(motion_.turn - steady_motion_.turn) / kFarInSigmas;
  const float sigma_turn = scale * (off > noise.sigma_turn ? off : noise.sigma_turn);
  const float sigma_speed = scale * noise.sigma_speed_mps;
  return motion.kind == OdometrySample::Kind::kAckermann
             ? ackermann_increment(motion.speed_mps, motion.turn, dt, noise.wheelbase_m,
                                   sigma_speed, sigma_turn)
             : twist_increment(motion.speed_mps, motion.turn, dt, sigma_speed, sigma_turn);
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

  report.status = integrate_to(t_us);
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
  judge(report);
  report.T_world_camera = T_world_map().inverse() * T_world_camera();
  pass_milestones();
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
  const bool known = consistent(report) || state_ == TrackingState::kInitialising;
  const bool can_recognise = kTakesLandmarksBack && library != nullptr && !library->empty();
  has_library_ = can_recognise;
  if (known) {
    remove_landmarks(map, report);
    places_.reset();
    place_found_ = false;
    looks_ = 0;
    unrecognised_ = 0;
  } else if (can_recognise && looks_for_place()) {
    pool_.clear();
    relocalise(image, *library, map, report);
  }
  const bool anew = !can_recognise || unrecognised_ >= parameters_.map_anew_after;
  if (anew && !known) usual_share_ = 0.0F;
  build_map(image, known || consistent(report) || anew, report);
  if (known && can_recognise) reenter_landmarks(*library, report);
  if (library != nullptr) map.exchange.release();
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::update(FixedVector<PixelMatch<float>, kMaxLandmarks>& matches,
                                          FrameReport& report) {
  if (matches.empty()) return;
  // Where the camera shows another place, a few landmarks are found by chance; the more so after
  // blind frames, when the windows have grown.
  const float least = weak_frames_ < 2 ? parameters_.min_match_share : parameters_.min_return_share;
  const bool looked_up = matches.data() != matches_.data();
  if (!looked_up) {
    const auto share = static_cast<float>(matches.size());
    if (share < least * static_cast<float>(report.searched)) return;
    if (weak_frames_ >= 2 && matches.size() < parameters_.min_return_matches) return;
  }
  OnePointRansacParameters ransac = parameters_.filter.ransac;
  ransac.min_support =
      looked_up ? support_of_place(matches.size(), parameters_) : support_wanted(report);
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

/// Another place of the same kind (tiles, shelves) can agree with a fifth of the map. Where far
/// fewer landmarks agree than did of late, and not nearly all of those found, the camera shows
/// something else.
template <class Config, class Filter>
int FrameTracker<Config, Filter>::support_wanted(const FrameReport& report) const {
  const float usual = usual_share_ * static_cast<float>(report.searched);
  const int of_usual = round_to_int(parameters_.min_usual_share * usual);
  constexpr float kNearlyAll = 0.8F;
  const int of_found = round_to_int(kNearlyAll * static_cast<float>(report.matches));
  const int nearly_all = of_found > parameters_.min_inliers ? of_found : parameters_.min_inliers;
  const int wanted = of_usual < nearly_all ? of_usual : nearly_all;
  const int least = parameters_.filter.ransac.min_support;
  return wanted > least ? wanted : least;
}

/// A frame in which nothing fits together says nothing against a landmark that was not found.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::note_matches(
    const ImageView& image, Map& map, const FixedVector<PixelMatch<float>, kMaxLandmarks>& matches,
    FrameReport& report) {
  if (!consistent(report) && state_ != TrackingState::kInitialising) {
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
void FrameTracker<Config, Filter>::judge(FrameReport& report) {
  if (report.inliers >= parameters_.min_inliers) {
    weak_frames_ = 0;
    state_ = TrackingState::kTracking;
    tracked_covariance_ = filter_.pose_covariance();
    constexpr float kOfLate = 0.1F;  // ten frames
    constexpr int kTelling = 8;
    if (report.searched >= kTelling) {
      const float share = static_cast<float>(report.inliers) / static_cast<float>(report.searched);
      usual_share_ += kOfLate * (share - usual_share_);
    }
  } else if (state_ != TrackingState::kInitialising) {
    // A frame that did not look tells nothing of the map.
    if (report.cut != FrameCut::kPredictionOnly) ++weak_frames_;
    const bool lost = weak_frames_ > parameters_.uncertain_frames_to_lost;
    if (lost && state_ != TrackingState::kLost) ++health_.losses;
    state_ = lost ? TrackingState::kLost : TrackingState::kUncertain;
  }
  if (report.searched > 0 && report.matches < parameters_.min_inliers) {
    ++health_.low_texture_frames;
    if (ok(report.status)) report.status = Status::kLowTexture;
  }
  if (state_ == TrackingState::kLost) report.status = Status::kLost;
  report.state = state_;
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::hash(Hash64& hash) const {
  filter_.hash(hash);
  hash.add(static_cast<std::uint8_t>(state_));
  hash.add(health_.landmarks_added);
  hash.add(health_.landmarks_removed);
  hash.add(static_cast<std::int32_t>(pool_.size()));
  for (const TrackedLandmark& landmark : table_) {
    hash.add(landmark.id);
    hash.add_bytes(landmark.appearance.descriptor.bytes, Descriptor::kBytes);
  }
}

}  // namespace cairn
