#pragma once

#include "cairn/planar/fixed/correction.hpp"
#include "cairn/planar/fixed/hypothesis.hpp"

namespace cairn::detail {

/// Which pixels agree with the mean that one of them alone would correct: the hypotheses of a
/// 1-point RANSAC. State and errors stay as they are; the correction becomes that of the
/// hypothesis.
template <class State, FixedError Error>
class FixedConsensus {
 public:
  using Errors = FixedPlanarError<State, Error>;
  using Hypothesis = FixedHypothesis<State::kStates>;

  /// A camera on the vehicle, and the largest score of a pixel that agrees.
  FixedConsensus(const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                 FixedScore threshold)
      : camera_(camera), T_vehicle_camera_(T_vehicle_camera), threshold_(threshold) {}

  /// Corrects by one sighting alone. Cost: n (n + 1) multiply-adds.
  static Hypothesis form(const FixedPixelSighting& sighting, const State& state, Errors& errors,
                         FixedCorrection<State, Error>& correction, std::uint32_t& saturations);

  /// Marks the sightings whose pixels agree then, judged by the covariance that is left; their
  /// number. `matches`: by a sighting's source.
  int count(int candidate, const FixedPixelSighting* sightings, int sighting_count,
            const FixedPixelMatch* matches, const State& state, Errors& errors,
            FixedCorrection<State, Error>& correction, bool* inliers,
            std::uint32_t& saturations) const;

 private:
  /// The mean that a hypothesis leads to.
  struct Corrected {
    const State& state;
    const Hypothesis& hypothesis;
    const FixedCorrection<State, Error>& correction;
    FixedExponential exponential;
    FixedCameraView view;
  };
  static FixedMeasurement measurement_of(const FixedPixelSighting& sighting, const State& state);
  FixedCameraView view_after(const FixedExponential& exponential, const State& state,
                             const FixedCorrection<State, Error>& correction,
                             std::uint32_t& saturations) const;
  static void relative_after(const Corrected& at, int slot, FixedLength (&out)[3],
                             std::uint32_t& saturations);
  bool agrees(const Corrected& at, const FixedPixelSighting& other, const FixedPixelMatch& match,
              std::uint32_t& saturations) const;
  bool is_certain(const FixedCovariance2& prior, const FixedVariance (&noise)[2],
                  const std::int64_t (&residual)[2], bool& inside) const;

