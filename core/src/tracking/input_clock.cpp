#include "cairn/tracking/input_clock.hpp"

#include "cairn/base/time.hpp"

namespace cairn {

Status InputClock::take(Source source, std::int64_t t_us) {
  const unsigned source_bit = 1U << static_cast<unsigned>(source);
  const std::int64_t step_us = known_sources_ == 0 ? 0 : difference_us(t_us, newest_us_);
  jumped_ = false;
  const bool in_order = step_us <= max_step_us_ && step_us >= -max_step_us_;
  if (!in_order) {
    if (!confirms(source_bit, t_us)) return step_us > 0 ? Status::kTimeGap : Status::kTimeBackwards;
    jumped_ = true;
    jump_us_ = step_us;
  }
  if (!in_order || step_us > 0 || known_sources_ == 0) newest_us_ = t_us;
  known_sources_ |= source_bit;
  suspect_count_ = 0;
  suspect_sources_ = 0;
  return Status::kOk;
}

/// Takes a stamp out of order into the suspicion; whether that confirms the jump.
bool InputClock::confirms(unsigned source_bit, std::int64_t t_us) {
  const std::int64_t since_us = difference_us(t_us, suspect_us_);
  if (suspect_count_ == 0 || since_us < 0 || since_us > max_step_us_) {
    suspect_count_ = 0;
    suspect_sources_ = 0;
  }
  suspect_us_ = t_us;
  suspect_sources_ |= source_bit;
  ++suspect_count_;
  const bool by_all = (known_sources_ & ~suspect_sources_) == 0;
  return suspect_count_ >= (by_all ? 2 : kStubborn);
}

}  // namespace cairn
