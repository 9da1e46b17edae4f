#pragma once

#include "cairn/tracking/seed_odometry.hpp"

namespace cairn {

/// Bounded pool of seeds, followed by a visual odometry of its own (SeedOdometry): it works while
/// the map is still empty and the heading only as good as the wheels'. Seeds begin at keyframes,
/// which the caller names and keeps in its own state. Cost per frame: at most 4 patch alignments
/// and one filter update a seed.
template <int MaxSeeds, int MaxKeyframes>
class SeedPool {
 public:
  using Parameters = SeedParameters;

  int size() const { return seeds_.size(); }
  bool full() const { return seeds_.full(); }
  const Seed& operator[](int i) const { return seeds_[i]; }
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

  /// Most units of work that following the present seeds takes, without searches.
  int work_to_follow() const { return seeds_.size() * (work::kAlignment + kCorrectionWork); }

  /// Follows every seed into `image`, taken at the caller's estimate `T_odometry_camera` (only its
  /// motion since the last call counts). Lost seeds are dropped, their number returned. Where
  /// `budget` does not afford work_to_follow(), as coast().
  int follow(const ImageView& image, const PinholeCamera<float>& camera,
             const Rigid<float>& T_odometry_camera, const Parameters& parameters,
             SearchScratch& scratch, WorkBudget& budget) {
    coast(T_odometry_camera, parameters);
    if (!budget.affords(work_to_follow())) return 0;
    budget.spend(seeds_.size() * kCorrectionWork);
    measure_all(image, camera, parameters, budget);
    search_missing(image, camera, parameters, scratch, budget);
    odometry_.correct(camera, parameters, seeds_, pixels_, found_);
    return drop_lost(parameters);
  }

  /// Moves on to the caller's estimate without the image: no seed is lost for it.
  void coast(const Rigid<float>& T_odometry_camera, const Parameters& parameters) {
    odometry_.move_to(T_odometry_camera, parameters);
  }

  /// Takes out the next seed that was seen in this frame and whose depth has converged; false when
  /// there is none. Seeds that converged outside the usable depths are dropped. Call until false.
  bool take_converged(const PinholeCamera<float>& camera, const Parameters& parameters,
                      ConvergedSeed& converged);

  bool has_keyframe(LandmarkId id) const { return odometry_.find_keyframe(id) >= 0; }

  /// Forgets the keyframes of which no seed is left. Where all stay in use and `make_room` is set,
  /// also the one with the lowest id and its seeds, whose number is returned.
  int end_keyframes(bool make_room);

 private:
  static constexpr int kCorrectionWork = 40;
  using Pixels = Vector2<float>[MaxSeeds];
  using Odometry = SeedOdometry<MaxSeeds, MaxKeyframes>;
  using Expected = typename Odometry::Expected;

  void remove(int i) {
    odometry_.remove_seed(i, seeds_.size() - 1);
    seeds_.remove_unordered(i);
  }
  bool warp_of(const PinholeCamera<float>& camera, const Seed& seed, const Expected& expected,
               Matrix2<float>& warp) const {
    return ok(predict_warp(camera, odometry_.T_pool_keyframe(seed.keyframe),
                           odometry_.T_pool_camera(), expected.p_camera, warp));
  }

  bool align(const ImageView& image, const PinholeCamera<float>& camera, const Seed& seed,
             const Expected& expected, const Vector2<float>& shift, const Parameters& parameters,
             Vector2<float>& pixel) const;
  int measure_shifted(const ImageView& image, const PinholeCamera<float>& camera,
                      const Vector2<float>& shift, const Parameters& parameters, bool* found,
                      Pixels& pixels) const;
  void measure_all(const ImageView& image, const PinholeCamera<float>& camera,
                   const Parameters& parameters, WorkBudget& budget);
  void search_missing(const ImageView& image, const PinholeCamera<float>& camera,
                      const Parameters& parameters, SearchScratch& scratch, WorkBudget& budget);
  int drop_lost(const Parameters& parameters);
  void fill(const PinholeCamera<float>& camera, const Parameters& parameters, int i,
            ConvergedSeed& converged) const;

