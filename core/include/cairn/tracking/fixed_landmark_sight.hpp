#pragma once

#include "cairn/planar/fixed/float_messages.hpp"
#include "cairn/tracking/fixed_camera_pose.hpp"
#include "cairn/tracking/fixed_patch_window.hpp"
#include "cairn/tracking/fixed_warp.hpp"
#include "cairn/tracking/landmark_search.hpp"

namespace cairn {

template <int MaxLandmarks>
class FixedVehicleSlam;
template <class Filter>
class VehicleEstimate;

struct FixedPlannedSearch {
  FixedPixelPrediction prediction;
  Fixed<std::int64_t, 16> priority;  ///< determinant of the innovation covariance, px^4
  int most_work = 0;
};

/// The same without floating point, but for landmarks that have no patch.
template <int MaxLandmarks>
class LandmarkSight<VehicleEstimate<FixedVehicleSlam<MaxLandmarks>>> {
 public:
  using Estimate = VehicleEstimate<FixedVehicleSlam<MaxLandmarks>>;
  using Planned = FixedPlannedSearch;
  using Warp = PatchWarp;

  explicit LandmarkSight(const Estimate& estimate)
      : estimate_(estimate),
        pose_(estimate.camera(), estimate.filter().T_world_camera(estimate.T_vehicle_camera())) {}

  bool plan(int slot, Planned& entry) const {
    constexpr FixedPixel kMargin = FixedPixel::nearest(2.0);
    FixedPixelPrediction& p = entry.prediction;
    if (!ok(estimate_.predict(slot, p)) || !pose_.camera().contains(p.pixel, kMargin)) return false;
    using Priority = decltype(entry.priority);
    std::uint32_t none = 0;
    entry.priority =
        subtract(multiply<Priority>(p.xx, p.yy, none), multiply<Priority>(p.xy, p.xy, none), none);
    return true;
  }
  /// As its filter's predictions, 0.3 m away or more.
  bool see(int slot, int& x, int& y) const {
    constexpr FixedLength kNearest = FixedLength::nearest(0.3);
    FixedCoordinate p_world[3];
    FixedPixel pixel[2];
    estimate_.filter().mean_landmark(slot, p_world);
    if (!pose_.see(p_world, kNearest, pixel)) return false;
    x = pixel[0].raw() >> FixedPixel::kFractionBits;
    y = pixel[1].raw() >> FixedPixel::kFractionBits;
    return true;
  }
  int most_work(const Planned& entry, const Appearance& appearance,
                const SearchParameters& parameters) const {
    if (!is_searched_by_patch(appearance, parameters)) {
      return most_search_work(in_float(entry), appearance, parameters);
    }
    FixedPatchWindow window;
    return window.set(entry.prediction, parameters.patch) ? patch_search_work(window)
                                                          : work::kPatchWindow;
  }
  bool predict(const Planned& entry, const Appearance& appearance, Warp& warp) const {
    return pose_.predict(appearance.T_world_reference, entry.prediction.p_camera, warp);
  }
  Status search(const ImageView& image, const Planned& entry, const Appearance& appearance,
                const Warp& warp, const SearchParameters& parameters, SearchScratch& scratch,
                Vector2<float>& pixel, SearchReport& report) const {
    if (!is_searched_by_patch(appearance, parameters)) {
      return search_landmark(image, in_float(entry), appearance, matrix_of(warp), parameters,
                             scratch, pixel, report);
    }
    report = SearchReport{};
    FixedPatchWindow window;
    if (!window.set(entry.prediction, parameters.patch)) return Status::kSingular;
    report.work = patch_search_work(window);
    return search_patch(image, window, appearance.patch, warp, parameters.patch, pixel);
  }

 private:
  static PixelPrediction<float> in_float(const Planned& entry) {
    PixelPrediction<float> prediction;
    float_of(entry.prediction, prediction);
    return prediction;
  }

  const Estimate& estimate_;
  FixedCameraPose pose_;
};

}  // namespace cairn
