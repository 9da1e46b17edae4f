#pragma once

#include <Eigen/Dense>

namespace cairn::mono_test {

/// Least eigenvalue of the correlation matrix of a filter's state, -1 where a variance is negative
/// or anything is not finite. Zero is sound: a quaternion of length 1 has no error along itself.
template <class Filter>
double smallest_correlation_eigenvalue(const Filter& filter) {
  const int n = filter.state_size();
  Eigen::MatrixXd P(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) P(i, j) = static_cast<double>(filter.covariance(i, j));
  }
  if (!P.allFinite() || P.diagonal().minCoeff() < 0.0) return -1.0;
  const Eigen::VectorXd scale = P.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * P * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(0);
}

}  // namespace cairn::mono_test
