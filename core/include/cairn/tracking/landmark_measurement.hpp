#pragma once

#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/landmark_search.hpp"
#include "cairn/tracking/tracking_monitor.hpp"

namespace cairn {

/// What an update with pixel matches did.
struct PixelUpdate {
  Status status = Status::kOk;
  int inliers = 0;
  int left_out = 0;  ///< matches that the budget did not pay for
  UpdateReport report;
};

/// Most of `matches` whose update the frame can pay for. `update_work(n)`: units for n matches.
template <class UpdateWork>
int affordable_matches(int matches, const FrameWork& work, UpdateWork update_work) {
  while (matches > 0 && !work.affords(update_work(matches))) --matches;
  return matches;
}

/// Measures the filter's landmarks in the image: plans the searches, makes them within the frame's
/// budget, and keeps the matches and their counts until the next frame.
template <int Capacity>
class LandmarkMeasurement {
 public:
  using Matches = FixedVector<PixelMatch<float>, Capacity>;
  using Landmarks = TrackedLandmarks<Capacity>;

  struct Parameters {
    SearchParameters search;
    int max_searches = Capacity;

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = ok(search.validate()) && max_searches >= 0;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    begin();
  }
  /// Begins a frame.
  void begin() {
    matches_.clear();
    counts_ = MeasurementCounts{};
    deferred_ = left_out_ = 0;
  }

  /// Searches landmarks of `filter` (search_landmarks() says what it must offer), at most
  /// `max_searches` in this frame and within `units` of work. Cost: as search_landmarks().
  template <class Filter>
  void search(FrameContext& frame, const Filter& filter, Landmarks& landmarks, SearchPass pass,
              SearchOrder when_cut, int max_searches, int units, SearchScratch& scratch) {
    SearchTotals totals;
    totals.searched = counts_.searched;
    WorkBudget searching(units);
    search_landmarks(frame.image, filter, pass, when_cut, landmarks, parameters_.search,
                     max_searches, scratch, matches_, totals, searching);
    frame.work.spend(searching.spent());
    FrameCut cut = FrameCut::kNone;
    if (totals.deferred > 0 && totals.searched < max_searches) {
      cut = totals.searched > 0 ? FrameCut::kFewerUpdates : FrameCut::kPredictionOnly;
    }
    if (left_out_ > 0 && cut < FrameCut::kFewerUpdates) cut = FrameCut::kFewerUpdates;
    frame.work.set_search_cut(cut);
    frame.report.corners += totals.corners;
    frame.report.candidates += totals.descriptors;
    frame.health.corners_dropped += static_cast<std::uint32_t>(totals.corners_dropped);
    counts_.searched = totals.searched;
    counts_.matches = matches_.size();
    counts_.could_search = frame.work.could_search();
    deferred_ = totals.deferred;
  }

  /// Searches them once more, where the filter expects them now, in place of the search before.
  template <class Filter>
  void search_again(FrameContext& frame, const Filter& filter, Landmarks& landmarks, int units,
                    SearchScratch& scratch) {
    forget_searches(landmarks);
    begin();
    search(frame, filter, landmarks, SearchPass::kAll, SearchOrder::kBestKnown,
           parameters_.max_searches, units, scratch);
  }

  /// The filter was updated with the matches, or with a part of them.
  void note_update(const PixelUpdate& update) {
    counts_.inliers += update.inliers;
    counts_.nis += update.report.nis;
    left_out_ += update.left_out;
  }
  /// A later measurement of the frame, of `matches` landmarks at a recognised place, takes the
  /// place of the first.
  void replace(int matches, const PixelUpdate& update) {
    counts_.matches = matches;
    counts_.inliers = update.inliers;
    left_out_ += update.left_out;
  }

  /// Takes the frame's searches out of the landmarks' records. A frame in which too few matches
  /// agree says nothing about a landmark that was not found.
  static void forget_searches(Landmarks& landmarks) {
    for (TrackedLandmark& landmark : landmarks) {
      if (!landmark.searched) continue;
      --landmark.predicted;
      --landmark.misses;
      landmark.searched = false;
    }
  }
  /// The filter used a match of this landmark.
  static void note_inlier(TrackedLandmark& landmark, FrameReport& report) {
    ++landmark.measured;
    landmark.misses = 0;
    report.from_library += landmark.from_library ? 1 : 0;
  }

  /// Writes what is reported of the measurements.
  void report(FrameReport& report) const {
    report.searched = counts_.searched;
    report.matches = counts_.matches;
    report.inliers = counts_.inliers;
  }

  Matches& matches() { return matches_; }
  const Matches& matches() const { return matches_; }
  const MeasurementCounts& counts() const { return counts_; }
  /// Landmarks in view that the last pass did not search.
  int not_searched() const { return deferred_; }
  /// Landmarks in view not searched, and matches left out of updates.
  int deferred() const { return deferred_ + left_out_; }
  const Parameters& parameters() const { return parameters_; }

 private:
  Parameters parameters_;
  Matches matches_;
  MeasurementCounts counts_;
  int deferred_ = 0;
  int left_out_ = 0;
};

}  // namespace cairn
