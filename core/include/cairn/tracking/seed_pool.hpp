#pragma once

#include "cairn/tracking/seed_odometry.hpp"
#include "cairn/tracking/work_budget.hpp"

namespace cairn {

/// Bounded pool of seeds, followed by a visual odometry of its own (SeedOdometry): it works while
/// the map is still empty and the heading only as good as the wheels'. Seeds begin at keyframes,
/// which the caller names and keeps in its own state. Cost per frame: one patch search and one
/// filter update a seed. `Odometry`: SeedOdometry, or FixedSeedOdometry without floating point.
template <int MaxSeeds, int MaxKeyframes, class Odometry = SeedOdometry<MaxSeeds, MaxKeyframes>>
class SeedPool {
 public:
  using Parameters = SeedParameters;
  using Pose = typename Odometry::Pose;

  int size() const { return seeds_.size(); }
  bool full() const { return seeds_.full(); }
  const Seed& operator[](int i) const { return seeds_[i]; }
  /// Seeds seen in the last frame.
  int found() const {
    int count = 0;
    for (const Seed& seed : seeds_) count += seed.misses == 0 ? 1 : 0;
    return count;
  }
  void clear() {
    seeds_.clear();
    odometry_.clear();
  }

  /// Makes the frame last given to follow() a keyframe, at which seeds can begin. kNotInitialised
  /// (no frame yet), kFull (see end_keyframes), kInvalidArgument (id 0).
  Status begin_keyframe(LandmarkId id) {
    if (!odometry_.has_pose()) return Status::kNotInitialised;
    if (id == kNoLandmark) return Status::kInvalidArgument;
    const int slot = odometry_.find_keyframe(kNoLandmark);
    if (slot < 0) return Status::kFull;
    odometry_.begin_keyframe(slot, id);
    return Status::kOk;
  }

  /// Starts following the corner at integer pixel (x, y) of the frame last given to follow(), which
  /// begin_keyframe() named `keyframe`. kFull, kOutOfView, kNotFound (no such keyframe).
  Status add(const ImageView& image, const PinholeCamera<float>& camera, int x, int y,
             LandmarkId keyframe, const Parameters& parameters);

  /// Units of work that following the present seeds takes at least: in the smallest windows.
  int work_to_follow() const { return seeds_.size() * (kSmallSearchWork + kCorrectionWork); }

  /// Follows every seed into `image`, taken at the caller's estimate `T_odometry_camera` (only its
  /// motion since the last call counts). Lost seeds are dropped, their number returned. Where
  /// `budget` does not afford work_to_follow(), as coast(); a single seed whose search it does not
  /// afford is not lost for it either.
  int follow(const ImageView& image, const PinholeCamera<float>& camera,
             const Pose& T_odometry_camera, const Parameters& parameters, WorkBudget& budget) {
    coast(T_odometry_camera, parameters);
    typename Odometry::View view;
    if (!budget.affords(work_to_follow()) || !odometry_.look(camera, parameters, view)) return 0;
    budget.spend(seeds_.size() * kCorrectionWork);
    measure(image, view, parameters, budget);
    odometry_.correct(view, parameters, seeds_, pixels_, found_);
    return drop_lost(parameters);
  }

  /// Moves on to the caller's estimate without the image: no seed is lost for it.
  void coast(const Pose& T_odometry_camera, const Parameters& parameters) {
    guess_depths(parameters);
    odometry_.move_to(T_odometry_camera, parameters);
  }

  /// The caller's estimate was corrected since follow(): no motion.
  void stand_at(const Pose& T_odometry_camera) { odometry_.stand_at(T_odometry_camera); }

  /// Takes out the next seed that was seen in this frame and whose depth has converged; false when
  /// there is none. Seeds that converged outside the usable depths are dropped. Call until false.
  /// `known(keyframe)`: whether the way since a keyframe, of which depths are multiples, is known
  /// well enough; the seeds of others stay.
  template <class Known>
  bool take_converged(const PinholeCamera<float>& camera, const Parameters& parameters,
                      const Known& known, ConvergedSeed& converged);
  bool take_converged(const PinholeCamera<float>& camera, const Parameters& parameters,
                      ConvergedSeed& converged) {
    const auto always = [](LandmarkId) { return true; };
    return take_converged(camera, parameters, always, converged);
  }

