#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: updates.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::predict_range_bearing(
    int slot, FixedLength sensor_offset, FixedLength sigma_range, FixedAngle sigma_bearing,
    FixedRangeBearingPrediction& prediction) const {
  if (!initialised_) return Status::kNotInitialised;
  if (slot < 0 || slot >= landmark_count()) return Status::kNotFound;
  if (sigma_range.raw() <= 0 || sigma_bearing.raw() <= 0) return Status::kInvalidArgument;
  std::uint32_t none = 0;
  FixedRangeBearingPrediction expected;
  FixedRatio cosine;
  FixedRatio sine;
  if (!detail::expected_range_bearing(state_.axes(), state_.relative(slot, 0),
                                      state_.relative(slot, 1), sensor_offset, expected, cosine,
                                      sine, none)) {
    return Status::kOutOfView;
  }
  const FixedCovariance2 s =
      detail::along_direction(errors_.relative_covariance(state_, slot, none), cosine, sine, none);
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
  records_.begin();
  const detail::FixedAxes axes = state_.axes();
  int count = 0;
  for (const Observation& observation : observations) {
    const int slot = find(observation.id);
    if (slot < 0) continue;
    ++report.matches;
    detail::FixedSighting& sighting = sightings_[count];
    sighting.slot = slot;
    if (!linearise(observation, axes, state_.relative(slot, 0), state_.relative(slot, 1),
                   sensor_offset, sighting, saturations_)) {
      ++health_.innovations_singular;
      continue;
    }
    const FixedScore score = detail::score(
        sighting, errors_.relative_covariance(state_, slot, saturations_), saturations_);
    if (score <= parameters_.gate) {
      records_.admit(score);
      ++count;
    } else {
      records_.refuse(slot, report, health_);
    }
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
    if (tells_nothing_new(sightings_, count, report)) return Status::kOk;
    end_rest();
    count = collect(observations, sensor_offset, report);
  }
  apply(sightings_, count, report);
  finish_update(sightings_, count, report);
  return Status::kOk;
}

/// At rest: whether the sightings agree with no motion. They are then counted, and the noise held
/// back is dropped.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
template <class Sighting>
bool FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::tells_nothing_new(
    const Sighting* sightings, int count, FixedUpdateReport& report) {
  constexpr int kFewest = 3;        // fewer prove little
  constexpr int kRefusedShare = 4;  // nor do some of which one in four is refused
  constexpr int kBits = FixedScore::kFractionBits;
  if (count < kFewest || records_.refused() * kRefusedShare > count) return false;
  if (parameters_.rest_sigmas.raw() <= 0) return false;
  const int rows = 2 * count;
  const std::int64_t score = records_.admitted_score();
  if (!rest_.agrees(score, rows, parameters_.rest_sigmas)) return false;
  rest_.begin();
  report.nis = FixedCoordinate::from_raw(
      wide::scale(score, FixedCoordinate::kFractionBits - kBits, saturations_));
  report.nis_dof = rows;
  finish_update(sightings, count, report);
  return true;
}

/// Updates with sightings that are all linearised at the present mean. `deviates`: the mean was
/// moved away from the prior by the opposite of the correction.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
template <class Sighting>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::apply(const Sighting* sightings, int count,
                                                              FixedUpdateReport& report,
                                                              bool deviates) {
  if (count == 0) {
    if (deviates) correction_.apply(state_, saturations_);
    return;
  }
  absorb_motion();
  if (!deviates) correction_.clear(state_size());
  std::int64_t nis = 0;
  int rows = 0;
  for (int k = 0; k < count; ++k) {
    for (int row = 0; row < sightings[k].rows; ++row) {
      const std::int64_t part =
          correction_.take_in(sightings[k], row, state_, errors_, saturations_);
      nis = wide::add(nis, part, saturations_);
      ++rows;
    }
  }
  report.nis = add(report.nis, FixedCoordinate::from_raw(nis), saturations_);
  report.nis_dof += rows;
  correction_.apply(state_, saturations_);
  rest_.note_moving(nis, rows);
  if (parameters_.rest_sigmas.raw() > 0) rest_.begin();
}

/// Book-keeping after an update; landmarks that the gate may have locked out are widened.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
template <class Sighting>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::finish_update(const Sighting* sightings,
                                                                      int used,
                                                                      FixedUpdateReport& report) {
  if (report.matches == 0) return;
  records_.finish(sightings, used, parameters_, state_.slots(), health_);
  for (int k = 0; k < records_.refused(); ++k) {
    const int doublings = records_.doublings(k, parameters_, state_.slots());
    if (doublings < 0) continue;
    errors_.widen_landmark(state_of(records_.refused_slot(k)), parameters_.reacquire_landmark,
                           doublings, saturations_);
    ++health_.reacquisitions;
  }
}

}  // namespace cairn
