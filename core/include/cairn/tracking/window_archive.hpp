#pragma once

#include "cairn/map/library.hpp"
#include "cairn/tracking/place_recogniser.hpp"
#include "cairn/tracking/window_features.hpp"

namespace cairn {

/// Capacities of the library of a WindowTracker. An image is compared with the whole of it within a
/// few frames.
template <class Config>
struct WindowLibraryConfig : Config {
  static constexpr int kLibraryLandmarks =
      Config::kLibraryLandmarks < 256 ? Config::kLibraryLandmarks : 256;
  static constexpr int kRelocalisationFeatures = 160;
  static constexpr int kRelocalisationMatches = 48;
  static constexpr int kPlaceViews = kLibraryLandmarks / 5 < 40 ? kLibraryLandmarks / 5 : 40;
};

/// The map library of a WindowTracker and the archiving of its well-known features: each with a
/// descriptor at the camera's roll, and with its template of the shrunk image, by which it is found
/// in other images.
template <class Config>
class WindowArchive {
 public:
  using LibraryConfig = WindowLibraryConfig<Config>;
  using Library = MapLibrary<LibraryConfig>;
  using Features = WindowFeatures<Config>;
  using Window = typename Features::Window;

  struct Parameters {
    int mature_sightings = 20;  ///< a feature is archived at so many, and its record renewed each
                                ///< time that the number doubles
    float max_depth_sigma = 0.1F;  ///< of an archived feature, relative to its depth
    float same_share = 0.02F;      ///< of its distance: a landmark nearer to it is the same point

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = mature_sightings >= 1 && is_positive(max_depth_sigma) &&
                        same_share >= 0.0F && same_share < 1.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    library_.clear();
    health_ = Health{};
    next_renewed_ = 0;
  }
  /// Forgets all landmarks.
  void clear() { library_.clear(); }

  const Library& library() const { return library_; }
  Library& library() { return library_; }
  /// Admissions, replacements and refusals of the library.
  const Health& health() const { return health_; }

  /// Archives features that are due, a bounded number in a frame, and renews the depths of
  /// some that were. `T_camera_world`: the frame's. `sigma`: of a pixel, relative to the focal
  /// length.
  void archive_due(FrameContext& frame, const Window& window, Features& features,
                   const Rigid<float>& T_camera_world, float sigma);
  /// The library gets the depth that is known of a feature by now: before it is given up. Cost:
  /// kRenewal.
  void renew_depth(FrameContext& frame, const Window& window, const WindowFeature& feature,
                   float sigma);

  /// Pixel at which a camera should see the landmark in `slot`, and about as it was seen when it
  /// was archived. False where it should not. Cost: half of work::kLibrarySlot.
  bool expected_pixel(const PinholeCamera<float>& camera, int slot,
                      const Rigid<float>& T_map_camera, Vector2<float>& pixel) const;
  /// Pixel at which the frame's image shows the landmark in `slot`, within `radius` of it in the
  /// shrunk image about `expected`: by its template, resampled as a camera at T_map_camera sees it.
  /// False where it is not found with a correlation of `least_q15`. Cost: work::warped_search().
  bool find(const FrameContext& frame, const Features& features, int slot,
            const Rigid<float>& T_map_camera, const Vector2<float>& expected, int radius,
            int least_q15, Vector2<float>& pixel) const;

 private:
  static constexpr int kRenewal = 50;  // units, of MapLibrary::update()

  bool is_due(const WindowFeature& feature) const;
  void archive(FrameContext& frame, const Window& window, WindowFeature& feature,
               const Rigid<float>& T_camera_world, float sigma);
  static void place_landmark(const Window& window, int slot, float sigma,
                             typename Library::Landmark& landmark);
  int same_point(const Vector3<float>& p_map, float distance) const;

