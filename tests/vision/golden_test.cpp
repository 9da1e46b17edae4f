#include "golden.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "cairn/vision/fast.hpp"

namespace cairn {
namespace {

const std::string kRoot = CAIRN_SOURCE_DIR;

struct GoldenCase {
  const char* name;
  bool shared;  // beside the repository, else in it
};

std::string golden_folder(const GoldenCase& golden) {
  return golden.shared ? kRoot + "/../shared/golden/vision/" : kRoot + "/tests/vision/golden/";
}

class Golden : public testing::TestWithParam<GoldenCase> {
 protected:
  void SetUp() override {
    base_ = golden_folder(GetParam()) + GetParam().name;
    image_ = test::read_pgm(base_ + ".pgm");
    if (image_.pixels.empty()) {
      if (GetParam().shared) GTEST_SKIP() << "no recorded expectations at " << base_;
      FAIL() << "cannot read " << base_ << ".pgm";
    }
  }

  std::string base_;
  test::GreyImage image_;
};

TEST_P(Golden, FastCornersAndScoresEqualOpenCv) {
  const auto expected = test::read_csv(base_ + "_fast.csv");
  ASSERT_FALSE(expected.empty());
  std::vector<Corner> corners(20000);
  const auto scratch = std::make_unique<FastScratch<1024>>();
  FastReport report;
  ASSERT_EQ(detect_fast(image_.view(), image_.whole(), 20, *scratch, corners.data(),
                        static_cast<int>(corners.size()), report),
            Status::kOk);
  EXPECT_EQ(report.dropped, 0);
  ASSERT_EQ(report.found, static_cast<int>(expected.size()));
  for (int i = 0; i < report.found; ++i) {
    const auto& row = expected[static_cast<std::size_t>(i)];
    const Corner& corner = corners[static_cast<std::size_t>(i)];
    ASSERT_EQ(corner.x, std::stoi(row[0])) << "corner " << i;
    ASSERT_EQ(corner.y, std::stoi(row[1])) << "corner " << i;
    ASSERT_EQ(corner.score, std::stoi(row[2])) << "corner " << i;
  }
}

TEST_P(Golden, FreakDescriptorsEqualOpenCv) {
  const auto expected = test::read_csv(base_ + "_freak.csv");
  ASSERT_FALSE(expected.empty());
  for (const auto& row : expected) {
    const int x = std::stoi(row[0]);
    const int y = std::stoi(row[1]);
    Descriptor descriptor;
    std::uint8_t bin = 0;
    ASSERT_EQ(describe_freak(image_.view(), x, y, descriptor, bin), Status::kOk);
    ASSERT_EQ(bin, std::stoi(row[2])) << x << "," << y;
    ASSERT_EQ(test::to_hex(descriptor), row[3]) << x << "," << y;
    Descriptor steered;
    ASSERT_EQ(describe_freak(image_.view(), x, y, FreakPose{bin, 0}, steered), Status::kOk);
    ASSERT_EQ(test::to_hex(steered), row[3]) << x << "," << y;
  }
}

INSTANTIATE_TEST_SUITE_P(Own, Golden, testing::Values(GoldenCase{"blocks", false}),
                         [](const auto& param) { return std::string(param.param.name); });

INSTANTIATE_TEST_SUITE_P(Shared, Golden,
                         testing::Values(GoldenCase{"graf1", true}, GoldenCase{"graf3", true},
                                         GoldenCase{"churchill1", true},
                                         GoldenCase{"kitchen000", true},
                                         GoldenCase{"desk00", true}),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace cairn
