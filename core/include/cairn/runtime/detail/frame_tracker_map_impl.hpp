#pragma once

#include "cairn/runtime/frame_tracker.hpp"

namespace cairn {

template <class Config, class Filter>
typename FrameTracker<Config, Filter>::Pool::Parameters
FrameTracker<Config, Filter>::pool_parameters() const {
  constexpr float kSlowest = 0.02F;
  typename Pool::Parameters pool = parameters_.pool;
  const float told = abs(odometry_.speed_mps());
  const float speed = told > kSlowest ? told : kSlowest;
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
  pool.sigma_yaw_rad = state() == TrackingState::kTracking
                           ? parameters_.tracked_yaw_rad
                           : sqrt(odometry_.turn_variance()) + 1e-4F;
  return pool;
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::remove_landmarks(Map& map, FrameReport& report) {
  for (int slot = filter_.landmark_count() - 1; slot >= 0; --slot) {
    const TrackedLandmark* landmark = table_.find(filter_.landmark_id(slot));
    if (landmark == nullptr) continue;
    const bool not_recognised =
        landmark->from_library && landmark->measured == 0 && landmark->predicted >= 4;
    const bool rarely_found =
        landmark->predicted >= 8 && 2 * landmark->measured < landmark->predicted;
    if (!not_recognised && !rarely_found) continue;
    if (!work_.take(work::kRemoval)) return;
    if (not_recognised) {
      tell(map, Map::Message::Kind::kNotFound, landmark->id);
      reentry_.refuse(landmark->id);
    }
    remove_landmark(slot, report);
  }
  make_room(map, kMaxLandmarks / 6, parameters_.max_promotions_per_frame, report);
}

/// Keeps `reserve` slots free for what comes into view, at the cost of at most `limit` of the
/// landmarks longest out of it: a full map of places passed would leave the vehicle blind.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::make_room(Map& map, int reserve, int limit,
                                             FrameReport& report) {
  constexpr int kLeastFramesOutOfView = 15;
  for (int i = 0; i < limit; ++i) {
    if (filter_.landmark_count() + reserve <= kMaxLandmarks || !work_.take(work::kRemoval)) return;
    int longest = -1;
    int frames = kLeastFramesOutOfView;
    for (int slot = 0; slot < filter_.landmark_count(); ++slot) {
      const TrackedLandmark* landmark = table_.find(filter_.landmark_id(slot));
      if (landmark == nullptr || landmark->frames_out_of_view <= frames) continue;
      frames = landmark->frames_out_of_view;
      longest = slot;
    }
    if (longest < 0) return;
    const TrackedLandmark& leaving = *table_.find(filter_.landmark_id(longest));
    if (leaving.measured >= parameters_.min_sightings_to_store) store(longest, leaving, map);
    remove_landmark(longest, report);
  }
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::remove_landmark(int slot, FrameReport& report) {
  const LandmarkId id = filter_.landmark_id(slot);
  if (!ok(filter_.remove_landmark(slot))) return;
  table_.remove(id);
  ++report.removed;
  ++health_.landmarks_removed;
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::build_map(const ImageView& image, bool growing,
                                             FrameReport& report) {
  if (!work_.affords(pool_.work_to_follow())) work_.cut_mapping();
  const int dropped = pool_.follow(image, camera_, T_world_camera(), pool_parameters(),
                                   scratch_.search, work_.budget());
  health_.candidates_dropped += static_cast<std::uint32_t>(dropped);
  if (growing) promote_candidates(report);
  end_keyframes(false);
  odometry_.forget_turn();
  ++frames_since_keyframe_;
  if (growing) begin_candidates(image, report);
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::begin_candidates(const ImageView& image, FrameReport& report) {
  if (frames_since_keyframe_ < parameters_.keyframe_interval) return;
  if (!work_.take(work::kKeyframe + work::kProjection * filter_.landmark_count())) {
    work_.cut_mapping();
    return;
  }
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
  const int found = supply_.find(image, parameters_.supply, limit, scratch_.supply, corners,
                                 supplied, work_.budget());
  report.corners += supplied.corners;
  health_.corners_dropped += static_cast<std::uint32_t>(supplied.corners_dropped);
  if (found == 0 || !begin_keyframe()) return;
  for (int i = 0; i < found && work_.take(work::kAppearance); ++i) {
    const Status status = pool_.add(image, camera_, corners[i].x, corners[i].y,
                                    keyframes_[keyframes_.size() - 1], pool_parameters());
    if (status == Status::kFull) break;
  }
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::promote_candidates(FrameReport& report) {
  for (int i = 0; i < parameters_.max_promotions_per_frame; ++i) {
    Promotion promotion;
    if (!work_.affords(work::kPromotion)) {
      work_.cut_mapping();
      return;
    }
    if (!pool_.promote(camera_, pool_parameters(), promotion)) return;
    work_.spend(work::kPromotion);
    if (!add_promoted(promotion, report)) ++health_.landmarks_refused;
  }
}

/// The pool tells depth in units of the way made since the candidate's keyframe, and the filter
/// knows that way better than dead reckoning does: it has both ends in its state.
template <class Config, class Filter>
bool FrameTracker<Config, Filter>::add_promoted(const Promotion& promotion, FrameReport& report) {
  const int slot = filter_.find(promotion.keyframe);
  if (slot < 0) return false;
  const Rigid<float> T_world_vehicle = on_floor(filter_.mean_pose());
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
  const Matrix3<float> turned = R_vehicle_camera * covariance * R_vehicle_camera.transpose();
  // Rounding leaves two of three products not symmetric to the bit, which the filter would refuse.
  const Matrix3<float> noise = 0.5F * (turned + turned.transpose());
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
  if (!ok(filter_.add_landmark_on_path(landmark.id, T_vehicle_camera_.translation + offset, noise,
                                       promotion.keyframe, by_path, &replaced))) {
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
bool FrameTracker<Config, Filter>::begin_keyframe() {
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
void FrameTracker<Config, Filter>::end_keyframes(bool make_room) {
  health_.candidates_dropped += static_cast<std::uint32_t>(pool_.end_keyframes(make_room));
  for (int i = keyframes_.size() - 1; i >= 0; --i) {
    if (pool_.has_keyframe(keyframes_[i])) continue;
    static_cast<void>(filter_.remove_landmark(filter_.find(keyframes_[i])));
    keyframes_.remove_unordered(i);
  }
}

}  // namespace cairn
