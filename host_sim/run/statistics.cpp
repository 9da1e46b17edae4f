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
  constexpr double kNormal975 = 1.959963984540054;
  const double spread = 2.0 / (9.0 * dof);
  const auto quantile = [&](double z) {
    const double root = 1.0 - spread + z * std::sqrt(spread);
    return dof * root * root * root;
  };
  return {quantile(-kNormal975), quantile(kNormal975)};
}

}  // namespace cairn::host
