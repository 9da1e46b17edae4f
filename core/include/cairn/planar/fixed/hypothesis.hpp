#pragma once

#include "cairn/planar/fixed/row_scaled_factor.hpp"
#include "cairn/planar/fixed/types.hpp"

namespace cairn::detail {

/// Two rows of a measurement, their innovations and independent noise with kBits fraction bits.
struct FixedMeasurement {
  static constexpr int kBits = 40;
  FixedStateRow row[2];
  int last = 0;  ///< column of the factor beyond which the rows are zero
  std::int64_t innovation[2] = {};
  std::int64_t sigma[2] = {};  ///< above 0
};

/// What one measurement alone would make of mean and covariance, both untouched: the two directions
/// P H^T L^-T of WhitenedUpdate, with L L^T the innovation covariance. Rows and noise are made
/// orthogonal as vectors on the columns of the factor, so no innovation covariance is subtracted
/// from, and none can fail to be positive.
template <int Capacity>
class FixedHypothesis {
 public:
  using Factor = RowScaledFactor<Capacity>;

  /// `scratch`: 2 Capacity elements, which hold the directions as long as this lives.
  FixedHypothesis(const Factor& factor, std::int32_t* scratch)
      : factor_(factor), direction_{scratch, scratch + Capacity} {}

  /// Cost: n (last + 1) multiply-adds for each row.
  void form(const FixedMeasurement& measurement, std::uint32_t& saturations) {
    std::int32_t noise[2];
    int bits[2];
    for (int r = 0; r < 2; ++r) {
      bits[r] = element_bits(measurement, r);
      noise[r] = static_cast<std::int32_t>(
          wide::scale(measurement.sigma[r], bits[r] - FixedMeasurement::kBits, saturations));
      if (noise[r] == 0) noise[r] = 1;
    }
    const int last = measurement.last;
    std::int32_t* const first = direction_[0];
    std::int32_t* const second = direction_[1];
    const std::int64_t own = square(noise[0]);
    FixedRoot length = square_root(own + squared(first, last), 2 * bits[0]);
    Unit unit(length, bits[0]);
    for (int j = 0; j <= last; ++j) first[j] = unit.of(first[j]);
    const std::int32_t noise_first = unit.of(noise[0]);
    score_[0] = whitened(measurement.innovation[0], length, saturations);

    // The part of the second along the first: an innovation in common, not noise.
    std::int64_t sum = 0;
    for (int j = 0; j <= last; ++j) sum += std::int64_t{second[j]} * first[j];
    const std::int64_t along = wide::round_shift_far(sum, kUnitBits);
    const auto part = [along](std::int32_t element) {
      return static_cast<std::int32_t>(wide::round_shift_far(along * element, kUnitBits));
    };
    for (int j = 0; j <= last; ++j) second[j] -= part(first[j]);
    const std::int64_t rest = squared(second, last) + square(part(noise_first)) + square(noise[1]);
    length = square_root(rest, 2 * bits[1]);
    unit = Unit(length, bits[1]);
    for (int j = 0; j <= last; ++j) second[j] = unit.of(second[j]);
    const std::int64_t shared =
        wide::scale(along * score_[0], FixedMeasurement::kBits - bits[1] - kScoreBits, saturations);
    score_[1] =
        whitened(wide::add(measurement.innovation[1], -shared, saturations), length, saturations);

    factor_.multiply(first, second, last);
  }

  /// The correction of state i with `fraction` bits.
  std::int32_t correction(int i, int fraction, std::uint32_t& saturations) const {
    const std::int64_t sum =
        std::int64_t{direction_[0][i]} * score_[0] + std::int64_t{direction_[1][i]} * score_[1];
    return wide::narrow(wide::round_shift_far(sum, factor_.bits(i) + kScoreBits - fraction),
                        saturations);
  }

  /// What is left of the covariance `prior` of two other rows, m^2.
  FixedCovariance2 left(const FixedStateRow (&rows)[2], const FixedCovariance2& prior,
                        std::uint32_t& saturations) const {
    FixedCovariance2 out = prior;
    for (const std::int32_t* direction : direction_) {
      const std::int64_t f[2] = {applied(rows[0], direction, saturations),
                                 applied(rows[1], direction, saturations)};
      const auto subtract_product = [&](FixedVariance& from, int i, int j) {
        constexpr int kDown = 2 * FixedMeasurement::kBits - FixedVariance::kFractionBits;
        const std::int64_t product = wide::multiply(f[i], f[j], kDown, saturations);
        from = FixedVariance::from_raw(wide::add(from.raw(), -product, saturations));
      };
      subtract_product(out.xx, 0, 0);
      subtract_product(out.xy, 0, 1);
      subtract_product(out.yy, 1, 1);
    }
    // Below zero by rounding alone.
    if (out.xx.raw() < 0) out.xx = FixedVariance();
    if (out.yy.raw() < 0) out.yy = FixedVariance();
    return out;
  }

 private:
  static constexpr int kUnitBits = FixedRatio::kFractionBits;
  static constexpr int kScoreBits = 20;

  /// Divides by the length of a vector whose elements have `bits` of fraction; the result has
  /// kUnitBits.
  class Unit {
   public:
    Unit(FixedRoot length, int bits)
        : inverse_(static_cast<std::int64_t>((std::uint64_t{1} << 60) /
                                             static_cast<std::uint32_t>(length.mantissa))),
          shift_(bits + kUnitBits - length.bits) {}
    std::int32_t of(std::int32_t element) const {
      return static_cast<std::int32_t>(wide::round_shift(element * inverse_, shift_));
    }

   private:
    std::int64_t inverse_;
    int shift_;
  };

  static std::int64_t square(std::int32_t value) { return std::int64_t{value} * value; }
  static std::int64_t squared(const std::int32_t* v, int last) {
    std::int64_t sum = 0;
    for (int j = 0; j <= last; ++j) sum += square(v[j]);
    return sum;
  }

  /// Writes a row on the factor's columns, with room for its noise; the scale.
  int element_bits(const FixedMeasurement& measurement, int r) {
    const int room =
        29 - wide::bit_length(wide::magnitude(measurement.sigma[r])) + FixedMeasurement::kBits;
    const int most = room < Factor::kMostBits ? room : Factor::kMostBits;
    return factor_.product(measurement.row[r], measurement.last, most, direction_[r]);
  }

  static std::int32_t whitened(std::int64_t innovation, FixedRoot length,
                               std::uint32_t& saturations) {
    const int shift = kScoreBits + length.bits - FixedMeasurement::kBits;
    return wide::narrow(wide::divide(shift < 0 ? wide::round_shift(innovation, -shift) : innovation,
                                     length.mantissa, shift < 0 ? 0 : shift, saturations),
                        saturations);
  }

  /// A row on a direction, FixedMeasurement::kBits.
  std::int64_t applied(const FixedStateRow& row, const std::int32_t* direction,
                       std::uint32_t& saturations) const {
    std::int64_t sum = 0;
    for (int k = 0; k < row.count; ++k) {
      const int state = row.state[k];
      // Coefficients have 20 fraction bits at least, and so do rows of the factor.
      const int down = row.bits[k] + factor_.bits(state) - FixedMeasurement::kBits;
      sum = wide::add(sum, wide::round_shift(row.coefficient[k] * direction[state], down),
                      saturations);
    }
    return sum;
  }

  const Factor& factor_;
  std::int32_t* direction_[2];
  std::int32_t score_[2] = {};
};

}  // namespace cairn::detail
