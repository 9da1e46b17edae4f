#pragma once

#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/planar/types.hpp"

namespace cairn::detail {

/// Errors of new states as sparse combinations of those that a filter has: row i is
/// sum_k weight[i][k] * error[index[i][k]].
template <class T, int Rows>
struct ErrorRows {
  static constexpr int kMaxTerms = 6;
  int index[Rows][kMaxTerms] = {};
  T weight[Rows][kMaxTerms] = {};
  int count[Rows] = {};

  void add(int row, int state, T factor) {
    index[row][count[row]] = state;
    weight[row][count[row]++] = factor;
  }
};

/// Appends `Rows` states to P whose errors are `rows` plus independent noise.
/// Cost: at most kMaxTerms * Rows multiply-adds for each state.
template <class T, int Rows, int Capacity>
void append_error_rows(PackedSymmetric<T, Capacity>& P, const ErrorRows<T, Rows>& rows,
                       const Matrix<T, Rows, Rows>& noise) {
  const int first = P.size();
  P.resize(first + Rows);
  for (int i = 0; i < Rows; ++i) {
    T* row = P.row(first + i);
    for (int k = 0; k < rows.count[i]; ++k) {
      const int state = rows.index[i][k];
      const T weight = rows.weight[i][k];
      for (int j = 0; j < first; ++j) row[j] += weight * P(state, j);
    }
    for (int j = 0; j <= i; ++j) {
      T sum = noise(i, j);
      for (int k = 0; k < rows.count[j]; ++k) sum += rows.weight[j][k] * row[rows.index[j][k]];
      row[first + j] = sum;
    }
  }
}

}  // namespace cairn::detail
