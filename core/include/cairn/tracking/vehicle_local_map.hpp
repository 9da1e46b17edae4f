#pragma once

#include "cairn/tracking/seed_motion.hpp"
#include "cairn/tracking/seed_pool.hpp"
#include "cairn/tracking/start_heading.hpp"
#include "cairn/tracking/vehicle_estimate.hpp"
#include "cairn/tracking/vehicle_frame.hpp"
#include "cairn/tracking/vehicle_numbers.hpp"

namespace cairn {

/// Keeps the landmarks of a vehicle's filter: seeds at corners of keyframes, landmarks made of
/// those whose depth has converged, and the removal of what is not found again or in their way.
template <class Config, class Filter>
class VehicleLocalMap {
 public:
  static constexpr int kMaxLandmarks = Config::kMaxLandmarks;
  using Supply = FeatureSupply<Config::kMaxImageWidth>;
  using Seeds =
      SeedPool<Config::kMaxSeeds, Config::kMaxKeyframes,
               typename VehicleNumbers<Filter>::template SeedOdometry<Config::kMaxSeeds,
                                                                      Config::kMaxKeyframes>>;
  using Estimate = VehicleEstimate<Filter>;
  using Frame = VehicleFrame<Config>;

  struct Parameters {
    typename Supply::Parameters supply;
    SeedParameters seeds;
    SeedNoise seed_noise;
    int target_in_view = 32;  ///< landmarks and seeds wanted in view
    int max_new_seeds_per_frame = 6;
    float keyframe_interval_s = 0.25F;  ///< least time, or else
    float keyframe_distance_m = 0.5F;   ///< distance, between frames with new seeds
    int max_new_landmarks_per_frame = 4;
    float out_of_view_s = 0.5F;        ///< least time before a landmark makes room for a new one
    int min_sightings_to_archive = 6;  ///< of a landmark that leaves the filter

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = ok(supply.validate()) && ok(seeds.validate()) &&
                        ok(seed_noise.validate()) && target_in_view >= 0 &&
                        max_new_seeds_per_frame >= 0 && is_positive(keyframe_interval_s) &&
                        is_positive(keyframe_distance_m) && max_new_landmarks_per_frame >= 0 &&
                        is_positive(out_of_view_s) && min_sightings_to_archive >= 1;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  /// Starts anew. `search`: how seeds are searched.
  void reset(const Parameters& parameters, const SearchParameters& search) {
    parameters_ = parameters;
    parameters_.seeds.search = search.patch;
    seeds_.clear();
    supply_ = Supply{};
    keyframes_.clear();
    since_keyframe_s_ = parameters.keyframe_interval_s;
    since_keyframe_m_ = step_s_ = 0.0F;
  }
  /// `step_s`: since the frame before.
  void begin_frame(const ImageView& image, float step_s) {
    supply_.begin(image.width, image.height);
    step_s_ = step_s;
  }

  const Seeds& seeds() const { return seeds_; }
  void drop_seeds() { seeds_.clear(); }
  /// Whether `in_view` landmarks are so few that not finding them says little.
  bool is_thin(int in_view) const { return 3 * in_view <= parameters_.target_in_view; }
  /// Why the map has too few landmarks in view.
  NotTracked shortage() const {
    if (seeds_lost_) return NotTracked::kSeedsLost;
    return seeds_.size() > 0 ? NotTracked::kNoDepth : NotTracked::kNoCorners;
  }

  /// Removes landmarks that are rarely found where they are searched, and makes room for new ones.
  /// Those of the library are passed to archive.report_not_found(frame, id).
  template <class Archive>
  void remove_unreliable(Frame& frame, Estimate& estimate, Archive& archive);

  /// Keeps `reserve` slots of the filter free by removing at most `limit` landmarks, those longest
  /// out of view first: a map full of places passed would leave no room for what is in view.
  /// Landmarks seen often enough go to archive.archive(frame, estimate, slot, landmark).
  template <class Archive>
  void make_room(Frame& frame, Estimate& estimate, Archive& archive, int reserve, int limit);

  /// Follows the seeds into the frame, and while `growing` also makes landmarks of those that have
  /// converged and begins new ones.
  void follow(Frame& frame, Estimate& estimate, const VehicleMotion& motion, bool growing);

 private:
  static constexpr float kMinBaseline_m = 1e-3F;

