#pragma once

#include "cairn/base/health.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/work_budget.hpp"

namespace cairn {

/// The work budget of a tracker's frames, and what they left out to stay within it. Without mapping
/// a tracker would run out of landmarks: after `max_frames_without_mapping` frames that could not
/// pay for it, the searches get only half of one frame's budget.
class FrameWork {
 public:
  /// Starts anew. `limit`: units of WorkBudget a frame.
  void reset(int limit, int max_frames_without_mapping) {
    *this = FrameWork();
    limit_ = limit;
    max_frames_without_mapping_ = max_frames_without_mapping;
  }
  /// From the next frame on. kInvalidArgument for a negative number, unchanged.
  Status set_limit(int units) {
    if (units < 0) return Status::kInvalidArgument;
    limit_ = units;
    return Status::kOk;
  }

  /// Begins a frame and books `fixed` units for what every frame does.
  void begin(int fixed) {
    budget_ = WorkBudget(limit_);
    budget_.spend(fixed);
    mapping_cut_ = false;
    cut_ = FrameCut::kNone;
  }
  WorkBudget& budget() { return budget_; }
  bool affords(int units) const { return budget_.affords(units); }
  int left() const { return budget_.left(); }
  bool take(int units) {
    if (!budget_.affords(units)) return false;
    budget_.spend(units);
    return true;
  }
  void spend(int units) { budget_.spend(units); }
  /// Units that searches may take. `later`: units kept for relocalisation; `update`: what the
  /// update takes if every search succeeds. A limit that does not pay for all of it pays for some
  /// searches and some updates.
  int for_searches(int later, int update) const {
    const bool mapping_waits = frames_without_mapping_ >= max_frames_without_mapping_;
    const int left = (mapping_waits ? budget_.left() / 2 : budget_.left()) - later;
    return left - update > left / 2 ? left - update : left / 2;
  }

  /// What the last search pass left out, in place of what an earlier one did.
  void set_search_cut(FrameCut cut) { cut_ = cut; }
  /// Further work was left out.
  void raise_cut(FrameCut cut) {
    if (cut_ < cut) cut_ = cut;
  }
  /// This frame could not pay for mapping.
  void cut_mapping() { mapping_cut_ = true; }
  /// False when the frame could not pay for a single search: it says nothing about the map.
  bool could_search() const { return cut_ != FrameCut::kPredictionOnly; }

  /// Ends a frame in which `deferred` searches or matches were left out: completes `report` and
  /// `health`.
  void end(int deferred, FrameReport& report, Health& health) {
    frames_without_mapping_ = mapping_cut_ ? frames_without_mapping_ + 1 : 0;
    if (mapping_cut_) raise_cut(FrameCut::kNoMapping);
    if (cut_ != FrameCut::kNone) ++health.budget_exceeded;
    health.searches_deferred += static_cast<std::uint32_t>(deferred);
    report.deferred = deferred;
    report.cut = cut_;
    report.work = budget_.spent();
  }

 private:
  WorkBudget budget_;
  int limit_ = 0;
  int max_frames_without_mapping_ = 0;
  int frames_without_mapping_ = 0;
  bool mapping_cut_ = false;  ///< in this frame
  FrameCut cut_ = FrameCut::kNone;
};

}  // namespace cairn
