#pragma once

#include <vector>

namespace cairn::host {

/// Summary of a series; percentiles by nearest rank.
struct Statistics {
  int n = 0;
  double mean = 0.0;
  double p50 = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

/// All zero for an empty series.
Statistics statistics_of(std::vector<double> values);

/// Share of `values` above `limit`, 0..1.
double share_above(const std::vector<double>& values, double limit);

/// x with P(chi-square <= x) = `probability`. Domain: degrees_of_freedom > 0, probability in (0,
/// 1).
double chi_square_quantile(double degrees_of_freedom, double probability);

struct Band {
  double low = 0.0;
  double high = 0.0;
  bool contains(double value) const { return value >= low && value <= high; }
};

/// Two-sided 95 % band of the chi-square distribution, dof >= 1.
Band chi_square_band_95(int dof);

/// Two-sided 95 % band of the average over `runs` of a normalised error squared with `dof` degrees
/// of freedom: runs * average is chi-square distributed with runs * dof.
Band average_nees_band(int runs, int dof);

}  // namespace cairn::host
