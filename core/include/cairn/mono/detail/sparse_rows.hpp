#pragma once

#include <utility>

#include "cairn/geometry/types.hpp"
#include "cairn/numeric/multiply_add.hpp"
#include "cairn/numeric/positive_definite.hpp"

namespace cairn::mono {

/// Rows of a Jacobian by the filter's state, zero but for a few runs of columns: the camera block,
/// one anchor, one feature.
template <class T, int Rows>
struct SparseRows {
  static constexpr int kMaxColumns = 16;
  static constexpr int kMaxRuns = 4;

  int first[kMaxRuns] = {};
  int size[kMaxRuns] = {};
  int run_count = 0;
  int columns = 0;
  T h[Rows][kMaxColumns] = {};

  /// Appends the columns [at, at + Columns) with the coefficients `block`. Domain: room for them.
  template <int Columns>
  void add_run(int at, const Matrix<T, Rows, Columns>& block) {
    add_run(at, Columns, block);
  }
  /// The same of the first `count` columns of `block`.
  template <int Columns>
  void add_run(int at, int count, const Matrix<T, Rows, Columns>& block) {
    first[run_count] = at;
    size[run_count] = count;
    ++run_count;
    for (int r = 0; r < Rows; ++r) {
      for (int c = 0; c < count; ++c) h[r][columns + c] = block(r, c);
    }
    columns += count;
  }

