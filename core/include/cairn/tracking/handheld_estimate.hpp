#pragma once

#include "cairn/mono/mono_ekf.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/landmark_measurement.hpp"

namespace cairn {

/// A monocular SLAM filter and the tracker's records of its features, which come and go together.
/// Poses and points are in the filter's frame, `world`, which in hand-held mode is also the map's:
/// the camera of the first frame, in the filter's own unit of length.
template <int MaxFeatures>
class HandheldEstimate {
 public:
  using Filter = MonoEkf<float, MaxFeatures>;
  using Landmarks = TrackedLandmarks<MaxFeatures>;
  using Matches = FixedVector<PixelMatch<float>, MaxFeatures>;

  /// Starts anew without features. Errors: as MonoEkf::initialise(); nothing is changed.
  Status initialise(const PinholeCamera<float>& camera, const MonoParameters<float>& parameters) {
    const Status status = filter_.initialise(camera, parameters);
    if (!ok(status)) return status;
    landmarks_.clear();
    next_id_ = 1;
    return Status::kOk;
  }
  /// Starts over at a known pose. Errors: as MonoEkf::restart(); nothing is changed.
  Status restart(const Rigid<float>& T_world_camera) {
    const Status status = filter_.restart(T_world_camera);
    if (ok(status)) landmarks_.clear();
    return status;
  }

  /// The same for a camera that goes on moving. Errors: as MonoEkf::restart_moving().
  Status restart_moving(const Rigid<float>& T_world_camera) {
    const Status status = filter_.restart_moving(T_world_camera);
    if (ok(status)) landmarks_.clear();
    return status;
  }

  const Filter& filter() const { return filter_; }
  Filter& filter() { return filter_; }
  const Landmarks& landmarks() const { return landmarks_; }
  Landmarks& landmarks() { return landmarks_; }
  /// The first id that was not given out yet.
  const LandmarkId& next_id() const { return next_id_; }
  LandmarkId& next_id() { return next_id_; }

  // What search_landmarks() asks of a filter.
  int size() const { return filter_.feature_count(); }
  LandmarkId id(int slot) const { return filter_.feature_id(slot); }
  Status predict(int slot, PixelPrediction<float>& prediction) const {
    return filter_.predict_feature(slot, prediction);
  }
  /// With the focal length as the filter estimates it.
  PinholeCamera<float> camera() const { return filter_.camera(); }
  Rigid<float> T_world_camera() const { return filter_.T_world_camera(); }

  /// Most units of work that update() takes with so many matches, hypotheses of three apart: those
  /// are drawn from what the frame has left.
  int update_work(int matches) const {
    const int most = filter_.parameters().ransac.max_hypotheses;
    return work::mono_update(filter_.state_size(), filter_.feature_count(), matches,
                             matches < most ? matches : most, matches);
  }

  /// Updates the filter with the matches from `first` on that the frame can pay for; the last ones
  /// are left out first, and do not count as searched. `usable` false: with none of them, so that
  /// the filter's statistics go on. Errors, in the result: as MonoEkf::update(); there is then no
  /// inlier.
  PixelUpdate update(FrameContext& frame, Matches& matches, int first, bool usable);

  /// Removes a feature from the filter and from the records. False when there is no such slot.
  bool remove(FrameContext& frame, int slot);

 private:
  int leave_out(FrameContext& frame, Matches& matches, int first);
  int affordable_triples(FrameWork& work, int matches) const;

  Filter filter_;
  Landmarks landmarks_;
  LandmarkId next_id_ = 1;
};

template <int MaxFeatures>
int HandheldEstimate<MaxFeatures>::leave_out(FrameContext& frame, Matches& matches, int first) {
  const int used =
      affordable_matches(matches.size() - first, frame.work, [&](int n) { return update_work(n); });
  const int left_out = matches.size() - first - used;
  for (int i = first + used; i < matches.size(); ++i) {
    if (TrackedLandmark* landmark = landmarks_.find(matches[i].id)) {
      --landmark->predicted;
      --landmark->misses;
    }
  }
  matches.resize(first + used);
  if (left_out > 0) frame.work.raise_cut(FrameCut::kFewerUpdates);
  return left_out;
}

template <int MaxFeatures>
int HandheldEstimate<MaxFeatures>::affordable_triples(FrameWork& work, int matches) const {
  const int most = filter_.parameters().max_triples;
  const int left = work.budget().left() - update_work(matches);
  const int each = work::mono_triples(filter_.state_size(), matches, 1);
  return left <= 0 ? 0 : left / each < most ? left / each : most;
}

template <int MaxFeatures>
PixelUpdate HandheldEstimate<MaxFeatures>::update(FrameContext& frame, Matches& matches, int first,
                                                  bool usable) {
  PixelUpdate result;
  if (usable) result.left_out = leave_out(frame, matches, first);
  const int count = usable ? matches.size() - first : 0;
  filter_.set_triple_limit(affordable_triples(frame.work, count));
  result.status = filter_.update(matches.data() + first, count, frame.random, result.report);
  frame.work.spend(work::mono_update(filter_.state_size(), filter_.feature_count(), count,
                                     result.report.hypotheses, result.report.nis_dof / 2) +
                   work::mono_triples(filter_.state_size(), count, result.report.triples));
  for (int i = first; i < first + count; ++i) {
    result.inliers += ok(result.status) && matches[i].inlier ? 1 : 0;
  }
  return result;
}

template <int MaxFeatures>
bool HandheldEstimate<MaxFeatures>::remove(FrameContext& frame, int slot) {
  const LandmarkId id = filter_.feature_id(slot);
  if (!ok(filter_.remove_feature(slot))) return false;
  landmarks_.remove(id);
  ++frame.report.removed;
  ++frame.health.landmarks_removed;
  return true;
}

}  // namespace cairn
