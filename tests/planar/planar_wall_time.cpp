// Wall time of GroupIekfSlam and LiftedIekfSlam against EkfSlam, paired: blocks of ten update
// cycles of two filters take turns in one process, so that both meet the same clock, caches and
// neighbours. Where the filters lie in memory is drawn anew for every placement, because it alone
// moves the ratio by a few percent. planar_wall_time [PLACEMENTS [PAIRS]]. A report, not a test. It
// prints
//   fastest  ratio of the fastest blocks of a placement, median over the placements
//   paired   ratio of neighbouring blocks, median over all; and its quartiles

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "planar_cycles.hpp"

namespace {

using Clock = std::chrono::steady_clock;
using cairn::planar_test::make_runner;
using cairn::planar_test::Runner;

constexpr int kCycles = 10;  // short enough to end before the scheduler looks in
constexpr int kWarmUp = 2;
constexpr std::size_t kMostPadding = 16384;

double microseconds(Runner& runner) {
  runner.restart();
  const auto start = Clock::now();
  runner.cycles(kCycles);
  const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
  return spent.count() / kCycles;
}

double quantile(std::vector<double> values, double q) {
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

struct Comparison {
  std::vector<double> base_us;  ///< fastest block of each placement
  std::vector<double> fastest;
  std::vector<double> paired;
};

void compare_placed(Runner& base, Runner& other, int pairs, Comparison& out) {
  double base_us = 1e9;
  double other_us = 1e9;
  for (int k = -kWarmUp; k < pairs; ++k) {
    double a = 0.0;
    double b = 0.0;
    if (k % 2 == 0) {
      a = microseconds(base);
      b = microseconds(other);
    } else {
      b = microseconds(other);
      a = microseconds(base);
    }
    if (k < 0) continue;
    out.paired.push_back(b / a);
    base_us = std::min(base_us, a);
    other_us = std::min(other_us, b);
  }
  out.base_us.push_back(base_us);
  out.fastest.push_back(other_us / base_us);
}

template <class T>
void compare(const char* scalar, const char* name, int landmarks, int placements, int pairs) {
  std::mt19937 generator(1);
  std::uniform_int_distribution<std::size_t> padding(1, kMostPadding);
  Comparison result;
  for (int k = 0; k < placements; ++k) {
    const auto before = std::make_unique<char[]>(padding(generator));
    const auto base = make_runner<T>("ekf", landmarks);
    const auto between = std::make_unique<char[]>(padding(generator));
    const auto other = make_runner<T>(name, landmarks);
    compare_placed(*base, *other, pairs, result);
  }
  std::printf("%-6s %-6s %9d %8.2f %8.3f %7.3f %6.3f %6.3f\n", scalar, name, landmarks,
              quantile(result.base_us, 0.5), quantile(result.fastest, 0.5),
              quantile(result.paired, 0.5), quantile(result.paired, 0.25),
              quantile(result.paired, 0.75));
  std::fflush(stdout);
}

template <class T>
void compare_all(const char* scalar, int placements, int pairs) {
  for (const int landmarks : {10, 20, 30, 60}) {
    compare<T>(scalar, "group", landmarks, placements, pairs);
  }
  for (const int landmarks : {10, 20, 30, 60}) {
    compare<T>(scalar, "lifted", landmarks, std::min(placements, 5), std::min(pairs, 20));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int placements = argc > 1 ? std::atoi(argv[1]) : 40;
  const int pairs = argc > 2 ? std::atoi(argv[2]) : 100;
  if (placements < 1 || pairs < 1) return 2;
  std::printf("scalar filter landmarks   ekf us  fastest  paired    25%%    75%%\n");
  compare_all<double>("double", placements, pairs);
  compare_all<float>("float", placements, pairs);
  return 0;
}
