#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/planar/planar_types.hpp"

namespace cairn::host {

/// Quantile of the chi-square distribution (Wilson and Hilferty 1931; relative error below 1e-3
/// from 30 degrees of freedom on). `normal_quantile` is that of the level: 1.959964 for 97.5 %.
double chi_square_quantile(double degrees_of_freedom, double normal_quantile);

/// Two-sided 95 % band of the average over `runs` of a normalised error squared with `dof`.
struct Band {
  double low = 0.0;
  double high = 0.0;
  bool contains(double value) const { return value >= low && value <= high; }
};
Band average_nees_band(int runs, int dof);

/// Normalised estimation error squared of (x, y, heading), additive coordinates, 3 degrees of
/// freedom.
double pose_nees(const PoseEstimate& estimate, const Pose2& truth);

/// The same for a landmark in world coordinates, 2 degrees of freedom.
double landmark_nees(const LandmarkEstimate& estimate, const Eigen::Vector2d& truth);

/// Sums per time step in fixed point: addition of integers is associative, so the total does not
/// depend on the order of runs, threads or shards. A sample is rounded to 1 / scale and clamped to
/// [0, largest]; clamped samples are counted.
class FixedSums {
 public:
  FixedSums() = default;
  FixedSums(int steps, double scale, double largest)
      : sums_(static_cast<std::size_t>(steps), 0), scale_(scale), largest_(largest) {}

  void add(int step, double sample);
  void add(const FixedSums& other);
  double mean(int step, int runs) const;
  int steps() const { return static_cast<int>(sums_.size()); }
  std::int64_t clamped() const { return clamped_; }

  const std::vector<std::int64_t>& raw() const { return sums_; }
  void set_raw(const std::vector<std::int64_t>& sums, std::int64_t clamped) {
    sums_ = sums;
    clamped_ = clamped;
  }

 private:
  std::vector<std::int64_t> sums_;
  double scale_ = 1.0;
  double largest_ = 1.0;
  std::int64_t clamped_ = 0;
};

}  // namespace cairn::host
