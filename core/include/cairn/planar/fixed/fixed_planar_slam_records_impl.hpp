#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: book-keeping of updates.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::refuse(int slot,
                                                               FixedUpdateReport& report) {
  ++report.gated;
  ++health_.innovations_gated;
  refused_[refused_count_++] = static_cast<std::int16_t>(slot);
}

/// Book-keeping after an update: which landmarks were refused, and whether the gate has locked the
/// filter out.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::finish_update(int used,
                                                                      FixedUpdateReport& report) {
  if (report.matches == 0) return;
  ++updates_;
  for (int k = 0; k < used; ++k) {
    LandmarkStatistics& s = slots_.statistics(used_[k]);
    ++s.measured;
    s.rejected_in_row = 0;
    s.last_measured = updates_;
  }
  int again = 0;
  for (int k = 0; k < refused_count_; ++k) {
    LandmarkStatistics& s = slots_.statistics(refused_[k]);
    ++s.rejected;
    if (++s.rejected_in_row > 1) ++again;
  }
  health_.innovations_used += static_cast<std::uint32_t>(used);
  if (parameters_.reacquire_after == 0) return;
  reacquisition_.note(used, again, parameters_.reacquire_after, parameters_.reacquire_steps);
  if (!reacquisition_.accepted()) return;
  const auto after = static_cast<std::uint32_t>(parameters_.reacquire_landmark_after);
  for (int k = 0; k < refused_count_; ++k) {
    const std::uint32_t in_row = slots_.statistics(refused_[k]).rejected_in_row;
    if (in_row < after) continue;
    const std::uint32_t step = in_row - after;
    if (step > static_cast<std::uint32_t>(parameters_.reacquire_steps)) continue;
    widen_landmark(refused_[k], static_cast<int>(step));
    ++health_.reacquisitions;
  }
}

/// Adds position noise of the parameters' standard deviation, doubled `doublings` times.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::widen_landmark(int slot, int doublings) {
  const std::int64_t sigma = parameters_.reacquire_landmark.raw();
  const int fraction = FixedLength::kFractionBits - doublings;
  const int length = wide::bit_length(static_cast<std::uint64_t>(sigma)) - fraction;
  const int n = factor_.size();
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    const int row = state_of(slot) + axis;
    if (!factor_.make_room(row, 2 * length, saturations_)) continue;
    for (int i = 0; i < n; ++i) scratch_[i] = 0;
    scratch_[row] = factor_.to_row(row, sigma, fraction);
    factor_.absorb(scratch_, row);
  }
}

}  // namespace cairn
