#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: start and prediction.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::initialise(
    const FixedPose& pose, const FixedPoseCovariance& covariance,
    const FixedPlanarParameters& parameters) {
  const FixedCovariance2& c = covariance.position;
  if (!detail::possible(c.xx, c.yy, c.xy) ||
      !detail::possible(c.xx, covariance.heading, covariance.x_heading) ||
      !detail::possible(c.yy, covariance.heading, covariance.y_heading)) {
    return Status::kInvalidArgument;
  }
  if (!parameters.valid() || (LandmarkDim != 3 && parameters.tilt.tilts())) {
    return Status::kBadConfig;
  }
  parameters_ = parameters;
  health_ = Health{};
  saturations_ = 0;
  records_.clear();
  rest_ = detail::FixedRest();
  const bool tilts = parameters.tilt.tilts();
  state_.start(pose, tilts);
  const FixedCovariance2 tilt = detail::usual_tilt(parameters.tilt, saturations_);
  errors_.start(covariance, tilts ? &tilt : nullptr, saturations_);
  initialised_ = true;
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::predict(const FixedIncrement& increment) {
  if (!initialised_) return Status::kNotInitialised;
  const Status status = detail::validate(increment);
  if (!ok(status)) return status;
  if (!rest_.hold(increment)) {
    end_rest();
    propagate(increment);
  }
  detail::Reacquisition& reacquisition = records_.reacquisition();
  if (reacquisition.take()) {
    end_rest();
    const int doublings = reacquisition.steps() - 1;
    const auto widened = [&](auto sigma) {
      const auto fine = convert<Fixed<std::int64_t, 28>>(sigma, saturations_);
      const auto variance = multiply<FixedVariance>(fine, fine, saturations_);
      return FixedVariance::from_raw(wide::scale(variance.raw(), 2 * doublings, saturations_));
    };
    errors_.motion().widen(widened(parameters_.reacquire_position),
                           widened(parameters_.reacquire_heading), saturations_);
    ++health_.reacquisitions;
  }
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::propagate(const FixedIncrement& increment) {
  const detail::FixedStep step = detail::fixed_step(increment, state_.heading(), saturations_);
  errors_.propagate(increment, step, saturations_);
  state_.move(step, increment.turn, saturations_);
}

/// The vehicle may have moved, or there is something to learn without motion.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::end_rest() {
  if (!rest_.resting()) return;
  const FixedIncrement held = rest_.held();
  const bool noise = rest_.holds_noise();
  const FixedOffset held_s = rest_.held_s();
  rest_.clear();
  if (noise) propagate(held);
  if (held_s.raw() > 0) (void)predict_tilt(held_s);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::predict_tilt(FixedOffset dt_s) {
  if (!initialised_) return Status::kNotInitialised;
  if (dt_s.raw() < 0) return Status::kInvalidArgument;
  if (!tilts() || rest_.hold_time(dt_s)) return Status::kOk;
  const detail::FixedTiltStep step = detail::tilt_step(parameters_.tilt, dt_s, saturations_);
  state_.shrink_tilt(step.left, saturations_);
  errors_.shrink_tilt(step, saturations_);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::widen_pose(FixedVariance position,
                                                                     FixedVariance heading) {
  if (!initialised_) return Status::kNotInitialised;
  if (position.raw() < 0 || heading.raw() < 0) return Status::kInvalidArgument;
  end_rest();
  errors_.motion().widen(position, heading, saturations_);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::slip_laterally(FixedVariance variance) {
  if (!initialised_) return Status::kNotInitialised;
  if (variance.raw() < 0) return Status::kInvalidArgument;
  if (variance.raw() == 0) return Status::kOk;
  end_rest();
  errors_.motion().slip_laterally(variance, state_.heading(), saturations_);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::drift_world(FixedVariance position,
                                                                      FixedVariance heading) {
  if (!initialised_) return Status::kNotInitialised;
  if (position.raw() < 0 || heading.raw() < 0) return Status::kInvalidArgument;
  if (!kWorld) errors_.drift_world(state_, position, heading, saturations_);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
typename FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::Placement
FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::place(const FixedPose& pose,
                                                         FixedVariance position,
                                                         FixedVariance heading) {
  detail::FixedMotionNoise& motion = errors_.motion();
  const Placement before = {mean_pose(), motion};
  if (kWorld) return before;
  state_.move_to(pose, saturations_);
  const FixedCovariance2& own = motion.position();
  const FixedVariance larger = own.xx < own.yy ? own.yy : own.xx;
  const FixedVariance turn = motion.heading();
  const auto bounded = [](FixedVariance variance, FixedVariance most) {
    const FixedVariance least = variance < most ? variance : most;
    return least.raw() < 0 ? FixedVariance() : least;
  };
  motion.clear();
  motion.widen(bounded(larger, position), bounded(turn, heading), saturations_);
  return before;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::put_back(const Placement& before) {
  if (kWorld) return;
  state_.move_to(before.pose, saturations_);
  errors_.motion() = before.waiting_noise;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
bool FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::recentre() {
  constexpr FixedVariance kMost_m = FixedVariance::nearest(0.1);
  constexpr std::int64_t kNear = std::int64_t{1} << 40;  // 1 m^2
  if (kWorld || !initialised_) return false;
  const std::int64_t x[2] = {state_.vehicle(0).raw(), state_.vehicle(1).raw()};
  const std::int64_t squared = wide::add(x[0] * x[0], x[1] * x[1], saturations_);
  if (squared <= kNear) return false;
  const FixedRoot distance = square_root(squared, 2 * FixedLength::kFractionBits);
  const FixedVariance turn = errors_.pose_covariance(state_, saturations_).heading;
  if (wide::multiply(turn.raw(), distance.mantissa, distance.bits, saturations_) <= kMost_m.raw()) {
    return false;
  }
  errors_.recentre(state_, saturations_);
  state_.recentre(saturations_);
  return true;
}

}  // namespace cairn
