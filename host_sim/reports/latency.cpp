#include "host_sim/reports/latency.hpp"

#include "host_sim/base/statistics.hpp"

namespace cairn::host {

nlohmann::json latency_json(const std::vector<double>& values_ms, double limit_ms) {
  const Statistics s = statistics_of(values_ms);
  return {{"p50", s.p50}, {"p95", s.p95},   {"p99", s.p99},
          {"max", s.max}, {"mean", s.mean}, {"over_budget", share_above(values_ms, limit_ms)}};
}

}  // namespace cairn::host
