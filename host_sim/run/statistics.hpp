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

/// Two-sided 95 % band of the chi-square distribution, dof >= 1.
struct ChiSquareBand {
  double low = 0.0;
  double high = 0.0;
};
ChiSquareBand chi_square_band_95(int dof);

}  // namespace cairn::host
