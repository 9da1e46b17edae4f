#pragma once

#include "cairn/planar/fixed/error.hpp"
#include "cairn/planar/fixed/pixel_sighting.hpp"
#include "cairn/planar/fixed/sighting.hpp"

namespace cairn::detail {

/// Correction of a FixedPlanarState by measurements that are all linearised at one mean, state by
/// state, each with its correction_bits().
template <class State, FixedError Error>
class FixedCorrection {
 public:
  using Errors = FixedPlanarError<State, Error>;

  void clear(int states) { wide::clear(values_, states); }
  void negate(int states) {
    for (int i = 0; i < states; ++i) values_[i] = -values_[i];
  }
  std::int32_t operator[](int state) const { return values_[state]; }
  std::int32_t& operator[](int state) { return values_[state]; }
  const std::int32_t* values() const { return values_; }

  /// Conditions the covariance on a row of a sighting and adds its part to the correction. Its
  /// normalised innovation squared, with the fraction of the report's. Cost: with n states at most
  /// 2 n^2 turned elements.
  std::int64_t take_in(const FixedSighting& sighting, int row, const State& state, Errors& errors,
                       std::uint32_t& saturations);
  std::int64_t take_in(const FixedPixelSighting& sighting, int row, const State& state,
                       Errors& errors, std::uint32_t& saturations);

  void apply(State& state, std::uint32_t& saturations) const {
    if constexpr (Errors::kWorld) {
      state.add_to_each(values_, saturations);
    } else {
      state.turn_by(values_, saturations);
    }
  }

 private:
  static constexpr int kStates = State::kStates;
  using Factor = typename Errors::Factor;

  /// A row of the plane: `h` on the vector to the landmark whose states begin at `l`.
  struct PlaneRow {
    int l;
    std::int32_t h[2];
    FixedLength by_heading;  ///< of the world's error: h J (landmark - vehicle)
  };
  static PlaneRow row_of(const FixedSighting& sighting, int row, const State& state,
                         std::uint32_t& saturations);
  static int scale_of(const PlaneRow& row, const Factor& factor);
  static void write(const PlaneRow& row, const Factor& factor, int bits, std::int32_t* out,
                    std::uint32_t& saturations);
  std::int64_t innovation_left(const PlaneRow& row, FixedOffset innovation) const;
  std::int64_t condition(const State& state, Errors& errors, int last, int bits, std::int32_t sigma,
                         std::int64_t innovation, int fraction, std::uint32_t& saturations);

