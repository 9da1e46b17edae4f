#pragma once

#include "cairn/tracking/window_memory.hpp"

namespace cairn {

template <class Config>
void WindowMemory<Config>::keep_view(FrameContext& frame, const Features& features,
                                     const Rigid<float>& T_camera_world, float inverse_depth) {
  const Rigid<float> T_map_camera = T_camera_world.inverse();
  SmallPicture picture;
  if (!frame.work.take(Views::look_work()) || !views_.is_new(T_map_camera, inverse_depth) ||
      !frame.work.take(kPictureWork + Views::add_work()) || !picture.take(features.shrunk())) {
    return;
  }
  views_.add(picture, T_map_camera, inverse_depth);
}

/// The views that look most like the image propose poses: where they were taken from, turned by
/// what moves the one picture over the other.
template <class Config>
void WindowMemory<Config>::compare_views(FrameContext& frame, const Features& features,
                                         const Rigid<float>& T_camera_world) {
  frame.work.spend(views_work());
  T_camera_world_ = T_camera_world;
  proposals_.clear();
  SmallPicture picture;
  if (!picture.take(features.shrunk())) return;
  typename Views::Likeness like[kMaxProposals];
  const int count = views_.most_like(picture, like, parameters_.view_proposals);
  const float per_column = static_cast<float>(frame.image.width / SmallPicture::kColumns);
  const float per_row = static_cast<float>(frame.image.height / SmallPicture::kRows);
  for (int i = count - 1; i >= 0; --i) {
    const float right = static_cast<float>(like[i].shift.dx) * per_column / frame.camera.fx;
    const float down = static_cast<float>(like[i].shift.dy) * per_row / frame.camera.fy;
    Rigid<float> T_map_camera = views_[like[i].view].T_map_camera;
    T_map_camera.rotation =
        T_map_camera.rotation * rotation_exp(Vector3<float>(down, -right, 0.0F));
    static_cast<void>(proposals_.push_back(T_map_camera));
  }
  next_proposal();
}

template <class Config>
void WindowMemory<Config>::next_proposal() {
  stage_ = proposals_.empty() ? Stage::kIdle : Stage::kSeeking;
}

/// Landmarks that the next proposal expects are sought in wide windows. False where the frame does
/// not afford it. Proposals are relative to
/// T_camera_world_, where the tracker believed to be then.
template <class Config>
bool WindowMemory<Config>::seek_proposal(FrameContext& frame, const Features& features,
                                         const Rigid<float>& T_camera_world) {
  if (!frame.work.affords(seek_work())) return false;
  const Rigid<float> moved = T_camera_world_ * T_camera_world.inverse();
  for (Rigid<float>& proposal : proposals_) proposal = proposal * moved;
  T_camera_world_ = T_camera_world;
  place_.T_map_camera = proposals_.back();
  proposals_.pop_back();
  seek(frame, features, parameters_.seek_radius_px, parameters_.seek_landmarks);
  if (place_.seen.size() < parameters_.seek_found) {
    next_proposal();
    return true;
  }
  observe_seen();
  search_ = PoseSearch<float>();
  stage_ = Stage::kSampling;
  return true;
}

/// P3P over what was found, as many samples as the frame's work affords.
template <class Config>
void WindowMemory<Config>::sample_pose(FrameContext& frame) {
  constexpr int kSamples = 12;
  PoseRansacOptions<float> options = parameters_.recogniser.ransac;
  options.min_inliers = parameters_.seek_found;
  options.max_hypotheses = parameters_.seek_samples;
  const int count = place_.seen.size();
  const int most =
      Recogniser::pose_work(kSamples, 4 * kSamples, count) + refinement_work(count) * 2;
  bool done = false;
  while (!done && frame.work.affords(most)) {
    const int samples = search_.hypotheses;
    const int poses = search_.poses;
    if (!ok(search_pose(frame.camera, observations_, count, options, kSamples, frame.random,
                        search_, done))) {
      return next_proposal();
    }
    frame.work.spend(
        Recogniser::pose_work(search_.hypotheses - samples, search_.poses - poses, count));
  }
  if (!done) return;
  frame.work.spend(2 * refinement_work(count));
  PoseEstimate<float> estimate;
  PoseRansacReport<float> report;
  if (!ok(finish_pose(frame.camera, observations_, count, options, search_, place_.T_map_camera,
                      estimate, report))) {
    return next_proposal();
  }
  begin_looks();
}

/// place_ is to be confirmed by the next images.
template <class Config>
void WindowMemory<Config>::begin_looks() {
  stage_ = Stage::kFound;
  looks_ = confirmed_ = 0;
}

/// The pixel at which the image shows a landmark, resampled as the camera saw it that archived it.
template <class Config>
bool WindowMemory<Config>::find(const FrameContext& frame, const Features& features, int slot,
                                const Rigid<float>& T_map_camera, const Vector2<float>& expected,
                                int radius, int least_q15, Vector2<float>& pixel) const {
  const auto& landmark = library_[slot];
  Matrix2<float> warp;
  PatchWarp fixed;
  if (!ok(predict_warp(frame.camera, landmark.views[0].T_map_reference, T_map_camera,
                       Vector3<float>(T_map_camera.inverse() * landmark.p_map), warp)) ||
      !to_patch_warp(warp, fixed)) {
    return false;
  }
  return features.find_warped(coarse_[slot], fixed, expected, radius, least_q15, pixel);
}

template <class Config>
void WindowMemory<Config>::observe_seen() {
  constexpr float kSigma_px = 2.0F;
  for (int i = 0; i < place_.seen.size(); ++i) {
    const Seen& seen = place_.seen[i];
    const auto& landmark = library_[seen.slot];
    observations_[i] = {landmark.p_map, landmark.covariance, seen.pixel, kSigma_px};
  }
}

}  // namespace cairn
