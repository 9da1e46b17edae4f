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
  doubt_.reset(camera, T_vehicle_camera, parameters.sigma_px);
  work_.reset(parameters.work_limit, parameters.max_frames_without_mapping);
  random_ = Random(parameters.seed);
  health_ = Health{};
  thin_map_ = false;
  return Status::kOk;
}

template <class Config, class Filter>
Status FrameTracker<Config, Filter>::add_odometry(const OdometrySample& sample) {
  if (!input_.initialised()) return Status::kNotInitialised;
  const Status reading = OdometryIntegrator::check_reading(sample, health_);
  if (!ok(reading)) return reading;  // what is not taken says nothing of the clock
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
    const typename Measurement::Matches& matches = measurement_.matches();
    doubt_.compare(frame, odometry_, estimate_.tilt_noise(frame_step_s_), frame_step_s_,
                   matches.data(), matches.size());
    health_.ground_suspicions += ground().suspect() ? 1 : 0;
    doubt_.note_pose(monitor_.holds(measurement_.counts()), odometry_.yaw_variance());
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
  PictureDrift().add_to(estimate_.filter(), abs(odometry_.speed_mps()) * frame_step_s_, camera().fx,
                        measurement_.counts().inliers);
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
  // While the place is recognised, that work takes the place of searches.
  const int max_searches = measurement_.parameters().max_searches;
  const int planned =
      map_reuse_.takes_image() ? 0 : (relocalises ? max_searches / 2 : max_searches);
  const int landmarks = estimate_.size();
  const bool updates = work_.affords(estimate_.update_work(estimate_.min_inliers()));
  const int most = planned < landmarks ? planned : landmarks;
  const int update_work =
      estimate_.update_work(most) + (unsure() ? Estimate::agreement_work(most) : 0);
  const int kept = relocalises ? map_reuse_.next_work() : 0;
  const int units = updates ? work_.for_searches(kept, update_work) : 0;
  const bool aside = unsure();
  const typename Estimate::Placement before =
      aside ? look_aside(estimate_, monitor_) : typename Estimate::Placement{};
  measurement_.search(frame, estimate_, estimate_.landmarks(), SearchPass::kAll,
                      SearchOrder::kMostUncertain, planned, units, scratch_.search);
  if (!aside) return;
  if (look_again(frame, estimate_, measurement_)) {
    // Here and not in a part of its own: the searches are the deepest path of the stack.
    measurement_.search_again(frame, estimate_, estimate_.landmarks(),
                              work_.for_searches(kept, update_work), scratch_.search);
    frame.agrees = confirm(frame, estimate_, measurement_, monitor_);
  }
  estimate_.filter().put_back(before);
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
    const PixelUpdate update = update_estimate(frame, matches);
    measurement_.note_update(update);
    if (monitor_.holds(measurement_.counts())) note_correction(predicted);
    frame.report.update = update.report;
    if (ok(status)) status = update.status;
  }
  note_matches(frame, matches);
  return status;
}

template <class Config, class Filter>
PixelUpdate FrameTracker<Config, Filter>::update_estimate(Frame& frame,
                                                          typename Measurement::Matches& matches) {
  if (unsure()) return update_unsure(frame, estimate_, measurement_, monitor_);
  return estimate_.update(frame, matches,
                          monitor_.min_inliers(measurement_.counts(), estimate_.min_inliers()));
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
  thin_map_ = !known && !unsure() && !map_reuse_.looked() && state() != TrackingState::kLost &&
              !map_reuse_.takes_image() && measurement_.counts().could_search &&
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
  // Followed at rest, which nothing but its assumption says, seeds of a vehicle that moves already
  // would become landmarks at wrong places.
  if (!odometry_.begun()) local_map_.drop_seeds();
  const bool growing = known || thin_map_ || monitor_.holds(measurement_.counts()) || anew;
  const VehicleMotion motion = {odometry_.speed_mps(), frame_step_s_, odometry_.yaw_variance(),
                                measurement_.counts().inliers, odometry_.turn_over(frame_step_s_)};
  local_map_.follow(frame, estimate_, motion, growing);
  if (known && usable) map_reuse_.reactivate(frame, estimate_, *library);
  if (library != nullptr) frame.map.exchange.release();
  return status;
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
    odometry_.note_placed_pose();
    note_matches(frame, scratch_.expected.matches);
    monitor_.forget_mean();
  }
  return place.update.status;
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
    if (match.inlier) map_reuse_.archive().note_inlier(frame, estimate_, match);
  }
}

template <class Config, class Filter>
void FrameTracker<Config, Filter>::report(Status status, FrameReport& report) {
  if (monitor_.holds(measurement_.counts())) map_reuse_.archive().note_tracked(estimate_);
  map_reuse_.archive().policy().travel(abs(odometry_.speed_mps()) * frame_step_s_, next_id());
  report.status = status;
  report.state = state();
  report.not_tracked = monitor_.why_not_tracked(measurement_.counts(), local_map_.shortage());
  if (report.not_tracked != NotTracked::kTracked) {
    if (status == Status::kRepeatedImage) report.not_tracked = NotTracked::kNoNewImage;
    if (!odometry_.known()) report.not_tracked = NotTracked::kNoOdometry;
  }
  report.T_world_camera = T_world_camera();
  report.T_map_camera = map_reuse_.archive().T_map_camera(estimate_);
  measurement_.report(report);
  report.landmarks = estimate_.size();
  work_.end(measurement_.deferred(), report, health_);
}

/// Where inputs are in doubt, the camera's height among them, or the body tilts too far, the
/// landmarks' agreement does not make the pose known.
template <class Config, class Filter>
TrackingState FrameTracker<Config, Filter>::state() const {
  const TrackingState state = monitor_.state();
  const bool doubted =
      doubt_.contradicts(odometry_) || ground().suspect() || estimate_.tilts_too_far();
  return state == TrackingState::kTracking && doubted ? TrackingState::kUncertain : state;
}

template <class Config, class Filter>
bool FrameTracker<Config, Filter>::unsure() const {
  return monitor_.state() != TrackingState::kInitialising &&
         doubt_.heading_unsure(odometry_.yaw_variance());
}

/// From odometry's pose, as unsure as it is. What was mapped before would be found in the new map's
/// place by chance; the library keeps it.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::begin_anew(Frame& frame) {
  local_map_.drop_seeds();
  for (int slot = estimate_.size() - 1; slot >= 0; --slot) {
    if (estimate_.landmarks().find(estimate_.id(slot)) == nullptr) continue;
    if (!frame.work.take(work::kRemoval)) return;
    estimate_.remove(frame, slot);
  }
  map_reuse_.end_relocalisation();
  monitor_.restart();
  doubt_.trust_pose();
  odometry_.forget_yaw();
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
