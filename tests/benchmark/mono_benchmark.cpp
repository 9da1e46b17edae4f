// Processor time of the monocular filter's part of a frame (prediction, search regions, update):
// mean over the frames of SwingRun with a full map, every feature measured. The frames are those
// that mono_target counts instructions of on the emulated boards.

#include <ctime>

#include <benchmark/benchmark.h>

#include "swing_run.hpp"

namespace {

/// Time of this thread on a processor, s: what else the machine does is not in it.
struct ThreadClock {
  using Sum = double;
  static double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
};

/// Filter stages of the published MATLAB code in GNU Octave, 25 features, ms a frame.
constexpr double kOctaveMs = 54.0;

template <int Features>
void filter_part(benchmark::State& state) {
  static cairn_test::SwingRun<Features, ThreadClock> swing;
  double sum_s = 0.0;
  int frames = 0;
  for (auto _ : state) {
    swing.run();
    if (!swing.as_intended()) {
      state.SkipWithError("the run was not as intended");
      break;
    }
    sum_s += swing.sum();
    frames += swing.full_frames();
    state.SetIterationTime(swing.sum() / swing.full_frames());
  }
  if (frames == 0) return;
  const double frame_ms = 1e3 * sum_s / frames;
  state.counters["frame_ms"] = frame_ms;
  state.counters["states"] = swing.filter().state_size();
  if (Features == 25) state.counters["octave_ratio"] = kOctaveMs / frame_ms;
}

BENCHMARK_TEMPLATE(filter_part, 25)->UseManualTime()->Iterations(50)->Repetitions(5);
BENCHMARK_TEMPLATE(filter_part, 50)->UseManualTime()->Iterations(20)->Repetitions(5);

}  // namespace

BENCHMARK_MAIN();
