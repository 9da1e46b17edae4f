#include "cairn/tracking/repeated_image.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

/// GIVEN pictures of 37 by 40 pixels, in rows of 48 bytes.
class PicturesOfACamera : public ::testing::Test {
 protected:
  static constexpr int kWidth = 37;
  static constexpr int kHeight = 40;
  static constexpr int kStride = 48;

  PicturesOfACamera() {
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      pixels_[i] = static_cast<std::uint8_t>(i * 37 % 251);
    }
  }
  bool take() { return repeated_.take({pixels_.data(), kWidth, kHeight, kStride}); }
  std::uint8_t& at(int x, int y) { return pixels_[static_cast<std::size_t>(y * kStride + x)]; }

  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(kStride * kHeight);
  RepeatedImage repeated_;
};

TEST_F(PicturesOfACamera, AreRepeatedWhenTheirBytesAre) {
  EXPECT_FALSE(take()) << "the first repeats nothing";
  EXPECT_TRUE(take());
  EXPECT_TRUE(take());
  ++at(kWidth - 1, 32);
  EXPECT_FALSE(take()) << "the last byte of a row that is compared";
  EXPECT_TRUE(take());
}

TEST_F(PicturesOfACamera, AreNotRepeatedForWhatLiesBehindTheirRows) {
  static_cast<void>(take());
  ++at(kWidth, 16);
  EXPECT_TRUE(take()) << "padding is not part of the picture";
}

TEST_F(PicturesOfACamera, MayBeTheSameInTheDark) {
  for (std::uint8_t& grey : pixels_) grey = 3;
  EXPECT_FALSE(take());
  EXPECT_FALSE(take());
  at(5, 16) = 4;
  EXPECT_FALSE(take());
  EXPECT_TRUE(take());
}

TEST_F(PicturesOfACamera, AreForgottenByAReset) {
  static_cast<void>(take());
  repeated_.reset();
  EXPECT_FALSE(take());
}

}  // namespace
}  // namespace cairn
