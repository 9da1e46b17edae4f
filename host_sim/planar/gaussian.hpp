#pragma once

#include <cstdint>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn::host {

/// Standard normal deviates by Box and Muller over the core's generator and elementary functions:
/// the same sequence with every standard library and CPU, which std::normal_distribution is not.
class GaussianSource {
 public:
  explicit GaussianSource(std::uint64_t seed) : random_(seed) {}

  double uniform() { return (random_.next() + 0.5) / 4294967296.0; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = cairn::sqrt(-2.0 * cairn::log(uniform()));
    double sine = 0.0;
    double cosine = 0.0;
    cairn::sin_cos(kTwoPi<double> * uniform() - kPi<double>, sine, cosine);
    spare_ = radius * sine;
    has_spare_ = true;
    return radius * cosine;
  }
  double normal(double standard_deviation) { return standard_deviation * normal(); }

 private:
  Random random_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// Seed of an independent stream: splitmix64 over (seed, index).
inline std::uint64_t stream_seed(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t z = seed * 0x9E3779B97F4A7C15ULL + (index + 1) * 0xD1B54A32D192ED03ULL;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

}  // namespace cairn::host
