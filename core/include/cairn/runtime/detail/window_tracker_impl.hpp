#pragma once

#include "cairn/runtime/window_tracker.hpp"

namespace cairn {

template <class Config>
Status WindowTracker<Config>::initialise(const PinholeCamera<float>& camera,
                                         const Parameters& parameters) {
  Status status = FrameInput::check_camera(camera, Config::kMaxImageWidth, Config::kMaxImageHeight);
  if (ok(status)) status = parameters.validate();
  if (ok(status)) status = parameters.readout.validate(camera.width, camera.height);
  if (!ok(status)) return status;
  Parameters scaled = parameters.scaled_to(camera.width, camera.height);
  scaled.window.sigma = scaled.sigma_px / camera.fx;
  if (camera.lens == Lens::kFisheye) scaled.window.focal_sigma = 0.0F;
  status = window_.initialise(scaled.window);
  if (!ok(status)) return status;
  parameters_ = scaled;
  told_ = camera_ = camera;
  track_.reset(scaled, scaled.window.first_inverse_depth, scaled.covariance_factor);
  features_.reset(scaled.features);
  measurement_.reset(scaled, scaled.readout, camera);
  choice_.reset(scaled);
  memory_.reset(scaled.memory);
  covariance_.reset(scaled);
  input_.reset(parameters.max_step_us);
  repeated_.reset();
  clock_.reset(kStepsOfClock * parameters.max_step_us);
  work_.reset(parameters.work_limit, 0);
  random_ = Random(parameters.seed);
  health_ = Health{};
  next_id_ = 1;
  state_ = TrackingState::kInitialising;
  takes_points_ = false;
  weak_frames_ = frames_without_step_ = 0;
  return Status::kOk;
}

template <class Config>
Status WindowTracker<Config>::process_frame(const ImageView& image, std::int64_t t_us,
                                            const TickSource& ticks, FrameReport& report) {
  const Status accepted = input_.check(image, camera_, t_us, clock_, health_);
  if (!ok(accepted)) return accepted;
  report = FrameReport{};
  report.t_us = t_us;
  FrameContext frame{image, camera_, work_, random_, report, health_};
  StageTimer timer(ticks, report);
  work_.begin(work::kWindowFrame + work::repeated_image(image.width, image.height) +
              work::shrunk_image(image.width, image.height));
  Status status = Status::kRepeatedImage;
  if (repeated_.take(image) && state_ != TrackingState::kLost) {
    ++health_.repeated_images;
    timer.end(Stage::kPreprocess);
  } else {
    features_.begin(image);
    const FrameStep step = input_.accept(t_us, health_);
    track_.take_frame(frame, t_us);
    covariance_.note_frame(step.seconds(), track_.gyro());
    timer.end(Stage::kPreprocess);
    if (window_.keyframes() == 0) {
      status = begin_anew(frame) ? Status::kOk : Status::kLowTexture;
      update_covariance();
      timer.end(Stage::kFeatures);
    } else {
      status = track(frame, step, timer);
    }
  }
  report.status = status;
  report.state = state_;
  if (status == Status::kRepeatedImage && state_ == TrackingState::kTracking) {
    report.state = TrackingState::kUncertain;
  }
  report.T_world_camera = track_.pose().inverse();
  report.T_map_camera = report.T_world_camera;
  report.landmarks = features_.size();
  work_.end(0, report, health_);
  return status;
}

template <class Config>
Status WindowTracker<Config>::track(FrameContext& frame, const FrameStep& step, StageTimer& timer) {
  track_.advance(step);
  const Rigid<float> predicted = track_.predict(frame, step);
  if (measurement_.exposures().used()) frame.work.spend(work::rolling_shutter(features_.size()));
  timer.end(Stage::kPosePrediction);
  const typename Measurement::Scene scene{frame, features_, window_, track_, step};
  takes_points_ = memory_.takes_points(frame, parameters_.astray_features, parameters_.features);
  measurement_.find(scene, predicted, search_limits(frame));
  timer.end(Stage::kFeatures);
  Rigid<float> pose;
  const bool holds = measurement_.estimate(scene, predicted, pose);
  const int found = features_.found();
  frame.report.matches = found;
  choice_.note_frame();
  Status status = step.gap ? Status::kTimeGap : Status::kOk;
  if (holds) {
    frame.report.inliers = measurement_.inliers();
    compare_gyro(predicted, pose);
    accept(frame, pose);
    drop_missed(frame, pose);
    if (!takes_points_) keep_keyframes(frame);
    const bool sure = measurement_.sure(features_, window_) && !memory_.astray();
    state_ = sure ? TrackingState::kTracking : TrackingState::kUncertain;
  } else {
    status = found < parameters_.min_inliers ? Status::kLowTexture : Status::kNoConsensus;
    if (found < parameters_.min_inliers) ++health_.low_texture_frames;
    drop_missed(frame, predicted);
    track_.note_weak();
    track_.drift_to(predicted);
    note_weak(frame);
    if (state_ == TrackingState::kLost) status = Status::kLost;
  }
  if (memory_.seek(frame, features_, track_.pose(), window_.keyframes() > 0,
                   holds ? step.seconds() : 0.0F, parameters_.forget_s)) {
    return_to_map(frame);
  }
  improve_window(frame);
  if (holds) {
    memory_.keep(frame, window_, features_, track_.pose(), track_.typical_inverse_depth());
  }
  update_covariance();
  timer.end(Stage::kPoseUpdate);
  return status;
}

template <class Config>
typename WindowTracker<Config>::Measurement::Limits WindowTracker<Config>::search_limits(
    const FrameContext& frame) const {
  const bool window_waits = window_.working() && frames_without_step_ >= kMostWithoutStep;
  const int keyframe = choice_.postponed_work();
  const int half = frame.work.left() / 2;
  typename Measurement::Limits limits;
  limits.features = takes_points_ ? parameters_.astray_features : features_.size();
  limits.work = (window_waits ? window_.step_work() : 0) + (keyframe < half ? keyframe : half);
  return limits;
}

/// Compares the gyroscope with the attitude by the landmarks alone.
template <class Config>
void WindowTracker<Config>::compare_gyro(const Rigid<float>& predicted, const Rigid<float>& pose) {
  Quaternion<float> R_camera_world;
  Matrix3<float> covariance;
  if (!track_.gyro().turn().known ||
      !measurement_.attitude_alone(predicted, pose, R_camera_world, covariance)) {
    return track_.note_weak();
  }
  SeenAttitude seen;
  seen.focal_sigma = window_.focal_sigma();
  seen.lens_sigma = parameters_.lens_sigma;
  seen.R_world_camera = R_camera_world.conjugate();
  seen.variance = square(parameters_.covariance_factor) * covariance.trace() / 3.0F;
  track_.note_attitude(seen);
}

template <class Config>
void WindowTracker<Config>::accept(FrameContext& frame, const Rigid<float>& pose) {
  measurement_.note_agreement(frame, features_);
  measurement_.expose(track_, pose);
  WindowExposures& exposures = measurement_.exposures();
  if (exposures.used() && choice_.follows_keyframe()) {
    exposures.amend_keyframe(camera_, features_, window_);
  }
  exposures.end_frame();
  track_.move_to(pose);
  covariance_.note_seen();
  weak_frames_ = 0;
}

/// After some weak frames tracking is lost: a new map begins. Before, and where a gyroscope and the
/// velocity before say where the camera is, a frame whose landmarks left the view, or are blurred,
/// becomes a keyframe: the next frame finds what this one shows. The gyroscope's turn ties it to
/// the others.
template <class Config>
void WindowTracker<Config>::note_weak(FrameContext& frame) {
  ++weak_frames_;
  if (!track_.gyro().sure()) track_.forget_motion();
  state_ = TrackingState::kUncertain;
  if (weak_frames_ <= parameters_.weak_frames && features_.size() >= parameters_.min_inliers) {
    if (!track_.gyro().sure() || takes_points_) return;
    const int least = work::kWindowNewest + features_.new_work(frame) / kLeastKeyframe;
    if (frame.work.affords(least)) static_cast<void>(make_keyframe(frame, true));
    return;
  }
  ++health_.losses;
  if (!memory_.astray()) {
    covariance_.note_loss(window_, track_.pose());
    for (int i = 0; i < features_.size(); ++i) memory_.renew_depth(frame, window_, features_[i]);
  }
  memory_.note_loss();
  state_ = TrackingState::kLost;
  features_.clear();
  window_.clear();
  if (frame.work.affords(work::kWindowNewest + features_.new_work(frame))) {
    static_cast<void>(begin_anew(frame));
  }
}

template <class Config>
void WindowTracker<Config>::remove(FrameContext& frame, int i) {
  memory_.renew_depth(frame, window_, features_[i]);
  window_.retire(features_[i].slot);
  features_.remove(i);
  ++frame.report.removed;
  ++health_.landmarks_removed;
}

/// Gives up what was missed too often, left the view, or does not agree.
template <class Config>
void WindowTracker<Config>::drop_missed(FrameContext& frame, const Rigid<float>& pose) {
  const int most = window_.settled() ? parameters_.max_outliers : 2 * parameters_.max_outliers;
  for (int i = features_.size() - 1; i >= 0; --i) {
    const WindowFeature& feature = features_[i];
    const bool kept = feature.found
                          ? feature.outliers < most
                          : features_.miss(frame, i,
                                           measurement_.exposures().expected_pixel(
                                               camera_, window_, feature, track_.pose(), pose));
    if (!kept) remove(frame, i);
  }
}

}  // namespace cairn
