#include "cairn/planar/fixed/motion.hpp"

namespace cairn::detail {
namespace {

using Count = std::uint32_t;

FixedVariance times(FixedVariance variance, FixedOffset factor, Count& count) {
  return multiply<FixedVariance>(variance, factor, count);
}
FixedVariance times(FixedVariance variance, FixedRatio factor, Count& count) {
  return multiply<FixedVariance>(variance, factor, count);
}
FixedVariance times(FixedVariance variance, FixedLength factor, Count& count) {
  return multiply<FixedVariance>(variance, factor, count);
}
void accumulate(FixedVariance& sum, FixedVariance value, Count& count) {
  sum = add(sum, value, count);
}

/// value / root with `fraction` bits, value with 44.
std::int64_t divide_by(std::int64_t value, FixedRoot root, int fraction, Count& count) {
  if (root.mantissa == 0) return 0;
  const int shift = fraction + root.bits - FixedVariance::kFractionBits;
  return shift >= 0 ? wide::divide(value, root.mantissa, shift, count)
                    : wide::divide(wide::round_shift(value, -shift), root.mantissa, 0, count);
}

}  // namespace

FixedStep fixed_step(const FixedIncrement& increment, FixedAngle heading, Count& saturations) {
  const bool arc = increment.model == IncrementModel::kExactArc;
  const std::int64_t half_turn = arc ? wide::round_shift(increment.turn.raw(), 1) : 0;
  FixedRatio sine;
  FixedRatio cosine;
  sin_cos(wrapped_angle(heading.raw() + half_turn), sine, cosine);
  FixedStep step;
  step.by_distance[0] = cosine;
  step.by_distance[1] = sine;
  step.x = multiply<FixedCoordinate>(increment.distance, cosine, saturations);
  step.y = multiply<FixedCoordinate>(increment.distance, sine, saturations);
  if (arc) {
    const auto half = FixedOffset::from_raw(
        static_cast<std::int32_t>(wide::round_shift(increment.distance.raw(), 1)));
    step.by_turn[0] = -multiply<FixedOffset>(half, sine, saturations);
    step.by_turn[1] = multiply<FixedOffset>(half, cosine, saturations);
  }
  return step;
}

Status validate(const FixedIncrement& increment) {
  if (increment.turn > kFixedPi || increment.turn < -kFixedPi) return Status::kInvalidArgument;
  return possible(increment.distance_variance, increment.turn_variance, increment.distance_turn)
             ? Status::kOk
             : Status::kInvalidArgument;
}

bool possible(FixedVariance a, FixedVariance b, FixedVariance covariance) {
  if (a.raw() < 0 || b.raw() < 0) return false;
  const FixedRoot root_a = square_root(a.raw(), FixedVariance::kFractionBits);
  const FixedRoot root_b = square_root(b.raw(), FixedVariance::kFractionBits);
  Count none = 0;
  const std::int64_t most =
      wide::scale(std::int64_t{root_a.mantissa} * root_b.mantissa,
                  FixedVariance::kFractionBits - root_a.bits - root_b.bits, none);
  // Half a unit of each of the three is rounding.
  const auto limit = static_cast<std::uint64_t>(most);
  return wide::magnitude(covariance.raw()) <= limit + limit / 8192 + 2;
}

void FixedMotionNoise::turn(FixedOffset dx, FixedOffset dy, Count& saturations) {
  // own += J step (heading).
  const FixedVariance x_before = x_heading_;
  const FixedVariance y_before = y_heading_;
  accumulate(x_heading_, -times(heading_, dy, saturations), saturations);
  accumulate(y_heading_, times(heading_, dx, saturations), saturations);
  const FixedVariance x_sum = add(x_before, x_heading_, saturations);
  const FixedVariance y_sum = add(y_before, y_heading_, saturations);
  accumulate(own_.xx, -times(x_sum, dy, saturations), saturations);
  accumulate(own_.yy, times(y_sum, dx, saturations), saturations);
  accumulate(own_.xy, times(x_before, dx, saturations), saturations);
  accumulate(own_.xy, -times(y_heading_, dy, saturations), saturations);
}

void FixedMotionNoise::move(const FixedIncrement& increment, const FixedStep& step,
                            Count& saturations) {
  turn(convert<FixedOffset>(step.x, saturations), convert<FixedOffset>(step.y, saturations),
       saturations);

  // The increment's own: g Q g^T, g = [0 1; by_distance, by_turn].
  FixedVariance by_d[2];
  FixedVariance by_t[2];
  for (int i = 0; i < 2; ++i) {
    by_d[i] = add(times(increment.distance_variance, step.by_distance[i], saturations),
                  times(increment.distance_turn, step.by_turn[i], saturations), saturations);
    by_t[i] = add(times(increment.distance_turn, step.by_distance[i], saturations),
                  times(increment.turn_variance, step.by_turn[i], saturations), saturations);
  }
  const auto both = [&](int i, int j) {
    return add(times(by_d[i], step.by_distance[j], saturations),
               times(by_t[i], step.by_turn[j], saturations), saturations);
  };
  accumulate(heading_, increment.turn_variance, saturations);
  accumulate(x_heading_, by_t[0], saturations);
  accumulate(y_heading_, by_t[1], saturations);
  accumulate(own_.xx, both(0, 0), saturations);
  accumulate(own_.xy, both(1, 0), saturations);
  accumulate(own_.yy, both(1, 1), saturations);
}

void FixedMotionNoise::widen(FixedVariance position, FixedVariance heading, Count& saturations) {
  accumulate(heading_, heading, saturations);
  accumulate(own_.xx, position, saturations);
  accumulate(own_.yy, position, saturations);
}

void FixedMotionNoise::slip_laterally(FixedVariance variance, FixedAngle heading,
                                      Count& saturations) {
  FixedRatio sine;
  FixedRatio cosine;
  sin_cos(heading, sine, cosine);
  const FixedVariance by_x = -times(variance, sine, saturations);
  const FixedVariance by_y = times(variance, cosine, saturations);
  accumulate(own_.xx, -times(by_x, sine, saturations), saturations);
  accumulate(own_.xy, times(by_x, cosine, saturations), saturations);
  accumulate(own_.yy, times(by_y, cosine, saturations), saturations);
}

FixedPoseCovariance FixedMotionNoise::about(FixedLength x, FixedLength y,
                                            Count& saturations) const {
  // own - J p (heading): the same turn as that of a step by -p.
  FixedPoseCovariance out;
  const FixedVariance b0 = times(heading_, y, saturations);
  const FixedVariance b1 = -times(heading_, x, saturations);
  out.heading = heading_;
  out.x_heading = add(x_heading_, b0, saturations);
  out.y_heading = add(y_heading_, b1, saturations);
  const FixedVariance x_sum = add(x_heading_, out.x_heading, saturations);
  const FixedVariance y_sum = add(y_heading_, out.y_heading, saturations);
  out.position.xx = add(own_.xx, times(x_sum, y, saturations), saturations);
  out.position.yy = add(own_.yy, -times(y_sum, x, saturations), saturations);
  out.position.xy = add(own_.xy, -times(x_heading_, x, saturations), saturations);
  out.position.xy = add(out.position.xy, times(out.y_heading, y, saturations), saturations);
  return out;
}

void FixedMotionNoise::add_relative(FixedLength x, FixedLength y, FixedCovariance2& covariance,
                                    Count& saturations) const {
  const FixedPoseCovariance turned = about(-x, -y, saturations);
  accumulate(covariance.xx, turned.position.xx, saturations);
  accumulate(covariance.xy, turned.position.xy, saturations);
  accumulate(covariance.yy, turned.position.yy, saturations);
}

FixedMotionNoise::Columns FixedMotionNoise::columns(Count& saturations) const {
  constexpr int kBits = Columns::kBits;
  constexpr int kSquared = 2 * kBits - FixedVariance::kFractionBits;
  constexpr int kVariance = FixedVariance::kFractionBits;
  Columns c;
  c.heading = square_root(heading_.raw(), kVariance);
  c.along[0] = divide_by(x_heading_.raw(), c.heading, kBits, saturations);
  c.along[1] = divide_by(y_heading_.raw(), c.heading, kBits, saturations);
  const auto rest = [&](FixedVariance variance, int i, int j) {
    return wide::add(variance.raw(), -wide::multiply(c.along[i], c.along[j], kSquared, saturations),
                     saturations);
  };
  // The larger variance first: where the vehicle drives along an axis, that across it is a unit or
  // two, and a covariance divided by its root could be anything.
  const std::int64_t own[2] = {rest(own_.xx, 0, 0), rest(own_.yy, 1, 1)};
  const int large = own[0] >= own[1] ? 0 : 1;
  const FixedRoot first = square_root(own[large], kVariance);
  c.rest[0][large] = wide::scale(first.mantissa, kBits - first.bits, saturations);
  c.rest[0][1 - large] = divide_by(rest(own_.xy, 1, 0), first, kBits, saturations);
  const std::int64_t shared = c.rest[0][1 - large];
  const std::int64_t lost = wide::multiply(shared, shared, kSquared, saturations);
  const FixedRoot second = square_root(wide::add(own[1 - large], -lost, saturations), kVariance);
  c.rest[1][large] = 0;
  c.rest[1][1 - large] = wide::scale(second.mantissa, kBits - second.bits, saturations);
  return c;
}

}  // namespace cairn::detail