  Parameters parameters_;
  int next_renewed_ = 0;  ///< feature
  Library library_;
  Health health_;
  SmallTemplate coarse_[LibraryConfig::kLibraryLandmarks];  ///< of each slot, as archived
};

/// At the first mature sighting, and at twice as many, four times as many, and so on.
template <class Config>
bool WindowArchive<Config>::is_due(const WindowFeature& feature) const {
  const int mature = parameters_.mature_sightings;
  if (!feature.in_library) return feature.sightings >= mature;
  int next = mature;
  while (next < feature.sightings) next *= 2;
  return next == feature.sightings;
}

template <class Config>
void WindowArchive<Config>::archive_due(FrameContext& frame, const Window& window,
                                        Features& features, const Rigid<float>& T_camera_world,
                                        float sigma) {
  constexpr int kMaxInFrame = 4;  // the others follow in the next frames
  int archived = 0;
  for (int i = 0; i < features.size() && archived < kMaxInFrame; ++i) {
    WindowFeature& feature = features[i];
    if (!feature.found || feature.outliers > 0 || !is_due(feature)) continue;
    if (!(window.sigma(feature.slot) <
          parameters_.max_depth_sigma * window.inverse_depth(feature.slot))) {
      continue;
    }
    if (!frame.work.take(work::kArchiving + work::kDescriptor)) return;
    archive(frame, window, feature, T_camera_world, sigma);
    ++archived;
  }
  // Those that the library has already, in turn: their depths are known better by now.
  constexpr int kRenewed = 2;
  for (int i = 0; i < kRenewed && features.size() > 0; ++i) {
    next_renewed_ = (next_renewed_ + 1) % features.size();
    renew_depth(frame, window, features[next_renewed_], sigma);
  }
}

template <class Config>
void WindowArchive<Config>::renew_depth(FrameContext& frame, const Window& window,
                                        const WindowFeature& feature, float sigma) {
  if (!feature.in_library || feature.from_library || !window.used(feature.slot)) return;
  const int slot = library_.find(window.id(feature.slot));
  if (slot < 0 || !(window.sigma(feature.slot) <
                    parameters_.max_depth_sigma * window.inverse_depth(feature.slot))) {
    return;
  }
  if (!frame.work.take(kRenewal)) return;
  typename Library::Landmark landmark = library_[slot];
  place_landmark(window, feature.slot, sigma, landmark);
  static_cast<void>(library_.update(landmark));
}

/// Slot of the landmark at a place, seen from a distance, -1 where there is none: a point that was
/// lost and found again is in the library already.
template <class Config>
int WindowArchive<Config>::same_point(const Vector3<float>& p_map, float distance) const {
  const float reach = parameters_.same_share * distance;
  int best = -1;
  float nearest = square(reach);
  for (int slot = 0; slot < library_.size(); ++slot) {
    const float squared = (library_[slot].p_map - p_map).squaredNorm();
    if (!(squared < nearest)) continue;
    nearest = squared;
    best = slot;
  }
  return best;
}

/// Where the window has a landmark, which its first view should have the pose of. The covariance is
/// that of the depth, the poses known, and of the pixel.
template <class Config>
void WindowArchive<Config>::place_landmark(const Window& window, int slot, float sigma,
                                           typename Library::Landmark& landmark) {
  constexpr float kLeastSigma = 0.01F;  // of the depth
  landmark.p_map = window.position(slot);
  const Vector3<float> ray = landmark.p_map - landmark.views[0].T_map_reference.translation;
  const float own = window.sigma(slot) / window.inverse_depth(slot);
  const float along = square(own > kLeastSigma ? own : kLeastSigma);
  landmark.covariance = square(sigma) * ray.squaredNorm() * Matrix3<float>::Identity() +
                        along * (ray * ray.transpose());
}

template <class Config>
void WindowArchive<Config>::archive(FrameContext& frame, const Window& window,
                                    WindowFeature& feature, const Rigid<float>& T_camera_world,
                                    float sigma) {
  typename Library::Landmark landmark;
  LandmarkView<float>& view = landmark.views[0];
  view.pose.scale_index = kReferenceScaleIndex;
  view.pose.orientation_bin = roll_bin(T_camera_world);
  if (!ok(describe_freak(frame.image, round_to_int(feature.pixel.x()),
                         round_to_int(feature.pixel.y()), view.pose, view.descriptor))) {
    return;
  }
  view.focal_px = 0.5F * (frame.camera.fx + frame.camera.fy);
  view.T_map_reference = T_camera_world.inverse();
  landmark.id = window.id(feature.slot);
  place_landmark(window, feature.slot, sigma, landmark);
  const Vector3<float> ray = landmark.p_map - view.T_map_reference.translation;
  if (library_.find(landmark.id) < 0) {
    const int known = same_point(landmark.p_map, sqrt(ray.squaredNorm()));
    if (known >= 0) landmark.id = library_[known].id;
  }
  landmark.searches = feature.searches;
  landmark.sightings = feature.sightings < feature.searches ? feature.sightings : feature.searches;
  landmark.view_count = 1;
  const Status status = library_.find(landmark.id) < 0 ? library_.insert(landmark, health_)
                                                       : library_.update(landmark);
  if (ok(status)) {
    coarse_[library_.find(landmark.id)] = feature.coarse;
    ++frame.health.landmarks_archived;
  }
  feature.in_library = true;
}

template <class Config>
bool WindowArchive<Config>::expected_pixel(const PinholeCamera<float>& camera, int slot,
                                           const Rigid<float>& T_map_camera,
                                           Vector2<float>& pixel) const {
  constexpr float kLeastScale = 0.7F;
  constexpr float kMostScale = 1.5F;
  constexpr float kLeastCosine = 0.75F;
  constexpr float kMargin_px = 24.0F;
  const auto& landmark = library_[slot];
  ViewPrediction<float> expected;
  if (!ok(predict_view(camera, T_map_camera, landmark.p_map, landmark.views[0], expected)) ||
      !camera.contains(expected.pixel, kMargin_px) || expected.scale_ratio < kLeastScale ||
      expected.scale_ratio > kMostScale || expected.cosine < kLeastCosine) {
    return false;
  }
  pixel = expected.pixel;
  return true;
}

template <class Config>
bool WindowArchive<Config>::find(const FrameContext& frame, const Features& features, int slot,
                                 const Rigid<float>& T_map_camera, const Vector2<float>& expected,
                                 int radius, int least_q15, Vector2<float>& pixel) const {
  const auto& landmark = library_[slot];
  Matrix2<float> warp;
  PatchWarp fixed;
  if (!ok(predict_warp(frame.camera, landmark.views[0].T_map_reference, T_map_camera,
                       Vector3<float>(T_map_camera.inverse() * landmark.p_map), warp)) ||
      !to_patch_warp(warp, fixed)) {
    return false;
  }
  return features.find_warped(coarse_[slot], fixed, expected, radius, least_q15, pixel);
}

}  // namespace cairn
