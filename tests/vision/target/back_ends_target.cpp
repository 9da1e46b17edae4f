// The back ends of the vision kernels against each other on the target's own instructions, and its
// descriptors at every coordinate up to 4,096 against the sum of OpenCV's. Exit status 0: equal.

#include <cstdint>

#include "cairn/numeric/random.hpp"
#include "cairn/vision/patch.hpp"

#include "fast_detector.hpp"
#include "freak_kernel.hpp"
#include "freak_sum.hpp"
#include "text.hpp"

namespace {

using namespace cairn;
using cairn_test::Sum;
using cairn_test::write;

#ifdef CAIRN_PORT_FRAMES_SECTION
__attribute__((section(".frames")))
#endif
std::uint8_t pixels[cairn_test::kLong * cairn_test::kShort];

/// Noise, coarse steps, two values only, or one: where corners, ties and saturation come from.
ImageView make_image(Random& random, int least, int most) {
  const int width = least + random.below(most - least + 1);
  const int height = least + random.below(most - least + 1);
  const int stride = width + random.below(9);
  const int kind = random.below(4);
  for (int i = 0; i < stride * height; ++i) {
    const int value = random.below(256);
    pixels[i] = static_cast<std::uint8_t>(kind == 0   ? value
                                          : kind == 1 ? i % stride / 5 * 40 + value % 16
                                          : kind == 2 ? (value < 40 ? 255 : 0)
                                                      : 77);
  }
  return {pixels, width, height, stride};
}

template <class Lanes>
std::uint64_t detect(const ImageView& image, const Rect& rect, int threshold) {
  static FastScratch<96> scratch;
  static Corner corners[512];
  int count = 0;
  FastReport report;
  const Status status = vision::detect_fast_with<Lanes>(image, rect, threshold, {4096, 4096, 512},
                                                        scratch.buffers(), corners, &count, report);
  Sum sum;
  sum.add(&status, sizeof status);
  sum.add(&report.candidates, sizeof report.candidates);
  sum.add(&report.found, sizeof report.found);
  for (int i = 0; i < count; ++i) {
    sum.add(&corners[i].x, 2);
    sum.add(&corners[i].y, 2);
    sum.add(&corners[i].score, 1);
  }
  return sum.value();
}

template <class Lanes>
std::uint64_t describe(const ImageView& image, int x, int y, FreakPose pose) {
  Descriptor steered;
  Descriptor oriented;
  std::uint8_t bin = 0;
  const Status first = vision::describe_freak_with<Lanes>(image, x, y, pose, steered);
  const Status second =
      vision::describe_freak_with<Lanes>(image, x, y, FreakOrientation::kOpenCv, oriented, bin);
  Sum sum;
  sum.add(&first, sizeof first);
  sum.add(&second, sizeof second);
  sum.add(steered.bytes, sizeof steered.bytes);
  sum.add(oriented.bytes, sizeof oriented.bytes);
  sum.add(&bin, 1);
  return sum.value();
}

bool detectors_agree() {
  Random random(21);
  for (int trial = 0; trial < 150; ++trial) {
    const ImageView image = make_image(random, 1, 90);
    const Rect rect{random.below(image.width + 8) - 4, random.below(image.height + 8) - 4,
                    random.below(image.width + 8) + 4, random.below(image.height + 8) + 4};
    const int threshold = 1 + random.below(60);
    const std::uint64_t reference = detect<vision::PortableLanes>(image, rect, threshold);
    if (reference != detect<vision::WordLanes>(image, rect, threshold)) return false;
    if (reference != detect<vision::PixelLanes>(image, rect, threshold)) return false;
    if (reference != detect<vision::NativeLanes>(image, rect, threshold)) return false;
  }
  return true;
}

bool descriptors_agree() {
  Random random(22);
  for (int trial = 0; trial < 150; ++trial) {
    const ImageView image = make_image(random, 48, 170);
    const FreakPose pose{static_cast<std::uint8_t>(random.below(256)),
                         static_cast<std::uint8_t>(random.below(25))};
    const int x = 24 + random.below(image.width - 47);
    const int y = 24 + random.below(image.height - 47);
    const std::uint64_t reference = describe<vision::PortableLanes>(image, x, y, pose);
    if (reference != describe<vision::WordLanes>(image, x, y, pose)) return false;
    if (reference != describe<vision::PixelLanes>(image, x, y, pose)) return false;
    if (reference != describe<vision::NativeLanes>(image, x, y, pose)) return false;
  }
  return true;
}

/// See freak_sum.hpp.
std::uint64_t sum_of_all_coordinates() {
  using namespace cairn_test;
  Random random(kNoiseSeed);
  for (std::uint8_t& pixel : pixels) pixel = static_cast<std::uint8_t>(random.below(256));
  Sum sum;
  const ImageView wide{pixels, kLong, kShort, kLong};
  const ImageView tall{pixels, kShort, kLong, kShort};
  for (int k = kMargin; k <= kLong - kMargin; ++k) {
    for (const bool upright : {false, true}) {
      Descriptor along_x;
      Descriptor along_y;
      std::uint8_t bin_x = 0;
      std::uint8_t bin_y = 0;
      const bool described = upright
                                 ? ok(describe_freak(wide, k, across(k), FreakPose{}, along_x)) &&
                                       ok(describe_freak(tall, across(k), k, FreakPose{}, along_y))
                                 : ok(describe_freak(wide, k, across(k), along_x, bin_x)) &&
                                       ok(describe_freak(tall, across(k), k, along_y, bin_y));
      if (!described) return 0;
      sum.add(along_x.bytes, sizeof along_x.bytes);
      sum.add(along_y.bytes, sizeof along_y.bytes);
    }
  }
  return sum.value();
}

/// Blocks of random grey with a little noise: texture that alignment can hold on to.
ImageView make_texture(Random& random) {
  constexpr int kExtent = 48;
  const int block = 2 + random.below(4);
  for (int y = 0; y < kExtent; ++y) {
    for (int x = 0; x < kExtent; ++x) {
      const int value = x / block * 7919 + y / block * 104729 + x / block * (y / block) * 31;
      pixels[y * kExtent + x] = static_cast<std::uint8_t>(value % 251 + random.below(5));
    }
  }
  return {pixels, kExtent, kExtent, kExtent};
}

/// The same on every target, and before alignment worked on pairs.
constexpr std::uint64_t kSumOfAlignments = 0x600BAE995A53FDFC;

/// Patches taken and aligned under random warps, at starts of which some touch the border.
std::uint64_t sum_of_alignments() {
  Random random(24);
  Sum sum;
  for (int trial = 0; trial < 300; ++trial) {
    const ImageView image = make_texture(random);
    Patch patch;
    int x = 7 * 256 + random.below(33 * 256 + 1);
    int y = 7 * 256 + random.below(33 * 256 + 1);
    Status status = extract_patch(image, x, y, patch);
    sum.add(patch.pixels, sizeof patch.pixels);
    PatchWarp warp;
    const int spread = trial % 3 * 12000;
    for (std::int32_t* entry : {&warp.xx, &warp.xy, &warp.yx, &warp.yy}) {
      *entry += random.below(2 * spread + 1) - spread;
    }
    x = trial % 7 == 0 ? (48 - 6) * 256 : x + random.below(301) - 150;
    y = trial % 11 == 0 ? (48 - 6) * 256 : y + random.below(301) - 150;
    PatchAlignment alignment;
    status = align_patch(image, patch, warp, x, y, alignment);
    const std::int32_t results[] = {static_cast<std::int32_t>(status),
                                    x,
                                    y,
                                    alignment.converged ? 1 : 0,
                                    alignment.correlation,
                                    alignment.shift_x_q8,
                                    alignment.shift_y_q8,
                                    alignment.iterations};
    sum.add(results, sizeof results);
  }
  return sum.value();
}

bool report(const char* what, bool equal) {
  write(what);
  write(equal ? " equal\n" : " DIFFERENT\n");
  return equal;
}

}  // namespace

int main(int, char**) {
  bool equal = report("corners of the back ends", detectors_agree());
  equal = report("descriptors of the back ends", descriptors_agree()) && equal;
  equal = report("descriptors at all coordinates",
                 sum_of_all_coordinates() == cairn_test::kFreakSumOfAllCoordinates) &&
          equal;
  equal = report("patch alignments", sum_of_alignments() == kSumOfAlignments) && equal;
  return equal ? 0 : 1;
}
