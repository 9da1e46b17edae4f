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
  features_.reset(scaled.features);
  memory_.reset(scaled.memory);
  motion_.reset();
  shutter_.reset(parameters.readout, camera.width, camera.height);
  shutter_before_ = shutter_;
  gyro_.reset(parameters.gyro);
  rotation_.reset(parameters.rotation);
  input_.reset(parameters.max_step_us);
  repeated_.reset();
  clock_.reset(kStepsOfClock * parameters.max_step_us);
  work_.reset(parameters.work_limit, 0);
  random_ = Random(parameters.seed);
  health_ = Health{};
  next_id_ = 1;
  state_ = TrackingState::kInitialising;
  T_camera_world_ = Rigid<float>();
  note_pose();
  frame_covariance_.setZero();
  covariance_.setZero();
  for (Matrix3<float>& attitude : attitude_) attitude.setZero();
  lost_attitude_.setZero();
  blind_s_ = blind_variance_ = typical_inverse_depth_ = astray_s_ = 0.0F;
  astray_ = returned_ = takes_points_ = false;
  inliers_ = weak_frames_ = since_keyframe_ = frames_without_step_ = keyframe_work_ = 0;
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
    rotation_.take(frame);
    const FrameStep step = input_.accept(t_us, health_);
    note_gyro_frame(step, t_us);
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
  report.T_world_camera = T_camera_world_.inverse();
  report.T_map_camera = report.T_world_camera;
  report.landmarks = features_.size();
  work_.end(0, report, health_);
  return status;
}

template <class Config>
Status WindowTracker<Config>::track(FrameContext& frame, const FrameStep& step, StageTimer& timer) {
  pose_age_s_ += step.seconds();
  unseen_s_ += step.seconds();
  gap_ = gap_ || step.gap;
  const Rigid<float> predicted = predict(frame, step);
  if (shutter_.used()) frame.work.spend(work::rolling_shutter(features_.size()));
  timer.end(Stage::kPosePrediction);
  takes_points_ = takes_points(frame);
  find_features(frame, step, predicted);
  timer.end(Stage::kFeatures);
  Rigid<float> pose;
  const int found = features_.found();
  inliers_ = estimate(frame, predicted, pose);
  frame.report.matches = found;
  const float least = parameters_.min_inlier_share * static_cast<float>(found);
  ++since_keyframe_;
  Status status = step.gap ? Status::kTimeGap : Status::kOk;
  const bool holds = inliers_ >= least_inliers() && static_cast<float>(inliers_) >= least;
  if (holds) {
    frame.report.inliers = inliers_;
    compare_gyro(predicted, pose);
    accept(frame, pose);
    drop_missed(frame, pose);
    if (!takes_points_) keep_keyframes(frame);
    state_ = depths_hold() && !astray_ ? TrackingState::kTracking : TrackingState::kUncertain;
  } else {
    status = found < parameters_.min_inliers ? Status::kLowTexture : Status::kNoConsensus;
    if (found < parameters_.min_inliers) ++health_.low_texture_frames;
    drop_missed(frame, predicted);
    gyro_.note_weak();
    if (gyro_.predicts()) {
      T_camera_world_ = predicted;
      pose_age_s_ = 0.0F;
    }
    note_weak(frame);
    if (state_ != TrackingState::kLost && gyro_.sure()) bridge(frame);
    if (state_ == TrackingState::kLost) status = Status::kLost;
  }
  seek_map(frame, step, holds);
  improve_window(frame);
  if (holds) keep_memory(frame);
  update_covariance();
  timer.end(Stage::kPoseUpdate);
  return status;
}

/// With constant velocity and rate; where the whole picture turned otherwise, with its rotation. A
/// gyroscope that agrees with the pictures takes the place of both, one that is not proven yet that
/// of the constant rate.
template <class Config>
Rigid<float> WindowTracker<Config>::predict(FrameContext& frame, const FrameStep& step) {
  const float dt_s = static_cast<float>(step.us) * 1e-6F;
  if (step.gap) motion_.forget();
  if (gyro_.sure()) return motion_.predict_turned(T_camera_world_, gyro_.turn().rotation, dt_s);
  const bool by_gyro = gyro_.predicts() && !step.gap && step.us > 0;
  const Vector3<float> rate =
      by_gyro ? Vector3<float>(gyro_.turn().rotation / dt_s) : motion_.rate_radps();
  if (!step.gap && rotation_.seek(frame, rate, motion_.speed(), expected_inverse_depth(), dt_s)) {
    return motion_.predict_turned(T_camera_world_, rotation_.rotation(), dt_s);
  }
  if (by_gyro) return motion_.predict_turned(T_camera_world_, gyro_.turn().rotation, dt_s);
  return motion_.predict(T_camera_world_, dt_s);
}

