#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/active_search.hpp"
#include "cairn/tracking/tracked_landmarks.hpp"

namespace cairn {

struct SearchTotals {
  int corners = 0;
  int corners_dropped = 0;
  int descriptors = 0;
  int searched = 0;
  int deferred = 0;  ///< in view, not searched: beyond `max_searches` or the budget
};

/// Which landmarks are searched: all, or those that the frame has not searched yet.
enum class SearchPass : std::uint8_t { kAll, kRest };

/// What is searched first where the budget does not suffice for all. The most uncertain (largest
/// det S) is the most informative measurement; the best known has the smallest window, and an
/// update with it makes the other windows smaller.
enum class SearchOrder : std::uint8_t { kMostUncertain, kBestKnown };

struct PlannedSearch {
  PixelPrediction<float> prediction;
  float priority = 0.0F;
  int most_work = 0;  ///< units that the search may take
};

/// How the landmarks of a filter are seen and searched in one picture, in float; filters in fixed
/// point have another (fixed_landmark_sight.hpp). The filter must offer size(), id(slot),
/// predict(slot, prediction), camera() and T_world_camera().
template <class Filter>
class LandmarkSight {
 public:
  using Planned = PlannedSearch;
  using Warp = Matrix2<float>;

  explicit LandmarkSight(const Filter& filter)
      : filter_(filter), camera_(filter.camera()), T_world_camera_(filter.T_world_camera()) {}

  /// False for a landmark out of view.
  bool plan(int slot, Planned& entry) const {
    if (!ok(filter_.predict(slot, entry.prediction)) ||
        !camera_.contains(entry.prediction.pixel, 2.0F)) {
      return false;
    }
    const Matrix2<float>& s = entry.prediction.covariance;
    entry.priority = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
    return true;
  }
  /// The pixel in which a landmark lies; false for one out of view.
  bool see(int slot, int& x, int& y) const {
    PixelPrediction<float> prediction;
    if (!ok(filter_.predict(slot, prediction)) || !camera_.contains(prediction.pixel)) return false;
    x = static_cast<int>(prediction.pixel.x());
    y = static_cast<int>(prediction.pixel.y());
    return true;
  }
  int most_work(const Planned& entry, const Appearance& appearance,
                const SearchParameters& parameters) const {
    return most_search_work(entry.prediction, appearance, parameters);
  }
  bool predict(const Planned& entry, const Appearance& appearance, Warp& warp) const {
    return ok(predict_warp(camera_, appearance.T_world_reference, T_world_camera_,
                           entry.prediction.p_camera, warp));
  }
  Status search(const ImageView& image, const Planned& entry, const Appearance& appearance,
                const Warp& warp, const SearchParameters& parameters, SearchScratch& scratch,
                Vector2<float>& pixel, SearchReport& report) const {
    return search_landmark(image, entry.prediction, appearance, warp, parameters, scratch, pixel,
                           report);
  }

 private:
  const Filter& filter_;
  PinholeCamera<float> camera_;
  Rigid<float> T_world_camera_;
};

/// The landmarks in view, the most uncertain first. Cost: one projection per landmark, an insertion
/// sort of Capacity.
template <class Filter, class Sight, int Capacity>
void plan_searches(const Filter& filter, const Sight& sight, SearchPass pass,
                   TrackedLandmarks<Capacity>& landmarks,
                   FixedVector<typename Sight::Planned, Capacity>& plan) {
  for (int slot = 0; slot < filter.size(); ++slot) {
    TrackedLandmark* landmark = landmarks.find(filter.id(slot));
    if (landmark == nullptr || (pass == SearchPass::kRest && landmark->searched)) continue;
    landmark->searched = false;
    typename Sight::Planned entry;
    const bool visible = sight.plan(slot, entry);
    if (pass == SearchPass::kAll) {
      landmark->frames_out_of_view = visible ? 0 : landmark->frames_out_of_view + 1;
    }
    if (!visible) continue;
    plan.push_back(entry);
    int place = plan.size() - 1;
    for (; place > 0 && plan[place - 1].priority < entry.priority; --place) {
      plan[place] = plan[place - 1];
    }
    if (place < plan.size() - 1) plan[place] = entry;
  }
}

/// Searches the filter's landmarks that are in view, the most uncertain first, at most
/// `max_searches` of them and no more than `budget` affords; where it does not suffice for all, in
/// the order `when_cut`. The rest is counted as deferred; its S grows until it comes first.
///
/// Cost: plan_searches(), `max_searches` calls of search_landmark.
template <class Filter, int Capacity>
void search_landmarks(const ImageView& image, const Filter& filter, SearchPass pass,
                      SearchOrder when_cut, TrackedLandmarks<Capacity>& landmarks,
                      const SearchParameters& parameters, int max_searches, SearchScratch& scratch,
                      FixedVector<PixelMatch<float>, Capacity>& matches, SearchTotals& totals,
                      WorkBudget& budget) {
  using Sight = LandmarkSight<Filter>;
  const Sight sight(filter);
  FixedVector<typename Sight::Planned, Capacity> plan;
  plan_searches(filter, sight, pass, landmarks, plan);
  int work_of_all = 0;
  for (typename Sight::Planned& entry : plan) {
    const TrackedLandmark* landmark = landmarks.find(entry.prediction.id);
    entry.most_work = sight.most_work(entry, landmark->appearance, parameters);
    work_of_all += entry.most_work;
  }
  const bool backwards = when_cut == SearchOrder::kBestKnown && !budget.affords(work_of_all);

  for (int i = 0; i < plan.size(); ++i) {
    const typename Sight::Planned& entry = plan[backwards ? plan.size() - 1 - i : i];
    if (totals.searched >= max_searches || !budget.affords(entry.most_work)) {
      ++totals.deferred;
      continue;
    }
    TrackedLandmark* landmark = landmarks.find(entry.prediction.id);
    typename Sight::Warp warp;
    if (!sight.predict(entry, landmark->appearance, warp)) continue;
    ++totals.searched;
    landmark->searched = true;
    ++landmark->predicted;
    ++landmark->misses;
    PixelMatch<float> match;
    SearchReport report;
    const Status status = sight.search(image, entry, landmark->appearance, warp, parameters,
                                       scratch, match.pixel, report);
    budget.spend(report.work);
    totals.corners += report.corners;
    totals.corners_dropped += report.corners_dropped;
    totals.descriptors += report.descriptors;
    if (!ok(status)) continue;
    match.id = entry.prediction.id;
    match.slot = entry.prediction.slot;
    match.descriptor_distance = report.distance;
    matches.push_back(match);
  }
}

}  // namespace cairn
