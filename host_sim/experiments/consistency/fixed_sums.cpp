#include "host_sim/experiments/consistency/fixed_sums.hpp"

#include <cmath>

namespace cairn::host {

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