  std::int32_t values_[kStates] = {};
};

template <class State, FixedError Error>
typename FixedCorrection<State, Error>::PlaneRow FixedCorrection<State, Error>::row_of(
    const FixedSighting& sighting, int row, const State& state, std::uint32_t& saturations) {
  PlaneRow out;
  out.l = state.state_of(sighting.slot);
  out.h[0] = row == 0 ? sighting.cosine.raw() : -sighting.sine.raw();
  out.h[1] = row == 0 ? sighting.sine.raw() : sighting.cosine.raw();
  if constexpr (Errors::kWorld) {
    const auto part = [&](int axis, std::int32_t factor) {
      return multiply<FixedLength>(state.relative(sighting.slot, axis),
                                   FixedRatio::from_raw(factor), saturations);
    };
    out.by_heading = subtract(part(1, out.h[0]), part(0, out.h[1]), saturations);
  }
  return out;
}

/// One scale for the row's elements on the columns, so that all stay below 2^30.
template <class State, FixedError Error>
int FixedCorrection<State, Error>::scale_of(const PlaneRow& row, const Factor& factor) {
  int bits = Factor::kMostBits;
  for (const int state : {row.l, row.l + 1, 1, 2}) {
    bits = factor.bits(state) < bits ? factor.bits(state) : bits;
  }
  if constexpr (Errors::kWorld) {
    const int length =
        wide::bit_length(wide::magnitude(row.by_heading.raw())) - FixedLength::kFractionBits;
    const int fits = factor.bits(0) - length - 1;
    bits = (fits < bits ? fits : bits) - 1;
  }
  return bits - 2;
}

/// The row's elements on the columns, with `bits` of fraction.
template <class State, FixedError Error>
void FixedCorrection<State, Error>::write(const PlaneRow& row, const Factor& factor, int bits,
                                          std::int32_t* out, std::uint32_t& saturations) {
  const int l = row.l;
  const auto shift_of = [&](int state) {
    const int shift = FixedRatio::kFractionBits + factor.bits(state) - bits;
    return shift < 63 ? shift : 63;
  };
  const auto scaled = [&](int axis, std::int32_t element, int shift) {
    return static_cast<std::int32_t>(
        wide::round_shift_far(std::int64_t{row.h[axis]} * element, shift));
  };
  const int shifts[2] = {shift_of(l), shift_of(l + 1)};
  auto first = factor.row(l);
  auto second = factor.row(l + 1);
  for (int j = 0; j <= l; ++j) {
    out[j] = scaled(0, first.next(), shifts[0]) + scaled(1, second.next(), shifts[1]);
  }
  out[l + 1] = scaled(1, second.next(), shifts[1]);
  for (int axis = 0; axis < 2; ++axis) {
    const int shift = shift_of(1 + axis);
    for (int j = 0; j <= 1 + axis; ++j) out[j] -= scaled(axis, factor.at(1 + axis, j), shift);
  }
  if constexpr (Errors::kWorld) {
    out[0] += static_cast<std::int32_t>(
        wide::scale(std::int64_t{row.by_heading.raw()} * factor.at(0, 0),
                    bits - FixedLength::kFractionBits - factor.bits(0), saturations));
  }
}

/// The innovation at the mean corrected so far.
template <class State, FixedError Error>
std::int64_t FixedCorrection<State, Error>::innovation_left(const PlaneRow& row,
                                                            FixedOffset innovation) const {
  const int states[4] = {row.l, row.l + 1, 1, 2};
  std::int64_t left = innovation.raw() * (std::int64_t{1} << FixedRatio::kFractionBits);
  for (int k = 0; k < 4; ++k) {
    const std::int64_t part = std::int64_t{row.h[k % 2]} * values_[states[k]];
    left += k < 2 ? -part : part;
  }
  left = wide::round_shift(left, FixedRatio::kFractionBits);
  if (Errors::kWorld) {
    left -= wide::round_shift(
        std::int64_t{row.by_heading.raw()} * values_[0],
        FixedLength::kFractionBits + FixedAngle::kFractionBits - FixedOffset::kFractionBits);
  }
  return left;
}

template <class State, FixedError Error>
std::int64_t FixedCorrection<State, Error>::take_in(const FixedSighting& sighting, int row,
                                                    const State& state, Errors& errors,
                                                    std::uint32_t& saturations) {
  constexpr int kNoiseBits = FixedOffset::kFractionBits;
  const PlaneRow h = row_of(sighting, row, state, saturations);
  const std::int64_t noise = sighting.sigma[row].raw();
  const int room = 29 - wide::bit_length(static_cast<std::uint64_t>(noise)) + kNoiseBits;
  int bits = scale_of(h, errors.factor());
  if (bits > room) bits = room;
  auto sigma = static_cast<std::int32_t>(wide::scale(noise, bits - kNoiseBits, saturations));
  if (sigma == 0) sigma = 1;
  write(h, errors.factor(), bits, errors.scratch(), saturations);
  const std::int64_t innovation = innovation_left(h, sighting.innovation[row]);
  return condition(state, errors, h.l + 1, bits, sigma, innovation, kNoiseBits, saturations);
}

template <class State, FixedError Error>
std::int64_t FixedCorrection<State, Error>::take_in(const FixedPixelSighting& sighting, int row,
                                                    const State& state, Errors& errors,
                                                    std::uint32_t& saturations) {
  const int last = state.state_of(sighting.slot) + State::kLandmarkDim - 1;
  const int room = 29 - wide::bit_length(wide::magnitude(sighting.sigma[row])) + kPixelBits;
  const FixedStateRow h = state.row_of(sighting, row);
  const int most = Factor::kMostBits;
  const int bits = errors.factor().product(h, last, room < most ? room : most, errors.scratch());
  auto sigma =
      static_cast<std::int32_t>(wide::scale(sighting.sigma[row], bits - kPixelBits, saturations));
  if (sigma == 0) sigma = 1;
  // The innovation at the mean corrected so far.
  std::int64_t innovation = sighting.innovation[row];
  for (int k = 0; k < h.count; ++k) {
    const int fraction = h.bits[k] + state.correction_bits(h.state[k]);
    const std::int64_t part =
        wide::round_shift(h.coefficient[k] * values_[h.state[k]], fraction - kPixelBits);
    innovation = wide::add(innovation, -part, saturations);
  }
  return condition(state, errors, last, bits, sigma, innovation, kPixelBits, saturations);
}

/// Conditions the covariance on the row in the scratch memory, zero beyond `last`, with `bits` of
/// fraction as `sigma`; `innovation` has `fraction` bits of it.
template <class State, FixedError Error>
std::int64_t FixedCorrection<State, Error>::condition(const State& state, Errors& errors, int last,
                                                      int bits, std::int32_t sigma,
                                                      std::int64_t innovation, int fraction,
                                                      std::uint32_t& saturations) {
  constexpr int kScoreBits = 20;
  Factor& factor = errors.factor();
  std::int32_t* const gain = errors.scratch() + kStates;
  factor.condition(errors.scratch(), last, sigma, gain);
  // The innovation in standard deviations.
  const int shift = kScoreBits + bits - fraction;
  const std::int32_t y =
      wide::narrow(wide::divide(shift < 0 ? wide::round_shift(innovation, -shift) : innovation,
                                sigma, shift < 0 ? 0 : shift, saturations),
                   saturations);
  for (int i = 0; i < factor.size(); ++i) {
    // A row's scale has 20 bits or more: 12 to go at least.
    const int down = factor.bits(i) + kScoreBits - state.correction_bits(i);
    const std::int64_t part = wide::round_shift_far(std::int64_t{gain[i]} * y, down);
    values_[i] = wide::narrow(values_[i] + part, saturations);
  }
  return wide::round_shift(std::int64_t{y} * y, 2 * kScoreBits - FixedCoordinate::kFractionBits);
}

}  // namespace cairn::detail
