// All back ends of the kernels give the same bytes on random images, strides and rectangles.

#include <algorithm>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

#include "fast_detector.hpp"
#include "freak_kernel.hpp"
#include "hamming_kernel.hpp"

namespace cairn {
namespace {

using vision::PixelLanes;
using vision::PortableLanes;
using vision::WordLanes;

struct RandomImage {
  std::vector<std::uint8_t> bytes;  // no byte more than the view may read
  ImageView view;
};

/// Noise, blocks, ramps, two values only, or one value: what corners, ties and saturation come
/// from.
RandomImage make_image(Random& random, int min_extent, int max_extent) {
  RandomImage image;
  const int width = min_extent + random.below(max_extent - min_extent + 1);
  const int height = min_extent + random.below(max_extent - min_extent + 1);
  const int stride = width + random.below(9);
  image.bytes.resize(static_cast<std::size_t>(stride * (height - 1) + width));
  const int kind = random.below(5);
  const int block = 1 + random.below(6);
  for (std::size_t i = 0; i < image.bytes.size(); ++i) {
    const int x = static_cast<int>(i) % stride / block;
    const int y = static_cast<int>(i) / stride / block;
    int value = random.below(256);
    if (kind == 1) value = (x * 7919 + y * 104729 + x * y * 31) % 256 / 8 * 8 + value % 16;
    if (kind == 2) value = (x * 3 + y * 5) & 255;
    if (kind == 3) value = value < 40 ? 255 : 0;
    if (kind == 4) value = 77;
    image.bytes[i] = static_cast<std::uint8_t>(value < 255 ? value : 255);
  }
  image.view = {image.bytes.data(), width, height, stride};
  return image;
}

struct Detection {
  Status status = Status::kOk;
  std::vector<Corner> corners = std::vector<Corner>(600);
  std::vector<int> counts = std::vector<int>(600);
  FastReport report;
};

template <class Lanes>
Detection detect(const ImageView& view, const Rect& rect, int threshold, const FastCells& cells) {
  Detection d;
  FastScratch<160> scratch;
  std::memset(&scratch, 0x5A, sizeof scratch);
  d.status = vision::detect_fast_with<Lanes>(view, rect, threshold, cells, scratch.buffers(),
                                             d.corners.data(), d.counts.data(), d.report);
  return d;
}

void expect_equal(const Detection& a, const Detection& b) {
  ASSERT_EQ(a.status, b.status);
  ASSERT_EQ(a.report.candidates, b.report.candidates);
  ASSERT_EQ(a.report.found, b.report.found);
  ASSERT_EQ(a.report.dropped, b.report.dropped);
  ASSERT_EQ(a.counts, b.counts);
  for (std::size_t i = 0; i < a.corners.size(); ++i) {
    ASSERT_EQ(a.corners[i].x, b.corners[i].x);
    ASSERT_EQ(a.corners[i].y, b.corners[i].y);
    ASSERT_EQ(a.corners[i].score, b.corners[i].score);
  }
}

TEST(BackEnds, DetectTheSameCorners) {
  Random random(11);
  int corners = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const RandomImage image = make_image(random, 1, 90);
    const ImageView& v = image.view;
    const Rect rect{random.below(v.width + 8) - 4, random.below(v.height + 8) - 4,
                    random.below(v.width + 8) - 4, random.below(v.height + 8) - 4};
    const Rect whole{0, 0, v.width, v.height};
    const int threshold = 1 + random.below(trial % 2 == 0 ? 254 : 40);
    const FastCells cells = trial % 3 == 0 ? FastCells{16, 16, 10} : FastCells{4096, 4096, 600};
    const Rect searched = trial % 2 == 0 ? whole : rect;
    const Detection reference = detect<PortableLanes>(v, searched, threshold, cells);
    expect_equal(reference, detect<WordLanes>(v, searched, threshold, cells));
    expect_equal(reference, detect<PixelLanes>(v, searched, threshold, cells));
#if CAIRN_VISION_HAS_VECTOR
    expect_equal(reference, detect<vision::VectorLanes>(v, searched, threshold, cells));
#endif
    corners += reference.report.found;
    if (HasFatalFailure()) FAIL() << "trial " << trial;
  }
  EXPECT_GT(corners, 5000);
}

/// The corner test as its definition reads, independent of the kernels.
int score_by_definition(const ImageView& v, int x, int y) {
  constexpr int kDx[16] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr int kDy[16] = {3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1, 0, 1, 2, 3};
  const int centre = v.row(y)[x];
  int best = 0;
  for (int start = 0; start < 16; ++start) {
    int brighter = 255;
    int darker = 255;
    for (int k = start; k < start + 9; ++k) {
      const int value = v.row(y + kDy[k & 15])[x + kDx[k & 15]];
      brighter = std::min(brighter, value - centre);
      darker = std::min(darker, centre - value);
    }
    best = std::max({best, brighter, darker});
  }
  return best - 1;
}

TEST(BackEnds, ScoreAsTheDefinitionReads) {
  Random random(12);
  for (int trial = 0; trial < 200; ++trial) {
    const RandomImage image = make_image(random, 7, 40);
    const ImageView& v = image.view;
    const int threshold = 1 + random.below(60);
    std::vector<std::vector<int>> scores(static_cast<std::size_t>(v.height),
                                         std::vector<int>(static_cast<std::size_t>(v.width)));
    const auto at = [&](int x, int y) -> int& {
      return scores[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
    };
    for (int y = 3; y < v.height - 3; ++y) {
      for (int x = 3; x < v.width - 3; ++x) {
        const int score = score_by_definition(v, x, y);
        at(x, y) = score >= threshold ? score : 0;
      }
    }
    std::vector<Corner> expected;
    for (int y = 3; y < v.height - 3; ++y) {
      for (int x = 3; x < v.width - 3; ++x) {
        bool peak = at(x, y) > 0;
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            if ((dx != 0 || dy != 0) && at(x + dx, y + dy) >= at(x, y)) peak = false;
          }
        }
        if (peak) {
          expected.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                              static_cast<std::uint8_t>(at(x, y))});
        }
      }
    }
    const Detection d =
        detect<WordLanes>(v, {0, 0, v.width, v.height}, threshold, {4096, 4096, 600});
    ASSERT_EQ(d.report.found, static_cast<int>(expected.size()));
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(d.corners[i].x, expected[i].x);
      ASSERT_EQ(d.corners[i].y, expected[i].y);
      ASSERT_EQ(d.corners[i].score, expected[i].score);
    }
  }
}

