#pragma once

#include <vector>

#include <Eigen/Dense>

#include "host_sim/base/planar_types.hpp"

namespace cairn::host {

/// A linearised sighting: two rows with a block on the vehicle's columns (the first ones of the
/// state) and a block on the landmark's two columns.
struct DenseRow {
  int landmark_column = 0;
  Eigen::MatrixXd vehicle;  ///< 2 x vehicle states
  Eigen::Matrix2d landmark = Eigen::Matrix2d::Identity();
  Eigen::Vector2d innovation = Eigen::Vector2d::Zero();
  Eigen::Matrix2d noise = Eigen::Matrix2d::Identity();
};

/// Gain of the batch of rows: correction = gain * innovation, covariance -= gain * cross^T.
struct DenseGain {
  Eigen::MatrixXd gain;
  Eigen::MatrixXd cross;  ///< P H^T
  Eigen::VectorXd innovation;
};

/// Textbook Kalman gain by Cholesky of the whole innovation covariance. Reference code: dense, and
/// as plain as it can be.
DenseGain dense_gain(const Eigen::MatrixXd& covariance, const std::vector<DenseRow>& rows);

void apply_gain(const DenseGain& gain, Eigen::MatrixXd& covariance);

/// Replaces m by the mean of m and its transpose.
void symmetrise(Eigen::MatrixXd& m);

/// Landmark slots of a filter: which landmark of the world is which block of the state.
class SlotTable {
 public:
  void clear() { slots_.clear(); }
  /// -1 when absent.
  int find(int landmark) const;
  int add(int landmark);
  int size() const { return count_; }

 private:
  std::vector<int> slots_;
  int count_ = 0;
};

}  // namespace cairn::host
