#pragma once

#include "cairn/map/visibility.hpp"
#include "cairn/tracking/active_search.hpp"

namespace cairn {

/// Looks for library landmarks where a camera pose lets expect them: the first `count` of `visible`
/// (find_visible()), each by its descriptor in a window of `variance` px^2, as far as `budget`
/// goes. `matches` get the library's slots. Returns how many were looked for. Cost: `count` calls
/// of search_landmark.
template <class Library, int Capacity>
int search_expected(const ImageView& image, const PinholeCamera<float>& camera,
                    const Rigid<float>& T_map_camera, const Library& library,
                    const VisibleLandmark<float>* visible, int count, float variance,
                    const SearchParameters& parameters, SearchScratch& scratch,
                    FixedVector<PixelMatch<float>, Capacity>& matches, WorkBudget& budget) {
  for (int i = 0; i < count; ++i) {
    if (!budget.affords(work::kLandmarkSearch)) return i;
    const LandmarkView<float>& view = library[visible[i].slot].views[0];
    PixelPrediction<float> prediction;
    prediction.id = visible[i].id;
    prediction.pixel = visible[i].prediction.pixel;
    prediction.p_camera = visible[i].prediction.p_camera;
    prediction.covariance = Matrix2<float>::Identity() * variance;
    Appearance appearance;
    appearance.has_patch = false;
    appearance.descriptor = view.descriptor;
    appearance.scale_index = view.pose.scale_index;
    Matrix2<float> warp;
    if (!ok(predict_warp(camera, view.T_world_reference, T_map_camera, prediction.p_camera,
                         warp))) {
      continue;
    }
    PixelMatch<float> match;
    SearchReport search;
    const Status status = search_landmark(image, prediction, appearance, warp, parameters, scratch,
                                          match.pixel, search);
    budget.spend(search.work);
    if (!ok(status)) continue;
    match.id = visible[i].id;
    match.slot = visible[i].slot;
    match.descriptor_distance = search.distance;
    matches.push_back(match);
  }
  return count;
}

}  // namespace cairn