/// From where the camera is predicted and, unless nearly all agree on that, from where it was; the
/// start with more inliers counts.
template <class Config>
int WindowTracker<Config>::estimate(FrameContext& frame, const Rigid<float>& predicted,
                                    Rigid<float>& pose) {
  const WindowPoseOptions<float> options = pose_options(predicted);
  const int found = gather(predicted);
  frame.work.spend(work::window_pose(found));
  pose = predicted;
  Matrix<float, 6, 6> covariance = Matrix<float, 6, 6>::Zero();
  guided_information_ = options.attitude_information;
  const int inliers = estimate_window_pose(sightings_, found, options, pose, covariance);
  if (inliers >= 0) frame_covariance_ = covariance;
  if (inliers >= parameters_.min_inliers && 10 * inliers >= 9 * found) return inliers;
  frame.work.spend(work::window_pose(found));
  bool inlier[kMaxFeatures];
  for (int i = 0; i < found; ++i) inlier[i] = sightings_[i].inlier;
  Rigid<float> standing = T_camera_world_;
  if (gyro_.predicts()) standing = motion_.turned(T_camera_world_, gyro_.turn().rotation);
  const int from_standing = estimate_window_pose(sightings_, found, options, standing, covariance);
  if (from_standing > inliers) {
    pose = standing;
    frame_covariance_ = covariance;
    return from_standing;
  }
  for (int i = 0; i < found; ++i) sightings_[i].inlier = inlier[i];
  return inliers;
}

/// T_camera_world_ is that of the present frame.
template <class Config>
void WindowTracker<Config>::note_pose() {
  pose_age_s_ = unseen_s_ = 0.0F;
  gap_ = false;
}

template <class Config>
void WindowTracker<Config>::accept(FrameContext& frame, const Rigid<float>& pose) {
  const int found = features_.found();
  for (int k = 0; k < found; ++k) {
    WindowFeature& feature = features_[sighted_[k]];
    if (sightings_[k].inlier) {
      feature.outliers = 0;
      frame.report.from_library += feature.from_library ? 1 : 0;
      ++health_.innovations_used;
    } else {
      ++health_.innovations_gated;
      ++frame.report.update.gated;
      ++feature.outliers;
    }
  }
  expose(pose);
  if (shutter_.used() && since_keyframe_ == 1) amend_keyframe(shutter_before_.with_next(shutter_));
  shutter_before_ = shutter_;
  motion_.note(T_camera_world_, pose, gap_ ? 0.0F : pose_age_s_);
  T_camera_world_ = pose;
  note_pose();
  weak_frames_ = 0;
  blind_s_ = blind_variance_ = 0.0F;
}

/// A keyframe seeks new landmarks in as many cells as the frame's work affords. Where those would
/// be too few, the next frame makes it, and searches less for it.
template <class Config>
void WindowTracker<Config>::keep_keyframes(FrameContext& frame) {
  const ViewChange change = view_change();
  const bool due = keyframe_work_ > 0;
  if (!due && !wants_keyframe(change)) return;
  const int least = work::kWindowNewest + features_.new_work(frame) / kLeastKeyframe;
  if (!due && !frame.work.affords(least)) {
    keyframe_work_ = least;
    frame.work.raise_cut(FrameCut::kNoMapping);
    return;
  }
  static_cast<void>(make_keyframe(frame, change.parallax > parameters_.standing_px));
}

template <class Config>
void WindowTracker<Config>::remove(FrameContext& frame, int i) {
  if (!astray_) memory_.renew_depth(frame, window_, features_[i], parameters_.window.sigma);
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
    const bool kept = feature.found ? feature.outliers < most
                                    : features_.miss(frame, i, expected_pixel(feature, pose));
    if (!kept) remove(frame, i);
  }
}

/// How the view changed since the newest keyframe, over the landmarks that it and the frame see.
template <class Config>
typename WindowTracker<Config>::ViewChange WindowTracker<Config>::view_change() const {
  const Quaternion<float> turned =
      T_camera_world_.rotation * window_.newest_pose().rotation.conjugate();
  const Matrix3<float> rotation = turned.toRotationMatrix();
  ViewChange change;
  for (int i = 0; i < features_.size(); ++i) {
    if (!features_[i].found) continue;
    ++change.found;
    Vector2<float> before;
    if (!window_.newest_sees(features_[i].slot, before)) continue;
    const Vector3<float> p = rotation * Vector3<float>(before.x(), before.y(), 1.0F);
    if (!(p.z() > 0.0F)) continue;
    const Vector2<float> seen = seen_direction(features_[i], T_camera_world_);
    change.flow += sqrt((seen - before).squaredNorm());
    change.parallax += sqrt((seen - Vector2<float>(p.x(), p.y()) / p.z()).squaredNorm());
    ++change.common;
  }
  if (change.common > 0) {
    const float share = camera_.fx / static_cast<float>(change.common);
    change.flow *= share;
    change.parallax *= share;
  }
  return change;
}

template <class Config>
bool WindowTracker<Config>::wants_keyframe(const ViewChange& change) const {
  if (since_keyframe_ < 2) return false;
  const float least = parameters_.keyframe_share * static_cast<float>(at_keyframe_);
  return change.parallax > parameters_.keyframe_parallax_px || 2 * change.common < change.found ||
         static_cast<float>(change.found) < least ||
         (since_keyframe_ >= parameters_.keyframe_frames && change.flow > parameters_.standing_px);
}

}  // namespace cairn
