#include "cairn/tracking/place_views.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

using Views = PlaceViews<4>;
constexpr float kInverseDepth = 0.5F;

Rigid<float> at(float x, float turn) {
  return {rotation_exp(Vector3<float>(0.0F, turn, 0.0F)), {x, 0.0F, 0.0F}};
}

/// Of a texture that is another one for each `seed`.
SmallPicture picture(std::uint32_t seed) {
  SmallPicture out;
  std::uint32_t state = seed;
  for (std::uint8_t& cell : out.cells) {
    state = state * 1664525U + 1013904223U;
    cell = static_cast<std::uint8_t>(state >> 24U);
  }
  return out;
}

/// GIVEN three views, 0.5 apart and one of them turned.
class FewPlaceViews : public ::testing::Test {
 protected:
  FewPlaceViews() {
    views_.add(picture(1), at(0.0F, 0.0F), kInverseDepth);
    views_.add(picture(2), at(0.5F, 0.0F), kInverseDepth);
    views_.add(picture(3), at(0.5F, 0.4F), kInverseDepth);
  }
  Views views_;
};

TEST_F(FewPlaceViews, CallAPoseNewByItsAngleAndByWhatItMovesThePicture) {
  EXPECT_FALSE(views_.is_new(at(0.05F, 0.05F), kInverseDepth));
  EXPECT_TRUE(views_.is_new(at(0.0F, 0.15F), kInverseDepth));
  EXPECT_TRUE(views_.is_new(at(-0.3F, 0.0F), kInverseDepth));
  EXPECT_FALSE(views_.is_new(at(-0.3F, 0.0F), 0.1F * kInverseDepth)) << "nothing near is seen";
}

TEST_F(FewPlaceViews, NameTheOnesThatAPictureLooksLike) {
  Views::Likeness found[2];
  ASSERT_EQ(views_.most_like(picture(3), found, 2), 2);
  EXPECT_EQ(found[0].view, 2);
  EXPECT_EQ(found[0].shift.dx, 0);
  EXPECT_EQ(found[0].shift.dy, 0);
  EXPECT_GT(found[0].shift.score, 10.0F * found[1].shift.score);
}

TEST_F(FewPlaceViews, GiveUpOneOfTheTwoThatAreNearestWhenFull) {
  views_.add(picture(4), at(0.05F, 0.0F), kInverseDepth);
  ASSERT_EQ(views_.size(), Views::kCapacity);
  views_.add(picture(5), at(2.0F, 0.0F), kInverseDepth);
  ASSERT_EQ(views_.size(), Views::kCapacity);
  Views::Likeness found[1];
  views_.most_like(picture(5), found, 1);
  EXPECT_EQ(found[0].view, 0) << "the earlier one of those at 0 and 0.05";
  views_.most_like(picture(4), found, 1);
  EXPECT_EQ(found[0].view, 3);
}

}  // namespace
}  // namespace cairn