  FixedVector<Seed, MaxSeeds> seeds_;
  bool found_[MaxSeeds] = {};  ///< this frame's measurements, by seed
  Pixels pixels_;
  Odometry odometry_;
};

template <int MaxSeeds, int MaxKeyframes>
Status SeedPool<MaxSeeds, MaxKeyframes>::add(const ImageView& image,
                                             const PinholeCamera<float>& camera, int x, int y,
                                             LandmarkId keyframe, const Parameters& parameters) {
  const int slot = keyframe == kNoLandmark ? -1 : odometry_.find_keyframe(keyframe);
  if (slot < 0) return Status::kNotFound;
  if (seeds_.full()) return Status::kFull;
  Seed seed;
  const Status status = make_appearance(image, x, y, odometry_.T_pool_camera(), seed.appearance);
  if (!ok(status)) return status;
  seed.pixel = Vector2<float>(static_cast<float>(x), static_cast<float>(y));
  seed.first_ray = camera.unproject(seed.pixel);
  seed.rho = 1.0F / parameters.initial_depth_m;
  seed.keyframe = slot;
  odometry_.begin_seed(seeds_.size(), square(parameters.initial_sigma_rho));
  seeds_.push_back(seed);
  return Status::kOk;
}

template <int MaxSeeds, int MaxKeyframes>
bool SeedPool<MaxSeeds, MaxKeyframes>::take_converged(const PinholeCamera<float>& camera,
                                                      const Parameters& parameters,
                                                      ConvergedSeed& converged) {
  for (int i = seeds_.size() - 1; i >= 0; --i) {
    const Seed& seed = seeds_[i];
    if (seed.misses > 0 || seed.seen < parameters.min_views || !(seed.rho > 0.0F)) continue;
    const float sigma = sqrt(odometry_.variance(i));
    if (sigma > parameters.max_relative_sigma * seed.rho) continue;
    const float depth = 1.0F / seed.rho;
    const bool usable = depth > parameters.min_depth_m && depth < parameters.max_depth_m;
    if (usable) fill(camera, parameters, i, converged);
    remove(i);
    if (usable) return true;
  }
  return false;
}

template <int MaxSeeds, int MaxKeyframes>
int SeedPool<MaxSeeds, MaxKeyframes>::end_keyframes(bool make_room) {
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

template <int MaxSeeds, int MaxKeyframes>
bool SeedPool<MaxSeeds, MaxKeyframes>::align(const ImageView& image,
                                             const PinholeCamera<float>& camera, const Seed& seed,
                                             const Expected& expected, const Vector2<float>& shift,
                                             const Parameters& parameters,
                                             Vector2<float>& pixel) const {
  Matrix2<float> warp;
  PatchWarp patch_warp;
  if (!warp_of(camera, seed, expected, warp) || !to_patch_warp(warp, patch_warp)) return false;
  int x_q8 = round_to_int((expected.pixel.x() + shift.x()) * 256.0F);
  int y_q8 = round_to_int((expected.pixel.y() + shift.y()) * 256.0F);
  PatchAlignment alignment;
  if (!ok(align_patch(image, seed.appearance.patch, patch_warp, x_q8, y_q8, alignment)) ||
      !alignment.converged || alignment.correlation < parameters.min_correlation_q10) {
    return false;
  }
  pixel = Vector2<float>(static_cast<float>(x_q8) / 256.0F, static_cast<float>(y_q8) / 256.0F);
  return true;
}

/// Seeds found when all are expected `shift` away from their prediction.
template <int MaxSeeds, int MaxKeyframes>
int SeedPool<MaxSeeds, MaxKeyframes>::measure_shifted(const ImageView& image,
                                                      const PinholeCamera<float>& camera,
                                                      const Vector2<float>& shift,
                                                      const Parameters& parameters, bool* found,
                                                      Pixels& pixels) const {
  int count = 0;
  for (int i = 0; i < seeds_.size(); ++i) {
    Expected expected;
    found[i] = odometry_.expect(camera, seeds_, i, expected) &&
               align(image, camera, seeds_[i], expected, shift, parameters, pixels[i]);
    count += found[i] ? 1 : 0;
  }
  return count;
}

template <int MaxSeeds, int MaxKeyframes>
void SeedPool<MaxSeeds, MaxKeyframes>::measure_all(const ImageView& image,
                                                   const PinholeCamera<float>& camera,
                                                   const Parameters& parameters,
                                                   WorkBudget& budget) {
  const int round_work = seeds_.size() * work::kAlignment;
  budget.spend(round_work);
  int best = measure_shifted(image, camera, Vector2<float>::Zero(), parameters, found_, pixels_);
  const float steps[] = {-parameters.search_step_px, parameters.search_step_px};
  for (const float step : steps) {
    if (10 * best >= 7 * seeds_.size() || !budget.affords(round_work)) return;
    budget.spend(round_work);
    bool found[MaxSeeds];
    Pixels pixels;
    const int count =
        measure_shifted(image, camera, Vector2<float>(step, 0.0F), parameters, found, pixels);
    if (count <= best) continue;
    best = count;
    for (int i = 0; i < seeds_.size(); ++i) {
      found_[i] = found[i];
      pixels_[i] = pixels[i];
    }
  }
}

/// Searches the seeds that alignment did not find by descriptor, in the window that their uncertain
/// depth and rotation give.
template <int MaxSeeds, int MaxKeyframes>
void SeedPool<MaxSeeds, MaxKeyframes>::search_missing(const ImageView& image,
                                                      const PinholeCamera<float>& camera,
                                                      const Parameters& parameters,
                                                      SearchScratch& scratch, WorkBudget& budget) {
  for (int i = 0; i < seeds_.size(); ++i) {
    if (found_[i]) continue;
    if (!budget.affords(work::kLandmarkSearch)) return;
    const Seed& seed = seeds_[i];
    Expected expected;
    Matrix2<float> warp;
    if (!odometry_.expect(camera, seeds_, i, expected) || !warp_of(camera, seed, expected, warp)) {
      continue;
    }
    PixelPrediction<float> prediction;
    prediction.pixel = expected.pixel;
    prediction.covariance = odometry_.innovation_covariance(expected, parameters.sigma_px);
    prediction.p_camera = expected.p_camera;
    SearchReport report;
    found_[i] = ok(search_landmark(image, prediction, seed.appearance, warp, parameters.search,
                                   scratch, pixels_[i], report));
    budget.spend(report.work);
  }
}

template <int MaxSeeds, int MaxKeyframes>
int SeedPool<MaxSeeds, MaxKeyframes>::drop_lost(const Parameters& parameters) {
  int dropped = 0;
  for (int i = seeds_.size() - 1; i >= 0; --i) {
    Seed& seed = seeds_[i];
    if (found_[i]) {
      seed.pixel = pixels_[i];
      ++seed.seen;
      seed.misses = 0;
    } else {
      ++seed.misses;
    }
    if (seed.misses > parameters.max_misses || seed.seen + seed.misses > parameters.max_views) {
      remove(i);
      ++dropped;
    }
  }
  return dropped;
}

template <int MaxSeeds, int MaxKeyframes>
void SeedPool<MaxSeeds, MaxKeyframes>::fill(const PinholeCamera<float>& camera,
                                            const Parameters& parameters, int i,
                                            ConvergedSeed& converged) const {
  const Seed& seed = seeds_[i];
  converged.appearance = seed.appearance;
  converged.T_camera_first = odometry_.T_camera_first(seed);
  converged.ray = camera.unproject(seed.pixel);
  converged.depth_m = (converged.T_camera_first * Vector3<float>(seed.first_ray / seed.rho)).z();
  converged.sigma_depth_m =
      sqrt(odometry_.variance(i)) * parameters.depth_inflation / square(seed.rho);
  converged.pixel = seed.pixel;
  converged.keyframe = odometry_.keyframe_id(seed.keyframe);
}

}  // namespace cairn
