#include "cairn/vision/fast.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

#include "grey_image.hpp"

namespace cairn {
namespace {

test::GreyImage noise_image(int width, int height, std::uint64_t seed) {
  test::GreyImage image{width, height, {}};
  Random random(seed);
  for (int i = 0; i < width * height; ++i) {
    image.pixels.push_back(static_cast<std::uint8_t>(random.below(256)));
  }
  return image;
}

struct Detection {
  std::vector<Corner> corners;
  FastReport report;
  Status status = Status::kOk;
};

Detection detect(const test::GreyImage& image, const Rect& rect, int threshold, int capacity) {
  FastScratch<256> scratch;
  std::memset(&scratch, 0xA5, sizeof scratch);  // its contents must not matter
  Detection d;
  d.corners.resize(static_cast<std::size_t>(capacity) + 1, Corner{-1, -1, 77});
  d.status =
      detect_fast(image.view(), rect, threshold, scratch, d.corners.data(), capacity, d.report);
  EXPECT_EQ(d.corners.back().score, 77) << "wrote beyond its capacity";
  d.corners.resize(static_cast<std::size_t>(d.report.found - d.report.dropped));
  return d;
}

bool same(const Corner& a, const Corner& b) {
  return a.x == b.x && a.y == b.y && a.score == b.score;
}

TEST(Fast, SmallestImageHasOneCandidate) {
  test::GreyImage image{7, 7, std::vector<std::uint8_t>(49, 100)};
  EXPECT_EQ(detect(image, image.whole(), 20, 4).report.candidates, 0);
  image.pixels[3 * 7 + 3] = 10;
  const Detection d = detect(image, image.whole(), 20, 4);
  ASSERT_EQ(d.report.found, 1);
  EXPECT_TRUE(same(d.corners[0], Corner{3, 3, 89}));  // all differ by 90: a corner up to 89
  EXPECT_EQ(detect(image, image.whole(), 89, 4).report.found, 1);
  EXPECT_EQ(detect(image, image.whole(), 90, 4).report.found, 0);
}

TEST(Fast, SmallerImagesAndEmptyRectanglesHaveNone) {
  const test::GreyImage image = noise_image(6, 40, 1);
  EXPECT_EQ(detect(image, image.whole(), 20, 4).status, Status::kOk);
  EXPECT_EQ(detect(image, image.whole(), 20, 4).report.found, 0);
  const test::GreyImage large = noise_image(60, 60, 1);
  EXPECT_EQ(detect(large, {30, 30, 30, 40}, 20, 4).report.candidates, 0);
  EXPECT_EQ(detect(large, {50, 40, 30, 20}, 20, 4).report.candidates, 0);
  EXPECT_EQ(detect(large, {100, 100, 120, 120}, 20, 4).report.candidates, 0);
}

TEST(Fast, ExtremeContrastKeepsItsScore) {
  test::GreyImage image{9, 9, std::vector<std::uint8_t>(81, 255)};
  image.pixels[4 * 9 + 4] = 0;
  const Detection d = detect(image, image.whole(), 254, 4);
  ASSERT_EQ(d.report.found, 1);
  EXPECT_EQ(d.corners[0].score, 254);
}

TEST(Fast, EqualNeighboursSuppressEachOther) {
  test::GreyImage image{16, 9, std::vector<std::uint8_t>(16 * 9, 200)};
  image.pixels[4 * 16 + 7] = image.pixels[4 * 16 + 8] = 50;
  const Detection d = detect(image, image.whole(), 20, 4);
  EXPECT_EQ(d.report.candidates, 2);
  EXPECT_EQ(d.report.found, 0);
}

TEST(Fast, EqualPixelsHaveNoCorners) {
  const test::GreyImage image{64, 48, std::vector<std::uint8_t>(64 * 48, 128)};
  EXPECT_EQ(detect(image, image.whole(), 1, 4).report.candidates, 0);
}

TEST(Fast, RefusesWhatItCannotSearch) {
  const test::GreyImage image = noise_image(64, 64, 2);
  FastScratch<32> scratch;
  Corner corners[4];
  FastReport report{1, 2, 3};
  EXPECT_EQ(detect_fast(image.view(), image.whole(), 20, scratch, corners, 4, report),
            Status::kInvalidArgument);
  EXPECT_EQ(detect_fast(image.view(), {10, 10, 42, 60}, 20, scratch, corners, 4, report),
            Status::kOk);
  report = {1, 2, 3};
  EXPECT_EQ(detect_fast(image.view(), {0, 0, 9, 9}, 0, scratch, corners, 4, report),
            Status::kInvalidArgument);
  EXPECT_EQ(detect_fast(image.view(), {0, 0, 9, 9}, 255, scratch, corners, 4, report),
            Status::kInvalidArgument);
  EXPECT_EQ(detect_fast(ImageView{}, {0, 0, 9, 9}, 20, scratch, corners, 4, report),
            Status::kInvalidArgument);
  EXPECT_EQ(detect_fast(image.view(), {0, 0, 9, 9}, 20, scratch, corners, -1, report),
            Status::kInvalidArgument);
  EXPECT_EQ(report.dropped, 3);
}

TEST(Fast, FullOutputKeepsTheBestInRasterOrder) {
  const test::GreyImage image = noise_image(200, 120, 3);
  const Detection all = detect(image, image.whole(), 30, 20000);
  ASSERT_GT(all.report.found, 300);
  for (const int capacity : {0, 1, 2, 7, 100, all.report.found - 1, all.report.found}) {
    std::vector<Corner> best = all.corners;
    std::stable_sort(best.begin(), best.end(),
                     [](const Corner& a, const Corner& b) { return a.score > b.score; });
    best.resize(static_cast<std::size_t>(capacity));
    std::sort(best.begin(), best.end(),
              [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    const Detection some = detect(image, image.whole(), 30, capacity);
    EXPECT_EQ(some.report.found, all.report.found);
    EXPECT_EQ(some.report.dropped, all.report.found - capacity);
    ASSERT_EQ(some.corners.size(), best.size());
    EXPECT_TRUE(std::equal(best.begin(), best.end(), some.corners.begin(), same)) << capacity;
  }
}

TEST(Fast, CellsKeepTheirOwnBest) {
  const test::GreyImage image = noise_image(150, 100, 4);
  const Rect rect{11, 7, 160, 93};  // reaches beyond the image
  const Rect visible{11, 7, 150, 93};
  const Detection all = detect(image, rect, 40, 20000);
  const FastCells cells{32, 25, 3};
  ASSERT_EQ(cells.columns(visible), 5);
  ASSERT_EQ(cells.rows(visible), 4);
  std::vector<Corner> corners(20 * 3);
  std::vector<int> counts(20, 99);
  FastScratch<256> scratch;
  FastReport report;
  ASSERT_EQ(detect_fast_cells(image.view(), rect, 40, cells, scratch, corners.data(), counts.data(),
                              report),
            Status::kOk);
  EXPECT_EQ(report.found, all.report.found);
  int kept = 0;
  for (int c = 0; c < 20; ++c) {
    const Rect cell = intersect(
        visible, {11 + c % 5 * 32, 7 + c / 5 * 25, 11 + c % 5 * 32 + 32, 7 + c / 5 * 25 + 25});
    std::vector<Corner> best;
    for (const Corner& k : all.corners) {
      if (k.x >= cell.x0 && k.x < cell.x1 && k.y >= cell.y0 && k.y < cell.y1) best.push_back(k);
    }
    std::stable_sort(best.begin(), best.end(),
                     [](const Corner& a, const Corner& b) { return a.score > b.score; });
    if (best.size() > 3) best.resize(3);
    std::sort(best.begin(), best.end(),
              [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    ASSERT_EQ(counts[static_cast<std::size_t>(c)], static_cast<int>(best.size())) << c;
    EXPECT_TRUE(std::equal(best.begin(), best.end(), corners.begin() + c * 3, same)) << c;
    kept += static_cast<int>(best.size());
  }
  EXPECT_EQ(report.dropped, report.found - kept);
}

}  // namespace
}  // namespace cairn
