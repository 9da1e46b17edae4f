#pragma once

#include "cairn/tracking/place_sightings.hpp"

namespace cairn {

/// Landmarks of a WindowArchive become landmarks of the window again, at their place in the map: so
/// that its frame and scale hold.
template <class Config>
class WindowMapReuse {
 public:
  using Archive = WindowArchive<Config>;
  using Features = typename Archive::Features;
  using Window = typename Features::Window;
  using Seen = typename PlaceSightings<Config>::Seen;
  using Place = typename PlaceSightings<Config>::Place;

  struct Parameters {
    int min_library = 16;     ///< landmarks; with fewer a lost tracker begins its map anew
    int reuse_visits = 64;    ///< library landmarks, in a frame
    int reuse_searches = 4;   ///< of these
    int reuse_q15 = 26214;    ///< correlation, 0.8
    int reuse_radius_px = 2;  ///< in the shrunk image

    /// kBadConfig unless every value is in its domain.
    Status validate() const {
      const bool good = min_library >= 0 && reuse_visits >= 0 && reuse_searches >= 0 &&
                        reuse_q15 >= 0 && reuse_q15 <= 1 << 15 && reuse_radius_px >= 1 &&
                        reuse_radius_px <= kMaxSearchRadius;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    next_slot_ = 0;
    host_ = -1;
  }
  /// Whether a library is not worth a return to its map.
  bool too_small(const Archive& archive) const {
    return archive.library().size() < parameters_.min_library;
  }
  /// The window has a new keyframe.
  void note_keyframe() { host_ = -1; }
  /// The landmarks of `place` become features of the window, whose first keyframe is at its pose.
  void take_place(FrameContext& frame, Archive& archive, const Place& place, Window& window,
                  Features& features);
  /// Landmarks of a part of the library, each time of another one, become features where the frame,
  /// at T_camera_world, finds them. Cost: reuse_visits projections and reuse_searches searches.
  void reuse(FrameContext& frame, Archive& archive, Window& window, Features& features,
             const Rigid<float>& T_camera_world);

 private:
  using Library = typename Archive::Library;

  void take(FrameContext& frame, Library& library, Window& window, Features& features,
            const Seen& seen, const Rigid<float>& T_camera_map);

  Parameters parameters_;
  int next_slot_ = 0;        ///< before the next one that reuse() visits
  int host_ = -1;            ///< of reused landmarks, in the window, until its next keyframe
  Rigid<float> T_host_map_;  ///< its pose
};

/// As its host sees it, which is fixed.
template <class Config>
void WindowMapReuse<Config>::take(FrameContext& frame, Library& library, Window& window,
                                  Features& features, const Seen& seen,
                                  const Rigid<float>& T_camera_map) {
  constexpr float kInflation = 2.0F;  // of the sigma: errors of neighbours are correlated
  constexpr float kLeastSigma = 0.03F;
  constexpr float kLeastDepth = 0.2F;  // of its distance from the host
  const auto& landmark = library[seen.slot];
  if (host_ < 0) {
    T_host_map_ = T_camera_map;
    host_ = window.add_host(T_host_map_);
  }
  const Vector3<float> p = T_host_map_ * landmark.p_map;
  const float squared = p.squaredNorm();
  if (!(p.z() > kLeastDepth * sqrt(squared))) return;
  const Vector3<float> ray = T_host_map_.rotation.conjugate() * p;
  const float along = sqrt(ray.dot(landmark.covariance * ray) / squared) / sqrt(squared);
  const float relative = kInflation * (along > kLeastSigma ? along : kLeastSigma);
  const float rho = 1.0F / p.z();
  const int slot = window.add_known_landmark(
      landmark.id, host_, Vector2<float>(p.x() * rho, p.y() * rho), rho, relative * rho);
  if (slot < 0) return;
  if (!features.add_known(frame, slot, seen.pixel)) {
    window.retire(slot);
    return;
  }
  static_cast<void>(library.record(landmark.id, true));
  ++frame.report.reactivated;
  ++frame.health.landmarks_reactivated;
}

template <class Config>
void WindowMapReuse<Config>::take_place(FrameContext& frame, Archive& archive, const Place& place,
                                        Window& window, Features& features) {
  host_ = -1;
  const Rigid<float> T_camera_map = place.T_map_camera.inverse();
  for (const Seen& seen : place.seen)
    take(frame, archive.library(), window, features, seen, T_camera_map);
}

template <class Config>
void WindowMapReuse<Config>::reuse(FrameContext& frame, Archive& archive, Window& window,
                                   Features& features, const Rigid<float>& T_camera_world) {
  const int size = archive.library().size();
  const int search = work::warped_search(parameters_.reuse_radius_px) +
                     work::window_landmark(Features::Candidates::kCell);
  const int visits = parameters_.reuse_visits < size ? parameters_.reuse_visits : size;
  if (!frame.work.take(visits * work::kLibrarySlot / 2 + parameters_.reuse_searches * search)) {
    return;
  }
  const Rigid<float> T_map_camera = T_camera_world.inverse();
  int searches = 0;
  for (int i = 0; i < visits && searches < parameters_.reuse_searches; ++i) {
    next_slot_ = (next_slot_ + 1) % size;
    Seen seen;
    seen.slot = next_slot_;
    Vector2<float> expected;
    if (features.full() ||
        !archive.expected_pixel(frame.camera, seen.slot, T_map_camera, expected) ||
        !features.is_free(frame, expected)) {
      continue;
    }
    ++searches;
    if (archive.find(frame, features, seen.slot, T_map_camera, expected,
                     parameters_.reuse_radius_px, parameters_.reuse_q15, seen.pixel) &&
        features.is_free(frame, seen.pixel)) {
      take(frame, archive.library(), window, features, seen, T_camera_world);
    }
  }
}

}  // namespace cairn
