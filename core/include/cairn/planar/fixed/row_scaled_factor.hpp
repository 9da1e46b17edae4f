#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/numeric/fixed_math.hpp"

namespace cairn {

namespace detail {
/// One row of a measurement: what it makes of at most seven states.
struct FixedStateRow {
  static constexpr int kMost = 7;
  int state[kMost];
  std::int64_t coefficient[kMost];  ///< below 2^31
  int bits[kMost];                  ///< fraction of the coefficient
  int count = 0;

  void add(int of, std::int64_t factor, int fraction) {
    state[count] = of;
    coefficient[count] = factor;
    bits[count++] = fraction;
  }
};
}  // namespace detail

/// Covariance P = S S^T of up to `Capacity` states as its lower triangular factor S: 32-bit
/// mantissas, one scale for each row. Row i holds S_ij 2^bits(i), and its length, the standard
/// deviation of state i, stays below 2^30 of them and near that.
///
/// All that changes S turns pairs of its columns (Givens): lengths of rows are kept, so no element
/// can overflow, scales of rows do not matter, and P is positive semi-definite whatever is rounded.
template <int Capacity>
class RowScaledFactor {
 public:
  static constexpr int kLeastBits = 20;  ///< standard deviations up to 2^10
  static constexpr int kMostBits = 50;   ///< smaller ones lose precision

  int size() const { return size_; }
  int bits(int row) const { return bits_[row]; }
  /// Element (row, column), column <= row.
  std::int32_t at(int row, int column) const { return data_[index(row, column)]; }

  /// The elements of a row from the first on.
  class RowReader {
   public:
    RowReader(const RowScaledFactor& factor, int row) : at_(factor.data_ + row) {}
    std::int32_t next() {
      const std::int32_t element = *at_;
      at_ += --step_;
      return element;
    }

   private:
    const std::int32_t* at_;
    int step_ = Capacity;
  };
  RowReader row(int row) const { return RowReader(*this, row); }

  void clear() { size_ = 0; }
  /// Appends a row of zeros.
  void append() {
    const int row = size_++;
    bits_[row] = kMostBits;
    for (int j = 0; j <= row; ++j) data_[index(row, j)] = 0;
  }
  /// Appends a row of the elements `value(column)`, each with `fraction` bits. Of them at most
  /// 4^spare are not zero.
  template <class Value>
  void append(int fraction, const Value& value, std::uint32_t& saturations, int spare = 1) {
    const int row = size_++;
    if (row < 0) return;  // never: GCC warns of a store there
    std::int64_t largest = 0;
    for (int j = 0; j <= row; ++j) largest |= static_cast<std::int64_t>(wide::magnitude(value(j)));
    const std::uint64_t most = with_rounding(static_cast<std::uint64_t>(largest));
    const int length = wide::bit_length(most) + spare - fraction;
    // Deviations beyond the largest are shrunk to it: the elements fit all the same.
    const int fits = fitting_bits(2 * length);
    bits_[row] = static_cast<std::int8_t>(bits_for(2 * length, saturations));
    for (int j = 0; j <= row; ++j) {
      data_[index(row, j)] =
          wide::narrow(wide::scale(value(j), fits - fraction, saturations), saturations);
    }
  }

  /// P(i, k) with 44 fraction bits. Cost: min(i, k) multiply-adds.
  std::int64_t covariance(int i, int k, std::uint32_t& saturations) const {
    const int last = i < k ? i : k;
    std::int64_t sum = 0;
    for (int j = 0; j <= last; ++j) {
      sum += std::int64_t{data_[index(i, j)]} * data_[index(k, j)];
    }
    return wide::scale(sum, 44 - bits_[i] - bits_[k], saturations);
  }