  bool keyframe_is_due() const;
  void begin_seeds(Frame& frame, Estimate& estimate, const SeedParameters& seeds,
                   const VehicleMotion& motion);
  int occupy_view(const Estimate& estimate);
  void add_landmarks(Frame& frame, Estimate& estimate, const SeedParameters& seeds);
  bool add_landmark(Frame& frame, Estimate& estimate, const ConvergedSeed& seed);
  Matrix3<float> point_covariance(const Estimate& estimate, const ConvergedSeed& seed,
                                  float scale) const;
  bool begin_keyframe(Frame& frame, Estimate& estimate);
  void end_keyframes(Frame& frame, Estimate& estimate, bool make_room);

  Parameters parameters_;
  Seeds seeds_;
  Supply supply_;
  FixedVector<LandmarkId, Config::kMaxKeyframes> keyframes_;  ///< remembered positions
  float step_s_ = 0.0F;
  float since_keyframe_s_ = 0.0F;
  float since_keyframe_m_ = 0.0F;
  bool seeds_lost_ = false;  ///< most were not found in this frame
  StartHeading start_heading_;
};

template <class Config, class Filter>
template <class Archive>
void VehicleLocalMap<Config, Filter>::remove_unreliable(Frame& frame, Estimate& estimate,
                                                        Archive& archive) {
  for (int slot = estimate.size() - 1; slot >= 0; --slot) {
    const TrackedLandmark* landmark = estimate.landmarks().find(estimate.id(slot));
    if (landmark == nullptr) continue;
    const bool not_recognised =
        landmark->from_library && landmark->measured == 0 && landmark->predicted >= 4;
    const bool rarely_found =
        landmark->predicted >= 8 && 2 * landmark->measured < landmark->predicted;
    if (!not_recognised && !rarely_found) continue;
    if (!frame.work.take(work::kRemoval)) return;
    if (not_recognised) archive.report_not_found(frame, landmark->id);
    estimate.remove(frame, slot);
  }
  make_room(frame, estimate, archive, kMaxLandmarks / 6, parameters_.max_new_landmarks_per_frame);
}

template <class Config, class Filter>
template <class Archive>
void VehicleLocalMap<Config, Filter>::make_room(Frame& frame, Estimate& estimate, Archive& archive,
                                                int reserve, int limit) {
  for (int i = 0; i < limit; ++i) {
    if (estimate.size() + reserve <= kMaxLandmarks || !frame.work.take(work::kRemoval)) return;
    int longest = -1;
    int frames = step_s_ > 0.0F ? static_cast<int>(parameters_.out_of_view_s / step_s_) : 0;
    for (int slot = 0; slot < estimate.size(); ++slot) {
      const TrackedLandmark* landmark = estimate.landmarks().find(estimate.id(slot));
      if (landmark == nullptr || landmark->frames_out_of_view <= frames) continue;
      frames = landmark->frames_out_of_view;
      longest = slot;
    }
    if (longest < 0) return;
    const TrackedLandmark& leaving = *estimate.landmarks().find(estimate.id(longest));
    if (leaving.measured >= parameters_.min_sightings_to_archive) {
      archive.archive(frame, estimate, longest, leaving);
    }
    estimate.remove(frame, longest);
  }
}

template <class Config, class Filter>
void VehicleLocalMap<Config, Filter>::follow(Frame& frame, Estimate& estimate,
                                             const VehicleMotion& motion, bool growing) {
  const SeedParameters seeds =
      seeds_in_motion(parameters_.seeds, parameters_.seed_noise, estimate, motion);
  if (!frame.work.affords(seeds_.work_to_follow())) frame.work.cut_mapping();
  const int followed = seeds_.size();
  const int dropped =
      seeds_.follow(frame.image, frame.camera, VehicleNumbers<Filter>::T_world_camera(estimate),
                    seeds, frame.work.budget());
  frame.health.candidates_dropped += static_cast<std::uint32_t>(dropped);
  seeds_lost_ = 2 * seeds_.found() < followed;
  start_heading_.template take<VehicleNumbers<Filter>>(seeds_, keyframes_, estimate);
  if (growing) add_landmarks(frame, estimate, seeds);
  end_keyframes(frame, estimate, false);
  since_keyframe_s_ += motion.step_s;
  since_keyframe_m_ += abs(motion.speed_mps) * motion.step_s;
  if (growing) begin_seeds(frame, estimate, seeds, motion);
}

/// Marks where seeds and landmarks are seen; returns how many.
template <class Config, class Filter>
int VehicleLocalMap<Config, Filter>::occupy_view(const Estimate& estimate) {
  int in_view = seeds_.size();
  for (int i = 0; i < seeds_.size(); ++i) supply_.occupy(seeds_[i].pixel.x(), seeds_[i].pixel.y());
  const LandmarkSight<Estimate> sight(estimate);
  for (int slot = 0; slot < estimate.size(); ++slot) {
    int x = 0;
    int y = 0;
    if (!sight.see(slot, x, y)) continue;
    supply_.occupy_pixel(x, y);
    ++in_view;
  }
  return in_view;
}

template <class Config, class Filter>
bool VehicleLocalMap<Config, Filter>::keyframe_is_due() const {
  return since_keyframe_s_ >= parameters_.keyframe_interval_s ||
         since_keyframe_m_ >= parameters_.keyframe_distance_m;
}

template <class Config, class Filter>
void VehicleLocalMap<Config, Filter>::begin_seeds(Frame& frame, Estimate& estimate,
                                                  const SeedParameters& seeds,
                                                  const VehicleMotion& motion) {
  if (seeds_.full()) return;
  if (!frame.work.take(work::kKeyframe + work::kCellMotion * Supply::kCells +
                       estimate.projection_work() * estimate.size())) {
    frame.work.cut_mapping();
    return;
  }
  const int in_view = occupy_view(estimate);
  const bool few = 2 * in_view < parameters_.target_in_view;
  if (!(few && !keyframes_.full()) && !keyframe_is_due()) return;
  const int room = parameters_.target_in_view - in_view;
  const int most = room / 2 > parameters_.max_new_seeds_per_frame
                       ? room / 2
                       : parameters_.max_new_seeds_per_frame;
  const int limit = room < most ? room : most;
  if (limit <= 0) return;
  Corner corners[Supply::kCells];
  typename Supply::Parameters supply = parameters_.supply;
  if (few) supply.cells_per_frame *= 2;
  const Rigid<float> T_later_now =
      camera_after(motion, seeds.min_views - 1, estimate.T_vehicle_camera()).inverse();
  const typename VehicleNumbers<Filter>::StayingInView stays(frame.camera, T_later_now,
                                                             seeds.initial_depth_m);
  supply_.close_cells([&](const Vector2<float>& pixel) { return !stays(pixel); });
  const int found = propose_corners(frame, supply_, supply, limit, frame.scratch.supply, corners);
  if (found == 0 || !begin_keyframe(frame, estimate)) return;
  for (int i = 0; i < found && frame.work.take(work::kAppearance); ++i) {
    const Status status = seeds_.add(frame.image, frame.camera, corners[i].x, corners[i].y,
                                     keyframes_[keyframes_.size() - 1], seeds);
    if (status == Status::kFull) break;
  }
}

template <class Config, class Filter>
void VehicleLocalMap<Config, Filter>::add_landmarks(Frame& frame, Estimate& estimate,
                                                    const SeedParameters& seeds) {
  for (int i = 0; i < parameters_.max_new_landmarks_per_frame; ++i) {
    ConvergedSeed seed;
    if (!frame.work.affords(work::kLandmarkInitialisation)) {
      frame.work.cut_mapping();
      return;
    }
    const auto known = [&](LandmarkId keyframe) { return way_is_known(estimate, keyframe); };
    if (!seeds_.take_converged(frame.camera, seeds, known, seed)) return;
    frame.work.spend(work::kLandmarkInitialisation);
    if (!add_landmark(frame, estimate, seed)) ++frame.health.landmarks_refused;
  }
}

/// A seed's depth is relative to the baseline since its keyframe. The filter, with both ends in its
/// state, knows that better than dead reckoning does: depth and error follow from the filter's.
template <class Config, class Filter>
bool VehicleLocalMap<Config, Filter>::add_landmark(Frame& frame, Estimate& estimate,
                                                   const ConvergedSeed& seed) {
  Filter& filter = estimate.filter();
  const int slot = filter.find(seed.keyframe);
  if (slot < 0) return false;
  const Rigid<float>& T_vehicle_camera = estimate.T_vehicle_camera();
  const Rigid<float> T_world_vehicle = estimate.T_world_vehicle();
  const Rigid<float> T_world_camera = estimate.T_world_camera();
  const Quaternion<float> R_world_first = T_world_camera.rotation * seed.T_camera_first.rotation;
  const Quaternion<float> R_world_past = R_world_first * T_vehicle_camera.rotation.conjugate();
  const Vector3<float> first_camera =
      filter.mean_landmark(slot) + R_world_past * T_vehicle_camera.translation;
  const Vector3<float> baseline = T_world_camera.translation - first_camera;
  const Vector3<float>& reckoned = seed.T_camera_first.translation;
  const float length = sqrt(baseline.dot(baseline));
  const float reckoned_length = sqrt(reckoned.dot(reckoned));
  if (!(length > kMinBaseline_m) || !(reckoned_length > kMinBaseline_m)) return false;
  const float scale = length / reckoned_length;
  const Matrix3<float> noise = point_covariance(estimate, seed, scale);
  const Matrix3<float> R_vehicle_camera = T_vehicle_camera.rotation.toRotationMatrix();
  const float depth = seed.depth_m * scale;
  const Vector3<float> offset = R_vehicle_camera * Vector3<float>(seed.ray * depth);
  const Vector3<float> direction =
      (T_world_vehicle.rotation.conjugate() * baseline) * (1.0F / length);
  const Matrix<float, 3, 2> by_baseline =
      (offset * (1.0F / length)) * direction.template head<2>().transpose();
  TrackedLandmark landmark;
  landmark.id = estimate.next_id();
  landmark.appearance = seed.appearance;
  landmark.appearance.T_world_reference =
      T_world_camera * Rigid<float>{seed.T_camera_first.rotation, reckoned * scale};
  LandmarkId replaced = kNoLandmark;
  if (!ok(filter.add_landmark_on_path(landmark.id, T_vehicle_camera.translation + offset, noise,
                                      seed.keyframe, by_baseline, &replaced))) {
    return false;
  }
  ++estimate.next_id();
  if (replaced != kNoLandmark) {
    estimate.landmarks().remove(replaced);
    ++frame.health.landmarks_replaced;
  }
  estimate.landmarks().add(landmark);
  ++frame.report.added;
  ++frame.health.landmarks_added;
  return true;
}

/// Of a converged seed in the vehicle frame, m^2: the depth's along the ray, the pixel's across it.
template <class Config, class Filter>
Matrix3<float> VehicleLocalMap<Config, Filter>::point_covariance(const Estimate& estimate,
                                                                 const ConvergedSeed& seed,
                                                                 float scale) const {
  const float sigma_depth = seed.sigma_depth_m * scale;
  const float sigma_lateral =
      (seed.depth_m * scale) * parameters_.seeds.sigma_px / estimate.camera().fx;
  Matrix3<float> covariance = square(sigma_depth) * (seed.ray * seed.ray.transpose());
  covariance(0, 0) += square(sigma_lateral);
  covariance(1, 1) += square(sigma_lateral);
  const Matrix3<float> R_vehicle_camera = estimate.T_vehicle_camera().rotation.toRotationMatrix();
  const Matrix3<float> rotated = R_vehicle_camera * covariance * R_vehicle_camera.transpose();
  // Rounding leaves a product that is not symmetric to the bit, which the filter would refuse.
  return 0.5F * (rotated + rotated.transpose());
}

/// Makes this frame one at which seeds begin; false when pool or filter have no room.
template <class Config, class Filter>
bool VehicleLocalMap<Config, Filter>::begin_keyframe(Frame& frame, Estimate& estimate) {
  end_keyframes(frame, estimate, true);
  const LandmarkId id = estimate.next_id();
  Filter& filter = estimate.filter();
  if (keyframes_.full() || !ok(filter.add_position(id))) return false;
  if (!ok(seeds_.begin_keyframe(id))) {
    static_cast<void>(filter.remove_landmark(filter.find(id)));
    return false;
  }
  ++estimate.next_id();
  if (keyframes_.empty()) start_heading_.begin(estimate);
  keyframes_.push_back(id);
  since_keyframe_s_ = since_keyframe_m_ = 0.0F;
  return true;
}

/// Forgets the positions that no seed refers to any more.
template <class Config, class Filter>
void VehicleLocalMap<Config, Filter>::end_keyframes(Frame& frame, Estimate& estimate,
                                                    bool make_room) {
  Filter& filter = estimate.filter();
  frame.health.candidates_dropped += static_cast<std::uint32_t>(seeds_.end_keyframes(make_room));
  for (int i = keyframes_.size() - 1; i >= 0; --i) {
    if (seeds_.has_keyframe(keyframes_[i])) continue;
    static_cast<void>(filter.remove_landmark(filter.find(keyframes_[i])));
    keyframes_.remove_unordered(i);
    if (i == 0) start_heading_.forget();
  }
}

}  // namespace cairn
