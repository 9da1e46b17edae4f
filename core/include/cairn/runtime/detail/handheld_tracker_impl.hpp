#pragma once

#include "cairn/runtime/handheld_tracker.hpp"

namespace cairn {

template <class Config>
Status HandheldTracker<Config>::initialise(const PinholeCamera<float>& camera,
                                           const Parameters& parameters) {
  Status status = FrameInput::check_camera(camera, Config::kMaxImageWidth, Config::kMaxImageHeight);
  if (ok(status)) status = parameters.validate();
  if (!ok(status)) return status;
  status = estimate_.initialise(camera, parameters.filter);
  if (!ok(status)) return status;
  camera_ = camera;
  measurement_.reset(parameters.measurement);
  monitor_.reset(parameters.monitor);
  local_map_.reset(parameters.local_map);
  start_.reset(parameters.start);
  motion_.reset(parameters.motion);
  rotation_.reset(parameters.rotation);
  map_reuse_.reset(parameters.map_reuse, parameters.measurement.search);
  input_.reset(parameters.max_step_us);
  repeated_.reset();
  clock_.reset(kStepsOfClock * parameters.max_step_us);
  work_.reset(parameters.work_limit, parameters.max_frames_without_mapping);
  random_ = Random(parameters.seed);
  health_ = Health{};
  return Status::kOk;
}

template <class Config>
Status HandheldTracker<Config>::load_map(const ByteSource& source, MapFileInfo& info) {
  if (!input_.initialised()) return Status::kNotInitialised;
  const Status status = cairn::load_map(source, map_reuse_.archive().library(), info);
  if (!ok(status)) return status;
  if (info.next_id > estimate_.next_id()) estimate_.next_id() = info.next_id;
  static_cast<void>(estimate_.restart(Rigid<float>()));
  map_reuse_.begin();
  start_.pass();
  monitor_.lose();
  return Status::kOk;
}

template <class Config>
Status HandheldTracker<Config>::process_frame(const ImageView& image, std::int64_t t_us,
                                              const TickSource& ticks, FrameReport& report) {
  const Status accepted = input_.check(image, camera_, t_us, clock_, health_);
  if (!ok(accepted)) return accepted;
  report = FrameReport{};
  report.t_us = t_us;
  Frame frame({image, camera_, work_, random_, report, health_}, scratch_);
  StageTimer timer(ticks, report);
  local_map_.begin_frame(image);
  measurement_.begin();
  work_.begin(work::kMonoFrame + work::repeated_image(image.width, image.height) +
              work::kProjection * estimate_.size());
  const bool repeated = repeated_.take(image);
  if (repeated && state() != TrackingState::kLost) {
    this->report(pass_over(), report);
    report.state = state();
    timer.end(Stage::kPreprocess);
    return report.status;
  }
  rotation_.take(frame);
  const FrameStep step = input_.accept(t_us, health_);
  timer.end(Stage::kPreprocess);
  const bool lost = state() == TrackingState::kLost;
  const Status status = lost ? relocalise(frame) : track(frame, step, timer);
  if (lost) timer.end(Stage::kFeatures);
  this->report(status, report);
  return status;
}

/// The pose of this picture is that of the one before; where the camera is now, it does not say.
template <class Config>
Status HandheldTracker<Config>::pass_over() {
  ++health_.repeated_images;
  monitor_.note_blind_frames(1);
  return Status::kRepeatedImage;
}

template <class Config>
Status HandheldTracker<Config>::track(Frame& frame, const FrameStep& step, StageTimer& timer) {
  Status status = predict(frame, step);
  timer.end(Stage::kPosePrediction);
  measure(frame, SearchPass::kAll);
  timer.end(Stage::kFeatures);
  status = update(frame, 0, status);
  measure_rest(frame);
  status = monitor_.judge(measurement_.counts(), status, health_);
  note_motion(step.us);
  keep_map(frame);
  frame.report.state = state();
  if (start_failed()) {
    frame.report.state = TrackingState::kLost;
    status = Status::kLost;
  }
  timer.end(Stage::kPoseUpdate);
  return status;
}

/// With constant velocity and rate; where the whole picture turned otherwise, with its rotation.
template <class Config>
Status HandheldTracker<Config>::predict(Frame& frame, const FrameStep& step) {
  if (step.us == 0) return Status::kOk;  // the first frame
  monitor_.begin_frame(step.seconds_of_a_frame());
  if (step.gap) monitor_.note_blind_frames(step.missed);
  Filter& filter = estimate_.filter();
  const float dt_s = static_cast<float>(step.us) * 1e-6F;
  const Vector3<float> rate = filter.rate_radps();
  const bool turned = !step.gap && rotation_.seek(frame, rate, filter.velocity_mps().norm(),
                                                  filter.typical_inverse_depth(), dt_s);
  if (turned) motion_.note_rate_change(rotation_.rotation() / dt_s - rate, dt_s);
  const Status set = filter.set_motion_noise(motion_.velocity_noise(), motion_.rate_noise());
  if (!ok(set)) return set;
  const Status predicted = filter.predict(dt_s);
  if (!ok(predicted)) return predicted;
  if (turned) {
    const Status observed =
        filter.observe_rotation(rotation_.rotation(), rotation_.sigma_rad(), dt_s);
    if (!ok(observed)) return observed;
  }
  return step.gap ? Status::kTimeGap : predicted;
}

template <class Config>
void HandheldTracker<Config>::note_motion(std::int64_t step_us) {
  if (monitor_.weak_frames() > 0) {
    if (measurement_.counts().could_search) motion_.note_weak();
  } else if (monitor_.holds(measurement_.counts())) {
    motion_.note(filter().velocity_mps(), filter().rate_radps(),
                 static_cast<float>(step_us) * 1e-6F);
  }
}

/// Where the frame's work does not suffice for all windows (after a fast movement), the best known
/// landmarks come first; the update with them makes the windows of the rest smaller. Without an
/// update, searches are in vain.
template <class Config>
void HandheldTracker<Config>::measure(Frame& frame, SearchPass pass) {
  const int left = estimate_.size() - measurement_.counts().searched;
  const SearchOrder order =
      pass == SearchPass::kAll ? SearchOrder::kBestKnown : SearchOrder::kMostUncertain;
  const bool updates = work_.affords(estimate_.update_work(monitor_.parameters().min_inliers));
  measurement_.search(
      frame, estimate_, estimate_.landmarks(), pass, order, measurement_.parameters().max_searches,
      updates ? work_.for_searches(0, estimate_.update_work(left)) : 0, scratch_.search);
}

/// With the matches from `first` on.
template <class Config>
Status HandheldTracker<Config>::update(Frame& frame, int first, Status status) {
  const bool usable = first > 0 || monitor_.enough_matches(measurement_.counts());
  const int matches = measurement_.matches().size() - first;
  const PixelUpdate update = estimate_.update(frame, measurement_.matches(), first, usable);
  measurement_.note_update(update);
  add(update.report, frame.report.update);
  note_matches(frame, first);
  const bool used = usable && matches > update.left_out;
  return used && first == 0 && ok(status) ? update.status : status;
}

/// Searches what the first pass could not pay for, once an update has made the windows smaller.
template <class Config>
void HandheldTracker<Config>::measure_rest(Frame& frame) {
  if (measurement_.not_searched() == 0 || !monitor_.holds(measurement_.counts())) return;
  const int first = measurement_.matches().size();
  measure(frame, SearchPass::kRest);
  static_cast<void>(update(frame, first, Status::kOk));
}

template <class Config>
void HandheldTracker<Config>::note_matches(Frame& frame, int first) {
  if (!monitor_.holds(measurement_.counts()) && state() != TrackingState::kInitialising) {
    Measurement::forget_searches(estimate_.landmarks());
    return;
  }
  const typename Measurement::Matches& matches = measurement_.matches();
  for (int i = first; i < matches.size(); ++i) {
    TrackedLandmark* landmark =
        matches[i].inlier ? estimate_.landmarks().find(matches[i].id) : nullptr;
    if (landmark != nullptr) Measurement::note_inlier(*landmark, frame.report);
  }
}

/// Nothing is archived before the start is accepted, because the map may still begin anew.
template <class Config>
void HandheldTracker<Config>::keep_map(Frame& frame) {
  if (state() == TrackingState::kLost) {
    map_reuse_.begin();
    return;
  }
  if (monitor_.weak_frames() == 0) {
    if (start_.over() && state() == TrackingState::kTracking) {
      map_reuse_.archive().archive_due(frame, estimate_, measurement_.matches());
    }
    local_map_.remove_unreliable(frame, estimate_, [&](int slot, TrackedLandmark& landmark) {
      if (start_.over()) map_reuse_.archive().archive(frame, estimate_, slot, landmark);
    });
  }
  if (monitor_.weak_frames() < local_map_.parameters().max_weak_frames) {
    static_cast<void>(local_map_.add_features(frame, estimate_));
  }
}

template <class Config>
bool HandheldTracker<Config>::start_failed() {
  if (!start_.fails(measurement_.counts(), filter().parameters().rescue_gate)) return false;
  if (!ok(estimate_.restart_moving(estimate_.T_world_camera()))) return false;
  start_.note_restart();
  monitor_.restart();
  ++health_.losses;
  return true;
}

template <class Config>
Status HandheldTracker<Config>::relocalise(Frame& frame) {
  frame.report.state = TrackingState::kLost;
  if (map_reuse_.library_too_small()) {
    begin_anew(frame);
    return Status::kLost;
  }
  int matches = 0;
  if (!map_reuse_.relocalise(frame, estimate_, matches)) return Status::kLost;
  PixelUpdate restarted;
  restarted.inliers = estimate_.size();
  measurement_.replace(matches, restarted);
  motion_.begin();
  monitor_.begin_probation();
  frame.report.state = state();
  frame.report.relocalised = true;
  ++health_.relocalisations;
  return Status::kOk;
}

/// A map too small to be recognised is given up, once there is something to see.
template <class Config>
void HandheldTracker<Config>::begin_anew(Frame& frame) {
  if (estimate_.size() > 0 && !ok(estimate_.restart(estimate_.T_world_camera()))) return;
  estimate_.landmarks().clear();
  map_reuse_.archive().library().clear();
  if (local_map_.add_features(frame, estimate_) == 0) return;
  monitor_.restart();
  start_.begin();
  motion_.begin();
}

template <class Config>
void HandheldTracker<Config>::report(Status status, FrameReport& report) {
  report.status = status;
  report.T_world_camera = estimate_.T_world_camera();
  report.T_map_camera = report.T_world_camera;
  measurement_.report(report);
  report.landmarks = estimate_.size();
  work_.end(measurement_.deferred(), report, health_);
}

template <class Config>
void HandheldTracker<Config>::hash(Hash64& hash) const {
  filter().hash(hash);
  hash.add(static_cast<std::uint8_t>(state()));
  hash.add(health_.landmarks_added);
  hash.add(health_.landmarks_removed);
  hash.add(static_cast<std::int32_t>(library().size()));
  hash.add(library().revision());
  estimate_.landmarks().hash(hash);
}

}  // namespace cairn
