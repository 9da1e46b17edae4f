#include "cairn/tracking/vehicle_relocalisation.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/base/config.hpp"

namespace cairn {
namespace {

using Relocalisation = VehicleRelocalisation<TinyConfig>;

/// GIVEN a vehicle that has lost its place before a grey wall, which shows nothing of any library.
class LostBeforeAWall : public ::testing::Test {
 protected:
  LostBeforeAWall() { relocalisation_->reset(parameters_); }

  ImageView image() const { return {pixels_.data(), kWidth, kHeight, kWidth}; }
  /// A frame that looks for its place; whether it took its image.
  bool look_for_place(int units = 100000) {
    relocalisation_->begin_frame(true);
    WorkBudget budget(units);
    if (!relocalisation_->takes_image(image(), budget)) return false;
    relocalisation_->capture(image(), Rigid<float>{}, PlanarPrior{}, *scratch_, budget);
    return true;
  }

  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(kWidth * kHeight, 90);
  Relocalisation::Parameters parameters_;
  std::unique_ptr<Relocalisation> relocalisation_ = std::make_unique<Relocalisation>();
  std::unique_ptr<Relocalisation::Scratch> scratch_ = std::make_unique<Relocalisation::Scratch>();
};

TEST_F(LostBeforeAWall, TakesNoTwoImagesInARow) {
  ASSERT_TRUE(look_for_place());
  EXPECT_FALSE(relocalisation_->working()) << "nothing of a grey wall can be compared";
  EXPECT_FALSE(look_for_place());
  EXPECT_TRUE(look_for_place());
}

TEST_F(LostBeforeAWall, WaitsForAFrameThatCanPayTheImage) {
  EXPECT_FALSE(look_for_place(0));
  EXPECT_TRUE(relocalisation_->image_wanted());
  EXPECT_TRUE(look_for_place());
}

/// THEN the image that the first loss took last does not cost the second a frame.
TEST_F(LostBeforeAWall, ANewLossTakesItsFirstImageAtOnce) {
  ASSERT_TRUE(look_for_place());
  relocalisation_->end();
  EXPECT_TRUE(look_for_place());
}

TEST_F(LostBeforeAWall, BeginsAfterWeakFrames) {
  EXPECT_FALSE(relocalisation_->wanted(parameters_.after_weak_frames - 1));
  EXPECT_TRUE(relocalisation_->wanted(parameters_.after_weak_frames));
}

TEST_F(LostBeforeAWall, GivesUpAPlaceThatTheLibraryDoesNotHave) {
  for (int i = 1; i < parameters_.unknown_after; ++i) relocalisation_->note_unknown();
  ASSERT_TRUE(relocalisation_->wanted(100));
  relocalisation_->note_unknown();
  EXPECT_TRUE(relocalisation_->unknown());
  EXPECT_FALSE(relocalisation_->wanted(100));
  relocalisation_->end();
  EXPECT_TRUE(relocalisation_->wanted(100)) << "the place was known again";
}

/// A place of the map where the vehicle cannot be says that the map has something like it: the
/// unknown takes longer.
TEST_F(LostBeforeAWall, ARefusedPlacePutsMappingOff) {
  relocalisation_->refuse();
  EXPECT_FALSE(relocalisation_->take_found());
  int looks = 0;
  while (!relocalisation_->unknown()) {
    relocalisation_->note_unknown();
    ++looks;
  }
  EXPECT_EQ(looks, 5 * parameters_.unknown_after);
}

}  // namespace
}  // namespace cairn
