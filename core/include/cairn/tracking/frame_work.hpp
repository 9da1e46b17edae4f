#pragma once

#include "cairn/base/health.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/work_budget.hpp"

namespace cairn {

/// What a tracker's frames may take, and what they gave up for it. A map that is never served would
/// leave the camera without landmarks: after `max_frames_without_mapping` such frames the searches
/// get half of one frame's work.
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

  /// Begins a frame, with the units of what is done in every case.
  void begin(int always) {
    budget_ = WorkBudget(limit_);
    budget_.spend(always);
    mapping_cut_ = false;
  }
  WorkBudget& budget() { return budget_; }
  bool affords(int units) const { return budget_.affords(units); }
  bool take(int units) {
    if (!budget_.affords(units)) return false;
    budget_.spend(units);
    return true;
  }
  void spend(int units) { budget_.spend(units); }
  /// What searches may take. `later`: units kept for the look-up of a lost place; `update`: what
  /// the use of all that they may find would take. A limit that does not pay all of it pays some
  /// searches and some updates.
  int for_searches(int later, int update) const {
    const bool mapping_waits = frames_without_mapping_ >= max_frames_without_mapping_;
    const int left = (mapping_waits ? budget_.left() / 2 : budget_.left()) - later;
    return left - update > left / 2 ? left - update : left / 2;
  }
  /// The map was not served in this frame, for want of work.
  void cut_mapping() { mapping_cut_ = true; }

  /// Ends the frame: completes `report` and `health`.
  void end(FrameReport& report, Health& health) {
    frames_without_mapping_ = mapping_cut_ ? frames_without_mapping_ + 1 : 0;
    if (mapping_cut_ && report.cut < FrameCut::kNoMapping) report.cut = FrameCut::kNoMapping;
    if (report.cut != FrameCut::kNone) ++health.budget_exceeded;
    health.searches_deferred += static_cast<std::uint32_t>(report.deferred);
    report.work = budget_.spent();
  }

 private:
  WorkBudget budget_;
  int limit_ = 0;
  int max_frames_without_mapping_ = 0;
  int frames_without_mapping_ = 0;
  bool mapping_cut_ = false;  ///< in this frame
};

}  // namespace cairn
