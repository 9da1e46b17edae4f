#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include "cairn/numeric/math.hpp"

namespace cairn::host {

/// A double that counts what is done with it: additions, subtractions, multiplications, divisions
/// and square roots each as one operation. Comparisons, signs and copies are free; the elementary
/// functions count as the number of operations of the core's polynomials, rounded.
class Counted {
 public:
  constexpr Counted() = default;
  constexpr Counted(double value) : value_(value) {}  // NOLINT: stands in for a plain number
  constexpr Counted(int value) : value_(value) {}     // NOLINT: the same
  explicit constexpr operator double() const { return value_; }
  explicit constexpr operator float() const { return static_cast<float>(value_); }
  explicit constexpr operator int() const { return static_cast<int>(value_); }
  constexpr double value() const { return value_; }

  Counted& operator+=(Counted b) { return set(value_ + b.value_); }
  Counted& operator-=(Counted b) { return set(value_ - b.value_); }
  Counted& operator*=(Counted b) { return set(value_ * b.value_); }
  Counted& operator/=(Counted b) { return set(value_ / b.value_); }

  static void reset() { operations_ = 0; }
  static std::int64_t operations() { return operations_; }
  static void note(int operations) { operations_ += operations; }

 private:
  Counted& set(double value) {
    ++operations_;
    value_ = value;
    return *this;
  }

  double value_ = 0.0;
  inline static thread_local std::int64_t operations_ = 0;
};

inline Counted operator+(Counted a, Counted b) {
  return a += b;
}
inline Counted operator-(Counted a, Counted b) {
  return a -= b;
}
inline Counted operator*(Counted a, Counted b) {
  return a *= b;
}
inline Counted operator/(Counted a, Counted b) {
  return a /= b;
}
constexpr Counted operator-(Counted a) {
  return -a.value();
}
constexpr Counted operator+(Counted a) {
  return a;
}
constexpr bool operator<(Counted a, Counted b) {
  return a.value() < b.value();
}
constexpr bool operator>(Counted a, Counted b) {
  return a.value() > b.value();
}
constexpr bool operator<=(Counted a, Counted b) {
  return a.value() <= b.value();
}
constexpr bool operator>=(Counted a, Counted b) {
  return a.value() >= b.value();
}
constexpr bool operator==(Counted a, Counted b) {
  return a.value() == b.value();
}
constexpr bool operator!=(Counted a, Counted b) {
  return a.value() != b.value();
}

inline Counted sqrt(Counted x) {
  Counted::note(1);
  return std::sqrt(x.value());
}
inline Counted abs(Counted x) {
  return std::fabs(x.value());
}
inline Counted floor(Counted x) {
  return std::floor(x.value());
}
inline Counted exp(Counted x) {
  Counted::note(20);
  return cairn::exp(x.value());
}
inline Counted log(Counted x) {
  Counted::note(20);
  return cairn::log(x.value());
}
inline Counted atan2(Counted y, Counted x) {
  Counted::note(25);
  return cairn::atan2(y.value(), x.value());
}
inline void sin_cos(Counted angle, Counted& sine, Counted& cosine) {
  Counted::note(30);
  double s = 0.0;
  double c = 0.0;
  cairn::sin_cos(angle.value(), s, c);
  sine = s;
  cosine = c;
}

}  // namespace cairn::host

template <>
struct Eigen::NumTraits<cairn::host::Counted> : Eigen::NumTraits<double> {
  using Real = cairn::host::Counted;
  using NonInteger = cairn::host::Counted;
  using Nested = cairn::host::Counted;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
};
