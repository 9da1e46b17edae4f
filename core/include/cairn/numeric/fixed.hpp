#pragma once

#include <type_traits>

#include "cairn/numeric/wide_integer.hpp"

namespace cairn {

/// Number raw / 2^FractionBits in `Storage` (std::int32_t or std::int64_t), for cores without a
/// floating-point unit. Every operation is defined for every input: it rounds to nearest and
/// saturates at the largest number of its sign; where a result did not fit, or a divisor was zero,
/// `saturations` grows by one.
template <class Storage, int FractionBits>
class Fixed {
  static_assert(std::is_same_v<Storage, std::int32_t> || std::is_same_v<Storage, std::int64_t>);
  static_assert(FractionBits >= 0 && FractionBits < 63);

 public:
  static constexpr int kFractionBits = FractionBits;

  constexpr Fixed() = default;
  static constexpr Fixed from_raw(Storage raw) {
    Fixed result;
    result.raw_ = raw;
    return result;
  }
  /// Nearest number; not for code that must do without floating point, but in constants.
  static constexpr Fixed nearest(double value) {
    const double scaled = value * static_cast<double>(std::int64_t{1} << FractionBits);
    const auto most = static_cast<double>(most_raw());
    if (!(scaled < most)) return from_raw(scaled >= most ? most_raw() : 0);
    if (scaled <= -most) return from_raw(-most_raw());
    return from_raw(static_cast<Storage>(scaled + (scaled < 0.0 ? -0.5 : 0.5)));
  }
  constexpr double to_double() const {
    return static_cast<double>(raw_) / static_cast<double>(std::int64_t{1} << FractionBits);
  }

  constexpr Storage raw() const { return raw_; }
  static constexpr Fixed most() { return from_raw(most_raw()); }

  constexpr Fixed operator-() const { return from_raw(raw_ < -most_raw() ? most_raw() : -raw_); }
  friend constexpr bool operator==(Fixed a, Fixed b) { return a.raw_ == b.raw_; }
  friend constexpr bool operator!=(Fixed a, Fixed b) { return a.raw_ != b.raw_; }
  friend constexpr bool operator<(Fixed a, Fixed b) { return a.raw_ < b.raw_; }
  friend constexpr bool operator>(Fixed a, Fixed b) { return a.raw_ > b.raw_; }
  friend constexpr bool operator<=(Fixed a, Fixed b) { return a.raw_ <= b.raw_; }
  friend constexpr bool operator>=(Fixed a, Fixed b) { return a.raw_ >= b.raw_; }

 private:
  static constexpr Storage most_raw() {
    return std::is_same_v<Storage, std::int32_t> ? static_cast<Storage>(INT32_MAX)
                                                 : static_cast<Storage>(INT64_MAX);
  }

  Storage raw_ = 0;
};

namespace detail {
template <class To>
To to_fixed(std::int64_t raw, std::uint32_t& saturations) {
  if constexpr (sizeof(To) == sizeof(std::int32_t)) {
    return To::from_raw(wide::narrow(raw, saturations));
  } else {
    return To::from_raw(raw);
  }
}
}  // namespace detail

/// The same number in another format.
template <class To, class S, int F>
To convert(Fixed<S, F> value, std::uint32_t& saturations) {
  return detail::to_fixed<To>(wide::scale(value.raw(), To::kFractionBits - F, saturations),
                              saturations);
}

template <class S, int F>
Fixed<S, F> add(Fixed<S, F> a, Fixed<S, F> b, std::uint32_t& saturations) {
  return detail::to_fixed<Fixed<S, F>>(wide::add(a.raw(), b.raw(), saturations), saturations);
}
template <class S, int F>
Fixed<S, F> subtract(Fixed<S, F> a, Fixed<S, F> b, std::uint32_t& saturations) {
  return add(a, -b, saturations);
}

/// a b in the format To, rounded once. Domain: the product has no more fraction bits than its
/// factors together.
template <class To, class Sa, int Fa, class Sb, int Fb>
To multiply(Fixed<Sa, Fa> a, Fixed<Sb, Fb> b, std::uint32_t& saturations) {
  constexpr int kShift = Fa + Fb - To::kFractionBits;
  static_assert(kShift >= 0);
  if constexpr (sizeof(Sa) == 4 && sizeof(Sb) == 4) {
    const std::int64_t product = std::int64_t{a.raw()} * b.raw();
    return detail::to_fixed<To>(wide::round_shift(product, kShift), saturations);
  } else {
    return detail::to_fixed<To>(wide::multiply(a.raw(), b.raw(), kShift, saturations), saturations);
  }
}

/// a / b in the format To, rounded once. Domain: a has no more fraction bits than b and the
/// quotient together.
template <class To, class Sa, int Fa, class Sb, int Fb>
To divide(Fixed<Sa, Fa> a, Fixed<Sb, Fb> b, std::uint32_t& saturations) {
  constexpr int kShift = To::kFractionBits + Fb - Fa;
  static_assert(kShift >= 0);
  return detail::to_fixed<To>(wide::divide(a.raw(), b.raw(), kShift, saturations), saturations);
}

}  // namespace cairn
