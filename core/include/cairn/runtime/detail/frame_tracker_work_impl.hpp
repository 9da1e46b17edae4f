#pragma once

#include "cairn/runtime/frame_tracker.hpp"

namespace cairn {

/// The order in which a frame's work is served:
///   1. prediction and planning, always;
///   2. searches, the most informative landmarks first, while what their update may take is left;
///   3. the update, with the least informative matches left out where it could not be paid;
///   4. the library's looks at a lost place, or the candidates, promotions, new candidates, and
///      landmarks that come back.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::begin_work() {
  work_.begin(work::kFrame + work::kProjection * filter_.landmark_count());
  look_up_.begin_frame(looks_for_place());
}

template <class Config, class Filter>
int FrameTracker<Config, Filter>::updating_work(int matches) const {
  const int most = parameters_.filter.ransac.max_hypotheses;
  const int states = 3 + 3 * filter_.landmark_count();
  return work::planar_update(states, matches, matches < most ? matches : most, matches);
}

/// What searches may take: what is left when the update and a step of the look-up are paid.
template <class Config, class Filter>
int FrameTracker<Config, Filter>::searching_work() const {
  const int look_up = looks_for_place() ? look_up_.next_work(parameters_.look_up) : 0;
  const int planned = searches_planned();
  const int landmarks = filter_.landmark_count();
  return work_.for_searches(look_up, updating_work(planned < landmarks ? planned : landmarks));
}

/// While the place is looked up, that work takes the place of searches.
template <class Config, class Filter>
int FrameTracker<Config, Filter>::searches_planned() const {
  if (look_up_.image_wanted()) return 0;
  return looks_for_place() ? parameters_.max_searches / 2 : parameters_.max_searches;
}

/// Leaves out the least informative matches, which stand last, until the update can be paid.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::afford_update(
    FixedVector<PixelMatch<float>, kMaxLandmarks>& matches, FrameReport& report) {
  while (!matches.empty() && !work_.affords(updating_work(matches.size()))) {
    matches.pop_back();
    ++report.deferred;
  }
}

}  // namespace cairn
