#pragma once

#include "cairn/runtime/frame_tracker.hpp"

namespace cairn {

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::initialise(const PinholeCamera<float>& camera,
                                                const Rigid<float>& T_vehicle_camera,
                                                const Start& start, const Parameters& parameters) {
  Status status = FrameInput::check_camera(camera, Config::kMaxImageWidth, Config::kMaxImageHeight);
  if (ok(status)) status = validate_mounting(T_vehicle_camera);
  if (ok(status)) status = parameters.validate();
  if (!ok(status)) return status;
  status = estimate_.initialise(camera, T_vehicle_camera, start.pose, start.covariance,
                                parameters.filter, parameters.sigma_px, parameters.floor);
  if (!ok(status)) return status;
  measurement_.reset(parameters.measurement);
  monitor_.reset(parameters.monitor);
  local_map_.reset(parameters.local_map, parameters.measurement.search);
  map_reuse_.reset(parameters.map_reuse, parameters.measurement.search, start.covariance);
  systematic_ = parameters.systematic;
  start_ = start.pose.position;
  odometry_.reset(parameters.odometry, parameters.max_step_us, start.t_us);
  input_.reset(parameters.max_step_us);
  clock_.reset(parameters.max_step_us);
  repeated_.reset();
  mount_check_.reset(camera, T_vehicle_camera, parameters.sigma_px);
  yaw_check_.reset(camera, T_vehicle_camera);
  work_.reset(parameters.work_limit, parameters.max_frames_without_mapping);
  random_ = Random(parameters.seed);
  health_ = Health{};
  thin_map_ = false;
  unseen_yaw_ = 0.0F;
  return Status::kOk;
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::add_odometry(const OdometrySample& sample) {
  if (!input_.initialised()) return Status::kNotInitialised;
  const Status believed = clock_.take(InputClock::Source::kOdometry, sample.t_us);
  if (!ok(believed)) {
    ++health_.time_errors;
    return believed;
  }
  if (clock_.was_set_back()) restart_clock(sample.t_us);
  return odometry_.add(sample, estimate_.filter(), health_);
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::restart_clock(std::int64_t t_us) {
  static_cast<void>(odometry_.restart_clock(t_us, estimate_.filter()));
  input_.restart_clock();
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::process_frame(const ImageView& image, std::int64_t t_us,
                                                   const TickSource& ticks, Map& map,
                                                   FrameReport& report) {
  const Status accepted = input_.check(image, camera(), t_us, clock_, health_);
  if (!ok(accepted)) return accepted;
  if (clock_.was_set_back()) restart_clock(t_us);
  report = FrameReport{};
  report.t_us = t_us;
  Frame frame({image, camera(), work_, random_, report, health_}, map, scratch_);
  StageTimer timer(ticks, report);
  Status status = predict(t_us);
  timer.end(Stage::kPosePrediction);
  begin(image);
  // Compressed video of a vehicle at rest repeats its bytes too: the filter knows that as rest.
  const bool repeated = repeated_.take(image) && !odometry_.at_rest();
  timer.end(Stage::kPreprocess);
  if (repeated) {
    status = pass_over(status);
  } else {
    measure(frame);
    timer.end(Stage::kFeatures);
    status = update(frame, status);
    status = keep_map(frame, status);
    check_mount(frame);
    check_yaw(image);
    health_.ground_suspicions += ground().suspect() ? 1 : 0;
    const bool seen = monitor_.holds(measurement_.counts());
    unseen_yaw_ = seen ? 0.0F : unseen_yaw_ + odometry_.yaw_variance();
    odometry_.forget_yaw();
    status = monitor_.judge(measurement_.counts(), status, health_);
  }
  this->report(status, report);
  timer.end(Stage::kPoseUpdate);
  return status;
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::begin(const ImageView& image) {
  local_map_.begin_frame(image, frame_step_s_);
  measurement_.begin();
  const int recentring = estimate_.recentre();
  work_.begin(work::kFrame + work::kYawCheck + recentring +
              work::repeated_image(image.width, image.height) +
              estimate_.projection_work() * estimate_.size());
  map_reuse_.begin_frame(thin_map_ ? 0 : monitor_.weak_frames());
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::predict(std::int64_t t_us) {
  const Status status = odometry_.integrate_to(t_us, estimate_.filter(), health_);
  const FrameStep step = input_.accept(t_us, health_);
  frame_step_s_ = step.seconds();
  monitor_.begin_frame(step.seconds_of_a_frame());
  static_cast<void>(estimate_.filter().predict_tilt(frame_step_s_));
  monitor_.note_blind_frames(step.missed);
  if (!step.gap) return status;
  local_map_.drop_seeds();
  return ok(status) ? Status::kTimeGap : status;
}

/// The picture is the one before: odometry alone has moved the vehicle, and the map stays.
template <class Config, class Filter>
Status FrameTracker<Config, Filter>::pass_over(Status status) {
  ++health_.repeated_images;
  monitor_.note_blind_frames(1);
  if (state() == TrackingState::kLost) return Status::kLost;
  return ok(status) ? Status::kRepeatedImage : status;
}

/// Searches are paid for with what is left when the update and a step of the relocalisation are.
/// Without an update they are in vain.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::measure(Frame& frame) {
  const bool relocalises = this->relocalises();
  const int planned = planned_searches();
  const int landmarks = estimate_.size();
  const bool updates = work_.affords(estimate_.update_work(estimate_.min_inliers()));
  const int most = planned < landmarks ? planned : landmarks;
  const int update_work =
      estimate_.update_work(most) + (unsure() ? Estimate::agreement_work(most) : 0);
  const int units =
      updates ? work_.for_searches(relocalises ? map_reuse_.next_work() : 0, update_work) : 0;
  measurement_.search(frame, estimate_, estimate_.landmarks(), SearchPass::kAll,
                      SearchOrder::kMostUncertain, planned, units, scratch_.search);
}

/// While the place is recognised, that work takes the place of searches.
template <class Config, class Filter>
int FrameTracker<Config, Filter>::planned_searches() const {
  if (map_reuse_.takes_image()) return 0;
  const int most = measurement_.parameters().max_searches;
  return relocalises() ? most / 2 : most;
}

template <class Config, class Filter>
bool FrameTracker<Config, Filter>::relocalises() const {
  return !thin_map_ && map_reuse_.relocalises(monitor_.weak_frames());
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::update(Frame& frame, Status status) {
  typename Measurement::Matches& matches = measurement_.matches();
  const bool thin = thin_map_ && local_map_.is_thin(measurement_.counts().searched);
  if (!matches.empty() && (unsure() || monitor_.enough_matches(measurement_.counts(), thin))) {
    const PlanarPose<float> predicted = filter().mean_pose();
    const PixelUpdate update =
        unsure() ? update_unsure(frame, matches) : estimate_.update(frame, matches, min_inliers());
    measurement_.note_update(update);
    if (monitor_.holds(measurement_.counts())) note_correction(predicted);
    frame.report.update = update.report;
    if (ok(status)) status = update.status;
  }
  note_matches(frame, matches);
  return status;
}

template <class Config, class Filter>
int FrameTracker<Config, Filter>::min_inliers() const {
  return monitor_.min_inliers(measurement_.counts(), estimate_.min_inliers());
}

/// Tells odometry how far the image moved the pose along its heading. Where the pose was not known
/// before, that says nothing about the wheels.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::note_correction(const PlanarPose<float>& predicted) {
  const Rigid<float> corrected = estimate_.T_world_vehicle();
  const Vector3<float> ahead = corrected.rotation * Vector3<float>::UnitX();
  const float x_m = corrected.translation.x() - predicted.position.x();
  const float y_m = corrected.translation.y() - predicted.position.y();
  const bool known = monitor_.state() == TrackingState::kTracking;
  const bool sure = known && measurement_.counts().inliers >= 2 * monitor_.parameters().min_inliers;
  const float turn_rad = wrap_angle(filter().mean_pose().heading - predicted.heading);
  const float ahead_m = known ? ahead.x() * x_m + ahead.y() * y_m : 0.0F;
  if (known) estimate_.check_ground(odometry_.speed_mps() * frame_step_s_, ahead_m);
  odometry_.note_image_update(ahead_m, known ? turn_rad : 0.0F, frame_step_s_, sure);
}

/// Grows the map while the pose holds, recognises the place while it does not. A place that the
/// library does not have is mapped from odometry's pose, and so is one where the map has too few
/// landmarks in view to say anything, until tracking is lost.
template <class Config, class Filter>
Status FrameTracker<Config, Filter>::keep_map(Frame& frame, Status status) {
  const Library* library = frame.map.exchange.acquire();
  const bool known =
      monitor_.holds(measurement_.counts()) || state() == TrackingState::kInitialising;
  const bool usable = map_reuse_.usable(library);
  // A frame whose image is captured searches nothing, and says nothing about the map.
  thin_map_ = !known && !unsure() && state() != TrackingState::kLost && !map_reuse_.takes_image() &&
              measurement_.counts().could_search &&
              local_map_.is_thin(measurement_.counts().searched);
  if (known || thin_map_) local_map_.remove_unreliable(frame, estimate_, map_reuse_.archive());
  if (known) {
    map_reuse_.end_relocalisation();
  } else if (relocalises()) {
    local_map_.drop_seeds();
    status = relocalise(frame, *library, status);
  }
  const bool anew = !usable || map_reuse_.place_unknown();
  if (anew && !known) monitor_.forget_mean();
  const bool given_up = map_reuse_.place_unknown() || state() == TrackingState::kLost;
  if (anew && given_up && !known && unsure()) begin_anew(frame);
  const bool growing = known || thin_map_ || monitor_.holds(measurement_.counts()) || anew;
  local_map_.follow(frame, estimate_, motion(), growing);
  if (known && usable) map_reuse_.reactivate(frame, estimate_, *library);
  if (library != nullptr) frame.map.exchange.release();
  return status;
}

/// All matches count, not the filter's inliers alone: it takes those that fit the assumed mount.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::check_mount(Frame& frame) {
  if (!odometry_.known()) return;
  const typename Measurement::Matches& matches = measurement_.matches();
  const Vector2<float> tilt = estimate_.tilt_noise(frame_step_s_);
  const OdometryStep step = {odometry_.path(), odometry_.yaw_variance(),
                             tilt.x() > tilt.y() ? tilt.x() : tilt.y(), frame_step_s_};
  const bool paid = frame.work.take(work::kMountCheck);
  mount_check_.add(camera(), step, matches.data(), paid ? matches.size() : 0);
  frame.health.mount_suspicions += mount_offset().any_suspect() ? 1 : 0;
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::relocalise(Frame& frame, const Library& library,
                                                Status status) {
  const PlaceVerification place =
      map_reuse_.relocalise(frame, estimate_, local_map_, monitor_, library, unsure());
  if (!place.updated) return status;
  measurement_.replace(place.matches, place.update);
  if (place.matches > 0) frame.report.update = place.update.report;
  if (place.confirmed) {
    note_matches(frame, scratch_.expected.matches);
    monitor_.forget_mean();
  }
  return place.update.status;
}

template <class Config, class Filter>
VehicleMotion FrameTracker<Config, Filter>::motion() const {
  return {odometry_.speed_mps(), frame_step_s_, odometry_.yaw_variance(),
          monitor_.state() == TrackingState::kTracking, odometry_.turn_over(frame_step_s_)};
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::note_matches(Frame& frame,
                                                const typename Measurement::Matches& matches) {
  if (!monitor_.holds(measurement_.counts()) && state() != TrackingState::kInitialising &&
      !local_map_.is_thin(measurement_.counts().searched)) {
    Measurement::forget_searches(estimate_.landmarks());
    return;
  }
  for (const PixelMatch<float>& match : matches) {
    if (match.inlier) note_inlier(frame, match);
  }
}

/// Records the match. A landmark of the library gets its patch, one on the floor its height, and
/// one that has become mature its place in the library.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::note_inlier(Frame& frame, const PixelMatch<float>& match) {
  TrackedLandmark* landmark = estimate_.landmarks().find(match.id);
  if (landmark == nullptr) return;
  Measurement::note_inlier(*landmark, frame.report);
  if (estimate_.take_patch(frame, *landmark, match.pixel) && landmark->measured == 1) {
    map_reuse_.archive().report_found(frame, match.id);
  }
  estimate_.check_ground(frame, *landmark);
  estimate_.constrain_to_floor(frame, *landmark);
  map_reuse_.archive().archive_mature(frame, estimate_, *landmark);
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::report(Status status, FrameReport& report) {
  if (monitor_.holds(measurement_.counts()))
    map_reuse_.archive().note_tracked(filter().pose_covariance());
  map_reuse_.archive().policy().travel(abs(odometry_.speed_mps()) * frame_step_s_, next_id());
  report.status = status;
  report.state = state();
  report.not_tracked = why_not_tracked(status);
  report.T_world_camera = T_world_camera();
  report.T_map_camera = map_reuse_.archive().T_map_camera(estimate_);
  measurement_.report(report);
  report.landmarks = estimate_.size();
  work_.end(measurement_.deferred(), report, health_);
}

template <class Config, class Filter>
NotTracked FrameTracker<Config, Filter>::why_not_tracked(Status status) const {
  const MeasurementCounts& counts = measurement_.counts();
  if (monitor_.holds(counts)) return NotTracked::kTracked;
  if (!odometry_.known()) return NotTracked::kNoOdometry;
  if (status == Status::kRepeatedImage) return NotTracked::kNoNewImage;
  if (!counts.could_search) return NotTracked::kNoWork;
  if (counts.searched < monitor_.parameters().min_inliers) return local_map_.shortage();
  const bool found =
      counts.matches >= monitor_.parameters().min_inliers && monitor_.enough_matches(counts);
  return found ? NotTracked::kNoConsensus : NotTracked::kNotFound;
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::hash(Hash64& hash) const {
  filter().hash(hash);
  hash.add(static_cast<std::uint8_t>(state()));
  hash.add(health_.landmarks_added);
  hash.add(health_.landmarks_removed);
  hash.add(static_cast<std::int32_t>(local_map_.seeds().size()));
  estimate_.landmarks().hash(hash);
}

}  // namespace cairn
