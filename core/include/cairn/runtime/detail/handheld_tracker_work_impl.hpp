#pragma once

#include "cairn/runtime/handheld_tracker.hpp"

namespace cairn {

/// Where the frame's work does not suffice for all windows (after a fast movement), the best known
/// landmarks come first, and the rest once they have told where to look.
template <class Config>
void HandheldTracker<Config>::search(const ImageView& image, SearchPass pass,
                                     FixedVector<PixelMatch<float>, kMaxFeatures>& matches,
                                     FrameReport& report) {
  SearchTotals totals;
  totals.searched = report.searched;
  const int left = filter_.feature_count() - report.searched;
  WorkBudget searching(work_.for_searches(0, updating_work(left)));
  const SearchOrder order =
      pass == SearchPass::kAll ? SearchOrder::kBestKnown : SearchOrder::kMostUncertain;
  search_landmarks(image, View{filter_}, pass, order, table_, parameters_.search,
                   parameters_.max_searches, scratch_.search, matches, totals, searching);
  work_.spend(searching.spent());
  report.cut = FrameCut::kNone;
  if (totals.deferred > 0 && totals.searched < parameters_.max_searches) {
    report.cut = totals.searched > 0 ? FrameCut::kFewerUpdates : FrameCut::kPredictionOnly;
  }
  report.corners += totals.corners;
  report.candidates += totals.descriptors;
  report.searched = totals.searched;
  report.matches = matches.size();
  report.deferred = totals.deferred;
  health_.corners_dropped += static_cast<std::uint32_t>(totals.corners_dropped);
}

template <class Config>
int HandheldTracker<Config>::updating_work(int matches) const {
  const int most = parameters_.filter.ransac.max_hypotheses;
  return work::mono_update(filter_.state_size(), filter_.feature_count(), matches,
                           matches < most ? matches : most, matches);
}

/// Leaves out the last matches from `first` on until the update can be paid.
template <class Config>
void HandheldTracker<Config>::afford_update(int first,
                                            FixedVector<PixelMatch<float>, kMaxFeatures>& matches,
                                            FrameReport& report) {
  while (matches.size() > first && !work_.affords(updating_work(matches.size() - first))) {
    if (TrackedLandmark* landmark = table_.find(matches[matches.size() - 1].id)) {
      --landmark->predicted;
      --landmark->misses;
    }
    matches.pop_back();
    ++report.deferred;
    if (report.cut < FrameCut::kFewerUpdates) report.cut = FrameCut::kFewerUpdates;
  }
}

}  // namespace cairn
