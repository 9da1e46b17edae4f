#pragma once

namespace cairn {

template <class Config>
Status HandheldTracker<Config>::initialise(const PinholeCamera<float>& camera,
                                           const Parameters& parameters) {
  Status status = camera.validate();
  if (!ok(status)) return status;
  if (camera.width > Config::kMaxImageWidth || camera.height > Config::kMaxImageHeight) {
    return Status::kBadConfig;
  }
  status = filter_.initialise(camera, parameters.filter);
  if (!ok(status)) return status;
  camera_ = camera;
  parameters_ = parameters;
  table_.clear();
  supply_ = Supply{};
  random_ = Random(parameters.seed);
  health_ = Health{};
  state_ = TrackingState::kInitialising;
  initialised_ = true;
  has_frame_ = false;
  next_id_ = 1;
  weak_frames_ = 0;
  start_ = StartTrial{};
  probation_ = 0;
  library_.clear();
  library_health_ = Health{};
  places_.reset();
  place_found_ = false;
  work_.reset(parameters.work_limit, parameters.max_frames_without_mapping);
  return Status::kOk;
}

template <class Config>
Status HandheldTracker<Config>::check_input(const ImageView& image, std::int64_t t_us) {
  if (!initialised_) return Status::kNotInitialised;
  if (!image.valid() || image.width != camera_.width || image.height != camera_.height) {
    return Status::kInvalidArgument;
  }
  if (has_frame_ && t_us <= last_t_us_) {
    ++health_.time_errors;
    return t_us == last_t_us_ ? Status::kDuplicate : Status::kTimeBackwards;
  }
  return Status::kOk;
}

template <class Config>
Status HandheldTracker<Config>::predict(std::int64_t t_us) {
  if (!has_frame_) return Status::kOk;
  std::int64_t step_us = t_us - last_t_us_;
  Status status = Status::kOk;
  if (step_us > parameters_.max_step_us) {
    ++health_.time_errors;
    step_us = parameters_.max_step_us;
    status = Status::kTimeGap;
  }
  const Parameters& p = parameters_;
  const bool calm = start_.restarts == 0 && start_.frames < p.calm_frames;
  const Status set =
      filter_.set_motion_noise(calm ? p.calm_velocity_noise : p.filter.velocity_noise,
                               calm ? p.calm_rate_noise : p.filter.rate_noise);
  if (!ok(set)) return set;
  const Status predicted = filter_.predict(static_cast<float>(step_us) * 1e-6F);
  return ok(predicted) ? status : predicted;
}

template <class Config>
Status HandheldTracker<Config>::process_frame(const ImageView& image, std::int64_t t_us,
                                              const TickSource& ticks, FrameReport& report) {
  const Status accepted = check_input(image, t_us);
  if (!ok(accepted)) return accepted;
  report = FrameReport{};
  report.t_us = t_us;
  const std::uint32_t start = ticks.now();
  supply_.begin(image.width, image.height);
  work_.begin(work::kMonoFrame + work::kProjection * filter_.feature_count());
  report.stage_ticks[static_cast<int>(Stage::kPreprocess)] = ticks.now() - start;
  if (state_ == TrackingState::kLost) {
    const std::uint32_t prepared = ticks.now();
    report.status = Status::kLost;
    look_up(image, report);
    report.stage_ticks[static_cast<int>(Stage::kFeatures)] = ticks.now() - prepared;
  } else {
    track(image, t_us, ticks, report);
  }
  last_t_us_ = t_us;
  has_frame_ = true;
  report.T_world_camera = filter_.T_world_camera();
  report.landmarks = filter_.feature_count();
  work_.end(report, health_);
  return report.status;
}

template <class Config>
void HandheldTracker<Config>::track(const ImageView& image, std::int64_t t_us,
                                    const TickSource& ticks, FrameReport& report) {
  const std::uint32_t start = ticks.now();
  report.status = predict(t_us);
  const std::uint32_t predicted = ticks.now();

  FixedVector<PixelMatch<float>, kMaxFeatures> matches;
  search(image, SearchPass::kAll, matches, report);
  const std::uint32_t searched = ticks.now();

  const int not_searched = report.deferred;
  update(matches, 0, report);
  if (not_searched > 0 && report.inliers >= parameters_.min_inliers) {
    const int unpaid = report.deferred - not_searched;
    const int first = matches.size();
    search(image, SearchPass::kRest, matches, report);
    report.deferred += unpaid;
    if (unpaid > 0 && report.cut < FrameCut::kFewerUpdates) report.cut = FrameCut::kFewerUpdates;
    update(matches, first, report);
  }
  judge(report);
  if (weak_frames_ == 0) {
    archive(matches);
    remove_features(report);
  }
  const bool lost = state_ == TrackingState::kLost;
  if (!lost && weak_frames_ < parameters_.weak_births) add_features(image, report);
  watch_start(report);
  const std::uint32_t updated = ticks.now();
  report.stage_ticks[static_cast<int>(Stage::kPosePrediction)] = predicted - start;
  report.stage_ticks[static_cast<int>(Stage::kFeatures)] = searched - predicted;
  report.stage_ticks[static_cast<int>(Stage::kPoseUpdate)] = updated - searched;
}

/// After blind frames the windows have grown, and a few landmarks are found by chance.
template <class Config>
bool HandheldTracker<Config>::plausible(const FrameReport& report) const {
  if (weak_frames_ < 2) return true;
  const float least = parameters_.min_return_share * static_cast<float>(report.searched);
  return report.matches >= parameters_.min_inliers && static_cast<float>(report.matches) >= least;
}

/// With the matches from `first` on.
template <class Config>
void HandheldTracker<Config>::update(FixedVector<PixelMatch<float>, kMaxFeatures>& matches,
                                     int first, FrameReport& report) {
  const bool usable = first > 0 || plausible(report);
  if (usable) afford_update(first, matches, report);
  const int used = usable ? matches.size() - first : 0;
  UpdateReport of_these;
  const Status status = filter_.update(matches.data() + first, used, random_, of_these);
  work_.spend(work::mono_update(filter_.state_size(), filter_.feature_count(), used,
                                of_these.hypotheses, of_these.nis_dof / 2));
  if (!ok(status) && used > 0 && first == 0 && ok(report.status)) report.status = status;
  for (int i = first; i < first + used; ++i) {
    report.inliers += ok(status) && matches[i].inlier ? 1 : 0;
  }
  add(of_these, report.update);
  if (report.inliers >= parameters_.min_inliers || state_ == TrackingState::kInitialising) {
    note_inliers(matches, first, report);
  } else {
    forget_searches();
  }
}

template <class Config>
void HandheldTracker<Config>::note_inliers(
    const FixedVector<PixelMatch<float>, kMaxFeatures>& matches, int first, FrameReport& report) {
  for (int i = first; i < matches.size(); ++i) {
    if (!matches[i].inlier) continue;
    TrackedLandmark* landmark = table_.find(matches[i].id);
    if (landmark == nullptr) continue;
    ++landmark->measured;
    landmark->misses = 0;
    report.from_library += landmark->from_library ? 1 : 0;
  }
}

/// A frame in which too little fits together says nothing against a landmark that was not found.
template <class Config>
void HandheldTracker<Config>::forget_searches() {
  for (TrackedLandmark& landmark : table_) {
    if (!landmark.searched) continue;
    --landmark.predicted;
    --landmark.misses;
  }
}

template <class Config>
void HandheldTracker<Config>::remove_features(FrameReport& report) {
  for (int slot = filter_.feature_count() - 1; slot >= 0; --slot) {
    const LandmarkId id = filter_.feature_id(slot);
    TrackedLandmark* landmark = table_.find(id);
    const bool unknown = landmark == nullptr;
    const bool poor =
        !unknown && landmark->predicted >= 5 && 2 * landmark->measured < landmark->predicted;
    const bool gone = !unknown && (landmark->frames_out_of_view > 10 || landmark->misses > 10);
    if (!unknown && !poor && !gone) continue;
    if (!work_.take(work::kRemoval)) return;
    if (gone && start_is_over() && landmark->measured >= parameters_.min_sightings_to_store) {
      store(slot, *landmark, shared_depth_variance());
    }
    if (!ok(filter_.remove_feature(slot))) continue;
    table_.remove(id);
    ++report.removed;
    ++health_.landmarks_removed;
  }
}

template <class Config>
void HandheldTracker<Config>::add_features(const ImageView& image, FrameReport& report) {
  for (int slot = 0; slot < filter_.feature_count(); ++slot) {
    PixelPrediction<float> prediction;
    if (ok(filter_.predict_feature(slot, prediction))) {
      supply_.occupy(prediction.pixel.x(), prediction.pixel.y());
    }
  }
  const int room = parameters_.target_features - filter_.feature_count();
  const int limit =
      room < parameters_.max_births_per_frame ? room : parameters_.max_births_per_frame;
  if (limit <= 0) return;
  if (!work_.affords(supply_.cell_work())) work_.cut_mapping();
  Corner corners[Supply::kCells];
  typename Supply::Report supplied;
  const int found = supply_.find(image, parameters_.supply, limit, scratch_.supply, corners,
                                 supplied, work_.budget());
  report.corners += supplied.corners;
  health_.corners_dropped += static_cast<std::uint32_t>(supplied.corners_dropped);
  const Rigid<float> T_world_camera = filter_.T_world_camera();
  for (int i = 0; i < found && work_.take(work::kAppearance + work::kBirth); ++i) {
    TrackedLandmark landmark;
    landmark.id = next_id_;
    if (!ok(make_appearance(image, corners[i].x, corners[i].y, T_world_camera,
                            landmark.appearance))) {
      continue;
    }
    const Vector2<float> pixel(static_cast<float>(corners[i].x), static_cast<float>(corners[i].y));
    if (!ok(filter_.add_feature(landmark.id, pixel))) {
      ++health_.landmarks_refused;
      continue;
    }
    table_.add(landmark);
    ++next_id_;
    ++report.added;
    ++health_.landmarks_added;
  }
}

template <class Config>
void HandheldTracker<Config>::judge(FrameReport& report) {
  if (report.inliers >= parameters_.min_inliers) {
    weak_frames_ = 0;
    if (probation_ > 0) --probation_;
    state_ = probation_ > 0 ? TrackingState::kUncertain : TrackingState::kTracking;
  } else if (state_ != TrackingState::kInitialising) {
    // A frame that did not look tells nothing of the map.
    if (report.cut != FrameCut::kPredictionOnly) ++weak_frames_;
    state_ = TrackingState::kUncertain;
    // A place found that cannot be followed was none.
    const bool refuted = probation_ > 0 && report.cut != FrameCut::kPredictionOnly;
    if (refuted || weak_frames_ > parameters_.uncertain_frames_to_lost) lose(report);
  }
  if (report.searched > 0 && report.matches < parameters_.min_inliers) {
    ++health_.low_texture_frames;
    if (ok(report.status)) report.status = Status::kLowTexture;
  }
  if (state_ == TrackingState::kLost) report.status = Status::kLost;
  report.state = state_;
}

template <class Config>
void HandheldTracker<Config>::lose(FrameReport& report) {
  if (probation_ > 0) {
    ++health_.false_relocalisations_refused;
  } else {
    ++health_.losses;
  }
  probation_ = 0;
  state_ = TrackingState::kLost;
  report.state = state_;
  report.status = Status::kLost;
  places_.reset();
  place_found_ = false;
}

/// A match that was refused counts with the gate, so that refusing them does not hide a misfit.
template <class Config>
void HandheldTracker<Config>::watch_start(FrameReport& report) {
  const Parameters& p = parameters_;
  if (start_.frames >= p.start_blocks * p.start_block_frames) return;
  const auto refused = static_cast<float>(report.matches - report.inliers);
  start_.misfit += report.update.nis + p.filter.rescue_gate * refused;
  start_.dof += static_cast<float>(2 * report.matches);
  if (++start_.frames % p.start_block_frames != 0) return;
  const bool mirrored = start_.misfit > p.start_misfit * start_.dof;
  start_.misfit = start_.dof = 0.0F;
  if (!mirrored || start_.restarts >= p.max_restarts) return;
  if (!ok(filter_.restart(filter_.T_world_camera()))) return;
  table_.clear();
  weak_frames_ = 0;
  start_.frames = 0;
  ++start_.restarts;
  ++health_.losses;
  state_ = TrackingState::kInitialising;
  report.state = TrackingState::kLost;
  report.status = Status::kLost;
}

template <class Config>
bool HandheldTracker<Config>::object_place(Rigid<float>& T_world_object) {
  constexpr int kMinPoints = 10;
  static_assert(kMaxFeatures <= kMaxPlanePoints, "the plane is fitted to all features");
  const Rigid<float> T_world_camera = filter_.T_world_camera();
  const Rigid<float> T_camera_world = T_world_camera.inverse();
  FixedVector<Vector3<float>, kMaxFeatures> points;
  FixedVector<float, kMaxFeatures> depths;
  for (int slot = 0; slot < filter_.feature_count(); ++slot) {
    Vector3<float> p_world;
    Matrix3<float> covariance;
    if (!ok(filter_.feature_position(slot, p_world, covariance))) continue;
    const float depth = (T_camera_world * p_world).z();
    const float trace = covariance(0, 0) + covariance(1, 1) + covariance(2, 2);
    if (!(depth > 0.0F) || !(trace < square(0.2F * depth))) continue;
    points.push_back(p_world);
    depths.push_back(depth);
    for (int i = depths.size() - 1; i > 0 && depths[i - 1] > depths[i]; --i) {
      const float swapped = depths[i];
      depths[i] = depths[i - 1];
      depths[i - 1] = swapped;
    }
  }
  if (points.size() < kMinPoints) return false;
  const float median = depths[depths.size() / 2];
  const Vector3<float> ahead = T_world_camera * Vector3<float>(0.0F, 0.0F, median);
  PlaneFitOptions options;
  options.inlier_m = 0.03F * median;
  options.min_inliers = points.size() * 2 / 3;
  PlaneFit plane;
  if (ok(fit_plane(points.data(), points.size(), T_world_camera.translation, options, random_,
                   plane)) &&
      ok(pose_on_plane(plane, ahead, T_world_camera.rotation * Vector3<float>(1.0F, 0.0F, 0.0F),
                       T_world_object))) {
    return true;
  }
  // Upright as the camera is held: object z against the camera's y.
  const Quaternion<float> R_camera_object(0.70710678F, 0.70710678F, 0.0F, 0.0F);
  T_world_object = {T_world_camera.rotation * R_camera_object, ahead};
  return true;
}

template <class Config>
void HandheldTracker<Config>::augment(Augmenter& augmenter, const MutableImageView& overlay,
                                      const TickSource& ticks, FrameReport& report) {
  const std::uint32_t start = ticks.now();
  if (state_ == TrackingState::kTracking && augmenter.wants_object()) {
    Rigid<float> T_world_object;
    if (object_place(T_world_object)) static_cast<void>(augmenter.place(T_world_object));
  }
  if (state_ != TrackingState::kLost) {
    augmenter.draw(filter_.camera(), report.T_world_camera, overlay);
  }
  report.stage_ticks[static_cast<int>(Stage::kRender)] = ticks.now() - start;
}

template <class Config>
void HandheldTracker<Config>::hash(Hash64& hash) const {
  filter_.hash(hash);
  hash.add(static_cast<std::uint8_t>(state_));
  hash.add(health_.landmarks_added);
  hash.add(health_.landmarks_removed);
  hash.add(static_cast<std::int32_t>(library_.size()));
  hash.add(library_.revision());
  for (const TrackedLandmark& landmark : table_) {
    hash.add(landmark.id);
    hash.add_bytes(landmark.appearance.descriptor.bytes, Descriptor::kBytes);
  }
}

}  // namespace cairn
