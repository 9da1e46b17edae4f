#pragma once

#include <cstdint>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn::host {

/// Standard normal and uniform numbers from the core's generator: the same sequence everywhere.
class GaussianRandom {
 public:
  explicit GaussianRandom(std::uint64_t seed) : random_(seed) {}

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
    cairn::sin_cos(kTwoPi<double> * uniform(), sine, cosine);
    spare_ = radius * sine;
    has_spare_ = true;
    return radius * cosine;
  }
  double normal(double sigma) { return sigma * normal(); }

 private:
  Random random_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace cairn::host
