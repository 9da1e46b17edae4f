#pragma once

#include "cairn/planar/fixed/camera.hpp"

namespace cairn::detail {

/// R C R^T.
FixedCovariance3 turned(const FixedCovariance3& covariance, const FixedRotation& rotation,
                        std::uint32_t& saturations);

/// Lower triangular factor of a covariance, row by row (00, 10, 11, 20, 21, 22), kBits fraction
/// bits.
struct FixedCholesky3 {
  static constexpr int kBits = 40;
  std::int64_t l[6] = {};

  std::int64_t at(int row, int column) const { return l[row * (row + 1) / 2 + column]; }
};
/// False where the covariance is not positive definite.
bool cholesky(const FixedCovariance3& covariance, FixedCholesky3& out, std::uint32_t& saturations);

}  // namespace cairn::detail
