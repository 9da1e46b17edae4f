// Runs update cycles of one planar filter for an instruction counter: planar_cost
// ekf|group|lifted LANDMARKS CYCLES [float]. Only measured_cycles() counts: valgrind
// --tool=callgrind --toggle-collect=measured_cycles.

#include "planar_cycles.hpp"

using cairn::planar_test::kMaxLandmarks;
using cairn::planar_test::kSeen;
using cairn::planar_test::make_runner;
using cairn::planar_test::Runner;

extern "C" __attribute__((noinline)) void measured_cycles(void* runner, int count) {
  static_cast<Runner*>(runner)->cycles(count);
}

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const int landmarks = std::atoi(argv[2]);
  if (landmarks < kSeen || landmarks > kMaxLandmarks) return 2;
  const bool single = argc > 4 && std::strcmp(argv[4], "float") == 0;
  const auto runner =
      single ? make_runner<float>(argv[1], landmarks) : make_runner<double>(argv[1], landmarks);
  if (runner == nullptr) return 2;
  measured_cycles(runner.get(), std::atoi(argv[3]));
  return 0;
}
