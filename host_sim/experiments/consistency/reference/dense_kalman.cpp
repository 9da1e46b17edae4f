#include "host_sim/experiments/consistency/reference/dense_kalman.hpp"

namespace cairn::host {

DenseGain dense_gain(const Eigen::MatrixXd& covariance, const std::vector<DenseRow>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  const Eigen::Index n = covariance.rows();
  DenseGain result;
  result.cross.resize(n, 2 * count);
  result.innovation.resize(2 * count);
  Eigen::MatrixXd s(2 * count, 2 * count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const DenseRow& row = rows[static_cast<std::size_t>(k)];
    result.cross.middleCols(2 * k, 2) =
        covariance.leftCols(row.vehicle.cols()) * row.vehicle.transpose() +
        covariance.middleCols(row.landmark_column, 2) * row.landmark.transpose();
    result.innovation.segment<2>(2 * k) = row.innovation;
  }
  for (Eigen::Index k = 0; k < count; ++k) {
    const DenseRow& row = rows[static_cast<std::size_t>(k)];
    s.middleRows(2 * k, 2) = row.vehicle * result.cross.topRows(row.vehicle.cols()) +
                             row.landmark * result.cross.middleRows(row.landmark_column, 2);
    s.block<2, 2>(2 * k, 2 * k) += row.noise;
  }
  symmetrise(s);
  result.gain = s.llt().solve(result.cross.transpose()).transpose();
  return result;
}

void apply_gain(const DenseGain& gain, Eigen::MatrixXd& covariance) {
  covariance.noalias() -= gain.gain * gain.cross.transpose();
  symmetrise(covariance);
}

void symmetrise(Eigen::MatrixXd& m) {
  const Eigen::MatrixXd transposed = m.transpose();
  m = 0.5 * (m + transposed);
}

int SlotTable::find(int landmark) const {
  return landmark < static_cast<int>(slots_.size()) ? slots_[static_cast<std::size_t>(landmark)]
                                                    : -1;
}

int SlotTable::add(int landmark) {
  if (landmark >= static_cast<int>(slots_.size())) {
    slots_.resize(static_cast<std::size_t>(landmark) + 1, -1);
  }
  slots_[static_cast<std::size_t>(landmark)] = count_;
  return count_++;
}

}  // namespace cairn::host
