// The monocular filter on the target itself (SwingRun, with 25 and with 50 features).
//
//   mono_target [--count 1] [--limit-25 N] [--limit-50 N]
//
// Prints the hash of the filter after the run, the same on every target. With --count the
// instructions of a frame's filter part (prediction, search regions, update); a worst frame above
// its limit is exit status 1. Counting needs an emulator whose clock advances 64 ns with every
// instruction.

#include <cstdint>

#include "cairn/port/port.h"

#include "swing_run.hpp"
#include "text.hpp"

namespace {

using cairn_test::write;
using cairn_test::write_decimal;

struct PortClock {
  using Sum = std::uint64_t;
  static std::uint32_t now() { return cairn_port_ticks(); }
};

std::uint64_t instructions(std::uint64_t ticks) {
  return ticks * 15625000U / cairn_port_ticks_per_second();
}

/// Prints the results; true when the run was as intended and the worst frame within `limit`.
template <int Features>
bool run(cairn_test::SwingRun<Features, PortClock>& swing, bool count, int limit) {
  swing.run();
  cairn::Hash64 hash;
  swing.filter().hash(hash);
  write("features ");
  write_decimal(Features);
  write(", states ");
  write_decimal(static_cast<std::uint64_t>(swing.filter().state_size()));
  write(", bytes ");
  write_decimal(sizeof swing.filter());
  write(", hash ");
  cairn_test::write_hex64(hash.value());
  write("\n");
  bool good = swing.as_intended();
  if (!good) write("the run was not as intended\n");
  if (!count) return good;
  const std::uint64_t worst = instructions(swing.worst());
  write("instructions a frame: mean ");
  write_decimal(instructions(swing.sum()) / static_cast<std::uint64_t>(swing.full_frames() + 1));
  write(", worst ");
  write_decimal(worst);
  good = good && worst <= static_cast<std::uint64_t>(limit);
  write(worst <= static_cast<std::uint64_t>(limit) ? ", within the limit\n"
                                                   : ", ABOVE THE LIMIT\n");
  return good;
}

cairn_test::SwingRun<25, PortClock> small_run;
cairn_test::SwingRun<50, PortClock> large_run;

}  // namespace

int main(int argc, char** argv) {
  const bool count = *cairn_test::argument(argc, argv, "--count", "0") == '1';
  const auto limit = [&](const char* name) {
    return cairn_test::parse_decimal(cairn_test::argument(argc, argv, name, "100000000"));
  };
  const bool small = run(small_run, count, limit("--limit-25"));
  const bool large = run(large_run, count, limit("--limit-50"));
  return small && large ? 0 : 1;
}
