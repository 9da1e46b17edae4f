#pragma once

#include "cairn/planar/fixed/fixed_group_slam.hpp"

// FixedGroupSlam: updates and their book-keeping.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim>
FixedCovariance2 FixedGroupSlam<MaxLandmarks, LandmarkDim>::relative_covariance(
    int slot, std::uint32_t& saturations) const {
  const int l = state_of(slot);
  int bits = RowScaledFactor<kStates>::kMostBits;
  for (const int row : {1, 2, l, l + 1}) {
    bits = factor_.bits(row) < bits ? factor_.bits(row) : bits;
  }
  --bits;  // a difference of two
  std::int64_t xx = 0;
  std::int64_t xy = 0;
  std::int64_t yy = 0;
  for (int j = 0; j <= l + 1; ++j) {
    std::int64_t d[2] = {};
    for (int axis = 0; axis < 2; ++axis) {
      if (j <= l + axis) d[axis] = factor_.at(l + axis, j) >> (factor_.bits(l + axis) - bits);
      if (j <= 1 + axis) d[axis] -= factor_.at(1 + axis, j) >> (factor_.bits(1 + axis) - bits);
    }
    xx += d[0] * d[0];
    xy += d[0] * d[1];
    yy += d[1] * d[1];
  }
  const auto variance = [&](std::int64_t sum) {
    return FixedVariance::from_raw(
        wide::scale(sum, FixedVariance::kFractionBits - 2 * bits, saturations));
  };
  FixedCovariance2 out = {variance(xx), variance(xy), variance(yy)};
  motion_.add_relative(relative(slot, 0), relative(slot, 1), out, saturations);
  return out;
}

template <int MaxLandmarks, int LandmarkDim>
Status FixedGroupSlam<MaxLandmarks, LandmarkDim>::predict_range_bearing(
    int slot, FixedLength sensor_offset, FixedLength sigma_range, FixedAngle sigma_bearing,
    FixedRangeBearingPrediction& prediction) const {
  if (!initialised_) return Status::kNotInitialised;
  if (slot < 0 || slot >= slots_.size()) return Status::kNotFound;
  if (sigma_range.raw() <= 0 || sigma_bearing.raw() <= 0) return Status::kInvalidArgument;
  std::uint32_t none = 0;
  FixedRangeBearingPrediction expected;
  FixedRatio cosine;
  FixedRatio sine;
  if (!detail::expected_range_bearing(detail::FixedAxes(heading_), relative(slot, 0),
                                      relative(slot, 1), sensor_offset, expected, cosine, sine,
                                      none)) {
    return Status::kOutOfView;
  }
  const FixedCovariance2 s =
      detail::along_direction(relative_covariance(slot, none), cosine, sine, none);
  const auto noise = [&](auto sigma) { return multiply<FixedVariance>(sigma, sigma, none); };
  using Fine = Fixed<std::int64_t, 28>;
  expected.range_variance = add(s.xx, noise(convert<Fine>(sigma_range, none)), none);
  expected.range_bearing = divide<FixedVariance>(s.xy, expected.range, none);
  const auto across = divide<FixedVariance>(s.yy, expected.range, none);
  expected.bearing_variance =
      add(divide<FixedVariance>(across, expected.range, none), noise(sigma_bearing), none);
  prediction = expected;
  return Status::kOk;
}

/// Fills sightings_ with the sightings of known landmarks inside their gates; the number of them.
template <int MaxLandmarks, int LandmarkDim>
template <class Observation>
int FixedGroupSlam<MaxLandmarks, LandmarkDim>::collect(Span<Observation> observations,
                                                       FixedLength sensor_offset,
                                                       FixedUpdateReport& report) {
  report = FixedUpdateReport{};
  refused_count_ = 0;
  admitted_score_ = 0;
  const detail::FixedAxes axes(heading_);
  int count = 0;
  for (const Observation& observation : observations) {
    const int slot = find(observation.id);
    if (slot < 0) continue;
    ++report.matches;
    detail::FixedSighting& sighting = sightings_[count];
    sighting.slot = slot;
    if (!linearise(observation, axes, relative(slot, 0), relative(slot, 1), sensor_offset, sighting,
                   saturations_)) {
      ++health_.innovations_singular;
      continue;
    }
    const FixedScore score =
        detail::score(sighting, relative_covariance(slot, saturations_), saturations_);
    if (score <= parameters_.gate) {
      admitted_score_ += score.raw();
      used_[count++] = static_cast<std::int16_t>(slot);
      continue;
    }
    ++report.gated;
    ++health_.innovations_gated;
    refused_[refused_count_++] = static_cast<std::int16_t>(slot);
  }
  return count;
}