  const FixedCamera& camera_;
  const FixedMount& T_vehicle_camera_;
  FixedScore threshold_;
};

template <class State, FixedError Error>
FixedMeasurement FixedConsensus<State, Error>::measurement_of(const FixedPixelSighting& sighting,
                                                              const State& state) {
  static_assert(FixedMeasurement::kBits == kPixelBits);
  FixedMeasurement out;
  out.last = state.state_of(sighting.slot) + State::kLandmarkDim - 1;
  for (int i = 0; i < 2; ++i) {
    out.row[i] = state.row_of(sighting, i);
    out.innovation[i] = sighting.innovation[i];
    out.sigma[i] = sighting.sigma[i];
  }
  return out;
}

template <class State, FixedError Error>
typename FixedConsensus<State, Error>::Hypothesis FixedConsensus<State, Error>::form(
    const FixedPixelSighting& sighting, const State& state, Errors& errors,
    FixedCorrection<State, Error>& correction, std::uint32_t& saturations) {
  Hypothesis hypothesis(errors.factor(), errors.scratch());
  hypothesis.form(measurement_of(sighting, state), saturations);
  for (int i = 0; i < errors.factor().size(); ++i) {
    correction[i] = hypothesis.correction(i, state.correction_bits(i), saturations);
  }
  return hypothesis;
}

template <class State, FixedError Error>
int FixedConsensus<State, Error>::count(int candidate, const FixedPixelSighting* sightings,
                                        int sighting_count, const FixedPixelMatch* matches,
                                        const State& state, Errors& errors,
                                        FixedCorrection<State, Error>& correction, bool* inliers,
                                        std::uint32_t& saturations) const {
  const Hypothesis hypothesis = form(sightings[candidate], state, errors, correction, saturations);
  const FixedExponential exponential(FixedAngle::from_raw(correction[0]), saturations);
  const Corrected at = {state, hypothesis, correction, exponential,
                        view_after(exponential, state, correction, saturations)};
  int agreeing = 0;
  for (int k = 0; k < sighting_count; ++k) {
    const FixedPixelSighting& other = sightings[k];
    if (k != candidate && !agrees(at, other, matches[other.source], saturations)) continue;
    inliers[k] = true;
    ++agreeing;
  }
  return agreeing;
}

/// The camera at the corrected mean.
template <class State, FixedError Error>
FixedCameraView FixedConsensus<State, Error>::view_after(
    const FixedExponential& exponential, const State& state,
    const FixedCorrection<State, Error>& correction, std::uint32_t& saturations) const {
  const FixedAxes axes(
      wrapped_angle(std::int64_t{state.heading().raw()} + exponential.angle().raw()));
  const FixedTilt tilt = state.tilt_after(correction.values());
  return FixedCameraView(camera_, T_vehicle_camera_, axes.cosine, axes.sine,
                         state.tilts() ? &tilt : nullptr, saturations);
}

/// A landmark from the vehicle there.
template <class State, FixedError Error>
void FixedConsensus<State, Error>::relative_after(const Corrected& at, int slot,
                                                  FixedLength (&out)[3],
                                                  std::uint32_t& saturations) {
  const int l = at.state.state_of(slot);
  const auto by = [&](int i) { return FixedOffset::from_raw(at.correction[i]); };
  FixedCoordinate r[2];
  for (int axis = 0; axis < 2; ++axis) {
    r[axis] = convert<FixedCoordinate>(at.state.relative(slot, axis), saturations);
  }
  at.exponential.move(r[0], r[1], subtract(by(l), by(1), saturations),
                      subtract(by(l + 1), by(2), saturations), saturations);
  for (int axis = 0; axis < 2; ++axis) out[axis] = convert<FixedLength>(r[axis], saturations);
  const auto height = convert<FixedLength>(at.state.height(slot), saturations);
  out[2] = add(height, convert<FixedLength>(by(l + 2), saturations), saturations);
}

template <class State, FixedError Error>
bool FixedConsensus<State, Error>::agrees(const Corrected& at, const FixedPixelSighting& other,
                                          const FixedPixelMatch& match,
                                          std::uint32_t& saturations) const {
  FixedLength relative[3];
  relative_after(at, other.slot, relative, saturations);
  FixedProjection projection;
  if (!at.view.see(relative, projection, saturations)) return false;
  std::int64_t residual[2];
  other.difference(match.pixel, projection.pixel, residual, saturations);
  const FixedVariance noise[2] = {other.noise(0, saturations), other.noise(1, saturations)};
  bool inside = false;
  if (is_certain(other.own, noise, residual, inside)) return inside;
  const FixedStateRow rows[2] = {at.state.row_of(other, 0), at.state.row_of(other, 1)};
  const FixedCovariance2 left = at.hypothesis.left(rows, other.own, saturations);
  return mahalanobis(left, noise, residual, kPixelBits, saturations) <= threshold_;
}

/// Whether any covariance between the noise alone and the prior gives one answer, and which: most
/// matches need no more.
template <class State, FixedError Error>
bool FixedConsensus<State, Error>::is_certain(const FixedCovariance2& prior,
                                              const FixedVariance (&noise)[2],
                                              const std::int64_t (&residual)[2],
                                              bool& inside) const {
  std::uint32_t none = 0;  // what is too large is large
  const auto squared = [&](int i) {
    constexpr int kDown = 2 * kPixelBits - FixedVariance::kFractionBits;
    return FixedVariance::from_raw(wide::multiply(residual[i], residual[i], kDown, none));
  };
  const auto allowed = [&](FixedVariance variance) {
    return multiply<FixedVariance>(variance, threshold_, none);
  };
  const FixedVariance x = squared(0);
  const FixedVariance y = squared(1);
  inside = add(x, y, none) <= allowed(noise[0] < noise[1] ? noise[0] : noise[1]);
  return inside || x > allowed(add(prior.xx, noise[0], none)) ||
         y > allowed(add(prior.yy, noise[1], none));
}

}  // namespace cairn::detail
