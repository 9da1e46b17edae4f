#include "host_sim/base/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numeric>

namespace cairn::host {
namespace {

double percentile(const std::vector<double>& sorted, double fraction) {
  const auto rank =
      static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
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

double chi_square_quantile(double degrees_of_freedom, double probability) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

Band chi_square_band_95(int dof) {
  return {chi_square_quantile(dof, 0.025), chi_square_quantile(dof, 0.975)};
}

Band average_nees_band(int runs, int dof) {
  const Band sum = chi_square_band_95(runs * dof);
  return {sum.low / runs, sum.high / runs};
}

}  // namespace cairn::host
