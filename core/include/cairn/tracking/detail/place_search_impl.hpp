#pragma once

#include "cairn/tracking/place_search.hpp"

namespace cairn {

template <class Config>
int PlaceSearch<Config>::points_work(const ImageView& image) {
  constexpr int kCell = Features::Candidates::kCell;
  return Recogniser::kMaxPoints * (work::kDescriptor + work::texture_point(kCell)) +
         work::texture_cells(image.width * image.height / (kCell * kCell), kCell) + kSelection;
}

template <class Config>
int PlaceSearch<Config>::wanted_work(const ImageView& image) const {
  switch (stage_) {
    case Stage::kIdle:
      return capture_work(image);
    case Stage::kSeeking:
      return seek_work() + sampling_work();
    case Stage::kSampling:
      return sampling_work();
    case Stage::kFound:
      return Sightings::look_work(parameters_.wide_radius_px);
    case Stage::kComparing:
      break;
  }
  return 0;
}

template <class Config>
bool PlaceSearch<Config>::step(FrameContext& frame, Features& features, const Archive& archive,
                               const Rigid<float>& T_camera_world) {
  if (stage_ == Stage::kFound) return confirm(frame, features, archive, T_camera_world);
  if (stage_ == Stage::kIdle) begin_image(frame, features, T_camera_world);
  if (stage_ == Stage::kComparing) compare(frame, archive);
  for (int i = 0; i < Proposals::kMaxProposals && stage_ == Stage::kSeeking; ++i) {
    if (!seek_proposal(frame, features, archive, T_camera_world)) break;
    if (stage_ == Stage::kSampling) sample_pose(frame);
  }
  if (stage_ == Stage::kSampling) sample_pose(frame);
  return false;
}

/// By views and by descriptors in turn.
template <class Config>
void PlaceSearch<Config>::begin_image(FrameContext& frame, Features& features,
                                      const Rigid<float>& T_camera_world) {
  if (!frame.work.affords(capture_work(frame.image))) return;
  const bool views = compares_views();
  by_views_ = !by_views_;
  T_camera_world_ = T_camera_world;
  if (views) {
    proposals_.propose(frame, features, parameters_.view_proposals);
    next_proposal();
  } else {
    capture(frame, features, T_camera_world);
    stage_ = Stage::kComparing;
  }
}

/// Describes what the frame found, then further points.
template <class Config>
void PlaceSearch<Config>::capture(FrameContext& frame, Features& features,
                                  const Rigid<float>& T_camera_world) {
  const std::uint8_t bin = roll_bin(T_camera_world);
  recogniser_.reset();
  for (int i = 0; i < features.size(); ++i) {
    if (features[i].found) {
      static_cast<void>(recogniser_.add(frame.image, features[i].pixel, bin));
    }
  }
  const int most = Recogniser::kMaxPoints - recogniser_.points();
  const typename Features::Candidates& points = features.spread_points(frame, most);
  for (int i = 0; i < points.cells(); ++i) {
    if (!points.is_open(i)) continue;
    const Vector2<float> pixel(points[i].x, points[i].y);
    static_cast<void>(recogniser_.add(frame.image, pixel, bin));
  }
  frame.work.spend(recogniser_.points() * work::kDescriptor + kSelection);
}

template <class Config>
void PlaceSearch<Config>::compare(FrameContext& frame, const Archive& archive) {
  const typename Recogniser::Parameters& p = parameters_.recogniser;
  typename Recogniser::Outcome outcome = Recogniser::Outcome::kWorking;
  while (outcome == Recogniser::Outcome::kWorking && frame.work.affords(Recogniser::step_work(p))) {
    outcome =
        recogniser_.step(frame.camera, archive.library(), p, frame.random, frame.work.budget());
  }
  if (outcome == Recogniser::Outcome::kFailed) stage_ = Stage::kIdle;
  if (outcome == Recogniser::Outcome::kProposed) begin_looks(recogniser_.T_map_camera());
}

/// Landmarks that the next proposal expects are sought in wide windows. False where the frame does
/// not afford it.
template <class Config>
bool PlaceSearch<Config>::seek_proposal(FrameContext& frame, const Features& features,
                                        const Archive& archive,
                                        const Rigid<float>& T_camera_world) {
  if (!frame.work.affords(seek_work())) return false;
  proposals_.move(T_camera_world_ * T_camera_world.inverse());
  T_camera_world_ = T_camera_world;
  sightings_.move_to(proposals_.take_best());
  sightings_.seek(frame, features, archive, parameters_, parameters_.seek_radius_px,
                  parameters_.seek_landmarks);
  if (place().seen.size() < parameters_.seek_found) {
    next_proposal();
    return true;
  }
  sightings_.observe(archive.library());
  search_ = PoseSearch<float>();
  stage_ = Stage::kSampling;
  return true;
}

/// P3P over what was found, as many samples as the frame's work affords.
template <class Config>
void PlaceSearch<Config>::sample_pose(FrameContext& frame) {
  constexpr int kSamples = 12;
  PoseRansacOptions<float> options = parameters_.recogniser.ransac;
  options.min_inliers = parameters_.seek_found;
  options.max_hypotheses = parameters_.seek_samples;
  const PoseObservation<float>* observations = sightings_.observations();
  const int count = place().seen.size();
  const int conclusion = 2 * Sightings::refinement_work(count);
  const int most = Recogniser::pose_work(kSamples, 4 * kSamples, count) + conclusion;
  bool done = false;
  while (!done && frame.work.affords(most)) {
    const int samples = search_.hypotheses;
    const int poses = search_.poses;
    if (!ok(search_pose(frame.camera, observations, count, options, kSamples, frame.random, search_,
                        done))) {
      return next_proposal();
    }
    frame.work.spend(
        Recogniser::pose_work(search_.hypotheses - samples, search_.poses - poses, count));
  }
  if (!done) return;
  frame.work.spend(conclusion);
  Rigid<float> T_map_camera;
  PoseEstimate<float> estimate;
  PoseRansacReport<float> report;
  if (!ok(finish_pose(frame.camera, observations, count, options, search_, T_map_camera, estimate,
                      report))) {
    return next_proposal();
  }
  begin_looks(T_map_camera);
}

/// A pose is to be confirmed by the next images.
template <class Config>
void PlaceSearch<Config>::begin_looks(const Rigid<float>& T_map_camera) {
  sightings_.move_to(T_map_camera);
  stage_ = Stage::kFound;
  looks_ = confirmed_ = 0;
}

/// A pose proposed is confirmed by the present image: true for the last one that it takes.
template <class Config>
bool PlaceSearch<Config>::confirm(FrameContext& frame, const Features& features,
                                  const Archive& archive, const Rigid<float>& T_camera_world) {
  const int radius = looks_ == 0 ? parameters_.wide_radius_px : 2 * parameters_.narrow_radius_px;
  if (!frame.work.affords(Sightings::look_work(radius))) return false;
  sightings_.move_to(place().T_map_camera * T_camera_world_ * T_camera_world.inverse());
  T_camera_world_ = T_camera_world;
  const float evidence = sightings_.look(frame, features, archive, parameters_, radius);
  ++looks_;
  if (evidence >= parameters_.evidence && sightings_.pose_is_sure(archive.library(), parameters_)) {
    ++confirmed_;
  }
  if (evidence < parameters_.least_evidence || looks_ == kMostLooks) {
    ++frame.health.false_relocalisations_refused;
    next_proposal();
    return false;
  }
  if (confirmed_ < parameters_.confirmations) return false;
  stage_ = Stage::kIdle;
  return true;
}

}  // namespace cairn