  /// The elements of a measurement's row on the columns up to `last`, all below 2^30 and together
  /// too, at the scale that is returned, which is at most `most_bits`.
  int product(const detail::FixedStateRow& row, int last, int most_bits, std::int32_t* out) const {
    constexpr int kTermsBits = 3;  // seven terms, and room for the noise
    int bits = most_bits;
    for (int k = 0; k < row.count; ++k) {
      const int length = wide::bit_length(wide::magnitude(row.coefficient[k])) - row.bits[k];
      const int fits = bits_[row.state[k]] - length - kTermsBits;
      bits = fits < bits ? fits : bits;
    }
    // Upper halves of products with coefficients 2^32 in the scale of the result, below 2^29.
    std::int32_t factors[detail::FixedStateRow::kMost];
    for (int k = 0; k < row.count; ++k) {
      const int up = 32 - row.bits[k] - bits_[row.state[k]] + bits;
      factors[k] = static_cast<std::int32_t>(
          up >= 0 ? row.coefficient[k] * (std::int64_t{1} << up)
                  : wide::round_shift(row.coefficient[k], up < -63 ? 63 : -up));
    }
    int k = 0;
    int next = 0;
    if (begins_with_point(row, last)) {
      write_point(row.state[0], factors, out);
      k = 3;
      next = row.state[0] + 3;
    }
    for (; k < row.count; ++k) {
      const int end = (row.state[k] < last ? row.state[k] : last) + 1;
      const int written = end < next ? end : next;
      RowReader elements(*this, row.state[k]);
      for (int j = 0; j < written; ++j) out[j] += wide::high_product(factors[k], elements.next());
      for (int j = written; j < end; ++j) out[j] = wide::high_product(factors[k], elements.next());
      next = end > next ? end : next;
    }
    wide::clear(out + next, last + 1 - next);
    return bits;
  }

  /// u <- S u and v <- S v in the scale of the rows, both with 30 fraction bits and no longer than
  /// 1 on the columns up to `last`, where they end. Cost: 2 n (last + 1) multiply-adds at most.
  void multiply(std::int32_t* u, std::int32_t* v, int last) const {
    for (int i = size_ - 1; i >= 0; --i) {
      RowReader elements(*this, i);
      const int end = i < last ? i : last;
      std::int64_t first = 0;
      std::int64_t second = 0;
      for (int j = 0; j <= end; ++j) {
        const std::int64_t element = elements.next();
        first += element * u[j];
        second += element * v[j];
      }
      u[i] = static_cast<std::int32_t>(wide::round_shift_far(first, 30));
      v[i] = static_cast<std::int32_t>(wide::round_shift_far(second, 30));
    }
  }

  /// Adapts the scale of a row to the sum of its squared length and that of noise, below 2^noise,
  /// and to 2^more times as much; false (counted) where there is no room for the noise. Cost: row
  /// multiply-adds.
  bool make_room(int row, int noise, std::uint32_t& saturations, int more = 0) {
    std::uint64_t squared = 0;
    const std::int32_t* p = data_ + row;
    for (int j = 0; j <= row; ++j) {
      squared += static_cast<std::uint64_t>(std::int64_t{*p} * *p);
      p += Capacity - 1 - j;
    }
    const int scale = 2 * bits_[row];
    const int added = noise + scale;  // to the squared mantissas, which are below 2^62
    int sum = added + 1;
    if (added < 62) {
      squared = with_rounding(squared) + (std::uint64_t{1} << (added > 0 ? added : 0));
      sum = wide::bit_length(squared);
    }
    const std::uint32_t before = saturations;
    const int wanted = bits_for(sum - scale + more, saturations);
    if (saturations != before) return false;
    if (wanted != bits_[row]) rescale(row, wanted);
    return true;
  }
  /// Adds to an element of a row that has room for it.
  void add(int row, int column, std::int64_t value, int fraction, std::uint32_t& saturations) {
    std::int32_t& element = data_[index(row, column)];
    element = wide::narrow(std::int64_t{element} + to_row(row, value, fraction), saturations);
  }
  /// `value` with `fraction` bits, at the scale of a row that has room for it.
  std::int32_t to_row(int row, std::int64_t value, int fraction) const {
    std::uint32_t none = 0;
    return wide::narrow(wide::scale(value, bits_[row] - fraction, none), none);
  }

  /// P += v v^T, v in the scale of its rows, v_i = 0 for i < first; v is spoilt.
  /// Cost: (n - first)^2 turned elements.
  void absorb(std::int32_t* v, int first) {
    for (int j = first; j < size_; ++j) {
      if (v[j] == 0) continue;
      std::int32_t* const column = data_ + index(j, j);
      const PlaneRotation by = rotation_onto(*column, v[j]);
      rotate(by, column, v + j, size_ - j);
    }
  }

  /// Conditions P on a measurement whose row on the columns of S is `a`, zero beyond `last`, with
  /// noise `sigma`, both in one scale. `sigma` becomes the innovation's standard deviation s, and
  /// `gain` (n elements, in the scale of the rows) the gain times s. Domain: s below 2^30. Cost: 2
  /// (n - last / 2) last turned elements.
  void condition(const std::int32_t* a, int last, std::int32_t& sigma, std::int32_t* gain) {
    int j = last;
    while (j >= 0 && a[j] == 0) --j;
    wide::clear(gain, j < 0 ? size_ : j);
    for (bool first = true; j >= 0; --j, first = false) {
      if (a[j] == 0) continue;
      const PlaneRotation by = rotation_onto(sigma, a[j]);
      sigma = static_cast<std::int32_t>(wide::round_shift_far(
          std::int64_t{by.cosine} * sigma + std::int64_t{by.sine} * a[j], 30));
      std::int32_t* const column = data_ + index(j, j);
      if (first) {
        turn_from_nothing(by, gain + j, column, size_ - j);
      } else {
        rotate(by, gain + j, column, size_ - j);
      }
    }
  }

