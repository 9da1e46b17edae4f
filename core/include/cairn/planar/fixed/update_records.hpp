#pragma once

#include "cairn/base/health.hpp"
#include "cairn/planar/detail/landmark_slots.hpp"
#include "cairn/planar/detail/reacquisition.hpp"
#include "cairn/planar/fixed/types.hpp"

namespace cairn::detail {

/// Which sightings an update admitted and refused, and what follows from it for their landmarks.
template <int MaxObservations>
class FixedUpdateRecords {
 public:
  void clear() {
    updates_ = 0;
    reacquisition_.clear();
  }
  std::uint32_t updates() const { return updates_; }
  Reacquisition& reacquisition() { return reacquisition_; }

  void begin() {
    refused_count_ = 0;
    admitted_score_ = 0;
  }
  void admit(FixedScore score) { admitted_score_ += score.raw(); }
  void refuse(int slot, FixedUpdateReport& report, Health& health) {
    ++report.gated;
    ++health.innovations_gated;
    refused_[refused_count_++] = static_cast<std::int16_t>(slot);
  }
  int refused() const { return refused_count_; }
  int refused_slot(int k) const { return refused_[k]; }
  std::int64_t admitted_score() const { return admitted_score_; }

  /// After an update that used the first `used` of `sightings`.
  template <class Sighting, class Slots>
  void finish(const Sighting* sightings, int used, const FixedPlanarParameters& parameters,
              Slots& slots, Health& health);
  /// After finish(): by how many doublings of its noise the k-th refused landmark is to be widened,
  /// since the gate may have locked it out; -1: not at all.
  template <class Slots>
  int doublings(int k, const FixedPlanarParameters& parameters, const Slots& slots) const;

 private:
  Reacquisition reacquisition_;
  std::uint32_t updates_ = 0;
  std::int16_t refused_[MaxObservations] = {};
  int refused_count_ = 0;
  std::int64_t admitted_score_ = 0;
};

template <int MaxObservations>
template <class Sighting, class Slots>
void FixedUpdateRecords<MaxObservations>::finish(const Sighting* sightings, int used,
                                                 const FixedPlanarParameters& parameters,
                                                 Slots& slots, Health& health) {
  ++updates_;
  for (int k = 0; k < used; ++k) {
    LandmarkStatistics& s = slots.statistics(sightings[k].slot);
    ++s.measured;
    s.rejected_in_row = 0;
    s.last_measured = updates_;
  }
  int again = 0;
  for (int k = 0; k < refused_count_; ++k) {
    LandmarkStatistics& s = slots.statistics(refused_[k]);
    ++s.rejected;
    if (++s.rejected_in_row > 1) ++again;
  }
  health.innovations_used += static_cast<std::uint32_t>(used);
  if (parameters.reacquire_after == 0) return;
  reacquisition_.note(used, again, parameters.reacquire_after, parameters.reacquire_steps);
}

template <int MaxObservations>
template <class Slots>
int FixedUpdateRecords<MaxObservations>::doublings(int k, const FixedPlanarParameters& parameters,
                                                   const Slots& slots) const {
  if (parameters.reacquire_after == 0 || !reacquisition_.accepted()) return -1;
  const auto after = static_cast<std::uint32_t>(parameters.reacquire_landmark_after);
  const std::uint32_t in_row = slots.statistics(refused_[k]).rejected_in_row;
  if (in_row < after) return -1;
  const std::uint32_t step = in_row - after;
  return step > static_cast<std::uint32_t>(parameters.reacquire_steps) ? -1
                                                                       : static_cast<int>(step);
}

}  // namespace cairn::detail