  /// Results that did not fit their format, of an odometry in fixed point.
  std::uint32_t saturations() const { return odometry_.saturations(); }

  bool has_keyframe(LandmarkId id) const { return odometry_.find_keyframe(id) >= 0; }
  /// How the camera turned since a keyframe, as the pictures and the caller's estimate show it
  /// together: directions then, in its axes of now, and the variance about its y axis, rad^2. False
  /// where that is not told.
  bool turn_since(LandmarkId keyframe, Quaternion<float>& now_then, float& yaw_variance) const {
    return odometry_.turn_since(keyframe, now_then, yaw_variance);
  }

  /// Forgets the keyframes of which no seed is left. Where all stay in use and `make_room` is set,
  /// also the one with the lowest id and its seeds, whose number is returned.
  int end_keyframes(bool make_room);

 private:
  static constexpr int kCorrectionWork = 40;
  static constexpr int kSmallSearchWork = 60;
  using Pixels = Vector2<float>[MaxSeeds];

  void remove(int i) {
    odometry_.remove_seed(i, seeds_.size() - 1);
    seeds_.remove_unordered(i);
  }

  void guess_depths(const Parameters& parameters);
  void measure(const ImageView& image, const typename Odometry::View& view,
               const Parameters& parameters, WorkBudget& budget);
  int drop_lost(const Parameters& parameters);
  void fill(const PinholeCamera<float>& camera, const Parameters& parameters, int i,
            ConvergedSeed& converged) const;