  /// Sum over the columns of h[row] * v.
  T dot(int row, const T* v) const {
    T sum = T(0);
    int k = 0;
    for (int run = 0; run < run_count; ++run) {
      for (int c = 0; c < size[run]; ++c, ++k) sum += h[row][k] * v[first[run] + c];
    }
    return sum;
  }
};

namespace detail {

/// out[r][i] += sum_c h[r][c] * element(c). Every element is read once and before any result is
/// written; written out by the pack, so that the coefficients stay in registers.
template <int Rows, class T, int Size, int N, class Element, int... C>
void accumulate(const T (&h)[Rows][Size], int i, const Element& element, T (*out)[N],
                std::integer_sequence<int, C...>) {
  const T p[Size] = {element(C)...};
  T sums[Rows];
  for (int r = 0; r < Rows; ++r) {
    sums[r] = out[r][i];
    (multiply_add(sums[r], h[r][C], p[C]), ...);
  }
  for (int r = 0; r < Rows; ++r) out[r][i] = sums[r];
}

/// out[r][i] += sum_c H(r, k + c) P(first + c, i) for the columns of one run.
template <int Size, class T, int Rows, int N>
void multiply_run(const SparseRows<T, Rows>& rows, int first, int k, const PackedSymmetric<T, N>& p,
                  T (*out)[N]) {
  constexpr auto kColumns = std::make_integer_sequence<int, Size>{};
  T h[Rows][Size];
  for (int r = 0; r < Rows; ++r) {
    for (int c = 0; c < Size; ++c) h[r][c] = rows.h[r][k + c];
  }
  const T* above = p.row(first);
  for (int i = 0; i < first; ++i) {
    // Row first + c begins first * c + c (c + 1) / 2 elements after row first.
    accumulate(
        h, i, [&](int c) { return above[i + c * first + c * (c + 1) / 2]; }, out, kColumns);
  }
  for (int i = first; i < first + Size; ++i) {
    accumulate(
        h, i, [&](int c) { return p(first + c, i); }, out, kColumns);
  }
  if (first + Size >= p.size()) return;
  const T* below = p.row(first + Size) + first;
  for (int i = first + Size; i < p.size(); ++i) {
    accumulate(
        h, i, [&](int c) { return below[c]; }, out, kColumns);
    below += i + 1;
  }
}

}  // namespace detail

/// out[r][i] = sum_j H(r, j) P(j, i), `out` of Rows rows. Domain: runs of 1 to 4, 7 or 8 columns.
/// Cost: Rows * columns * n multiply-adds.
template <class T, int Rows, int N>
void multiply(const SparseRows<T, Rows>& rows, const PackedSymmetric<T, N>& p, T (*out)[N]) {
  const int n = p.size();
  for (int r = 0; r < Rows; ++r) {
    for (int i = 0; i < n; ++i) out[r][i] = T(0);
  }
  int k = 0;
  for (int run = 0; run < rows.run_count; ++run) {
    const int first = rows.first[run];
    switch (rows.size[run]) {
      case 1:
        detail::multiply_run<1>(rows, first, k, p, out);
        break;
      case 2:
        detail::multiply_run<2>(rows, first, k, p, out);
        break;
      case 3:
        detail::multiply_run<3>(rows, first, k, p, out);
        break;
      case 4:
        detail::multiply_run<4>(rows, first, k, p, out);
        break;
      case 5:
        detail::multiply_run<5>(rows, first, k, p, out);
        break;
      case 7:
        detail::multiply_run<7>(rows, first, k, p, out);
        break;
      default:
        detail::multiply_run<8>(rows, first, k, p, out);
        break;
    }
    k += rows.size[run];
  }
}

/// out -= (H V^T) V for two rows V of a product V^T V that P still lacks, `out` of two rows. Cost:
/// 4 n multiply-adds.
template <class T, int N>
void subtract_pending(const SparseRows<T, 2>& rows, const T (*v)[N], int n, T (*out)[N]) {
  const T c00 = rows.dot(0, v[0]);
  const T c01 = rows.dot(0, v[1]);
  const T c10 = rows.dot(1, v[0]);
  const T c11 = rows.dot(1, v[1]);
  for (int i = 0; i < n; ++i) {
    const T v0 = v[0][i];
    const T v1 = v[1][i];
    T first = c00 * v0;
    T second = c10 * v0;
    multiply_add(first, c01, v1);
    multiply_add(second, c11, v1);
    out[0][i] -= first;
    out[1][i] -= second;
  }
}

/// H P H^T of the first `runs` runs of H, from the support alone. Cost: (Rows + 1) * columns^2
/// multiply-adds.
template <class T, int Rows, int N>
Matrix<T, Rows, Rows> quadratic(const SparseRows<T, Rows>& rows, int runs,
                                const PackedSymmetric<T, N>& p) {
  Matrix<T, Rows, Rows> out = Matrix<T, Rows, Rows>::Zero();
  int k = 0;
  for (int run = 0; run < runs; ++run) {
    for (int i = 0; i < rows.size[run]; ++i, ++k) {
      T hp[Rows] = {};
      int l = 0;
      for (int other = 0; other < runs; ++other) {
        for (int j = 0; j < rows.size[other]; ++j, ++l) {
          const T value = p(rows.first[run] + i, rows.first[other] + j);
          for (int r = 0; r < Rows; ++r) hp[r] += rows.h[r][l] * value;
        }
      }
      for (int r = 0; r < Rows; ++r) {
        for (int c = 0; c <= r; ++c) out(r, c) += rows.h[r][k] * hp[c];
      }
    }
  }
  for (int r = 0; r < Rows; ++r) {
    for (int c = r + 1; c < Rows; ++c) out(r, c) = out(c, r);
  }
  return out;
}

template <class T, int Rows, int N>
Matrix<T, Rows, Rows> quadratic(const SparseRows<T, Rows>& rows, const PackedSymmetric<T, N>& p) {
  return quadratic(rows, rows.run_count, p);
}

/// What the arithmetic may have changed in (H P H^T)(row, row): kRoundingNoise of its terms.
template <class T, int Rows, int N>
T rounding_noise(const SparseRows<T, Rows>& rows, int row, const PackedSymmetric<T, N>& p) {
  T sum = T(0);
  int k = 0;
  for (int run = 0; run < rows.run_count; ++run) {
    for (int c = 0; c < rows.size[run]; ++c, ++k) {
      const int at = rows.first[run] + c;
      sum += square(rows.h[row][k]) * p.row(at)[at];
    }
  }
  return kRoundingNoise<T> * sum;
}

/// P becomes that of the state whose block [at, at + Rows) is replaced by `rows` * state plus an
/// independent noise of covariance `noise` and rounding_noise(); where `at` is the present size,
/// the block is appended. `scratch` has Rows rows.
template <class T, int Rows, int N>
void compose_block(PackedSymmetric<T, N>& p, int at, const SparseRows<T, Rows>& rows,
                   const Matrix<T, Rows, Rows>& noise, T (*scratch)[N]) {
  multiply(rows, p, scratch);
  Matrix<T, Rows, Rows> diagonal;
  for (int r = 0; r < Rows; ++r) {
    for (int c = 0; c <= r; ++c) {
      diagonal(r, c) = rows.dot(r, scratch[c]) + noise(r, c);
    }
    diagonal(r, r) += rounding_noise(rows, r, p);
  }
  if (at == p.size()) p.resize(at + Rows);
  for (int r = 0; r < Rows; ++r) {
    T* own = p.row(at + r);
    for (int i = 0; i < at; ++i) own[i] = scratch[r][i];
    for (int i = at + Rows; i < p.size(); ++i) p.row(i)[at + r] = scratch[r][i];
    for (int c = 0; c <= r; ++c) own[at + c] = diagonal(r, c);
  }
}

/// P of the state whose block [first, first + Size) is multiplied by J. Cost: Size^2 * n.
template <int Size, class T, int N>
void transform_block(PackedSymmetric<T, N>& p, int first, const Matrix<T, Size, Size>& J) {
  for (int i = 0; i < first; ++i) {
    Vector<T, Size> v;
    for (int k = 0; k < Size; ++k) v(k) = p.row(first + k)[i];
    v = (J * v).eval();
    for (int k = 0; k < Size; ++k) p.row(first + k)[i] = v(k);
  }
  Matrix<T, Size, Size> block;
  for (int r = 0; r < Size; ++r) {
    for (int c = 0; c < Size; ++c) block(r, c) = p(first + r, first + c);
  }
  block = (J * block).eval();
  for (int r = 0; r < Size; ++r) {
    for (int c = 0; c <= r; ++c) {
      T sum = T(0);
      for (int k = 0; k < Size; ++k) sum += block(r, k) * J(c, k);
      p.row(first + r)[first + c] = sum;
    }
  }
  for (int i = first + Size; i < p.size(); ++i) {
    T* r = p.row(i) + first;
    Vector<T, Size> v;
    for (int k = 0; k < Size; ++k) v(k) = r[k];
    v = (J * v).eval();
    for (int k = 0; k < Size; ++k) r[k] = v(k);
  }
}

}  // namespace cairn::mono
