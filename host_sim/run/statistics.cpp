#include "host_sim/run/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cairn::host {
namespace {

double percentile(const std::vector<double>& sorted, double fraction) {
  const auto rank =
      static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

/// P(chi2_dof <= x): series of the regularised incomplete gamma function.
double chi_square_probability(int dof, double x) {
  const double a = 0.5 * dof;
  const double z = 0.5 * x;
  double term = 1.0 / a;
  double sum = term;
  for (int k = 1; k < 2000 && term > 1e-16 * sum; ++k) {
    term *= z / (a + k);
    sum += term;
  }
  return sum * std::exp(a * std::log(z) - z - std::lgamma(a));
}

double chi_square_quantile(int dof, double probability) {
  double low = 0.0;
  double high = dof + 20.0 * std::sqrt(2.0 * dof);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (chi_square_probability(dof, middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Statistics statistics_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return {static_cast<int>(values.size()), sum / static_cast<double>(values.size()),
          percentile(values, 0.50),        percentile(values, 0.95),
          percentile(values, 0.99),        values.back()};
}

double share_above(const std::vector<double>& values, double limit) {
  if (values.empty()) return 0.0;
  const auto above =
      std::count_if(values.begin(), values.end(), [&](double v) { return v > limit; });
  return static_cast<double>(above) / static_cast<double>(values.size());
}

ChiSquareBand chi_square_band_95(int dof) {
  return {chi_square_quantile(dof, 0.025), chi_square_quantile(dof, 0.975)};
}

}  // namespace cairn::host
