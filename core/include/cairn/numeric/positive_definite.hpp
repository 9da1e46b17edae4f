#pragma once

#include "cairn/numeric/math.hpp"

namespace cairn {

/// Whether all elements of a fixed-size matrix are finite.
template <class Matrix>
bool all_finite(const Matrix& m) {
  bool finite = true;
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) finite = finite && is_finite(m(i, j));
  }
  return finite;
}

/// Whether a 2x2 or 3x3 matrix is symmetric to the bit and all its leading minors are positive.
template <class Matrix>
bool positive_definite(const Matrix& m) {
  static_assert(Matrix::RowsAtCompileTime == Matrix::ColsAtCompileTime, "a square matrix");
  static_assert(Matrix::RowsAtCompileTime == 2 || Matrix::RowsAtCompileTime == 3, "2x2 or 3x3");
  using T = typename Matrix::Scalar;
  const T corner = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1);
  if (!(m(0, 0) > T(0) && m(1, 1) > T(0) && m(0, 1) == m(1, 0) && corner > T(0))) return false;
  if constexpr (Matrix::RowsAtCompileTime == 3) {
    const T determinant = corner * m(2, 2) + T(2) * m(0, 1) * m(1, 2) * m(0, 2) -
                          m(0, 0) * m(1, 2) * m(1, 2) - m(1, 1) * m(0, 2) * m(0, 2);
    return m(2, 2) > T(0) && m(0, 2) == m(2, 0) && m(1, 2) == m(2, 1) && determinant > T(0);
  }
  return true;
}

}  // namespace cairn
