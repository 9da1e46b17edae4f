#pragma once

#include "cairn/numeric/fixed.hpp"

namespace cairn {

/// Between float as a format of messages and fixed point, by integers alone: no operation on
/// floating point, which a core without the unit would emulate. Cost: some twenty instructions.

/// Nearest number in the format To. What does not fit, an infinity among it, saturates, counted;
/// what is no number becomes 0, counted.
template <class To>
To fixed_of(float value, std::uint32_t& saturations);

/// Nearest float.
template <class S, int F>
float float_of(Fixed<S, F> value);

namespace detail {
std::int64_t fixed_from_float(float value, int fraction_bits, std::uint32_t& saturations);
float float_from_fixed(std::int64_t raw, int fraction_bits);
}  // namespace detail

template <class To>
To fixed_of(float value, std::uint32_t& saturations) {
  return detail::to_fixed<To>(detail::fixed_from_float(value, To::kFractionBits, saturations),
                              saturations);
}

template <class S, int F>
float float_of(Fixed<S, F> value) {
  return detail::float_from_fixed(value.raw(), F);
}

}  // namespace cairn
