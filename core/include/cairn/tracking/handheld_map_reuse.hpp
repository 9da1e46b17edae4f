#pragma once

#include <new>

#include "cairn/tracking/handheld_archive.hpp"

namespace cairn {

/// Reuse of the map library by a hand-held tracker that is lost: images are compared with the whole
/// library until one is recognised; the pose found must be confirmed by a later image before the
/// filter restarts there.
template <class Config>
class HandheldMapReuse {
 public:
  using Archive = HandheldArchive<Config>;
  using Library = typename Archive::Library;
  using Engine = Relocaliser<HandheldLibraryConfig<Config>>;
  using Estimate = HandheldEstimate<Config::kMaxFeatures>;
  using Frame = HandheldFrame<Config>;

  struct Parameters {
    /// Weak corners and few matches: a pose found is only a proposal, to be confirmed.
    Parameters() {
      engine.fast_threshold = 12;
      engine.min_score = 14;
      engine.max_capture_work = 11000;
      engine.max_pairs_per_step = 4096;
      engine.samples_per_step = 24;
      engine.ransac.min_inliers = 5;
      engine.ransac.inlier_px = 8.0F;
      engine.ransac.max_hypotheses = 300;
    }
    typename Archive::Parameters archive;
    typename Engine::Parameters engine;
    int min_library = 16;            ///< landmarks; with fewer a lost tracker begins its map anew
    int min_found = 8;               ///< landmarks that confirm a place,
    float min_found_ratio = 0.4F;    ///< and of those that the pose predicts
    int max_confirm_distance = 120;  ///< Hamming, of descriptors steered to the pose

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = ok(archive.validate()) && ok(engine.validate()) && min_library >= 0 &&
                        min_found >= 1 && min_found_ratio >= 0.0F && min_found_ratio <= 1.0F &&
                        max_confirm_distance >= 0 && max_confirm_distance <= 512;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  /// `search`: how landmarks are searched, but for what confirming a place changes.
  void reset(const Parameters& parameters, const SearchParameters& search) {
    parameters_ = parameters;
    search_ = search;
    search_.method = SearchMethod::kDescriptor;
    search_.fast_threshold = parameters.engine.fast_threshold;
    search_.max_distance = parameters.max_confirm_distance;
    archive_.reset(parameters.archive);
    begin();
  }
  /// Tracking was lost: the relocalisation starts over.
  void begin() {
    engine_.reset();
    found_ = false;
  }

  Archive& archive() { return archive_; }
  const Archive& archive() const { return archive_; }
  /// Whether the library has too few landmarks to be recognised.
  bool library_too_small() const { return archive_.library().size() < parameters_.min_library; }

  /// Steps of the relocalisation, as many as the frame's work affords. True when the place is
  /// confirmed: the filter then is at its pose, with the landmarks that confirmed it, whose number
  /// `matches` gets (not all of them may have become features).
  bool relocalise(Frame& frame, Estimate& estimate, int& matches);

 private:
  using LibraryLandmark = typename Library::Landmark;

  bool return_to_place(Frame& frame, Estimate& estimate, int& matches);
  bool confirm(Frame& frame, float variance_px2, Rigid<float>& T_map_camera,
               ConfirmationScratch& scratch) const;
  void reactivate(Frame& frame, Estimate& estimate, const Rigid<float>& T_map_camera,
                  const ConfirmationScratch& scratch);
  bool reactivate(Frame& frame, Estimate& estimate, const Rigid<float>& T_map_camera,
                  const PixelMatch<float>& match);

