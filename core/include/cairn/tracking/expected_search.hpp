#pragma once

#include "cairn/map/visibility.hpp"
#include "cairn/tracking/active_search.hpp"
#include "cairn/tracking/live_landmark.hpp"

namespace cairn {

/// Memory of a search for library landmarks that a pose predicts. `Capacity`: matches at most.
template <int Capacity>
struct ExpectedScratch {
  static constexpr int kMaxVisible = 24;
  SearchScratch search;
  VisibleLandmark<float> visible[kMaxVisible];
  FixedVector<PixelMatch<float>, Capacity> matches;  ///< slots are the library's
};

/// How landmarks of the library are searched from a camera pose in the map.
struct ExpectedSearch {
  VisibilityOptions<float> visibility;
  SearchParameters search;
  float variance_px2 = 0.0F;  ///< of the predicted pixels, for the pose's error
};

/// How many landmarks of the library a pose predicted, and how many of them were searched.
struct ExpectedCounts {
  int visible = 0;
  int searched = 0;
};

/// Searches `image` for the landmarks of `library` that a camera at `T_map_camera` should see, the
/// highest retention score first, each by its descriptor in a window of `variance_px2`, as far as
/// `budget` goes. scratch.matches gets those found. Cost: find_visible() over the whole library,
/// then kMaxVisible calls of search_landmark().
template <class Library, int Capacity>
ExpectedCounts search_expected(const ImageView& image, const PinholeCamera<float>& camera,
                               const Rigid<float>& T_map_camera, const Library& library,
                               const ExpectedSearch& how, ExpectedScratch<Capacity>& scratch,
                               WorkBudget& budget) {
  ExpectedCounts counts;
  counts.visible = find_visible(library, camera, T_map_camera, how.visibility, Span<LandmarkId>{},
                                scratch.visible, ExpectedScratch<Capacity>::kMaxVisible);
  scratch.matches.clear();
  for (int i = 0; i < counts.visible; ++i) {
    if (!budget.affords(work::kLandmarkSearch)) return counts;
    ++counts.searched;
    const VisibleLandmark<float>& expected = scratch.visible[i];
    const LandmarkView<float>& view = library[expected.slot].views[0];
    PixelPrediction<float> prediction;
    prediction.id = expected.id;
    prediction.pixel = expected.prediction.pixel;
    prediction.p_camera = expected.prediction.p_camera;
    prediction.covariance = Matrix2<float>::Identity() * how.variance_px2;
    Appearance appearance;
    appearance.has_patch = false;
    appearance.descriptor = view.descriptor;
    appearance.scale_index = view.pose.scale_index;
    Matrix2<float> warp;
    if (!ok(predict_warp(camera, view.T_map_reference, T_map_camera, prediction.p_camera, warp))) {
      continue;
    }
    PixelMatch<float> match;
    SearchReport search;
    const Status status = search_landmark(image, prediction, appearance, warp, how.search,
                                          scratch.search, match.pixel, search);
    budget.spend(search.work);
    if (!ok(status)) continue;
    match.id = expected.id;
    match.slot = expected.slot;
    match.descriptor_distance = search.distance;
    scratch.matches.push_back(match);
  }
  return counts;
}

/// Searches `image` for landmarks of the filter (LiveLandmarks) in the same way, each by its patch
/// or its descriptor, and adds those found to scratch.matches. Returns how many the pose predicted
/// that are not among them already. Cost: a projection and a search_landmark() for each.
template <class Live, int Capacity>
int search_live(const ImageView& image, const PinholeCamera<float>& camera,
                const Rigid<float>& T_map_camera, const Live& live, const ExpectedSearch& how,
                ExpectedScratch<Capacity>& scratch, WorkBudget& budget) {
  int expected = 0;
  const int from_library = scratch.matches.size();
  for (int slot = 0; slot < live.size(); ++slot) {
    LiveLandmark landmark;
    if (!live.get(slot, landmark)) continue;
    PixelPrediction<float> prediction;
    prediction.id = landmark.id;
    prediction.slot = slot;
    prediction.p_camera = T_map_camera.inverse() * landmark.p_map;
    prediction.covariance = Matrix2<float>::Identity() * how.variance_px2;
    if (!ok(camera.project(prediction.p_camera, prediction.pixel)) ||
        !camera.contains(prediction.pixel, how.visibility.margin_px)) {
      continue;
    }
    bool known = false;
    for (int i = 0; i < from_library && !known; ++i) known = scratch.matches[i].id == landmark.id;
    if (known) continue;
    const Appearance& appearance = landmark.record->appearance;
    Matrix2<float> warp;
    if (!ok(predict_warp(camera, appearance.T_world_reference, live.to_world(T_map_camera),
                         prediction.p_camera, warp)) ||
        !budget.affords(work::kLandmarkSearch)) {
      continue;
    }
    ++expected;
    PixelMatch<float> match;
    SearchReport search;
    const Status status = search_landmark(image, prediction, appearance, warp, how.search,
                                          scratch.search, match.pixel, search);
    budget.spend(search.work);
    if (!ok(status)) continue;
    match.id = landmark.id;
    match.slot = slot;
    match.descriptor_distance = search.distance;
    scratch.matches.push_back(match);
  }
  return expected;
}

}  // namespace cairn