template <int MaxLandmarks, int LandmarkDim>
template <class Observation>
Status FixedGroupSlam<MaxLandmarks, LandmarkDim>::update(Span<Observation> observations,
                                                         FixedLength sensor_offset,
                                                         FixedUpdateReport& report) {
  if (!initialised_) return Status::kNotInitialised;
  if (observations.size < 0 || observations.size > kMaxObservations) {
    return Status::kInvalidArgument;
  }
  for (const Observation& observation : observations) {
    const Status status = detail::check(observation);
    if (!ok(status)) return status;
  }
  int count = collect(observations, sensor_offset, report);
  if (rest_.resting()) {
    if (tells_nothing_new(count, report)) return Status::kOk;
    end_rest();
    count = collect(observations, sensor_offset, report);
  }
  apply(sightings_, count, report);
  finish_update(count, report);
  return Status::kOk;
}

/// At rest: whether the sightings agree with no motion. They are then counted, and the noise held
/// back is dropped.
template <int MaxLandmarks, int LandmarkDim>
bool FixedGroupSlam<MaxLandmarks, LandmarkDim>::tells_nothing_new(int count,
                                                                  FixedUpdateReport& report) {
  constexpr int kFewest = 3;        // fewer prove little
  constexpr int kRefusedShare = 4;  // nor do some of which one in four is refused
  constexpr int kBits = FixedScore::kFractionBits;
  if (count < kFewest || refused_count_ * kRefusedShare > count) return false;
  if (parameters_.rest_sigmas.raw() <= 0) return false;
  const int rows = 2 * count;
  if (!rest_.agrees(admitted_score_, rows, parameters_.rest_sigmas)) return false;
  rest_.begin();
  report.nis = FixedCoordinate::from_raw(
      wide::scale(admitted_score_, FixedCoordinate::kFractionBits - kBits, saturations_));
  report.nis_dof = rows;
  finish_update(count, report);
  return true;
}

/// Updates with sightings that are all linearised at the present mean.
template <int MaxLandmarks, int LandmarkDim>
template <class Sighting>
void FixedGroupSlam<MaxLandmarks, LandmarkDim>::apply(const Sighting* sightings, int count,
                                                      FixedUpdateReport& report) {
  if (count == 0) return;
  absorb_motion();
  for (int i = 0; i < factor_.size(); ++i) correction_[i] = 0;
  std::int64_t nis = 0;
  int rows = 0;
  for (int k = 0; k < count; ++k) {
    for (int row = 0; row < sightings[k].rows; ++row) {
      nis = wide::add(nis, apply_row(sightings[k], row), saturations_);
      ++rows;
    }
  }
  report.nis = FixedCoordinate::from_raw(nis);
  report.nis_dof = rows;
  correct();
  rest_.note_moving(nis, rows);
  if (parameters_.rest_sigmas.raw() > 0) rest_.begin();
}

/// Conditions the covariance on one measurement and adds its part to the correction; its normalised
/// innovation squared, with the fraction of the report's.
template <int MaxLandmarks, int LandmarkDim>
std::int64_t FixedGroupSlam<MaxLandmarks, LandmarkDim>::apply_row(
    const detail::FixedSighting& sighting, int row) {
  const int l = state_of(sighting.slot);
  const int states[4] = {l, l + 1, 1, 2};
  const std::int64_t cosine = sighting.cosine.raw();
  const std::int64_t sine = sighting.sine.raw();
  const std::int64_t h[2] = {row == 0 ? cosine : -sine, row == 0 ? sine : cosine};

  // One scale for the row's elements on the columns and the noise, so that all stay below 2^30.
  int bits = RowScaledFactor<kStates>::kMostBits;
  for (const int state : states) {
    bits = factor_.bits(state) < bits ? factor_.bits(state) : bits;
  }
  bits -= 2;
  const std::int64_t noise = sighting.sigma[row].raw();
  const int room =
      29 - wide::bit_length(static_cast<std::uint64_t>(noise)) + FixedOffset::kFractionBits;
  if (bits > room) bits = room;
  auto sigma = static_cast<std::int32_t>(
      wide::scale(noise, bits - FixedOffset::kFractionBits, saturations_));
  if (sigma == 0) sigma = 1;

  std::int32_t* const a = scratch_;
  for (int j = 0; j <= l + 1; ++j) {
    std::int64_t sum = 0;
    for (int k = 0; k < 4; ++k) {
      if (j > states[k]) continue;
      const std::int64_t part = h[k % 2] * factor_.at(states[k], j);
      const std::int64_t scaled =
          wide::round_shift(part, FixedRatio::kFractionBits + factor_.bits(states[k]) - bits);
      sum += k < 2 ? scaled : -scaled;
    }
    a[j] = static_cast<std::int32_t>(sum);
  }

  // The innovation at the mean corrected so far.
  std::int64_t innovation =
      sighting.innovation[row].raw() * (std::int64_t{1} << FixedRatio::kFractionBits);
  for (int k = 0; k < 4; ++k) {
    const std::int64_t part = h[k % 2] * correction_[states[k]];
    innovation += k < 2 ? -part : part;
  }
  return take_in(l + 1, bits, sigma, wide::round_shift(innovation, FixedRatio::kFractionBits),
                 FixedOffset::kFractionBits);
}

