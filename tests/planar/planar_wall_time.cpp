// Wall time of GroupIekfSlam against EkfSlam, paired: blocks of update cycles of the two take turns
// in one process, so that both meet the same clock, caches and neighbours. Prints the median ratio
// of neighbouring blocks and its quartiles: planar_wall_time [PAIRS]. A report, not a test.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "planar_cycles.hpp"

namespace {

using Clock = std::chrono::steady_clock;

double microseconds(cairn::planar_test::Runner& runner, int cycles) {
  const auto start = Clock::now();
  runner.cycles(cycles);
  const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
  return spent.count() / cycles;
}

double quantile(std::vector<double> values, double q) {
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

template <class T>
void compare(const char* scalar, int landmarks, int pairs) {
  const auto ekf = cairn::planar_test::make_runner<T>("ekf", landmarks);
  const auto group = cairn::planar_test::make_runner<T>("group", landmarks);
  const int cycles = 400 / landmarks;  // short enough to end before the scheduler looks in
  std::vector<double> ratios;
  std::vector<double> ekf_us;
  for (int k = -2; k < pairs; ++k) {
    // The order changes from pair to pair; the first two warm up.
    double a = 0.0;
    double b = 0.0;
    if (k % 2 == 0) {
      a = microseconds(*ekf, cycles);
      b = microseconds(*group, cycles);
    } else {
      b = microseconds(*group, cycles);
      a = microseconds(*ekf, cycles);
    }
    if (k < 0) continue;
    ratios.push_back(b / a);
    ekf_us.push_back(a);
  }
  std::printf("%-6s %9d %9.2f %9.3f %7.3f %7.3f\n", scalar, landmarks, quantile(ekf_us, 0.5),
              quantile(ratios, 0.5), quantile(ratios, 0.25), quantile(ratios, 0.75));
}

}  // namespace

int main(int argc, char** argv) {
  const int pairs = argc > 1 ? std::atoi(argv[1]) : 2000;
  if (pairs < 1) return 2;
  std::printf("scalar landmarks    ekf us group/ekf     25%%     75%%\n");
  for (const int landmarks : {10, 20, 30, 60}) compare<double>("double", landmarks, pairs);
  for (const int landmarks : {10, 20, 30, 60}) compare<float>("float", landmarks, pairs);
  return 0;
}
