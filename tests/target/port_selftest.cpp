// Self-test of a port: what the core and its results rely on, checked on the target itself.

#include <cmath>
#include <cstdint>
#include <limits>

#include "cairn/numeric/math.hpp"
#include "cairn/port/port.h"

#include "text.hpp"

namespace {

using cairn_test::write;
using cairn_test::write_decimal;

class Checks {
 public:
  void expect(bool good, const char* what) {
    ++count_;
    if (good) return;
    ++failed_;
    write("FAILED ");
    write(what);
    write("\n");
  }
  int count() const { return count_; }
  int failed() const { return failed_; }

 private:
  int count_ = 0;
  int failed_ = 0;
};

struct Constructed {
  std::uint32_t value;
  Constructed() : value(seed + 1U) {}
  static volatile std::uint32_t seed;
};
volatile std::uint32_t Constructed::seed = 0x12345678U;
Constructed constructed;
std::uint32_t zero_initialised[64];

void check_memory(Checks& checks) {
  checks.expect(Constructed::seed == 0x12345678U, "initialised data");
  checks.expect(constructed.value == 0x12345679U, "static constructors");
  std::uint32_t any = 0;
  for (const std::uint32_t word : zero_initialised) any |= word;
  checks.expect(any == 0, "zero-initialised data");
}

void check_ticks(Checks& checks) {
  checks.expect(cairn_port_ticks_per_second() >= 1000000U, "tick resolution of 1 us or better");
  std::uint32_t last = cairn_port_ticks();
  const std::uint32_t first = last;
  std::uint32_t smallest = 0xFFFFFFFFU;
  bool monotonic = true;
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t now = cairn_port_ticks();
    const std::uint32_t step = now - last;
    monotonic = monotonic && step < 0x80000000U;
    if (step > 0 && step < smallest) smallest = step;
    last = now;
  }
  checks.expect(monotonic, "ticks never jump back");
  checks.expect(last != first, "ticks advance");
  write("ticks per second ");
  write_decimal(cairn_port_ticks_per_second());
  write(", smallest step between two reads ");
  write_decimal(smallest);
  write("\n");
}

void check_floating_point(Checks& checks) {
  volatile float one = 1.0F;
  volatile float half_ulp = 5.9604644775390625e-8F;  // 2^-24
  checks.expect(one + half_ulp == 1.0F, "ties round to even (down)");
  volatile float odd = 1.00000011920928955078125F;  // 1 + 2^-23
  checks.expect(odd + half_ulp == 1.0000002384185791015625F, "ties round to even (up)");
  volatile float smallest_normal = std::numeric_limits<float>::min();
  const float denormal = smallest_normal * 0.25F;
  checks.expect(denormal > 0.0F, "denormals are kept (no flush to zero)");
  checks.expect(denormal * 4.0F == std::numeric_limits<float>::min(), "denormals are inputs");
  volatile float zero = 0.0F;
  const float nan = zero / zero;
  checks.expect(!(nan == nan) && !(nan < 1.0F) && !(nan > 1.0F), "NaN compares false");
  checks.expect(!cairn::is_finite(nan), "NaN is not finite");
  checks.expect(!cairn::is_finite(one / zero), "division by zero gives infinity, no trap");
  checks.expect(cairn::round_to_int(nan) == 0, "NaN to integer is 0");
  checks.expect(cairn::round_to_int(1e20F) == 1073741824, "large float to integer is clamped");
  volatile float two = 2.0F;
  checks.expect(cairn::sqrt(two) == 1.41421353816986083984375F, "square root is correctly rounded");
  // 4097 * 4097 = 2^24 + 2^13 + 1 needs 25 bits: a fused multiply-add would keep the last one.
  volatile float factor = 4097.0F;
  volatile float rounded = -16785408.0F;
  checks.expect(factor * factor + rounded == 0.0F, "products are rounded (no contraction)");
}

void check_stack(Checks& checks) {
  const std::uint32_t size = cairn_port_stack_size_bytes();
  if (size == 0) return;
  const std::uint32_t used = cairn_port_stack_used_bytes();
  checks.expect(used > 0 && used < size, "painted stack below the high-water mark is intact");
  write("stack used ");
  write_decimal(used);
  write(" of ");
  write_decimal(size);
  write(" bytes\n");
}

void check_critical_section(Checks& checks) {
  const std::uint32_t outer = cairn_port_critical_enter();
  const std::uint32_t inner = cairn_port_critical_enter();
  cairn_port_critical_exit(inner);
  cairn_port_critical_exit(outer);
  const std::uint32_t again = cairn_port_critical_enter();
  cairn_port_critical_exit(again);
  checks.expect(again == outer, "critical sections nest and restore");
}

}  // namespace

int main() {
  Checks checks;
  check_memory(checks);
  check_ticks(checks);
  check_floating_point(checks);
  check_critical_section(checks);
  check_stack(checks);
  write("port_selftest: ");
  write_decimal(static_cast<std::uint64_t>(checks.count()));
  write(" checks, ");
  write_decimal(static_cast<std::uint64_t>(checks.failed()));
  write(" failed\n");
  return checks.failed() == 0 ? 0 : 1;
}
