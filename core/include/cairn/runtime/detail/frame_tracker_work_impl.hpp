#pragma once

#include "cairn/runtime/frame_tracker.hpp"

namespace cairn {

/// The order in which a frame's work is served:
///   1. prediction and planning, always;
///   2. searches, the most informative landmarks first, while what their update may take is left;
///   3. the update, with the least informative matches left out where it could not be paid;
///   4. the library's looks at a lost place, or the candidates, promotions, new candidates, and
///      landmarks that come back.
/// A map that is never served would leave the vehicle without landmarks: after
/// `max_frames_without_mapping` such frames the searches get half of one frame's work.
template <class Config, class Filter>
void FrameTracker<Config, Filter>::begin_work() {
  work_ = WorkBudget(work_limit_);
  work_.spend(work::kFrame + work::kProjection * filter_.landmark_count());
  mapping_cut_ = false;
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
  const bool mapping_waits = frames_without_mapping_ >= parameters_.max_frames_without_mapping;
  int left = mapping_waits ? work_.left() / 2 : work_.left();
  if (looks_for_place() && places_.working()) {
    left -= looked_near_ ? Places::step_work(parameters_.places) : Places::near_work();
  }
  const int planned =
      searches_planned() < filter_.landmark_count() ? searches_planned() : filter_.landmark_count();
  // A limit that does not pay the update of all of them pays some searches and some updates.
  const int reserved = updating_work(planned);
  const int least = left / 2;
  return left - reserved > least ? left - reserved : least;
}

/// While the place is looked up, that work takes the place of searches.
template <class Config, class Filter>
int FrameTracker<Config, Filter>::searches_planned() const {
  if (needs_image_for_place()) return 0;
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

template <class Config, class Filter>
void FrameTracker<Config, Filter>::end_work(FrameReport& report) {
  frames_without_mapping_ = mapping_cut_ ? frames_without_mapping_ + 1 : 0;
  if (mapping_cut_ && report.cut < FrameCut::kNoMapping) report.cut = FrameCut::kNoMapping;
  if (report.cut != FrameCut::kNone) ++health_.budget_exceeded;
  health_.searches_deferred += static_cast<std::uint32_t>(report.deferred);
  report.work = work_.spent();
}

}  // namespace cairn
