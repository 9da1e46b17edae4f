#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: updates.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCovariance2 FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::relative_covariance(
    int slot, std::uint32_t& saturations) const {
  const int l = state_of(slot);
  int bits = RowScaledFactor<kStates>::kMostBits;
  for (const int row : {1, 2, l, l + 1}) {
    bits = factor_.bits(row) < bits ? factor_.bits(row) : bits;
  }
  --bits;                     // a difference of two
  std::int64_t turn[2] = {};  // the heading's part, in the first column
  if constexpr (kWorld) {
    const FixedLength by[2] = {lever(slot, 1), -lever(slot, 0)};
    const std::uint64_t larger = wide::magnitude(by[0].raw()) | wide::magnitude(by[1].raw());
    const int fits = factor_.bits(0) + FixedLength::kFractionBits - wide::bit_length(larger) - 1;
    bits = (fits < bits ? fits : bits) - 1;
    for (int axis = 0; axis < 2; ++axis) {
      turn[axis] = wide::scale(std::int64_t{by[axis].raw()} * factor_.at(0, 0),
                               bits - FixedLength::kFractionBits - factor_.bits(0), saturations);
    }
  }
  std::int64_t xx = 0;
  std::int64_t xy = 0;
  std::int64_t yy = 0;
  const auto shift_of = [&](int row) {
    const int shift = factor_.bits(row) - bits;
    return shift < 31 ? shift : 31;
  };
  const int shifts[2] = {shift_of(l), shift_of(l + 1)};
  auto first = factor_.row(l);
  auto second = factor_.row(l + 1);
  for (int j = 0; j <= l + 1; ++j) {
    std::int32_t d[2] = {j <= l ? first.next() >> shifts[0] : 0, second.next() >> shifts[1]};
    if (j <= 2) {  // the vehicle's
      for (int axis = 0; axis < 2; ++axis) {
        if (j <= 1 + axis) d[axis] -= factor_.at(1 + axis, j) >> shift_of(1 + axis);
        if (kWorld && j == 0) d[axis] += static_cast<std::int32_t>(turn[axis]);
      }
    }
    xx += std::int64_t{d[0]} * d[0];
    xy += std::int64_t{d[0]} * d[1];
    yy += std::int64_t{d[1]} * d[1];
  }
  const auto variance = [&](std::int64_t sum) {
    return FixedVariance::from_raw(
        wide::scale(sum, FixedVariance::kFractionBits - 2 * bits, saturations));
  };
  FixedCovariance2 out = {variance(xx), variance(xy), variance(yy)};
  motion_.add_relative(relative(slot, 0), relative(slot, 1), out, saturations);
  return out;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::predict_range_bearing(
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
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
template <class Observation>
int FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::collect(Span<Observation> observations,
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
    refuse(slot, report);
  }
  return count;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
template <class Observation>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::update(Span<Observation> observations,
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
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
bool FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::tells_nothing_new(
    int count, FixedUpdateReport& report) {
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

/// Updates with sightings that are all linearised at the present mean. `deviates`: the mean was
/// moved away from the prior by the opposite of correction_.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
template <class Sighting>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::apply(const Sighting* sightings, int count,
                                                              FixedUpdateReport& report,
                                                              bool deviates) {
  if (count == 0) {
    if (deviates) correct();
    return;
  }
  absorb_motion();
  for (int i = 0; i < factor_.size() && !deviates; ++i) correction_[i] = 0;
  std::int64_t nis = 0;
  int rows = 0;
  for (int k = 0; k < count; ++k) {
    for (int row = 0; row < sightings[k].rows; ++row) {
      nis = wide::add(nis, apply_row(sightings[k], row), saturations_);
      ++rows;
    }
  }
  report.nis = add(report.nis, FixedCoordinate::from_raw(nis), saturations_);
  report.nis_dof += rows;
  correct();
  rest_.note_moving(nis, rows);
  if (parameters_.rest_sigmas.raw() > 0) rest_.begin();
}

/// Conditions the covariance on one measurement and adds its part to the correction; its normalised
/// innovation squared, with the fraction of the report's.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
std::int64_t FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::apply_row(
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
  // By the heading, in the world's error: h J (landmark - vehicle).
  FixedLength by_heading;
  if constexpr (kWorld) {
    const auto part = [&](int axis, FixedRatio factor) {
      return multiply<FixedLength>(relative(sighting.slot, axis), factor, saturations_);
    };
    const auto ratio = [&](int axis) {
      return FixedRatio::from_raw(static_cast<std::int32_t>(h[axis]));
    };
    by_heading = subtract(part(1, ratio(0)), part(0, ratio(1)), saturations_);
    const int length =
        wide::bit_length(wide::magnitude(by_heading.raw())) - FixedLength::kFractionBits;
    const int fits = factor_.bits(0) - length - 1;
    bits = (fits < bits ? fits : bits) - 1;
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
  const std::int32_t factors[2] = {static_cast<std::int32_t>(h[0]),
                                   static_cast<std::int32_t>(h[1])};
  const auto shift_of = [&](int state) {
    const int shift = FixedRatio::kFractionBits + factor_.bits(state) - bits;
    return shift < 63 ? shift : 63;
  };
  const auto scaled = [&](int axis, std::int32_t element, int shift) {
    return static_cast<std::int32_t>(
        wide::round_shift_far(std::int64_t{factors[axis]} * element, shift));
  };
  const int shifts[2] = {shift_of(l), shift_of(l + 1)};
  auto first = factor_.row(l);
  auto second = factor_.row(l + 1);
  for (int j = 0; j <= l; ++j) {
    a[j] = scaled(0, first.next(), shifts[0]) + scaled(1, second.next(), shifts[1]);
  }
  a[l + 1] = scaled(1, second.next(), shifts[1]);
  for (int axis = 0; axis < 2; ++axis) {
    const int shift = shift_of(1 + axis);
    for (int j = 0; j <= 1 + axis; ++j) a[j] -= scaled(axis, factor_.at(1 + axis, j), shift);
  }
  if constexpr (kWorld) {
    a[0] += static_cast<std::int32_t>(
        wide::scale(std::int64_t{by_heading.raw()} * factor_.at(0, 0),
                    bits - FixedLength::kFractionBits - factor_.bits(0), saturations_));
  }

  // The innovation at the mean corrected so far.
  std::int64_t innovation =
      sighting.innovation[row].raw() * (std::int64_t{1} << FixedRatio::kFractionBits);
  for (int k = 0; k < 4; ++k) {
    const std::int64_t part = h[k % 2] * correction_[states[k]];
    innovation += k < 2 ? -part : part;
  }
  innovation = wide::round_shift(innovation, FixedRatio::kFractionBits);
  if (kWorld) {
    innovation -= wide::round_shift(
        std::int64_t{by_heading.raw()} * correction_[0],
        FixedLength::kFractionBits + FixedAngle::kFractionBits - FixedOffset::kFractionBits);
  }
  return take_in(l + 1, bits, sigma, innovation, FixedOffset::kFractionBits);
}

/// Conditions the covariance on the row in scratch_, zero beyond `last`, with `bits` of fraction as
/// `sigma`, and adds its part to the correction; `innovation` has `fraction` bits of it. Its
/// normalised innovation squared, with the fraction of the report's.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
std::int64_t FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::take_in(int last, int bits,
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
  for (int i = 0; i < n; ++i) {
    // A row's scale has 20 bits or more: 12 to go at least.
    const int down = factor_.bits(i) + kScoreBits - correction_bits(i);
    const std::int64_t part = wide::round_shift_far(std::int64_t{gain[i]} * y, down);
    correction_[i] = wide::narrow(correction_[i] + part, saturations_);
  }
  return wide::round_shift(std::int64_t{y} * y, 2 * kScoreBits - FixedCoordinate::kFractionBits);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::correct() {
  const auto by = [&](int i) { return FixedOffset::from_raw(correction_[i]); };
  if constexpr (kWorld) {
    const std::int64_t pi = kFixedPi.raw();
    const std::int64_t turn = correction_[0];
    heading_ = wrapped_angle(heading_.raw() + (turn > pi ? pi : (turn < -pi ? -pi : turn)));
    const auto move = [&](FixedCoordinate& coordinate, int i) {
      coordinate = add(coordinate, convert<FixedCoordinate>(by(i), saturations_), saturations_);
    };
    for (int axis = 0; axis < 2; ++axis) {
      move(x_[axis], 1 + axis);
      for (int slot = 0; slot < slots_.size(); ++slot) move(p_[slot][axis], state_of(slot) + axis);
    }
    return;
  }
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
  if (tilts()) tilt_ = tilt_after();
}

}  // namespace cairn