  /// Removes `Count` rows, the ones behind move up. `scratch`: Count n elements. Cost: as absorb()
  /// that many times.
  template <int Count>
  void remove_rows(int first, std::int32_t* scratch) {
    constexpr int kCount = Count;
    for (int k = 0; k < kCount; ++k) {
      for (int i = first + kCount; i < size_; ++i) {
        scratch[k * Capacity + i - kCount] = at(i, first + k);
      }
    }
    for (int j = 0; j < first; ++j) {
      for (int i = first + kCount; i < size_; ++i) data_[index(i - kCount, j)] = at(i, j);
    }
    for (int j = first + kCount; j < size_; ++j) {
      for (int i = j; i < size_; ++i) data_[index(i - kCount, j - kCount)] = at(i, j);
    }
    for (int i = first + kCount; i < size_; ++i) bits_[i - kCount] = bits_[i];
    size_ -= kCount;
    for (int k = 0; k < kCount; ++k) absorb(scratch + k * Capacity, first);
  }

  /// Multiplies a state by a factor of [0, 1].
  void shrink_row(int row, FixedRatio factor) {
    for (int j = 0; j <= row; ++j) {
      std::int32_t& element = data_[index(row, j)];
      element = static_cast<std::int32_t>(
          wide::round_shift(std::int64_t{element} * factor.raw(), FixedRatio::kFractionBits));
    }
  }

  void hash(Hash64& hash) const {
    hash.add(static_cast<std::int32_t>(size_));
    for (int i = 0; i < size_; ++i) {
      hash.add(static_cast<std::int32_t>(bits_[i]));
      for (int j = 0; j <= i; ++j) hash.add(at(i, j));
    }
  }

 private:
  /// Whether the first three terms are a landmark's coordinates, all on the columns up to `last`.
  static bool begins_with_point(const detail::FixedStateRow& row, int last) {
    const int* const state = row.state;
    return row.count >= 3 && state[1] == state[0] + 1 && state[2] == state[0] + 2 &&
           state[2] <= last;
  }
  /// Three rows, one after the other, on the columns that they have.
  void write_point(int row, const std::int32_t* factors, std::int32_t* out) const {
    const std::int32_t* elements = data_ + row;
    int step = Capacity;
    for (int j = 0; j <= row; ++j) {
      out[j] = wide::high_product(factors[0], elements[0]) +
               wide::high_product(factors[1], elements[1]) +
               wide::high_product(factors[2], elements[2]);
      elements += --step;
    }
    out[row + 1] = wide::high_product(factors[1], at(row + 1, row + 1)) +
                   wide::high_product(factors[2], at(row + 2, row + 1));
    out[row + 2] = wide::high_product(factors[2], at(row + 2, row + 2));
  }

  /// Columns one after the other, each with room for all rows below its diagonal.
  static constexpr int index(int row, int column) {
    return column * Capacity - column * (column + 1) / 2 + row;
  }

  /// Scale at which a squared length below 2^squared is below 2^60.
  static int fitting_bits(int squared) {
    return squared <= 60 - 2 * kMostBits ? kMostBits : (60 - squared) >> 1;
  }
  /// A length, or its square, with what rounding may add to it until the scale is adapted again.
  static std::uint64_t with_rounding(std::uint64_t length) { return length + (length >> 20U); }
  /// The same, at least the least one.
  static int bits_for(int squared, std::uint32_t& saturations) {
    const int bits = fitting_bits(squared);
    if (bits >= kLeastBits) return bits;
    ++saturations;
    return kLeastBits;
  }
  void rescale(int row, int bits) {
    const int shift = bits - bits_[row];
    for (int j = 0; j <= row; ++j) {
      std::int32_t& element = data_[index(row, j)];
      element = shift >= 0 ? element * (std::int32_t{1} << shift)
                           : static_cast<std::int32_t>(wide::round_shift(element, -shift));
    }
    bits_[row] = static_cast<std::int8_t>(bits);
  }

  std::int32_t data_[Capacity * (Capacity + 1) / 2] = {};
  std::int8_t bits_[Capacity] = {};
  int size_ = 0;
};

}  // namespace cairn