  FixedVector<Seed, MaxSeeds> seeds_;
  bool searched_[MaxSeeds] = {};  ///< this frame's measurements, by seed
  bool found_[MaxSeeds] = {};
  Pixels pixels_;
  Odometry odometry_;
};

template <int MaxSeeds, int MaxKeyframes, class Odometry>
Status SeedPool<MaxSeeds, MaxKeyframes, Odometry>::add(const ImageView& image,
                                                       const PinholeCamera<float>& camera, int x,
                                                       int y, LandmarkId keyframe,
                                                       const Parameters& parameters) {
  const int slot = keyframe == kNoLandmark ? -1 : odometry_.find_keyframe(keyframe);
  if (slot < 0) return Status::kNotFound;
  if (seeds_.full()) return Status::kFull;
  Seed seed;
  const Status status =
      make_patch_appearance(image, x, y, odometry_.T_pool_camera(), seed.appearance);
  if (!ok(status)) return status;
  seed.pixel = Vector2<float>(static_cast<float>(x), static_cast<float>(y));
  seed.first_ray = camera.unproject(seed.pixel);
  seed.rho = 1.0F / parameters.initial_depth_m;
  seed.keyframe = slot;
  odometry_.begin_seed(seeds_.size(), parameters.initial_sigma_rho);
  seeds_.push_back(seed);
  return Status::kOk;
}

template <int MaxSeeds, int MaxKeyframes, class Odometry>
template <class Known>
bool SeedPool<MaxSeeds, MaxKeyframes, Odometry>::take_converged(const PinholeCamera<float>& camera,
                                                                const Parameters& parameters,
                                                                const Known& known,
                                                                ConvergedSeed& converged) {
  for (int i = seeds_.size() - 1; i >= 0; --i) {
    const Seed& seed = seeds_[i];
    if (seed.misses > 0 || seed.seen < parameters.min_views || !(seed.rho > 0.0F)) continue;
    if (!odometry_.has_converged(i, seed.rho, parameters.max_relative_sigma)) continue;
    if (!known(odometry_.keyframe_id(seed.keyframe))) continue;
    const float depth = 1.0F / seed.rho;
    const bool usable = depth > parameters.min_depth_m && depth < parameters.max_depth_m;
    if (usable) fill(camera, parameters, i, converged);
    remove(i);
    if (usable) return true;
  }
  return false;
}

template <int MaxSeeds, int MaxKeyframes, class Odometry>
int SeedPool<MaxSeeds, MaxKeyframes, Odometry>::end_keyframes(bool make_room) {
  bool used[MaxKeyframes] = {};
  for (const Seed& seed : seeds_) used[seed.keyframe] = true;
  int oldest = 0;
  bool full = true;
  for (int k = 0; k < MaxKeyframes; ++k) {
    if (!used[k]) odometry_.end_keyframe(k);
    full = full && used[k];
    if (odometry_.keyframe_id(k) < odometry_.keyframe_id(oldest)) oldest = k;
  }
  if (!full || !make_room) return 0;
  int dropped = 0;
  for (int i = seeds_.size() - 1; i >= 0; --i) {
    if (seeds_[i].keyframe != oldest) continue;
    remove(i);
    ++dropped;
  }
  odometry_.end_keyframe(oldest);
  return dropped;
}

/// A seed that no second picture has seen has the depth of the present parameters: those at its
/// first picture may have followed from a speed that was not known yet.
template <int MaxSeeds, int MaxKeyframes, class Odometry>
void SeedPool<MaxSeeds, MaxKeyframes, Odometry>::guess_depths(const Parameters& parameters) {
  const float rho = 1.0F / parameters.initial_depth_m;
  for (int i = 0; i < seeds_.size(); ++i) {
    if (seeds_[i].seen > 1 || seeds_[i].rho == rho) continue;
    seeds_[i].rho = rho;
    odometry_.begin_seed(i, parameters.initial_sigma_rho);
  }
}

/// Searches each seed in the window that its uncertain depth and the camera's rotation give.
template <int MaxSeeds, int MaxKeyframes, class Odometry>
void SeedPool<MaxSeeds, MaxKeyframes, Odometry>::measure(const ImageView& image,
                                                         const typename Odometry::View& view,
                                                         const Parameters& parameters,
                                                         WorkBudget& budget) {
  for (int i = 0; i < seeds_.size(); ++i) {
    found_[i] = false;
    searched_[i] = true;
    typename Odometry::Search search;
    if (!odometry_.plan(view, parameters, seeds_, i, search)) continue;
    const int search_work = search.work(parameters.search);
    searched_[i] = budget.affords(search_work);
    if (!searched_[i]) continue;
    budget.spend(search_work);
    found_[i] = ok(search.find(image, seeds_[i].appearance.patch, parameters.search, pixels_[i]));
  }
}

template <int MaxSeeds, int MaxKeyframes, class Odometry>
int SeedPool<MaxSeeds, MaxKeyframes, Odometry>::drop_lost(const Parameters& parameters) {
  int dropped = 0;
  for (int i = seeds_.size() - 1; i >= 0; --i) {
    Seed& seed = seeds_[i];
    if (found_[i]) {
      seed.pixel = pixels_[i];
      ++seed.seen;
      seed.misses = 0;
    } else if (searched_[i]) {
      ++seed.misses;
    }
    if (seed.misses > parameters.max_misses || seed.seen + seed.misses > parameters.max_views) {
      remove(i);
      ++dropped;
    }
  }
  return dropped;
}

template <int MaxSeeds, int MaxKeyframes, class Odometry>
void SeedPool<MaxSeeds, MaxKeyframes, Odometry>::fill(const PinholeCamera<float>& camera,
                                                      const Parameters& parameters, int i,
                                                      ConvergedSeed& converged) const {
  const Seed& seed = seeds_[i];
  converged.appearance = seed.appearance;
  converged.T_camera_first = odometry_.T_camera_first(seed);
  converged.ray = camera.unproject(seed.pixel);
  converged.depth_m = (converged.T_camera_first * Vector3<float>(seed.first_ray / seed.rho)).z();
  converged.sigma_depth_m = odometry_.sigma_rho(i) * parameters.depth_inflation / square(seed.rho);
  converged.pixel = seed.pixel;
  converged.keyframe = odometry_.keyframe_id(seed.keyframe);
}

}  // namespace cairn