/// Conditions the covariance on the row in scratch_, zero beyond `last`, with `bits` of fraction as
/// `sigma`, and adds its part to the correction; `innovation` has `fraction` bits of it. Its
/// normalised innovation squared, with the fraction of the report's.
template <int MaxLandmarks, int LandmarkDim>
std::int64_t FixedGroupSlam<MaxLandmarks, LandmarkDim>::take_in(int last, int bits,
                                                                std::int32_t sigma,
                                                                std::int64_t innovation,
                                                                int fraction) {
  constexpr int kScoreBits = 20;
  std::int32_t* const gain = scratch_ + kStates;
  factor_.condition(scratch_, last, sigma, gain);
  // The innovation in standard deviations.
  const int shift = kScoreBits + bits - fraction;
  const std::int32_t y =
      wide::narrow(wide::divide(shift < 0 ? wide::round_shift(innovation, -shift) : innovation,
                                sigma, shift < 0 ? 0 : shift, saturations_),
                   saturations_);
  const int n = factor_.size();
  const int vehicle = vehicle_states();
  for (int i = 0; i < n; ++i) {
    const bool angle = i == 0 || (i >= kTiltState && i < vehicle);
    const int own = angle ? FixedAngle::kFractionBits : FixedOffset::kFractionBits;
    const std::int64_t part =
        wide::scale(std::int64_t{gain[i]} * y, own - factor_.bits(i) - kScoreBits, saturations_);
    correction_[i] = wide::narrow(correction_[i] + part, saturations_);
  }
  return wide::round_shift(std::int64_t{y} * y, 2 * kScoreBits - FixedCoordinate::kFractionBits);
}

template <int MaxLandmarks, int LandmarkDim>
void FixedGroupSlam<MaxLandmarks, LandmarkDim>::correct() {
  const auto by = [&](int i) { return FixedOffset::from_raw(correction_[i]); };
  const detail::FixedExponential exponential(FixedAngle::from_raw(correction_[0]), saturations_);
  heading_ = wrapped_angle(std::int64_t{heading_.raw()} + exponential.angle().raw());
  exponential.move(x_[0], x_[1], by(1), by(2), saturations_);
  for (int slot = 0; slot < slots_.size(); ++slot) {
    const int l = state_of(slot);
    exponential.move(p_[slot][0], p_[slot][1], by(l), by(l + 1), saturations_);
    if constexpr (LandmarkDim == 3) {
      p_[slot][2] =
          add(p_[slot][2], convert<FixedCoordinate>(by(l + 2), saturations_), saturations_);
    }
  }
  if (tilts()) {
    const auto turned = [&](FixedAngle angle, int state) {
      return wrapped_angle(std::int64_t{angle.raw()} + correction_[state]);
    };
    tilt_ = {turned(tilt_.pitch, kTiltState), turned(tilt_.roll, kTiltState + 1)};
  }
}

/// Book-keeping after an update: which landmarks were refused, and whether the gate has locked the
/// filter out.
template <int MaxLandmarks, int LandmarkDim>
void FixedGroupSlam<MaxLandmarks, LandmarkDim>::finish_update(int used, FixedUpdateReport& report) {
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
template <int MaxLandmarks, int LandmarkDim>
void FixedGroupSlam<MaxLandmarks, LandmarkDim>::widen_landmark(int slot, int doublings) {
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
