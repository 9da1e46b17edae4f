#pragma once

namespace cairn {

template <class Config, class Filter>
Status VehicleTracker<Config, Filter>::initialise(const PinholeCamera<float>& camera,
                                                  const Rigid<float>& T_vehicle_camera,
                                                  const Start& start,
                                                  const Parameters& parameters) {
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
  keyframes_.clear();
  frames_since_keyframe_ = parameters.keyframe_interval;
  weak_frames_ = 0;
  return Status::kOk;
}

template <class Config, class Filter>
Rigid<float> VehicleTracker<Config, Filter>::lift(const PlanarPose<float>& pose) {
  float sine = 0.0F;
  float cosine = 1.0F;
  sin_cos(0.5F * pose.heading, sine, cosine);
  return {{cosine, 0.0F, 0.0F, sine}, {pose.position.x(), pose.position.y(), 0.0F}};
}

template <class Config, class Filter>
void VehicleTracker<Config, Filter>::augment(Augmenter& augmenter, const MutableImageView& overlay,
                                             const TickSource& ticks, FrameReport& report) {
  const std::uint32_t start = ticks.now();
  if (state_ == TrackingState::kTracking && augmenter.wants_object()) {
    Rigid<float> T_world_object = lift(filter_.mean_pose());
    T_world_object.translation = T_world_object * Vector3<float>(3.5F, 0.7F, 0.0F);
    static_cast<void>(augmenter.place(T_world_object));
  }
  if (state_ != TrackingState::kLost) augmenter.draw(camera_, report.T_world_camera, overlay);
  report.stage_ticks[static_cast<int>(Stage::kRender)] = ticks.now() - start;
}

template <class Config, class Filter>
Status VehicleTracker<Config, Filter>::add_odometry(const OdometrySample& sample) {
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
OdometrySample VehicleTracker<Config, Filter>::steadied(const OdometrySample& sample) const {
  const float dt = static_cast<float>(sample.t_us - motion_.t_us) * 1e-6F;
  const float share = dt > 0.0F ? dt / (dt + parameters_.odometry.steady_s) : 0.0F;
  OdometrySample steady = sample;
  steady.speed_mps =
      steady_motion_.speed_mps + share * (sample.speed_mps - steady_motion_.speed_mps);
  steady.turn = steady_motion_.turn + share * (sample.turn - steady_motion_.turn);
  return steady;
}

template <class Config, class Filter>
Status VehicleTracker<Config, Filter>::integrate_to(std::int64_t t_us) {
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
PlanarIncrement<float> VehicleTracker<Config, Filter>::increment_of(const OdometrySample& motion,
                                                                    float dt, float scale) const {
  const OdometryNoise& noise = parameters_.odometry;
  return motion.kind == OdometrySample::Kind::kAckermann
             ? ackermann_increment(motion.speed_mps, motion.turn, dt, noise.wheelbase_m,
                                   noise.sigma_speed_mps * scale, noise.sigma_turn * scale)
             : twist_increment(motion.speed_mps, motion.turn, dt, noise.sigma_speed_mps * scale,
                               noise.sigma_turn * scale);
}

template <class Config, class Filter>
typename VehicleTracker<Config, Filter>::Pool::Parameters
VehicleTracker<Config, Filter>::pool_parameters() const {
  constexpr float kSlowest = 0.02F;
  typename Pool::Parameters pool = parameters_.pool;
  const float speed = abs(motion_.speed_mps) > kSlowest ? abs(motion_.speed_mps) : kSlowest;
  pool.search = parameters_.search;
  // Depth is told by the way made between frames: a fast vehicle must look, and may trust, farther.
  constexpr float kInitialDepthInSteps = 12.0F;
  constexpr float kMaxDepthInSteps = 60.0F;
  const float step = speed * frame_step_s_;
  if (kInitialDepthInSteps * step > pool.initial_depth_m) {
    pool.initial_depth_m = kInitialDepthInSteps * step;
    pool.initial_sigma_rho = 1.0F / pool.initial_depth_m;
  }
  if (kMaxDepthInSteps * step > pool.max_depth_m) pool.max_depth_m = kMaxDepthInSteps * step;
  pool.sigma_yaw_rad = state_ == TrackingState::kTracking ? parameters_.tracked_yaw_rad
                                                          : sqrt(turn_variance_) + 1e-4F;
  return pool;
}

template <class Config, class Filter>
Status VehicleTracker<Config, Filter>::check_input(const ImageView& image, std::int64_t t_us) {
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
Status VehicleTracker<Config, Filter>::process_frame(const ImageView& image, std::int64_t t_us,
                                                     const TickSource& ticks, FrameReport& report) {
  const Status accepted = check_input(image, t_us);
  if (!ok(accepted)) return accepted;
  report = FrameReport{};
  report.t_us = t_us;
  const std::uint32_t start = ticks.now();
  supply_.begin(image.width, image.height);
  const std::uint32_t prepared = ticks.now();

  report.status = integrate_to(t_us);
  frame_step_s_ = has_frame_ ? static_cast<float>(t_us - last_frame_us_) * 1e-6F : 0.0F;
  last_frame_us_ = t_us;
  has_frame_ = true;
  const std::uint32_t predicted = ticks.now();

  FixedVector<PixelMatch<float>, kMaxLandmarks> matches;
  SearchTotals totals;
  search_landmarks(image, View{*this}, table_, parameters_.search, parameters_.max_searches,
                   scratch_.search, matches, totals);
  report.corners = totals.corners;
  report.candidates = totals.descriptors;
  report.searched = totals.searched;
  report.matches = matches.size();
  health_.searches_deferred += static_cast<std::uint32_t>(totals.deferred);
  health_.corners_dropped += static_cast<std::uint32_t>(totals.corners_dropped);
  const std::uint32_t searched = ticks.now();

  update(matches, report);
  remove_landmarks(report);
  build_map(image, report);
  judge(report);
  report.T_world_camera = T_world_camera();
  report.landmarks = filter_.landmark_count();
  const std::uint32_t updated = ticks.now();

  report.stage_ticks[static_cast<int>(Stage::kPreprocess)] = prepared - start;
  report.stage_ticks[static_cast<int>(Stage::kPosePrediction)] = predicted - prepared;
  report.stage_ticks[static_cast<int>(Stage::kFeatures)] = searched - predicted;
  report.stage_ticks[static_cast<int>(Stage::kPoseUpdate)] = updated - searched;
  return report.status;
}

template <class Config, class Filter>
void VehicleTracker<Config, Filter>::update(FixedVector<PixelMatch<float>, kMaxLandmarks>& matches,
                                            FrameReport& report) {
  if (matches.empty()) return;
  const Status status =
      filter_.update_pixels(camera_, T_vehicle_camera_, parameters_.sigma_px, matches.data(),
                            matches.size(), random_, report.update);
  if (!ok(status)) {
    if (ok(report.status)) report.status = status;
    return;
  }
  for (const PixelMatch<float>& match : matches) {
    if (!match.inlier) continue;
    ++report.inliers;
    TrackedLandmark* landmark = table_.find(match.id);
    if (landmark == nullptr) continue;
    ++landmark->measured;
    landmark->misses = 0;
  }
}

template <class Config, class Filter>
void VehicleTracker<Config, Filter>::remove_landmarks(FrameReport& report) {
  for (int slot = filter_.landmark_count() - 1; slot >= 0; --slot) {
    const TrackedLandmark* landmark = table_.find(filter_.landmark_id(slot));
    if (landmark == nullptr) continue;
    if (landmark->predicted < 8 || 2 * landmark->measured >= landmark->predicted) continue;
    remove_landmark(slot, report);
  }
  make_room(report);
}

/// Keeps `kReserve` slots free for what comes into view, at the cost of the landmarks longest out
/// of it: a full map of places passed would leave the vehicle blind.
template <class Config, class Filter>
void VehicleTracker<Config, Filter>::make_room(FrameReport& report) {
  constexpr int kReserve = kMaxLandmarks / 6;
  constexpr int kLeastFramesOutOfView = 15;
  for (int i = 0; i < parameters_.max_promotions_per_frame; ++i) {
    if (filter_.landmark_count() + kReserve <= kMaxLandmarks) return;
    int longest = -1;
    int frames = kLeastFramesOutOfView;
    for (int slot = 0; slot < filter_.landmark_count(); ++slot) {
      const TrackedLandmark* landmark = table_.find(filter_.landmark_id(slot));
      if (landmark == nullptr || landmark->frames_out_of_view <= frames) continue;
      frames = landmark->frames_out_of_view;
      longest = slot;
    }
    if (longest < 0) return;
    remove_landmark(longest, report);
  }
}

template <class Config, class Filter>
void VehicleTracker<Config, Filter>::remove_landmark(int slot, FrameReport& report) {
  const LandmarkId id = filter_.landmark_id(slot);
  if (!ok(filter_.remove_landmark(slot))) return;
  table_.remove(id);
  ++report.removed;
  ++health_.landmarks_removed;
}

template <class Config, class Filter>
void VehicleTracker<Config, Filter>::build_map(const ImageView& image, FrameReport& report) {
  const int dropped =
      pool_.follow(image, camera_, T_world_camera(), pool_parameters(), scratch_.search);

  health_.candidates_dropped += static_cast<std::uint32_t>(dropped);
  promote_candidates(report);
  end_keyframes(false);
  turn_variance_ = 0.0F;
  if (++frames_since_keyframe_ < parameters_.keyframe_interval) return;

  int in_view = pool_.size();
  for (int i = 0; i < pool_.size(); ++i) supply_.occupy(pool_[i].pixel.x(), pool_[i].pixel.y());
  for (int slot = 0; slot < filter_.landmark_count(); ++slot) {
    PixelPrediction<float> prediction;
    if (!ok(View{*this}.predict(slot, prediction)) || !camera_.contains(prediction.pixel)) continue;
    supply_.occupy(prediction.pixel.x(), prediction.pixel.y());
    ++in_view;
  }
  const int room = parameters_.target_in_view - in_view;
  const int limit =
      room < parameters_.max_births_per_frame ? room : parameters_.max_births_per_frame;
  if (limit <= 0 || pool_.full()) return;
  Corner corners[Supply::kCells];
  typename Supply::Report supplied;
  const int found =
      supply_.find(image, parameters_.supply, limit, scratch_.supply, corners, supplied);
  report.corners += supplied.corners;
  health_.corners_dropped += static_cast<std::uint32_t>(supplied.corners_dropped);
  if (found == 0 || !begin_keyframe()) return;
  for (int i = 0; i < found; ++i) {
    const Status status = pool_.add(image, camera_, corners[i].x, corners[i].y,
                                    keyframes_[keyframes_.size() - 1], pool_parameters());
    if (status == Status::kFull) break;
  }
}

template <class Config, class Filter>
void VehicleTracker<Config, Filter>::promote_candidates(FrameReport& report) {
  for (int i = 0; i < parameters_.max_promotions_per_frame; ++i) {
    Promotion promotion;
    if (!pool_.promote(camera_, pool_parameters(), promotion)) return;
    if (!add_promoted(promotion, report)) ++health_.landmarks_refused;
  }
}

/// The pool tells depth in units of the way made since the candidate's keyframe, and the filter
/// knows that way better than dead reckoning does: it has both ends in its state.
template <class Config, class Filter>
bool VehicleTracker<Config, Filter>::add_promoted(const Promotion& promotion, FrameReport& report) {
  const int slot = filter_.find(promotion.keyframe);
  if (slot < 0) return false;
  const Rigid<float> T_world_vehicle = lift(filter_.mean_pose());
  const Rigid<float> T_world_camera = T_world_vehicle * T_vehicle_camera_;
  const Quaternion<float> R_world_first =
      T_world_camera.rotation * promotion.T_camera_first.rotation;
  const Quaternion<float> R_world_past = R_world_first * T_vehicle_camera_.rotation.conjugate();
  const Vector3<float> first_camera =
      filter_.mean_landmark(slot) + R_world_past * T_vehicle_camera_.translation;
  const Vector3<float> path = T_world_camera.translation - first_camera;
  const Vector3<float>& reckoned = promotion.T_camera_first.translation;
  const float length = sqrt(path.dot(path));
  const float reckoned_length = sqrt(reckoned.dot(reckoned));
  if (!(length > kShortestPath_m) || !(reckoned_length > kShortestPath_m)) return false;
  const float scale = length / reckoned_length;
  const float depth = promotion.depth_m * scale;
  const float sigma_depth = promotion.sigma_depth_m * scale;
  const float sigma_lateral = depth * parameters_.pool.sigma_px / camera_.fx;
  Matrix3<float> covariance = square(sigma_depth) * (promotion.ray * promotion.ray.transpose());
  covariance(0, 0) += square(sigma_lateral);
  covariance(1, 1) += square(sigma_lateral);
  const Matrix3<float> R_vehicle_camera = T_vehicle_camera_.rotation.toRotationMatrix();
  const Matrix3<float> turned = R_vehicle_camera * covariance;
  const Vector3<float> offset = R_vehicle_camera * Vector3<float>(promotion.ray * depth);
  const Vector3<float> direction = (T_world_vehicle.rotation.conjugate() * path) * (1.0F / length);
  const Matrix<float, 3, 2> by_path =
      (offset * (1.0F / length)) * direction.template head<2>().transpose();
  TrackedLandmark landmark;
  landmark.id = next_id_;
  landmark.appearance = promotion.appearance;
  landmark.appearance.T_world_reference =
      T_world_camera * Rigid<float>{promotion.T_camera_first.rotation, reckoned * scale};
  LandmarkId replaced = kNoLandmark;
  if (!ok(filter_.add_landmark_on_path(landmark.id, T_vehicle_camera_.translation + offset,
                                       turned * R_vehicle_camera.transpose(), promotion.keyframe,
                                       by_path, &replaced))) {
    return false;
  }
  ++next_id_;
  if (replaced != kNoLandmark) {
    table_.remove(replaced);
    ++health_.landmarks_replaced;
  }
  table_.add(landmark);
  ++report.added;
  ++health_.landmarks_added;
  return true;
}

/// Makes this frame one at which candidates begin; false when pool or filter have no room.
template <class Config, class Filter>
bool VehicleTracker<Config, Filter>::begin_keyframe() {
  end_keyframes(true);
  const LandmarkId id = next_id_;
  if (keyframes_.full() || !ok(filter_.add_position(id))) return false;
  if (!ok(pool_.begin_keyframe(id))) {
    static_cast<void>(filter_.remove_landmark(filter_.find(id)));
    return false;
  }
  ++next_id_;
  keyframes_.push_back(id);
  frames_since_keyframe_ = 0;
  return true;
}

/// Forgets the positions that no candidate refers to any more.
template <class Config, class Filter>
void VehicleTracker<Config, Filter>::end_keyframes(bool make_room) {
  health_.candidates_dropped += static_cast<std::uint32_t>(pool_.end_keyframes(make_room));
  for (int i = keyframes_.size() - 1; i >= 0; --i) {
    if (pool_.has_keyframe(keyframes_[i])) continue;
    static_cast<void>(filter_.remove_landmark(filter_.find(keyframes_[i])));
    keyframes_.remove_unordered(i);
  }
}

template <class Config, class Filter>
void VehicleTracker<Config, Filter>::judge(FrameReport& report) {
  if (report.inliers >= parameters_.min_inliers) {
    weak_frames_ = 0;
    state_ = TrackingState::kTracking;
  } else if (state_ != TrackingState::kInitialising) {
    ++weak_frames_;
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
void VehicleTracker<Config, Filter>::hash(Hash64& hash) const {
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
