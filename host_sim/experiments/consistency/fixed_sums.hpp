#pragma once

#include <cstdint>
#include <vector>

namespace cairn::host {

/// Sums per time step in fixed point: addition of integers is associative, so the total does not
/// depend on the order of runs, threads or shards. A sample is rounded to 1 / scale and clamped to
/// [0, largest]; clamped samples are counted.
class FixedSums {
 public:
  FixedSums() = default;
  FixedSums(int steps, double scale, double largest)
      : sums_(static_cast<std::size_t>(steps), 0), scale_(scale), largest_(largest) {}

  void add(int step, double sample);
  void add(const FixedSums& other);
  double mean(int step, int runs) const;
  int steps() const { return static_cast<int>(sums_.size()); }
  std::int64_t clamped() const { return clamped_; }

  const std::vector<std::int64_t>& raw() const { return sums_; }
  void set_raw(const std::vector<std::int64_t>& sums, std::int64_t clamped) {
    sums_ = sums;
    clamped_ = clamped;
  }

 private:
  std::vector<std::int64_t> sums_;
  double scale_ = 1.0;
  double largest_ = 1.0;
  std::int64_t clamped_ = 0;
};

}  // namespace cairn::host
