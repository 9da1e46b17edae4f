#pragma once

#include <cstdint>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn::host {

/// Standard normal and uniform numbers from the core's generator: the same sequence everywhere.
class GaussianRandom {
 public:
  /// `phase_rad` turns every pair of normal deviates: another phase, other numbers, the same
  /// distribution.
  explicit GaussianRandom(std::uint64_t seed, double phase_rad = 0.0)
      : random_(seed), phase_rad_(phase_rad) {}

  /// Uniform in (0, 1).
  double uniform() { return (static_cast<double>(random_.next()) + 0.5) / 4294967296.0; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  int below(int bound) { return random_.below(bound); }

  /// Box and Muller 1958.
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = cairn::sqrt(-2.0 * cairn::log(uniform()));
    double sine = 0.0;
    double cosine = 0.0;
    cairn::sin_cos(kTwoPi<double> * uniform() + phase_rad_, sine, cosine);
    spare_ = radius * sine;
    has_spare_ = true;
    return radius * cosine;
  }
  double normal(double sigma) { return sigma * normal(); }

 private:
  Random random_;
  double phase_rad_;
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

/// Phase that the planar experiments draw with; their published tables depend on it.
inline constexpr double kExperimentPhase = -kPi<double>;

}  // namespace cairn::host
