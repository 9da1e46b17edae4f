#pragma once

#include <rapidcheck.h>

#include "cairn/planar/fixed/types.hpp"

namespace cairn::planar_test {

/// Any number of a format, of every size alike, the extremes among them.
template <class Number>
Number any() {
  const auto raw = *rc::gen::arbitrary<std::uint64_t>();
  const int shift = *rc::gen::inRange(0, 66);
  const int width = std::is_same_v<decltype(Number().raw()), std::int32_t> ? 32 : 64;
  std::int64_t value = static_cast<std::int64_t>(raw) >> (shift % 64);
  if (shift == 64) value = INT64_MAX;
  if (shift == 65) value = INT64_MIN;
  return Number::from_raw(static_cast<decltype(Number().raw())>(value >> (64 - width)));
}

inline FixedCovariance2 any_covariance() {
  FixedCovariance2 c = {any<FixedVariance>(), {}, any<FixedVariance>()};
  if (*rc::gen::arbitrary<bool>()) c.xy = any<FixedVariance>();
  return c;
}

}  // namespace cairn::planar_test
