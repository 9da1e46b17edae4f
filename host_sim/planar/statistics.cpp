#include "host_sim/planar/statistics.hpp"

#include <cmath>

#include "cairn/numeric/math.hpp"

namespace cairn::host {

double chi_square_quantile(double degrees_of_freedom, double normal_quantile) {
  const double h = 2.0 / (9.0 * degrees_of_freedom);
  const double root = 1.0 - h + normal_quantile * std::sqrt(h);
  return degrees_of_freedom * root * root * root;
}

Band average_nees_band(int runs, int dof) {
  constexpr double kNormal975 = 1.959963984540054;
  const double degrees = static_cast<double>(runs) * dof;
  return {chi_square_quantile(degrees, -kNormal975) / runs,
          chi_square_quantile(degrees, kNormal975) / runs};
}

double pose_nees(const PoseEstimate& estimate, const Pose2& truth) {
  Eigen::Vector3d error;
  error << truth.position - estimate.pose.position,
      wrap_angle(truth.heading - estimate.pose.heading);
  return error.dot(estimate.covariance.ldlt().solve(error));
}

double landmark_nees(const LandmarkEstimate& estimate, const Eigen::Vector2d& truth) {
  const Eigen::Vector2d error = truth - estimate.position;
  return error.dot(estimate.covariance.ldlt().solve(error));
}

void FixedSums::add(int step, double sample) {
  double value = sample;
  if (!(value >= 0.0 && value <= largest_)) {
    value = value < 0.0 ? 0.0 : largest_;
    ++clamped_;
  }
  sums_[static_cast<std::size_t>(step)] += std::llround(value * scale_);
}

void FixedSums::add(const FixedSums& other) {
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += other.sums_[i];
  clamped_ += other.clamped_;
}

double FixedSums::mean(int step, int runs) const {
  return static_cast<double>(sums_[static_cast<std::size_t>(step)]) / scale_ / runs;
}

}  // namespace cairn::host
