#pragma once

#include "cairn/map/map_file.hpp"
#include "cairn/tracking/handheld_estimate.hpp"
#include "cairn/tracking/handheld_frame.hpp"
#include "cairn/tracking/map_archive.hpp"

namespace cairn {

/// The map library of a hand-held tracker, and the archiving of its well-known features.
template <class Config>
class HandheldArchive {
 public:
  using Library = MapLibrary<HandheldLibraryConfig<Config>>;
  using Estimate = HandheldEstimate<Config::kMaxFeatures>;
  using Frame = HandheldFrame<Config>;

  struct Parameters {
    int mature_sightings = 12;  ///< a feature is archived at so many, and its record renewed each
                                ///< time that the number doubles
    float max_depth_sigma = 0.15F;  ///< of an archived feature, relative to its distance

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = mature_sightings >= 1 && is_positive(max_depth_sigma);
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    library_.clear();
    health_ = Health{};
  }
  Library& library() { return library_; }
  const Library& library() const { return library_; }
  /// Admissions, replacements and refusals of the library.
  const Health& health() const { return health_; }

  /// Archives inliers of `matches` that are due, a bounded number in a frame.
  void archive_due(Frame& frame, Estimate& estimate, const typename Estimate::Matches& matches);
  /// Archives the feature in `slot`, unless its depth is too uncertain.
  void archive(Frame& frame, const Estimate& estimate, int slot, TrackedLandmark& landmark) {
    archive(frame, estimate, slot, landmark, common_depth_variance(estimate.filter()));
  }

 private:
  using Filter = typename Estimate::Filter;

  bool is_due(const TrackedLandmark& landmark) const;
  static float common_depth_variance(const Filter& filter);
  void archive(Frame& frame, const Estimate& estimate, int slot, TrackedLandmark& landmark,
               float common_variance);
  static Matrix3<float> covariance_of(const Vector3<float>& from_camera, float across_variance,
                                      float depth_variance);

  Parameters parameters_;
  Library library_;
  Health health_;
};

template <class Config>
void HandheldArchive<Config>::archive_due(Frame& frame, Estimate& estimate,
                                          const typename Estimate::Matches& matches) {
  constexpr int kMaxInFrame = 4;  // the others follow in the next frames
  float common = -1.0F;
  int archived = 0;
  for (const PixelMatch<float>& match : matches) {
    TrackedLandmark* landmark = match.inlier ? estimate.landmarks().find(match.id) : nullptr;
    if (landmark == nullptr || archived == kMaxInFrame || !is_due(*landmark)) continue;
    if (!frame.work.take(work::kArchiving)) return;
    if (common < 0.0F) common = common_depth_variance(estimate.filter());
    archive(frame, estimate, estimate.filter().find(match.id), *landmark, common);
    ++archived;
  }
}

/// At the first mature sighting, and at twice as many, four times as many, and so on.
template <class Config>
bool HandheldArchive<Config>::is_due(const TrackedLandmark& landmark) const {
  const int mature = parameters_.mature_sightings;
  if (!landmark.stored) return landmark.measured >= mature;
  int next = mature;
  while (next < landmark.measured) next *= 2;
  return next == landmark.measured;
}

/// The relative variance that all depths may have in common, that of the map's free scale included:
/// at most that of the best known depth.
template <class Config>
float HandheldArchive<Config>::common_depth_variance(const Filter& filter) {
  float least = 1.0F;
  for (int slot = 0; slot < filter.feature_count(); ++slot) {
    float inverse_depth = 0.0F;
    float sigma = 0.0F;
    if (!ok(filter.feature_inverse_depth(slot, inverse_depth, sigma))) continue;
    const float relative = square(sigma / inverse_depth);
    if (relative < least) least = relative;
  }
  return least;
}

/// The archived covariance is a feature's own: without the depth variance that all features have in
/// common.
template <class Config>
void HandheldArchive<Config>::archive(Frame& frame, const Estimate& estimate, int slot,
                                      TrackedLandmark& landmark, float common_variance) {
  constexpr float kMinRelativeSigma = 0.01F;
  const Filter& filter = estimate.filter();
  typename Library::Landmark archived;
  Matrix3<float> covariance;
  float inverse_depth = 0.0F;
  float sigma = 0.0F;
  if (!ok(filter.feature_position(slot, archived.p_map, covariance)) ||
      !ok(filter.feature_inverse_depth(slot, inverse_depth, sigma))) {
    return;
  }
  const float own = square(sigma / inverse_depth) - common_variance;
  if (!(own < square(parameters_.max_depth_sigma))) return;
  const Vector3<float> from_camera = archived.p_map - filter.T_world_camera().translation;
  if (!(from_camera.squaredNorm() > 0.0F)) return;
  const float focal_px = 0.5F * (frame.camera.fx + frame.camera.fy);
  archived.covariance =
      covariance_of(from_camera, square(filter.parameters().sigma_px / focal_px),
                    own > square(kMinRelativeSigma) ? own : square(kMinRelativeSigma));
  fill_archived(landmark, frame.camera, landmark.appearance.T_world_reference, archived);
  const Status status = library_.find(archived.id) < 0 ? library_.insert(archived, health_)
                                                       : library_.update(archived);
  if (ok(status)) ++frame.health.landmarks_archived;
  landmark.stored = true;
}

/// Of a point seen along `from_camera`: relative variances across the ray and along it.
template <class Config>
Matrix3<float> HandheldArchive<Config>::covariance_of(const Vector3<float>& from_camera,
                                                      float across_variance, float depth_variance) {
  const float squared = from_camera.squaredNorm();
  const float across = across_variance * squared;
  const float along = depth_variance * squared;
  return across * Matrix3<float>::Identity() +
         ((along - across) / squared) * (from_camera * from_camera.transpose());
}

}  // namespace cairn
