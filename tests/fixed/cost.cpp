// What a cycle of 5 predictions and 1 update of 8 landmarks costs, fixed point beside float, at 10,
// 20 and 30 landmarks, what the steps of a frame with a camera cost at 10 and 20, and the hash of
// what fixed point made of it. Ticks are the port's: on an emulated board they count instructions
// (toolchains/run_qemu_system.sh).

#include "cairn/port/port.h"

#include "cycles.hpp"
#include "pixel_cycles.hpp"
#include "tests/target/text.hpp"

namespace {

using cairn::planar_test::FixedCycles;
using cairn::planar_test::kFixedMapLandmarks;
using cairn::planar_test::kPixelMapLandmarks;
using cairn::planar_test::PixelCycles;
using cairn::planar_test::PixelPattern;
using cairn_test::write;
using cairn_test::write_decimal;

using Fixed = cairn::FixedGroupSlam<kFixedMapLandmarks>;
using Float = cairn::GroupIekfSlam<float, kFixedMapLandmarks>;
using FixedPixels = cairn::FixedGroupSlam<kPixelMapLandmarks, 3>;
using FloatPixels = cairn::GroupIekfSlam<float, kPixelMapLandmarks, 3>;

constexpr int kSteps = 5;
constexpr int kCycles = 4;

/// One line: scalar, step, landmarks, ticks of one.
void report(const char* name, const char* step, int landmarks, std::uint32_t ticks) {
  write(name);
  write(" ");
  write(step);
  write(" ");
  write_decimal(static_cast<std::uint64_t>(landmarks));
  write(" ");
  write_decimal(ticks);
  write("\n");
}

template <class Step>
bool add_ticks(std::uint32_t& sum, const Step& step) {
  const std::uint32_t before = cairn_port_ticks();
  const bool good = step();
  sum += cairn_port_ticks() - before;
  return good;
}

template <class Filter>
bool measure(const char* name, FixedCycles<Filter>& cycles, int landmarks) {
  if (!cycles.start(landmarks)) return false;
  std::uint32_t predict = 0;
  std::uint32_t update = 0;
  const auto predict_all = [&cycles] {
    bool good = true;
    for (int i = 0; i < kSteps; ++i) good = good && cycles.predict();
    return good;
  };
  for (int k = 0; k < kCycles; ++k) {
    if (!add_ticks(predict, predict_all)) return false;
    if (!add_ticks(update, [&cycles] { return cycles.update(); })) return false;
  }
  report(name, "prediction", landmarks, predict / (kCycles * kSteps));
  report(name, "update", landmarks, update / kCycles);
  return true;
}

/// A frame of 8 pixels, two of which are wrong, and the consensus of 16 that all disagree.
template <class Filter>
bool measure(const char* name, PixelCycles<Filter>& cycles, int landmarks) {
  if (!cycles.start(landmarks)) return false;
  const PixelPattern seen = {8, 4};
  const PixelPattern wrong = {landmarks < 16 ? landmarks : 16, 1};
  std::uint32_t tilt = 0;
  std::uint32_t windows = 0;
  std::uint32_t update = 0;
  for (int k = 0; k < kCycles; ++k) {
    const auto predict_tilt = [&cycles] { return cycles.predict_tilt(); };
    const auto all_windows = [&cycles, &seen] { return cycles.windows(seen); };
    const auto update_pixels = [&cycles, &seen] { return ok(cycles.update(seen)); };
    if (!cycles.predict() || !add_ticks(tilt, predict_tilt)) return false;
    if (!add_ticks(windows, all_windows) || !add_ticks(update, update_pixels)) return false;
  }
  std::uint32_t none = 0;
  if (!cycles.windows(wrong)) return false;
  const auto disagree = [&cycles, &wrong] {
    return cycles.update(wrong) == cairn::Status::kNoConsensus && cycles.hypotheses == wrong.seen;
  };
  if (!add_ticks(none, disagree)) return false;
  report(name, "tilt", landmarks, tilt / kCycles);
  report(name, "windows", landmarks, windows / kCycles);
  report(name, "consensus", landmarks, update / kCycles);
  report(name, "disagreement", landmarks, none);
  return true;
}

FixedCycles<Fixed> fixed_cycles;
FixedCycles<Float> float_cycles;
PixelCycles<FixedPixels> fixed_pixels;
PixelCycles<FloatPixels> float_pixels;

}  // namespace

int main() {
  cairn::Hash64 hash;
  bool good = true;
  for (const int landmarks : {10, 20, 30}) {
    good = good && measure("fixed", fixed_cycles, landmarks);
    fixed_cycles.filter.hash(hash);
    good = good && measure("float", float_cycles, landmarks);
  }
  for (const int landmarks : {10, kPixelMapLandmarks}) {
    good = good && measure("fixed", fixed_pixels, landmarks);
    fixed_pixels.filter.hash(hash);
    good = good && measure("float", float_pixels, landmarks);
  }
  write("hash ");
  cairn_test::write_hex64(hash.value());
  write("\n");
  good = good && fixed_cycles.filter.saturations() == 0 && fixed_pixels.filter.saturations() == 0;
  return good ? 0 : 1;
}
