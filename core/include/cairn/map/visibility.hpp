#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/map/library.hpp"

namespace cairn {

template <class T>
struct VisibilityOptions {
  T margin_px = T(0);     ///< how far inside the image the predicted pixel must lie; may be < 0
  T min_scale = T(0.6);   ///< image scale now over image scale at description
  T max_scale = T(2.8);   ///< 2^(24/16): the pattern cannot grow further
  T min_cosine = T(0.5);  ///< of the angle between the directions of view: 60 degrees
};

/// A library landmark that a camera should see.
template <class T>
struct VisibleLandmark {
  int slot = -1;  ///< in the library that was searched
  LandmarkId id = kNoLandmark;
  int view = 0;  ///< the view nearest in direction
  int retention_score = 0;
  ViewPrediction<T> prediction;
};

/// A part of a library, so that the work of a frame need not grow with the library.
struct LibrarySlice {
  int first = 0;
  int count = 0;
};

/// What a camera at `T_map_camera` should see of landmarks: those inside the image, at a scale and
/// a viewing angle at which their descriptor can be matched.
template <class T>
struct LandmarkViews {
  const PinholeCamera<T>& camera;
  const Rigid<T>& T_map_camera;
  const VisibilityOptions<T>& options;

  /// The landmark's view that is nearest in direction; false for one that is not to be seen.
  template <int Views>
  bool operator()(const LibraryLandmark<T, Views>& landmark, VisibleLandmark<T>& candidate) const {
    T best_cosine = options.min_cosine;
    bool seen = false;
    for (int v = 0; v < landmark.view_count; ++v) {
      ViewPrediction<T> prediction;
      if (!ok(predict_view(camera, T_map_camera, landmark.p_map, landmark.views[v], prediction))) {
        break;
      }
      if (!camera.contains(prediction.pixel, options.margin_px)) break;
      if (!(prediction.cosine >= best_cosine) || !(prediction.scale_ratio >= options.min_scale) ||
          !(prediction.scale_ratio <= options.max_scale)) {
        continue;
      }
      best_cosine = prediction.cosine;
      candidate.view = v;
      candidate.prediction = prediction;
      seen = true;
    }
    return seen;
  }
};

/// The landmarks of `library` of which `sees(landmark, candidate)` is true (LandmarkViews), and
/// that are not in `exclude` (ids that are already tracked). Highest retention score first, ties by
/// id; at most `capacity` of them are written to `visible`. Returns their number.
///
/// Cost: one pass over the slots of `slice`, about 150 operations a landmark and view; |exclude|
/// comparisons and at most `capacity` moves for each one that is visible.
template <class Config, int Views, class Sees>
int find_visible(const MapLibrary<Config, Views>& library, LibrarySlice slice, const Sees& sees,
                 Span<LandmarkId> exclude, VisibleLandmark<typename Config::Scalar>* visible,
                 int capacity) {
  using T = typename Config::Scalar;
  int count = 0;
  if (visible == nullptr || capacity <= 0) return 0;
  const int end =
      slice.first + slice.count < library.size() ? slice.first + slice.count : library.size();
  for (int slot = slice.first; slot < end; ++slot) {
    const auto& landmark = library[slot];
    VisibleLandmark<T> candidate;
    candidate.slot = slot;
    candidate.id = landmark.id;
    candidate.retention_score = library.retention_score(slot);
    if (count == capacity && candidate.retention_score < visible[count - 1].retention_score)
      continue;
    bool seen = sees(landmark, candidate);
    for (int e = 0; seen && e < exclude.size; ++e) seen = exclude[e] != landmark.id;
    if (!seen) continue;
    int place = count < capacity ? count : capacity;
    while (place > 0 && (visible[place - 1].retention_score < candidate.retention_score ||
                         (visible[place - 1].retention_score == candidate.retention_score &&
                          visible[place - 1].id > candidate.id))) {
      if (place < capacity) visible[place] = visible[place - 1];
      --place;
    }
    if (place == capacity) continue;
    visible[place] = candidate;
    if (count < capacity) ++count;
  }
  return count;
}

/// Same for a camera at `T_map_camera`.
template <class Config, int Views>
int find_visible(const MapLibrary<Config, Views>& library, LibrarySlice slice,
                 const PinholeCamera<typename Config::Scalar>& camera,
                 const Rigid<typename Config::Scalar>& T_map_camera,
                 const VisibilityOptions<typename Config::Scalar>& options,
                 Span<LandmarkId> exclude, VisibleLandmark<typename Config::Scalar>* visible,
                 int capacity) {
  using Sees = LandmarkViews<typename Config::Scalar>;
  return find_visible(library, slice, Sees{camera, T_map_camera, options}, exclude, visible,
                      capacity);
}

/// Same for the whole library.
template <class Config, int Views>
int find_visible(const MapLibrary<Config, Views>& library,
                 const PinholeCamera<typename Config::Scalar>& camera,
                 const Rigid<typename Config::Scalar>& T_map_camera,
                 const VisibilityOptions<typename Config::Scalar>& options,
                 Span<LandmarkId> exclude, VisibleLandmark<typename Config::Scalar>* visible,
                 int capacity) {
  return find_visible(library, LibrarySlice{0, library.size()}, camera, T_map_camera, options,
                      exclude, visible, capacity);
}

}  // namespace cairn
