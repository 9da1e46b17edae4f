#pragma once

#include "cairn/geometry/types.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

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

/// out[i] += sum_c h[c] P(i, first + c) for the rows i below the run, whose elements are
/// contiguous.
template <int Size, class T, int N>
void add_rows_below(const PackedSymmetric<T, N>& p, int first, const T* h, T* out) {
  for (int i = first + Size; i < p.size(); ++i) {
    const T* r = p.row(i) + first;
    T sum = out[i];
    for (int c = 0; c < Size; ++c) sum += h[c] * r[c];
    out[i] = sum;
  }
}

template <class T, int N>
void add_rows_below(const PackedSymmetric<T, N>& p, int first, int size, const T* h, T* out) {
  switch (size) {
    case 1:
      return add_rows_below<1>(p, first, h, out);
    case 2:
      return add_rows_below<2>(p, first, h, out);
    case 3:
      return add_rows_below<3>(p, first, h, out);
    case 4:
      return add_rows_below<4>(p, first, h, out);
    case 7:
      return add_rows_below<7>(p, first, h, out);
    default:
      for (int i = first + size; i < p.size(); ++i) {
        const T* r = p.row(i) + first;
        for (int c = 0; c < size; ++c) out[i] += h[c] * r[c];
      }
  }
}

}  // namespace detail

/// out[r][i] = sum_j H(r, j) P(j, i). Cost: Rows * columns * n multiply-adds.
template <class T, int Rows, int N>
void multiply(const SparseRows<T, Rows>& rows, const PackedSymmetric<T, N>& p, T (&out)[Rows][N]) {
  const int n = p.size();
  for (int r = 0; r < Rows; ++r) {
    for (int i = 0; i < n; ++i) out[r][i] = T(0);
    int k = 0;
    for (int run = 0; run < rows.run_count; ++run) {
      const int first = rows.first[run];
      const int size = rows.size[run];
      const T* h = rows.h[r] + k;
      for (int c = 0; c < size; ++c) {
        const T* above = p.row(first + c);
        const T f = h[c];
        for (int i = 0; i <= first + c; ++i) out[r][i] += f * above[i];
        for (int i = first + c + 1; i < first + size; ++i) out[r][i] += f * p.row(i)[first + c];
      }
      detail::add_rows_below(p, first, size, h, out[r]);
      k += size;
    }
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

/// P becomes that of the state whose block [at, at + Rows) is replaced by `rows` * state plus an
/// independent noise of covariance `noise`; where `at` is the present size, the block is appended.
/// `scratch` holds Rows * n values.
template <class T, int Rows, int N>
void compose_block(PackedSymmetric<T, N>& p, int at, const SparseRows<T, Rows>& rows,
                   const Matrix<T, Rows, Rows>& noise, T (&scratch)[Rows][N]) {
  multiply(rows, p, scratch);
  Matrix<T, Rows, Rows> diagonal;
  for (int r = 0; r < Rows; ++r) {
    for (int c = 0; c <= r; ++c) {
      diagonal(r, c) = rows.dot(r, scratch[c]) + noise(r, c);
    }
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
