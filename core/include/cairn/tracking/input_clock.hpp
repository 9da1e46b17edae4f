#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"

namespace cairn {

/// Decides which time stamps of a tracker's inputs are believed, so that one wrong stamp costs one
/// input and a real jump (a stalled recorder, a restarted clock) costs a few.
///
/// A stamp within `max_step_us` of the newest believed one is in order; each source checks its own
/// order. Any other stamp is a jump. It is refused until it is confirmed: by a stamp that follows
/// within `max_step_us` from every source that was believed before, or by kStubborn stamps in a row
/// where the other source is silent. A stamp in order ends the suspicion. Before the first believed
/// stamp any stamp is in order.
class InputClock {
 public:
  enum class Source : std::uint8_t { kFrame, kOdometry, kGyro };
  static constexpr int kStubborn = 30;

  void reset(std::int64_t max_step_us) {
    *this = InputClock();
    max_step_us_ = max_step_us;
  }

  /// kOk: believed. kTimeGap, kTimeBackwards: refused, an unconfirmed jump ahead or back.
  Status take(Source source, std::int64_t t_us);
  /// Whether the stamp that was taken last confirmed a jump.
  bool jumped() const { return jumped_; }
  /// By how much the newest believed time moved with that jump, us; negative for a restarted clock.
  std::int64_t jump_us() const { return jump_us_; }
  /// Whether the stamp that was taken last confirmed that the clock was set back.
  bool was_set_back() const { return jumped_ && jump_us_ < 0; }

 private:
  bool confirms(unsigned source_bit, std::int64_t t_us);

  std::int64_t max_step_us_ = 0;
  std::int64_t newest_us_ = 0;
  unsigned known_sources_ = 0;  ///< bits of Source
  std::int64_t suspect_us_ = 0;
  unsigned suspect_sources_ = 0;
  int suspect_count_ = 0;
  bool jumped_ = false;
  std::int64_t jump_us_ = 0;
};

}  // namespace cairn