  Parameters parameters_;
  SearchParameters search_;
  Archive archive_;
  Engine engine_;
  bool found_ = false;  ///< a pose waits to be confirmed
};

template <class Config>
bool HandheldMapReuse<Config>::relocalise(Frame& frame, Estimate& estimate, int& matches) {
  constexpr int kConfirmation = 6000;  // units: most confirmations take less
  const typename Engine::Parameters& p = parameters_.engine;
  FrameWork& work = frame.work;
  const bool resumed = engine_.working() || found_;
  if (!resumed) {
    if (!work.affords(Engine::least_capture_work(frame.image))) return false;
    static_cast<void>(engine_.capture(frame.image, p, frame.scratch.relocaliser, work.budget()));
  }
  while (engine_.working() && work.affords(Engine::step_work(p))) {
    found_ = engine_.step(frame.camera, archive_.library(), p, frame.random,
                          frame.scratch.relocaliser, work.budget()) == Engine::Outcome::kFound;
  }
  if (!resumed || !found_ || !work.affords(kConfirmation)) return false;
  found_ = false;
  if (return_to_place(frame, estimate, matches)) return true;
  ++frame.health.false_relocalisations_refused;
  return false;
}

/// Searches the present image for the landmarks that the pose found predicts: in wide windows
/// first, then in narrow ones about the pose on which these agree. Where a texture repeats, enough
/// match in wide windows by chance, but not in narrow ones.
template <class Config>
bool HandheldMapReuse<Config>::return_to_place(Frame& frame, Estimate& estimate, int& matches) {
  constexpr float kWide_px2 = 60.0F;  // the camera's motion from frame to frame
  constexpr float kNarrow_px2 = 2.0F;
  Rigid<float> T_map_camera = engine_.T_map_camera();
  ConfirmationScratch& scratch = *new (&frame.scratch.expected) ConfirmationScratch();
  if (!confirm(frame, kWide_px2, T_map_camera, scratch) ||
      !confirm(frame, kNarrow_px2, T_map_camera, scratch) || !ok(estimate.restart(T_map_camera))) {
    return false;
  }
  reactivate(frame, estimate, T_map_camera, scratch);
  matches = scratch.matches.size();
  return true;
}

/// Whether enough of the landmarks predicted at T_map_camera are found in windows of `variance_px2`
/// and agree on a pose, which T_map_camera then is; `scratch` has them.
template <class Config>
bool HandheldMapReuse<Config>::confirm(Frame& frame, float variance_px2, Rigid<float>& T_map_camera,
                                       ConfirmationScratch& scratch) const {
  ExpectedSearch how;
  how.visibility.margin_px = 30.0F;
  how.visibility.min_scale = 0.75F;
  how.visibility.max_scale = 2.0F;
  how.visibility.min_cosine = 0.85F;
  how.search = search_;
  how.variance_px2 = variance_px2;
  const Library& library = archive_.library();
  const int searched = search_expected(frame.image, frame.camera, T_map_camera, library, how,
                                       scratch, frame.work.budget())
                           .searched;
  const int found = scratch.matches.size();
  const float least = parameters_.min_found_ratio * static_cast<float>(searched);
  if (found < parameters_.min_found || static_cast<float>(found) < least) return false;
  for (int i = 0; i < found; ++i) {
    const LibraryLandmark& landmark = library[scratch.matches[i].slot];
    scratch.observations[i] = {landmark.p_map, landmark.covariance, scratch.matches[i].pixel, 1.0F};
  }
  PoseRefinementOptions<float> refinement;
  refinement.max_iterations = 8;
  refinement.min_inliers = parameters_.min_found;
  PoseEstimate<float> estimate;
  frame.work.spend(work::kRefinement);
  return ok(refine_pose(frame.camera, scratch.observations, found, refinement, T_map_camera,
                        estimate, scratch.inlier)) &&
         static_cast<float>(estimate.inliers) >= least;
}

template <class Config>
void HandheldMapReuse<Config>::reactivate(Frame& frame, Estimate& estimate,
                                          const Rigid<float>& T_map_camera,
                                          const ConfirmationScratch& scratch) {
  for (int i = 0; i < scratch.matches.size(); ++i) {
    if (scratch.inlier[i] == 0) continue;
    if (!frame.work.take(work::kAppearance + work::kFeatureInitialisation)) break;
    if (!reactivate(frame, estimate, T_map_camera, scratch.matches[i])) continue;
    static_cast<void>(archive_.library().record(scratch.matches[i].id, true));
    ++frame.report.reactivated;
    ++frame.health.landmarks_reactivated;
  }
}

/// Adds a landmark to the filter at its distance in the map, which keeps the map's scale.
template <class Config>
bool HandheldMapReuse<Config>::reactivate(Frame& frame, Estimate& estimate,
                                          const Rigid<float>& T_map_camera,
                                          const PixelMatch<float>& match) {
  constexpr float kInflation = 2.0F;  // of the sigma: errors of neighbours are correlated
  constexpr float kMinRelativeSigma = 0.02F;
  const LibraryLandmark& archived = archive_.library()[match.slot];
  const Vector3<float> ray = archived.p_map - T_map_camera.translation;
  const float squared = ray.squaredNorm();
  const float distance = sqrt(squared);
  const float along = sqrt(ray.dot(archived.covariance * ray) / squared) / distance;
  const float relative = kInflation * (along > kMinRelativeSigma ? along : kMinRelativeSigma);
  TrackedLandmark landmark = reactivated_landmark(archived.id);
  if (!ok(make_appearance(frame.image, round_to_int(match.pixel.x()), round_to_int(match.pixel.y()),
                          T_map_camera, landmark.appearance)) ||
      !ok(estimate.filter().add_feature(archived.id, match.pixel, 1.0F / distance,
                                        relative / distance))) {
    return false;
  }
  estimate.landmarks().add(landmark);
  return true;
}

}  // namespace cairn
