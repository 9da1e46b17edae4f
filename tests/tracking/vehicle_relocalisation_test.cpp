#include "cairn/tracking/vehicle_relocalisation.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/base/config.hpp"
#include "cairn/tracking/live_landmark.hpp"

#include "plane_scene.hpp"

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

/// The landmarks that a filter holds, at the corners of an image of a wall 2 m to the left of a
/// vehicle at the origin.
class WallInTheFilter {
 public:
  WallInTheFilter() = default;
  WallInTheFilter(const ImageView& image, const PinholeCamera<float>& camera,
                  const Rigid<float>& T_vehicle_camera) {
    constexpr int kMargin = 40;
    static FastScratch<320> scratch;
    Corner corners[kMost];
    FastReport found;
    EXPECT_TRUE(
        ok(detect_fast(image, {kMargin, kMargin, image.width - kMargin, image.height - kMargin}, 20,
                       scratch, corners, kMost, found)));
    for (int i = 0; i < found.found - found.dropped; ++i) {
      Appearance appearance;
      EXPECT_TRUE(
          ok(make_appearance(image, corners[i].x, corners[i].y, T_vehicle_camera, appearance)));
      const Vector2<float> pixel(static_cast<float>(corners[i].x),
                                 static_cast<float>(corners[i].y));
      records_.emplace_back();
      records_.back().id = static_cast<LandmarkId>(i + 1);
      records_.back().appearance = appearance;
      places_.push_back(T_vehicle_camera * Vector3<float>(2.0F * camera.unproject(pixel)));
    }
  }
  int size() const { return static_cast<int>(records_.size()); }
  LandmarkId id(int slot) const { return records_[static_cast<std::size_t>(slot)].id; }
  bool get(int slot, LiveLandmark& landmark) const {
    const auto i = static_cast<std::size_t>(slot);
    landmark = {slot, records_[i].id, places_[i], &records_[i]};
    return true;
  }

 private:
  static constexpr int kMost = 40;
  std::vector<TrackedLandmark> records_;
  std::vector<Vector3<float>> places_;
};

/// 0.4 rad and 0.4 m off, and as unsure, with an empty library.
TEST(UnsureVehicle, IsFoundByTheLandmarksOfItsFilter) {
  const PinholeCamera<float> camera = test::to_float(test::small_camera());
  const Rigid<float> T_vehicle_camera{{0.70710678F, -0.70710678F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
  const std::vector<std::uint8_t> pixels =
      test::PlaneScene(2.0, 0.22).render(test::small_camera(), {});
  const ImageView image{pixels.data(), 320, 240, 320};
  const WallInTheFilter wall(image, camera, T_vehicle_camera);
  ASSERT_GE(wall.size(), 20);
  using Engine = Relocaliser<DefaultConfig>;
  const auto engine = std::make_unique<Engine>();
  const auto scratch = std::make_unique<Engine::Scratch>();
  const Engine::Parameters parameters;
  WorkBudget budget(100000);
  static_cast<void>(engine->capture(image, parameters, *scratch, budget));
  ASSERT_TRUE(engine->working());
  PlanarPrior prior;
  prior.pose.position = {0.3F, 0.25F};
  prior.pose.heading = 0.4F;
  prior.covariance = Vector3<float>(0.2F, 0.2F, 0.2F).asDiagonal();
  const PlanarView view{camera, T_vehicle_camera, 0.0F};
  const auto library = std::make_unique<MapLibrary<DefaultConfig>>();
  EXPECT_FALSE(engine->find_near(view, prior, *library, WallInTheFilter(), parameters, *scratch));
  ASSERT_TRUE(engine->find_near(view, prior, *library, wall, parameters, *scratch));
  const Rigid<float> error = T_vehicle_camera.inverse() * engine->T_map_camera();
  EXPECT_LT(error.translation.norm(), 0.05F);
  EXPECT_LT(rotation_log(error.rotation).norm(), 0.02F);
}

}  // namespace
}  // namespace cairn
