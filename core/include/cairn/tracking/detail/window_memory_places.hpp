#pragma once

#include "cairn/tracking/window_memory.hpp"

namespace cairn {

template <class Config>
bool WindowMemory<Config>::recognise(FrameContext& frame, Features& features,
                                     const Rigid<float>& T_camera_world) {
  if (stage_ == Stage::kFound) return confirm(frame, features, T_camera_world);
  if (stage_ == Stage::kIdle) begin_image(frame, features, T_camera_world);
  if (stage_ == Stage::kComparing) compare(frame);
  for (int i = 0; i < kMaxProposals && stage_ == Stage::kSeeking; ++i) {
    if (!seek_proposal(frame, features, T_camera_world)) break;
    if (stage_ == Stage::kSampling) sample_pose(frame);
  }
  if (stage_ == Stage::kSampling) sample_pose(frame);
  return false;
}

/// By templates and by descriptors in turn.
template <class Config>
void WindowMemory<Config>::begin_image(FrameContext& frame, Features& features,
                                       const Rigid<float>& T_camera_world) {
  if (!frame.work.affords(capture_work(frame.image))) return;
  const bool views = compares_views();
  by_views_ = !by_views_;
  T_camera_world_ = T_camera_world;
  if (views) return compare_views(frame, features, T_camera_world);
  capture(frame, features, T_camera_world);
  stage_ = Stage::kComparing;
}

/// A pose proposed is confirmed by the present image: true for the second one that does.
template <class Config>
bool WindowMemory<Config>::confirm(FrameContext& frame, const Features& features,
                                   const Rigid<float>& T_camera_world) {
  const int radius = looks_ == 0 ? parameters_.wide_radius_px : 2 * parameters_.narrow_radius_px;
  if (!frame.work.affords(confirm_work(radius))) return false;
  place_.T_map_camera = place_.T_map_camera * T_camera_world_ * T_camera_world.inverse();
  T_camera_world_ = T_camera_world;
  const float evidence = look(frame, features, radius);
  ++looks_;
  if (evidence >= parameters_.evidence && pose_is_sure()) ++confirmed_;
  if (evidence < parameters_.least_evidence || looks_ == kMostLooks) {
    ++frame.health.false_relocalisations_refused;
    next_proposal();
    return false;
  }
  if (confirmed_ < parameters_.confirmations) return false;
  stage_ = Stage::kIdle;
  return true;
}

template <class Config>
void WindowMemory<Config>::compare(FrameContext& frame) {
  const typename Recogniser::Parameters& p = parameters_.recogniser;
  typename Recogniser::Outcome outcome = Recogniser::Outcome::kWorking;
  while (outcome == Recogniser::Outcome::kWorking && frame.work.affords(Recogniser::step_work(p))) {
    outcome = recogniser_.step(frame.camera, library_, p, frame.random, frame.work.budget());
  }
  if (outcome == Recogniser::Outcome::kFailed) stage_ = Stage::kIdle;
  if (outcome != Recogniser::Outcome::kProposed) return;
  place_.T_map_camera = recogniser_.T_map_camera();
  begin_looks();
}

/// Seeks the landmarks that a camera at place_.T_map_camera should see, at most `radius` from where
/// they should be, and moves that pose to where most of them agree. How many more do than a wrong
/// pose finds.
template <class Config>
float WindowMemory<Config>::look(FrameContext& frame, const Features& features, int radius) {
  constexpr float kNone = -1e6F;
  seek(frame, features, radius, kWidelySought);
  if (!refine(frame)) return kNone;
  seek(frame, features, parameters_.narrow_radius_px, kMaxSought);
  if (!refine(frame)) return kNone;
  return static_cast<float>(place_.seen.size()) -
         parameters_.chance_share * static_cast<float>(place_.sought);
}

/// Landmarks that are close together, or in a plane, leave the camera free to move about them.
template <class Config>
bool WindowMemory<Config>::pose_is_sure() const {
  const Vector3<float>& centre = place_.T_map_camera.translation;
  float distances = 0.0F;
  for (const Seen& seen : place_.seen) {
    distances += sqrt((library_[seen.slot].p_map - centre).squaredNorm());
  }
  const float mean = distances / static_cast<float>(place_.seen.size());
  return place_.covariance.template topLeftCorner<3, 3>().trace() <
         square(parameters_.position_sigma * mean);
}

/// Where a camera should see a landmark, and as it was seen when it was archived. False where it
/// should not.
template <class Config>
bool WindowMemory<Config>::expected_view(const FrameContext& frame, int slot,
                                         const Rigid<float>& T_map_camera,
                                         Vector2<float>& pixel) const {
  constexpr float kLeastScale = 0.7F;
  constexpr float kMostScale = 1.5F;
  constexpr float kLeastCosine = 0.75F;
  constexpr float kMargin_px = 24.0F;
  const auto& landmark = library_[slot];
  ViewPrediction<float> expected;
  if (!ok(predict_view(frame.camera, T_map_camera, landmark.p_map, landmark.views[0], expected)) ||
      !frame.camera.contains(expected.pixel, kMargin_px) || expected.scale_ratio < kLeastScale ||
      expected.scale_ratio > kMostScale || expected.cosine < kLeastCosine) {
    return false;
  }
  pixel = expected.pixel;
  return true;
}

template <class Config>
void WindowMemory<Config>::seek(FrameContext& frame, const Features& features, int radius,
                                int most) {
  place_.seen.clear();
  place_.sought = 0;
  frame.work.spend(library_.size() * work::kLibrarySlot / 2);
  for (int i = 0; i < library_.size() && place_.sought < most; ++i) {
    Seen seen;
    seen.slot = (i * kStride) % library_.size();
    Vector2<float> expected;
    if (!expected_view(frame, seen.slot, place_.T_map_camera, expected)) continue;
    ++place_.sought;
    frame.work.spend(work::warped_search(radius));
    if (find(frame, features, seen.slot, place_.T_map_camera, expected, radius,
             parameters_.least_q15, seen.pixel)) {
      static_cast<void>(place_.seen.push_back(seen));
    }
  }
}

/// Keeps the inliers of what was seen.
template <class Config>
bool WindowMemory<Config>::refine(FrameContext& frame) {
  constexpr int kLeast = 6;
  FixedVector<Seen, kMaxSought>& seen = place_.seen;
  if (seen.size() < kLeast) return false;
  observe_seen();
  PoseRefinementOptions<float> options;
  options.max_iterations = 10;
  options.min_inliers = kLeast;
  PoseEstimate<float> estimate;
  frame.work.spend(refinement_work(seen.size()));
  if (!ok(refine_pose(frame.camera, observations_, seen.size(), options, place_.T_map_camera,
                      estimate, inlier_))) {
    return false;
  }
  place_.covariance = estimate.covariance;
  const Rigid<float> T_camera_map = place_.T_map_camera.inverse();
  int kept = 0;
  for (int i = 0; i < seen.size(); ++i) {
    Vector2<float> pixel;
    if (inlier_[i] == 0 ||
        !ok(frame.camera.project(T_camera_map * library_[seen[i].slot].p_map, pixel)) ||
        (pixel - seen[i].pixel).squaredNorm() > square(parameters_.inlier_px)) {
      continue;
    }
    seen[kept++] = seen[i];
  }
  seen.resize(kept);
  return true;
}

/// At its place in the map, as its host sees it, which is fixed: so that the map's frame and scale
/// hold.
template <class Config>
void WindowMemory<Config>::take(FrameContext& frame, Window& window, Features& features,
                                const Seen& seen, const Rigid<float>& T_camera_map) {
  constexpr float kInflation = 2.0F;  // of the sigma: errors of neighbours are correlated
  constexpr float kLeastSigma = 0.03F;
  constexpr float kLeastDepth = 0.2F;  // of its distance from the host
  const auto& landmark = library_[seen.slot];
  if (host_ < 0) {
    T_host_map_ = T_camera_map;
    host_ = window.add_host(T_host_map_);
  }
  const Vector3<float> p = T_host_map_ * landmark.p_map;
  const float squared = p.squaredNorm();
  if (!(p.z() > kLeastDepth * sqrt(squared))) return;
  const Vector3<float> ray = T_host_map_.rotation.conjugate() * p;
  const float along = sqrt(ray.dot(landmark.covariance * ray) / squared) / sqrt(squared);
  const float relative = kInflation * (along > kLeastSigma ? along : kLeastSigma);
  const float rho = 1.0F / p.z();
  const int slot = window.add_known_landmark(
      landmark.id, host_, Vector2<float>(p.x() * rho, p.y() * rho), rho, relative * rho);
  if (slot < 0) return;
  if (!features.add_known(frame, slot, seen.pixel)) {
    window.retire(slot);
    return;
  }
  static_cast<void>(library_.record(landmark.id, true));
  ++frame.report.reactivated;
  ++frame.health.landmarks_reactivated;
}

template <class Config>
void WindowMemory<Config>::take_place(FrameContext& frame, Window& window, Features& features) {
  host_ = -1;
  const Rigid<float> T_camera_map = place_.T_map_camera.inverse();
  for (const Seen& seen : place_.seen) take(frame, window, features, seen, T_camera_map);
}

template <class Config>
void WindowMemory<Config>::reuse(FrameContext& frame, Window& window, Features& features,
                                 const Rigid<float>& T_camera_world) {
  const int search = work::warped_search(parameters_.reuse_radius_px) +
                     work::window_landmark(Features::Candidates::kCell);
  const int visits =
      parameters_.reuse_visits < library_.size() ? parameters_.reuse_visits : library_.size();
  if (!frame.work.take(visits * work::kLibrarySlot / 2 + parameters_.reuse_searches * search)) {
    return;
  }
  const Rigid<float> T_map_camera = T_camera_world.inverse();
  int searches = 0;
  for (int i = 0; i < visits && searches < parameters_.reuse_searches; ++i) {
    next_slot_ = (next_slot_ + 1) % library_.size();
    Seen seen;
    seen.slot = next_slot_;
    Vector2<float> expected;
    if (features.full() || !expected_view(frame, seen.slot, T_map_camera, expected) ||
        !features.is_free(frame, expected)) {
      continue;
    }
    ++searches;
    if (find(frame, features, seen.slot, T_map_camera, expected, parameters_.reuse_radius_px,
             parameters_.reuse_q15, seen.pixel) &&
        features.is_free(frame, seen.pixel)) {
      take(frame, window, features, seen, T_camera_world);
    }
  }
}

}  // namespace cairn
