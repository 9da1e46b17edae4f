#include "cairn/tracking/place_look_up.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/base/config.hpp"

namespace cairn {
namespace {

using LookUp = PlaceLookUp<TinyConfig>;

/// GIVEN a vehicle that has lost its place before a grey wall, which shows nothing of any library.
class LostBeforeAWall : public ::testing::Test {
 protected:
  LostBeforeAWall() { look_up_->reset(); }

  ImageView image() const { return {pixels_.data(), kWidth, kHeight, kWidth}; }
  /// A frame that looks for its place; whether it took its image.
  bool look_for_place(int units = 100000) {
    look_up_->begin_frame(true);
    WorkBudget budget(units);
    if (!look_up_->takes_image(image(), budget)) return false;
    look_up_->capture(image(), Rigid<float>{}, PlanarPrior{}, parameters_, *scratch_, budget);
    return true;
  }

  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(kWidth * kHeight, 90);
  LookUp::Parameters parameters_;
  std::unique_ptr<LookUp> look_up_ = std::make_unique<LookUp>();
  std::unique_ptr<LookUp::Scratch> scratch_ = std::make_unique<LookUp::Scratch>();
};

TEST_F(LostBeforeAWall, TakesNoTwoImagesInARow) {
  ASSERT_TRUE(look_for_place());
  EXPECT_FALSE(look_up_->working()) << "nothing of a grey wall can be compared";
  EXPECT_FALSE(look_for_place());
  EXPECT_TRUE(look_for_place());
}

TEST_F(LostBeforeAWall, WaitsForAFrameThatCanPayTheImage) {
  EXPECT_FALSE(look_for_place(0));
  EXPECT_TRUE(look_up_->image_wanted());
  EXPECT_TRUE(look_for_place());
}

/// THEN the image that the first loss took last does not cost the second a frame.
TEST_F(LostBeforeAWall, ANewLossTakesItsFirstImageAtOnce) {
  ASSERT_TRUE(look_for_place());
  look_up_->end();
  EXPECT_TRUE(look_for_place());
}

TEST_F(LostBeforeAWall, BeginsAfterWeakFrames) {
  EXPECT_FALSE(look_up_->wanted(parameters_, parameters_.after_weak_frames - 1));
  EXPECT_TRUE(look_up_->wanted(parameters_, parameters_.after_weak_frames));
}

TEST_F(LostBeforeAWall, GivesUpAPlaceThatTheLibraryDoesNotHave) {
  for (int i = 1; i < parameters_.unknown_after; ++i) look_up_->note_unknown();
  ASSERT_TRUE(look_up_->wanted(parameters_, 100));
  look_up_->note_unknown();
  EXPECT_TRUE(look_up_->unknown(parameters_));
  EXPECT_FALSE(look_up_->wanted(parameters_, 100));
  look_up_->end();
  EXPECT_TRUE(look_up_->wanted(parameters_, 100)) << "the place was known again";
}

/// A place of the map where the vehicle cannot be says that the map has something like it: the
/// unknown takes longer.
TEST_F(LostBeforeAWall, ARefusedPlacePutsMappingOff) {
  look_up_->refuse(parameters_);
  EXPECT_FALSE(look_up_->take_found());
  int looks = 0;
  while (!look_up_->unknown(parameters_)) {
    look_up_->note_unknown();
    ++looks;
  }
  EXPECT_EQ(looks, 5 * parameters_.unknown_after);
}

}  // namespace
}  // namespace cairn
