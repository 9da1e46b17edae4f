#pragma once

#include <cfloat>
#include <cstdint>
#include <utility>

#include "cairn/numeric/multiply_add.hpp"

namespace cairn {

/// Distance from 1 to the next number of a floating-point type.
template <class T>
inline constexpr double kEpsilonInDouble = DBL_EPSILON;
template <>
inline constexpr double kEpsilonInDouble<float> = static_cast<double>(FLT_EPSILON);
template <class T>
inline constexpr T kEpsilon = T(kEpsilonInDouble<T>);

/// Symmetric matrix of run-time size n <= Capacity, lower triangle packed row by row:
/// element (i, j), j <= i, lies at i (i + 1) / 2 + j. Half the memory traffic of a full matrix, and
/// it cannot lose its symmetry. All filters of the core keep their covariance in it.
///
/// Every kernel visits the elements in one fixed order, so results are equal to the bit everywhere.
template <class T, int Capacity>
class PackedSymmetric {
 public:
  using Scalar = T;
  static constexpr int kCapacity = Capacity;
  static constexpr int kStorage = Capacity * (Capacity + 1) / 2;

  int size() const { return size_; }

  /// Sets the size; rows that are new are zero. Domain: 0 <= size <= Capacity.
  void resize(int size) {
    for (int i = size_; i < size; ++i) {
      T* r = row(i);
      for (int j = 0; j <= i; ++j) r[j] = T(0);
    }
    size_ = size;
  }
  void set_zero() {
    const int count = size_ * (size_ + 1) / 2;
    for (int k = 0; k < count; ++k) data_[k] = T(0);
  }

  /// First element of row i; elements (i, 0) to (i, i) are contiguous.
  T* row(int i) { return data_ + i * (i + 1) / 2; }
  const T* row(int i) const { return data_ + i * (i + 1) / 2; }

  T& operator()(int i, int j) { return i >= j ? row(i)[j] : row(j)[i]; }
  T operator()(int i, int j) const { return i >= j ? row(i)[j] : row(j)[i]; }

  const T* data() const { return data_; }
  T* data() { return data_; }

  /// out[i] = sum_k coefficients[k] P(i, columns[k]), i = 0 .. n-1. `columns` ascending.
  /// Cost: n * count multiply-adds.
  void multiply_sparse(const int* columns, const T* coefficients, int count, T* out) const {
    for (int i = 0; i < size_; ++i) out[i] = T(0);
    for (int k = 0; k < count; ++k) {
      const int c = columns[k];
      const T h = coefficients[k];
      const T* r = row(c);
      for (int j = 0; j <= c; ++j) out[j] += h * r[j];
      const T* p = row(c) + c;
      for (int i = c + 1; i < size_; ++i) {
        p += i;
        out[i] += h * *p;
      }
    }
  }

  /// a[i] += scale_a P(i, column), b the same, i = 0 .. n-1. Cost: 2 n multiply-adds.
  void add_column(int column, T scale_a, T scale_b, T* __restrict a, T* __restrict b) const {
    const T* r = row(column);
    for (int j = 0; j <= column; ++j) {
      a[j] += scale_a * r[j];
      b[j] += scale_b * r[j];
    }
    const T* p = r + column;
    for (int i = column + 1; i < size_; ++i) {
      p += i;
      a[i] += scale_a * *p;
      b[i] += scale_b * *p;
    }
  }

  /// P -= weight * v v^T. Cost: n (n + 1) / 2 multiply-adds, one pass over P.
  void downdate(const T* v, T weight) {
    T* p = data_;
    for (int i = 0; i < size_; ++i) {
      const T f = weight * v[i];
      for (int j = 0; j <= i; ++j) p[j] -= f * v[j];
      p += i + 1;
    }
  }

  /// P -= [a b] M [a b]^T with M = [m00 m01; m01 m11]. Cost: n (n + 1) multiply-adds, one pass over
  /// P.
  void downdate(const T* a, const T* b, T m00, T m01, T m11) {
    T* p = data_;
    for (int i = 0; i < size_; ++i) {
      const T fa = m00 * a[i] + m01 * b[i];
      const T fb = m01 * a[i] + m11 * b[i];
      for (int j = 0; j <= i; ++j) p[j] -= fa * a[j] + fb * b[j];
      p += i + 1;
    }
  }

