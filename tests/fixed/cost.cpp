// What a cycle of 5 predictions and 1 update of 8 landmarks costs, fixed point beside float, at 10,
// 20 and 30 landmarks, and the hash of what fixed point made of it. Ticks are the port's: on an
// emulated board they count instructions (toolchains/run_qemu_system.sh).

#include "cairn/port/port.h"

#include "cycles.hpp"
#include "tests/target/text.hpp"

namespace {

using cairn::planar_test::FixedCycles;
using cairn::planar_test::kFixedMapLandmarks;
using cairn_test::write;
using cairn_test::write_decimal;

using Fixed = cairn::FixedGroupSlam<kFixedMapLandmarks>;
using Float = cairn::GroupIekfSlam<float, kFixedMapLandmarks>;

constexpr int kSteps = 5;
constexpr int kCycles = 4;

template <class Filter>
bool measure(const char* name, FixedCycles<Filter>& cycles, int landmarks) {
  if (!cycles.start(landmarks)) return false;
  std::uint32_t predict = 0;
  std::uint32_t update = 0;
  for (int k = 0; k < kCycles; ++k) {
    const std::uint32_t before = cairn_port_ticks();
    for (int i = 0; i < kSteps; ++i) {
      if (!cycles.predict()) return false;
    }
    const std::uint32_t between = cairn_port_ticks();
    if (!cycles.update()) return false;
    predict += between - before;
    update += cairn_port_ticks() - between;
  }
  write(name);
  write(" ");
  write_decimal(static_cast<std::uint64_t>(landmarks));
  write(" ");
  write_decimal(predict / (kCycles * kSteps));
  write(" ");
  write_decimal(update / kCycles);
  write("\n");
  return true;
}

FixedCycles<Fixed> fixed_cycles;
FixedCycles<Float> float_cycles;

}  // namespace

int main() {
  cairn::Hash64 hash;
  bool good = true;
  for (const int landmarks : {10, 20, 30}) {
    good = good && measure("fixed", fixed_cycles, landmarks);
    fixed_cycles.filter.hash(hash);
    good = good && measure("float", float_cycles, landmarks);
  }
  write("hash ");
  cairn_test::write_hex64(hash.value());
  write("\n");
  return good && fixed_cycles.filter.saturations() == 0 ? 0 : 1;
}
