#include "cairn/planar/fixed/motion.hpp"
#include "cairn/planar/fixed/sighting.hpp"

namespace cairn::detail {
namespace {

using Count = std::uint32_t;
constexpr int kVarianceBits = FixedVariance::kFractionBits;
constexpr int kOffsetBits = FixedOffset::kFractionBits;

FixedOffset at_least_one_unit(FixedOffset sigma) {
  return sigma.raw() > 0 ? sigma : FixedOffset::from_raw(1);
}
FixedVariance scaled(FixedVariance variance, FixedRatio factor, Count& count) {
  return multiply<FixedVariance>(variance, factor, count);
}

}  // namespace

/// Along and across the direction, the two columns turned so that they are triangular.
FixedCholesky3 FixedSighting::noise() const {
  constexpr int kBits = kOffsetBits - 1;
  const auto part = [](FixedRatio direction, FixedOffset deviation) {
    const std::int64_t product = std::int64_t{direction.raw()} * deviation.raw();
    return static_cast<std::int32_t>(wide::round_shift(product, FixedRatio::kFractionBits + 1));
  };
  const std::int32_t first[2] = {part(cosine, sigma[0]), part(sine, sigma[0])};
  const std::int32_t second[2] = {part(-sine, sigma[1]), part(cosine, sigma[1])};
  const PlaneRotation by = rotation_onto(first[0], second[0]);
  const auto turned = [](std::int32_t c, std::int32_t x, std::int32_t s, std::int32_t y) {
    return wide::round_shift(std::int64_t{c} * x + std::int64_t{s} * y, FixedRatio::kFractionBits);
  };
  FixedCholesky3 out;
  const std::int64_t elements[3] = {turned(by.cosine, first[0], by.sine, second[0]),
                                    turned(by.cosine, first[1], by.sine, second[1]),
                                    turned(by.cosine, second[1], -by.sine, first[1])};
  for (int k = 0; k < 3; ++k) {
    out.l[k] = elements[k] * (std::int64_t{1} << (FixedCholesky3::kBits - kBits));
  }
  return out;
}

void FixedAxes::turn(FixedLength x, FixedLength y, FixedLength& world_x, FixedLength& world_y,
                     Count& saturations) const {
  world_x = subtract(multiply<FixedLength>(x, cosine, saturations),
                     multiply<FixedLength>(y, sine, saturations), saturations);
  world_y = add(multiply<FixedLength>(x, sine, saturations),
                multiply<FixedLength>(y, cosine, saturations), saturations);
}

FixedPrincipalNoise principal_noise(const FixedCovariance2& noise, Count& saturations) {
  FixedPrincipalNoise out;
  FixedCovariance2 turned = noise;
  if (noise.xy.raw() != 0 || noise.xx != noise.yy) {
    const std::int64_t difference =
        wide::round_shift(noise.xx.raw(), 1) - wide::round_shift(noise.yy.raw(), 1);
    const FixedAngle twice = fixed_atan2(noise.xy.raw(), difference);
    out.direction =
        FixedAngle::from_raw(static_cast<std::int32_t>(wide::round_shift(twice.raw(), 1)));
    FixedRatio sine;
    FixedRatio cosine;
    sin_cos(out.direction, sine, cosine);
    turned = along_direction(noise, cosine, sine, saturations);
  }
  const FixedVariance variances[2] = {turned.xx, turned.yy};
  for (int i = 0; i < 2; ++i) {
    const FixedRoot root = square_root(variances[i].raw(), kVarianceBits);
    out.sigma[i] = at_least_one_unit(FixedOffset::from_raw(wide::narrow(
        wide::scale(root.mantissa, kOffsetBits - root.bits, saturations), saturations)));
  }
  return out;
}

Status check(const FixedPointObservation& observation) {
  const FixedCovariance2& n = observation.noise;
  const bool definite = n.xx.raw() > 0 && n.yy.raw() > 0 && possible(n.xx, n.yy, n.xy);
  return definite ? Status::kOk : Status::kInvalidArgument;
}

Status check(const FixedRangeBearingObservation& o) {
  const bool valid = o.range.raw() > 0 && o.sigma_range.raw() > 0 && o.sigma_bearing.raw() > 0;
  return valid ? Status::kOk : Status::kInvalidArgument;
}

bool linearise(const FixedPointObservation& observation, const FixedAxes& axes, FixedLength x,
               FixedLength y, FixedLength /*sensor_offset*/, FixedSighting& out,
               Count& saturations) {
  FixedLength seen[2];
  axes.turn(observation.x, observation.y, seen[0], seen[1], saturations);
  const FixedPrincipalNoise noise = principal_noise(observation.noise, saturations);
  const FixedLength missed[2] = {subtract(seen[0], x, saturations),
                                 subtract(seen[1], y, saturations)};
  sin_cos(wrapped_angle(std::int64_t{axes.heading.raw()} + noise.direction.raw()), out.sine,
          out.cosine);
  const auto along = [&](FixedRatio a, FixedRatio b) {
    return add(multiply<FixedOffset>(missed[0], a, saturations),
               multiply<FixedOffset>(missed[1], b, saturations), saturations);
  };
  out.innovation[0] = along(out.cosine, out.sine);
  out.innovation[1] = along(-out.sine, out.cosine);
  for (int i = 0; i < 2; ++i) out.sigma[i] = noise.sigma[i];
  return true;
}

bool expected_range_bearing(const FixedAxes& axes, FixedLength x, FixedLength y,
                            FixedLength sensor_offset, FixedRangeBearingPrediction& out,
                            FixedRatio& cosine, FixedRatio& sine, Count& saturations) {
  constexpr FixedLength kNearest = FixedLength::nearest(0.05);
  const FixedLength dx =
      subtract(x, multiply<FixedLength>(sensor_offset, axes.cosine, saturations), saturations);
  const FixedLength dy =
      subtract(y, multiply<FixedLength>(sensor_offset, axes.sine, saturations), saturations);
  const std::int64_t squared =
      wide::add(std::int64_t{dx.raw()} * dx.raw(), std::int64_t{dy.raw()} * dy.raw(), saturations);
  const FixedRoot range = square_root(squared, 2 * FixedLength::kFractionBits);
  out.range = FixedLength::from_raw(wide::narrow(
      wide::scale(range.mantissa, FixedLength::kFractionBits - range.bits, saturations),
      saturations));
  if (out.range <= kNearest) return false;
  const FixedAngle direction = fixed_atan2(dy.raw(), dx.raw());
  out.bearing = wrapped_angle(std::int64_t{direction.raw()} - axes.heading.raw());
  cosine = divide<FixedRatio>(dx, out.range, saturations);
  sine = divide<FixedRatio>(dy, out.range, saturations);
  return true;
}

bool linearise(const FixedRangeBearingObservation& observation, const FixedAxes& axes,
               FixedLength x, FixedLength y, FixedLength sensor_offset, FixedSighting& out,
               Count& saturations) {
  FixedRangeBearingPrediction expected;
  if (!expected_range_bearing(axes, x, y, sensor_offset, expected, out.cosine, out.sine,
                              saturations)) {
    return false;
  }
  const FixedAngle missed =
      wrapped_angle(std::int64_t{observation.bearing.raw()} - expected.bearing.raw());
  out.innovation[0] =
      convert<FixedOffset>(subtract(observation.range, expected.range, saturations), saturations);
  out.innovation[1] = multiply<FixedOffset>(missed, expected.range, saturations);
  out.sigma[0] = at_least_one_unit(convert<FixedOffset>(observation.sigma_range, saturations));
  out.sigma[1] = at_least_one_unit(
      multiply<FixedOffset>(observation.sigma_bearing, expected.range, saturations));
  return true;
}

FixedCovariance2 along_direction(const FixedCovariance2& covariance, FixedRatio cosine,
                                 FixedRatio sine, Count& saturations) {
  // First the columns, then the rows.
  const FixedVariance xc = add(scaled(covariance.xx, cosine, saturations),
                               scaled(covariance.xy, sine, saturations), saturations);
  const FixedVariance yc = add(scaled(covariance.xy, cosine, saturations),
                               scaled(covariance.yy, sine, saturations), saturations);
  const FixedVariance xs = subtract(scaled(covariance.xy, cosine, saturations),
                                    scaled(covariance.xx, sine, saturations), saturations);
  const FixedVariance ys = subtract(scaled(covariance.yy, cosine, saturations),
                                    scaled(covariance.xy, sine, saturations), saturations);
  FixedCovariance2 out;
  out.xx = add(scaled(xc, cosine, saturations), scaled(yc, sine, saturations), saturations);
  out.xy = add(scaled(xs, cosine, saturations), scaled(ys, sine, saturations), saturations);
  out.yy = subtract(scaled(ys, cosine, saturations), scaled(xs, sine, saturations), saturations);
  return out;
}

FixedScore score(const FixedSighting& sighting, const FixedCovariance2& relative,
                 Count& saturations) {
  const FixedCovariance2 s = along_direction(relative, sighting.cosine, sighting.sine, saturations);
  FixedVariance noise[2];
  std::int64_t innovation[2];
  for (int i = 0; i < 2; ++i) {
    noise[i] = multiply<FixedVariance>(sighting.sigma[i], sighting.sigma[i], saturations);
    innovation[i] = sighting.innovation[i].raw();
  }
  return mahalanobis(s, noise, innovation, kOffsetBits, saturations);
}

FixedScore mahalanobis(const FixedCovariance2& s, const FixedVariance (&noise)[2],
                       const std::int64_t (&innovation)[2], int bits, Count& saturations) {
  constexpr int kScoreBits = 20;   // of a normalised innovation
  constexpr int kFactorBits = 32;  // of s01 / sqrt(s00), m
  Count none = 0;                  // a distance too large for its format is large
  const auto whitened = [&](std::int64_t missed, FixedRoot root) {
    return wide::narrow(wide::divide(missed, root.mantissa, kScoreBits + root.bits - bits, none),
                        none);
  };
  const FixedRoot first = square_root(add(s.xx, noise[0], saturations).raw(), kVarianceBits);
  if (first.mantissa == 0) return FixedScore::most();
  const std::int64_t y0 = whitened(innovation[0], first);
  const std::int64_t factor =
      wide::divide(s.xy.raw(), first.mantissa, kFactorBits + first.bits - kVarianceBits, none);
  const FixedVariance explained = FixedVariance::from_raw(
      wide::multiply(factor, factor, 2 * kFactorBits - kVarianceBits, none));
  FixedVariance rest = subtract(add(s.yy, noise[1], none), explained, none);
  if (rest < noise[1]) rest = noise[1];
  const FixedRoot second = square_root(rest.raw(), kVarianceBits);
  if (second.mantissa == 0) return FixedScore::most();
  const std::int64_t shared = wide::multiply(factor, y0, kFactorBits + kScoreBits - bits, none);
  const std::int64_t y1 = whitened(wide::add(innovation[1], -shared, none), second);
  return FixedScore::from_raw(
      wide::narrow(wide::round_shift(y0 * y0, 2 * kScoreBits - FixedScore::kFractionBits) +
                       wide::round_shift(y1 * y1, 2 * kScoreBits - FixedScore::kFractionBits),
                   none));
}

FixedMoments turned_point_moments(FixedLength x, FixedLength y,
                                  const FixedPoseCovariance& covariance, Count& saturations) {
  constexpr std::int64_t kOne = std::int64_t{1} << kVarianceBits;
  const std::int64_t s2 = covariance.heading.raw();
  const FixedVariance rho = FixedVariance::from_raw(exp_negative_44(s2 / 2));
  const auto of = [&](FixedVariance a, auto b) {
    return multiply<FixedVariance>(a, b, saturations);
  };
  const FixedVariance rho2 = of(rho, rho);
  const FixedVariance lost = FixedVariance::from_raw(kOne - rho2.raw());
  const FixedVariance kept = FixedVariance::from_raw(kOne + rho2.raw());
  const auto half = [](FixedVariance a) {
    return FixedVariance::from_raw(wide::round_shift(a.raw(), 1));
  };
  const FixedVariance vc = half(of(lost, lost));  // (1 - rho^2)^2 / 2
  const FixedVariance vs = half(of(lost, kept));  // (1 - rho^4) / 2
  const auto sum = [&](FixedVariance a, FixedVariance b) { return add(a, b, saturations); };
  // J p = (-y, x).
  const FixedVariance cx = of(covariance.x_heading, rho);
  const FixedVariance cy = of(covariance.y_heading, rho);
  FixedMoments out;
  out.shrink = rho;
  FixedCovariance2& c = out.covariance.position;
  c.xx = sum(sum(of(of(vc, x), x), of(of(vs, y), y)), covariance.position.xx);
  c.xx = sum(c.xx, -of(sum(cx, cx), y));
  c.xy = sum(sum(of(of(vc, x), y), -of(of(vs, x), y)), covariance.position.xy);
  c.xy = sum(c.xy, sum(of(cx, x), -of(cy, y)));
  c.yy = sum(sum(of(of(vc, y), y), of(of(vs, x), x)), covariance.position.yy);
  c.yy = sum(c.yy, of(sum(cy, cy), x));
  const FixedVariance shrunk = of(covariance.heading, rho);
  out.covariance.x_heading = sum(covariance.x_heading, -of(shrunk, y));
  out.covariance.y_heading = sum(covariance.y_heading, of(shrunk, x));
  out.covariance.heading = covariance.heading;
  // Rounding may leave a variance of nothing below 0; far below it is where a sum did not fit.
  constexpr std::int64_t kRounding = 64;
  for (FixedVariance* variance : {&c.xx, &c.yy}) {
    if (variance->raw() >= 0) continue;
    *variance = variance->raw() > -kRounding ? FixedVariance() : FixedVariance::most();
  }
  return out;
}

FixedExponential::FixedExponential(FixedAngle turn, Count& saturations) {
  angle_ = turn > kFixedPi ? kFixedPi : (turn < -kFixedPi ? -kFixedPi : turn);
  constexpr FixedAngle kSmall = FixedAngle::nearest(1.0 / 256.0);
  if (angle_ < kSmall && angle_ > -kSmall) {
    const auto squared = multiply<FixedRatio>(angle_, angle_, saturations);
    v00_ = FixedRatio::from_raw((1 << 30) - squared.raw() / 6);
    v01_ = FixedRatio::from_raw(angle_.raw() * 2 -
                                multiply<FixedRatio>(squared, angle_, saturations).raw() / 24);
  } else {
    FixedRatio sine;
    FixedRatio cosine;
    const auto half =
        FixedAngle::from_raw(static_cast<std::int32_t>(wide::round_shift(angle_.raw(), 1)));
    sin_cos(half, sine, cosine);
    // sin t / t and (1 - cos t) / t by the halves of t.
    v00_ = divide<FixedRatio>(multiply<FixedRatio>(sine, cosine, saturations), half, saturations);
    v01_ = divide<FixedRatio>(multiply<FixedRatio>(sine, sine, saturations), half, saturations);
  }
  same_ = -multiply<FixedRatio>(angle_, v01_, saturations);
  turn_ = multiply<FixedRatio>(angle_, v00_, saturations);
}

void FixedExponential::move(FixedCoordinate& x, FixedCoordinate& y, FixedOffset xi_x,
                            FixedOffset xi_y, Count& saturations) const {
  const auto of = [&](auto a, FixedRatio b) {
    return multiply<FixedCoordinate>(a, b, saturations);
  };
  const auto sum = [&](FixedCoordinate a, FixedCoordinate b) { return add(a, b, saturations); };
  const FixedLength px = convert<FixedLength>(x, saturations);
  const FixedLength py = convert<FixedLength>(y, saturations);
  x = sum(x, sum(sum(of(px, same_), -of(py, turn_)), sum(of(xi_x, v00_), -of(xi_y, v01_))));
  y = sum(y, sum(sum(of(py, same_), of(px, turn_)), sum(of(xi_y, v00_), of(xi_x, v01_))));
}

}  // namespace cairn::detail