  /// P -= sum_r v_r v_r^T over Rank vectors; v_r starts at v + r * Stride. One pass over P in tiles
  /// of 4 x 4, so that a value loaded is used four times. Cost: Rank * n (n + 1) / 2 multiply-adds.
  template <int Rank, int Stride>
  void downdate(const T* v) {
    const int tiled = size_ / 4 * 4;
    T* p = data_;
    for (int i = 0; i < tiled; i += 4) {
      T* const rows[4] = {p, p + (i + 1), p + (2 * i + 3), p + (3 * i + 6)};
      for (int j = 0; j < i; j += 4) {
        downdate_tile<Rank, Stride>(v + i, v + j, rows, j, Tile{});
      }
      T diagonal[4][4] = {};
      T* const scratch[4] = {diagonal[0], diagonal[1], diagonal[2], diagonal[3]};
      downdate_tile<Rank, Stride>(v + i, v + i, scratch, 0, Tile{});
      for (int k = 0; k < 4; ++k) {
        for (int l = 0; l <= k; ++l) rows[k][i + l] += diagonal[k][l];
      }
      p += 4 * i + 10;
    }
    for (int i = tiled; i < size_; ++i) downdate_row<Rank, Stride>(v, i);
  }

  /// Removes rows and columns [first, first + count) by moving the last `count` rows and columns
  /// into their place. The order of the moved block is kept. Domain: the removed block is either
  /// the last one or does not overlap it. Cost: O(n * count).
  void remove_block_unordered(int first, int count) {
    const int last = size_ - count;
    if (first != last) {
      for (int k = 0; k < count; ++k) {
        const int from = last + k;
        const int to = first + k;
        for (int j = 0; j < last; ++j) {
          if (j >= first && j < first + count) continue;
          (*this)(to, j) = row(from)[j];
        }
        for (int j = 0; j <= k; ++j) row(to)[first + j] = row(from)[last + j];
      }
    }
    size_ = last;
  }

  /// Removes rows and columns [first, first + count) and closes the gap, order kept. Cost: O(n^2).
  void remove_block(int first, int count) {
    for (int i = first + count; i < size_; ++i) {
      const T* from = row(i);
      T* to = row(i - count);
      for (int j = 0; j < first; ++j) to[j] = from[j];
      for (int j = first + count; j <= i; ++j) to[j - count] = from[j];
    }
    size_ -= count;
  }

  /// P_ii += factor P_ii. Cost: n multiply-adds.
  void inflate_diagonal(T factor) {
    T* p = data_;
    for (int i = 0; i < size_; ++i) {
      *p += factor * *p;
      p += i + 2;
    }
  }

  /// Raises every diagonal element below `floor` to it; the number of elements raised.
  int floor_diagonal(T floor) {
    int raised = 0;
    for (int i = 0; i < size_; ++i) {
      T& d = row(i)[i];
      if (!(d >= floor)) {
        d = floor;
        ++raised;
      }
    }
    return raised;
  }

 private:
  using Tile = std::make_integer_sequence<int, 16>;

  /// rows[k][j + l] -= sum_r a_r[k] b_r[l]. Written out by the pack, so that the sums stay in
  /// registers: compilers keep an array that a loop indexes in memory.
  template <int Rank, int Stride, int... K>
  static void downdate_tile(const T* a, const T* b, T* const (&rows)[4], int j,
                            std::integer_sequence<int, K...>) {
    T sums[16] = {(a[K / 4] * b[K % 4])...};
    for (int r = 1; r < Rank; ++r) {
      a += Stride;
      b += Stride;
      const T a_r[4] = {a[0], a[1], a[2], a[3]};
      const T b_r[4] = {b[0], b[1], b[2], b[3]};
      (multiply_add(sums[K], a_r[K / 4], b_r[K % 4]), ...);
    }
    ((rows[K / 4][j + K % 4] -= sums[K]), ...);
  }

  template <int Rank, int Stride>
  void downdate_row(const T* v, int i) {
    T* p = row(i);
    for (int j = 0; j <= i; ++j) {
      T sum = v[i] * v[j];
      for (int r = 1; r < Rank; ++r) multiply_add(sum, v[r * Stride + i], v[r * Stride + j]);
      p[j] -= sum;
    }
  }

  T data_[kStorage] = {};
  int size_ = 0;
};

/// Inverse of the symmetric 2x2 matrix [a b; b c]. False (outputs untouched) unless it is positive
/// definite with a determinant above 1e-12 of the product of its diagonal.
template <class T>
bool invert_spd2(T a, T b, T c, T& ia, T& ib, T& ic) {
  const T determinant = a * c - b * b;
  if (!(a > T(0)) || !(c > T(0)) || !(determinant > T(1e-12) * a * c)) return false;
  const T scale = T(1) / determinant;
  ia = c * scale;
  ib = -b * scale;
  ic = a * scale;
  return true;
}

}  // namespace cairn