template <class Lanes>
std::vector<std::uint8_t> describe(const ImageView& v, int x, int y, FreakPose pose) {
  std::vector<std::uint8_t> out;
  Descriptor steered;
  out.push_back(
      static_cast<std::uint8_t>(vision::describe_freak_with<Lanes>(v, x, y, pose, steered)));
  out.insert(out.end(), steered.bytes, steered.bytes + Descriptor::kBytes);
  for (const auto precision : {FreakOrientation::kOpenCv, FreakOrientation::kFull}) {
    Descriptor self;
    std::uint8_t bin = 0;
    out.push_back(static_cast<std::uint8_t>(
        vision::describe_freak_with<Lanes>(v, x, y, precision, self, bin)));
    out.push_back(bin);
    out.insert(out.end(), self.bytes, self.bytes + Descriptor::kBytes);
  }
  return out;
}

TEST(BackEnds, DescribeTheSame) {
  Random random(13);
  for (int trial = 0; trial < 1500; ++trial) {
    const RandomImage image = make_image(random, 48, 170);
    const ImageView& v = image.view;
    const FreakPose pose{static_cast<std::uint8_t>(random.below(256)),
                         static_cast<std::uint8_t>(random.below(26))};
    const int margin = freak_margin(random.below(25));
    const int x = margin - 1 + random.below(std::max(1, v.width - 2 * margin + 3));
    const int y = margin - 1 + random.below(std::max(1, v.height - 2 * margin + 3));
    const auto reference = describe<PortableLanes>(v, x, y, pose);
    ASSERT_EQ(reference, describe<WordLanes>(v, x, y, pose)) << "trial " << trial;
    ASSERT_EQ(reference, describe<PixelLanes>(v, x, y, pose)) << "trial " << trial;
#if CAIRN_VISION_HAS_VECTOR
    ASSERT_EQ(reference, describe<vision::VectorLanes>(v, x, y, pose)) << "trial " << trial;
#endif
  }
}

TEST(BackEnds, SumTheSameBoxes) {
  Random random(14);
  const RandomImage image = make_image(random, 80, 80);
  const ImageView& v = image.view;
  for (int width = 1; width <= 48; ++width) {
    for (int height = 1; height <= 48; height += 1 + random.below(4)) {
      const std::uint8_t* const p =
          v.row(random.below(v.height - height)) + random.below(v.width - width - 15);
      const std::uint32_t sum = PortableLanes::box_sum(p, v.stride, width, height);
      ASSERT_EQ(sum, WordLanes::box_sum(p, v.stride, width, height)) << width << "x" << height;
      ASSERT_EQ(sum, PixelLanes::box_sum(p, v.stride, width, height)) << width << "x" << height;
#if CAIRN_VISION_HAS_VECTOR
      ASSERT_EQ(sum, vision::VectorLanes::box_sum(p, v.stride, width, height));
#endif
    }
  }
}

TEST(BackEnds, CountTheSameBits) {
  Random random(15);
  for (int trial = 0; trial < 5000; ++trial) {
    Descriptor a;
    Descriptor b;
    const int mode = random.below(3);
    for (int i = 0; i < Descriptor::kBytes; ++i) {
      a.bytes[i] = static_cast<std::uint8_t>(random.below(256));
      b.bytes[i] = static_cast<std::uint8_t>(mode == 0   ? random.below(256)
                                             : mode == 1 ? ~a.bytes[i]
                                                         : a.bytes[i] ^ (1 << random.below(9)));
    }
    int expected = 0;
    int prefix = 0;
    for (int bit = 0; bit < 512; ++bit) {
      expected += (a.bytes[bit / 8] ^ b.bytes[bit / 8]) >> (bit % 8) & 1;
      if (bit == 127) prefix = expected;
    }
    ASSERT_EQ(vision::WordCounter::whole(a, b), expected);
    ASSERT_EQ(vision::WordCounter::prefix(a, b), prefix);
    ASSERT_EQ(vision::PopulationCounter::whole(a, b), expected);
    ASSERT_EQ(vision::PopulationCounter::prefix(a, b), prefix);
  }
}

}  // namespace
}  // namespace cairn
