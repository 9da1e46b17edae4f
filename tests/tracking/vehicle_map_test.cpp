#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/base/config.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/tracking/vehicle_map_reuse.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using Config = TinyConfig;
using Filter = GroupIekfSlam<float, Config::kMaxLandmarks, 3>;
using Estimate = VehicleEstimate<Filter>;
using LocalMap = VehicleLocalMap<Config, Filter>;
using Archive = VehicleArchive<Config, Filter>;
using Map = SharedMap<Config>;

/// GIVEN a vehicle at x = 2 m that looks to its left at nothing in particular, with landmarks in
/// its filter.
class MapOfAVehicle : public ::testing::Test {
 protected:
  static constexpr int kUnits = 10000;

  MapOfAVehicle() {
    start(TiltParameters<float>::flat_floor());
    work_.reset(kUnits, 8);
    work_.begin(0);
  }

  void start(const TiltParameters<float>& tilt) {
    PlanarParameters<float> parameters;
    parameters.tilt = tilt;
    const Rigid<float> T_vehicle_camera{{0.70710678F, -0.70710678F, 0.0F, 0.0F},
                                        {0.0F, 0.0F, 1.0F}};
    PlanarPose<float> pose;
    pose.position = {2.0F, 0.0F};
    const Matrix3<float> covariance = 1e-4F * Matrix3<float>::Identity();
    EXPECT_TRUE(ok(estimate_->initialise(test::to_float(test::small_camera()), T_vehicle_camera,
                                         pose, covariance, parameters, 0.5F, FloorParameters{})));
    archive_.reset({}, covariance);
  }

  VehicleFrame<Config> frame() {
    return {{image_, estimate_->camera(), work_, random_, report_, health_}, *map_, *scratch_};
  }
  /// A landmark `ahead` m before the vehicle and 2 m to its left, out of view for so many frames.
  LandmarkId add(float ahead, int out_of_view = 0, int measured = 8) {
    TrackedLandmark landmark;
    landmark.id = estimate_->next_id()++;
    landmark.predicted = measured;
    landmark.measured = measured;
    landmark.frames_out_of_view = out_of_view;
    landmark.appearance.T_world_reference = estimate_->T_world_camera();
    EXPECT_TRUE(ok(estimate_->filter().add_landmark(landmark.id, {ahead, 2.0F, 1.0F},
                                                    0.01F * Matrix3<float>::Identity())));
    EXPECT_TRUE(estimate_->landmarks().add(landmark));
    return landmark.id;
  }
  Archive::Archived archived(LandmarkId id, const Vector3<float>& p_map) const {
    Archive::Archived landmark;
    landmark.id = id;
    landmark.p_map = p_map;
    landmark.covariance = 1e-4F * Matrix3<float>::Identity();
    landmark.view_count = 1;
    landmark.views[0].focal_px = 300.0F;
    return landmark;
  }

  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(320 * 240, 90);
  ImageView image_{pixels_.data(), 320, 240, 320};
  std::unique_ptr<Estimate> estimate_ = std::make_unique<Estimate>();
  Archive archive_;
  std::unique_ptr<Map> map_ = std::make_unique<Map>();
  std::unique_ptr<VehicleScratch<Config>> scratch_ = std::make_unique<VehicleScratch<Config>>();
  FrameWork work_;
  Random random_;
  FrameReport report_;
  Health health_;
};

TEST_F(MapOfAVehicle, ArchivesInTheFrameOfTheMap) {
  const LandmarkId id = add(1.0F);
  auto f = frame();
  archive_.archive(f, *estimate_, estimate_->filter().find(id), *estimate_->landmarks().find(id));
  const Map::Message* message = map_->messages.front();
  ASSERT_NE(message, nullptr);
  EXPECT_EQ(message->kind, Map::Message::Kind::kStore);
  EXPECT_EQ(message->landmark.id, id);
  EXPECT_LT((message->landmark.p_map - Vector3<float>(3.0F, 2.0F, 1.0F)).norm(), 1e-4F);
  EXPECT_EQ(message->landmark.sightings, 8);
  EXPECT_LT(message->landmark.covariance(0, 0), 0.011F) << "without the pose's own error";
  EXPECT_EQ(health_.landmarks_archived, 1U);
}

TEST_F(MapOfAVehicle, ArchivesAMatureLandmarkOnce) {
  const LandmarkId id = add(1.0F, 0, 11);
  TrackedLandmark& landmark = *estimate_->landmarks().find(id);
  auto f = frame();
  archive_.archive_mature(f, *estimate_, landmark);
  EXPECT_EQ(map_->messages.front(), nullptr);
  landmark.measured = landmark.predicted = 12;
  archive_.archive_mature(f, *estimate_, landmark);
  archive_.archive_mature(f, *estimate_, landmark);
  EXPECT_EQ(health_.landmarks_archived, 1U);
}

/// No place could be recognised by it.
TEST_F(MapOfAVehicle, DoesNotArchiveWhatHasNoDescriptor) {
  const LandmarkId id = add(1.0F, 0, 12);
  TrackedLandmark& landmark = *estimate_->landmarks().find(id);
  landmark.appearance.has_descriptor = false;
  auto f = frame();
  archive_.archive_mature(f, *estimate_, landmark);
  archive_.archive(f, *estimate_, estimate_->filter().find(id), landmark);
  EXPECT_EQ(map_->messages.front(), nullptr);
  EXPECT_FALSE(landmark.stored);
  EXPECT_EQ(health_.landmarks_archived, 0U);
}

/// What the filter knows of it comes from that place: stored again it would count twice.
TEST_F(MapOfAVehicle, LeavesALandmarkOfTheLibraryWhereItIs) {
  const LandmarkId id = add(1.0F, 0, 12);
  TrackedLandmark& landmark = *estimate_->landmarks().find(id);
  landmark.from_library = true;
  auto f = frame();
  archive_.archive(f, *estimate_, estimate_->filter().find(id), landmark);
  EXPECT_EQ(map_->messages.front(), nullptr);
  landmark.from_library = false;
  archive_.archive(f, *estimate_, estimate_->filter().find(id), landmark);
  EXPECT_NE(map_->messages.front(), nullptr);
}

TEST_F(MapOfAVehicle, ArchivesNothingWhereTheLibraryShowsThePlace) {
  for (int k = 0; k < 8; ++k) {
    TrackedLandmark& known = *estimate_->landmarks().find(add(2.0F + static_cast<float>(k)));
    known.from_library = known.searched = true;
  }
  const LandmarkId id = add(1.0F, 0, 12);
  TrackedLandmark& landmark = *estimate_->landmarks().find(id);
  auto f = frame();
  archive_.archive_mature(f, *estimate_, landmark);
  archive_.archive(f, *estimate_, estimate_->filter().find(id), landmark);
  EXPECT_EQ(health_.landmarks_archived, 0U);
  EXPECT_FALSE(landmark.stored);
  estimate_->landmarks().begin()->misses = 1;
  archive_.archive_mature(f, *estimate_, landmark);
  EXPECT_EQ(health_.landmarks_archived, 1U);
}

/// Until the map is recognised the pose's error is the map's. From then on the map keeps the error
/// that the pose had, turned about the place where it was recognised.
TEST_F(MapOfAVehicle, TheMapsErrorIsThatOfThePoseThatRecognisedIt) {
  EXPECT_EQ(archive_.map_covariance(*estimate_), Matrix3<float>::Zero().eval());
  EXPECT_EQ(archive_.covariance_in_map(*estimate_), estimate_->filter().pose_covariance());
  ASSERT_TRUE(ok(estimate_->filter().widen_pose(0.01F, 0.0009F)));
  archive_.note_tracked(*estimate_);
  const Matrix3<float> known = estimate_->filter().pose_covariance();
  auto f = frame();
  ASSERT_TRUE(archive_.reactivate(f, *estimate_, archived(50, {3.0F, 2.0F, 1.0F})));
  EXPECT_LT((archive_.map_covariance(*estimate_) - known).norm(), 1e-6F);

  PlanarIncrement<float> step;
  step.distance_m = 3.0F;
  ASSERT_TRUE(ok(estimate_->filter().predict(step)));
  ASSERT_TRUE(ok(estimate_->filter().widen_pose(1.0F, 0.0F)));
  archive_.note_tracked(*estimate_);
  const Matrix3<float> map = archive_.map_covariance(*estimate_);
  EXPECT_NEAR(map(0, 0), known(0, 0), 1e-5F);
  EXPECT_NEAR(map(1, 1), known(1, 1) + 9.0F * known(2, 2), 1e-4F);
  EXPECT_NEAR(map(2, 2), known(2, 2), 1e-6F);
  EXPECT_GT(archive_.covariance_in_map(*estimate_)(0, 0), 1.0F);
}

/// Of a vehicle that drives along a wall, 5 cm a frame by an odometry of so much noise.
TEST_F(MapOfAVehicle, GrowsOnceTheWayIsKnown) {
  constexpr float kStep_m = 0.05F;
  constexpr float kStep_s = 0.05F;
  std::vector<std::vector<std::uint8_t>> pictures;
  for (int k = 0; k < 9; ++k) {
    const Rigid<double> T{Quaternion<double>::Identity(), {0.05 * k, 0.0, 0.0}};
    pictures.push_back(test::PlaneScene(2.0).render(test::small_camera(), T));
  }
  const auto landmarks = [&](float sigma_m) {
    start(TiltParameters<float>::flat_floor());
    LocalMap local_map;
    local_map.reset({}, SearchParameters{});
    PlanarIncrement<float> increment;
    increment.distance_m = kStep_m;
    increment.covariance(0, 0) = square(sigma_m);
    increment.covariance(1, 1) = 1e-8F;
    int added = 0;
    for (const auto& picture : pictures) {
      image_.data = picture.data();
      report_ = FrameReport{};
      work_.begin(0);
      auto f = frame();
      local_map.begin_frame(image_, kStep_s);
      local_map.follow(f, *estimate_, {kStep_m / kStep_s, kStep_s, 1e-8F, true, 0.0F}, true);
      added += report_.added;
      EXPECT_TRUE(ok(estimate_->filter().predict(increment)));
    }
    return added;
  };
  EXPECT_GE(landmarks(0.005F), 4);
  EXPECT_EQ(landmarks(0.1F), 0) << "0.4 +- 0.28 m";
}

TEST_F(MapOfAVehicle, CountsMessagesForWhichThereIsNoRoom) {
  auto f = frame();
  for (int k = 0; k < 100; ++k) archive_.report_found(f, 1);
  EXPECT_GT(health_.map_messages_dropped, 0U);
  EXPECT_LT(health_.map_messages_dropped, 100U);
}

/// THEN it is where the map has it, in the filter's frame, and the alignment takes two ids.
TEST_F(MapOfAVehicle, ReactivatesALandmarkOfTheLibrary) {
  archive_.policy().allow_below(100);
  estimate_->next_id() = 100;
  auto f = frame();
  ASSERT_TRUE(archive_.reactivate(f, *estimate_, archived(50, {3.0F, 2.0F, 1.0F})));
  EXPECT_EQ(estimate_->next_id(), 102U);
  const int slot = estimate_->filter().find(50);
  ASSERT_GE(slot, 0);
  EXPECT_LT((estimate_->filter().mean_landmark(slot) - Vector3<float>(3.0F, 2.0F, 1.0F)).norm(),
            1e-4F);
  const TrackedLandmark* landmark = estimate_->landmarks().find(50);
  ASSERT_NE(landmark, nullptr);
  EXPECT_TRUE(landmark->from_library);
  EXPECT_TRUE(landmark->stored);
  EXPECT_FALSE(landmark->appearance.has_patch);
  EXPECT_EQ(report_.reactivated, 1);
  EXPECT_FALSE(archive_.reactivate(f, *estimate_, archived(50, {3.0F, 2.0F, 1.0F})))
      << "it is in the filter already";
}

TEST_F(MapOfAVehicle, DoesNotReactivateSoonWhatWasNotFound) {
  archive_.policy().allow_below(100);
  ASSERT_TRUE(archive_.policy().allows(50));
  auto f = frame();
  archive_.report_not_found(f, 50);
  EXPECT_FALSE(archive_.policy().allows(50));
  ASSERT_NE(map_->messages.front(), nullptr);
  EXPECT_EQ(map_->messages.front()->kind, Map::Message::Kind::kNotFound);
}

TEST_F(MapOfAVehicle, MakesRoomWhereLandmarksAreLongestOutOfView) {
  LocalMap local_map;
  local_map.reset({}, SearchParameters{});
  const LandmarkId oldest = add(-2.0F, 90);
  const LandmarkId seen_little = add(-1.0F, 40, 3);
  for (int k = 2; k < Config::kMaxLandmarks; ++k) add(1.0F + 0.1F * static_cast<float>(k), k);
  auto f = frame();
  local_map.make_room(f, *estimate_, archive_, 2, 8);
  EXPECT_EQ(estimate_->size(), Config::kMaxLandmarks - 2);
  EXPECT_EQ(estimate_->filter().find(oldest), -1);
  EXPECT_EQ(estimate_->landmarks().find(oldest), nullptr);
  EXPECT_EQ(estimate_->filter().find(seen_little), -1);
  EXPECT_EQ(report_.removed, 2);
  EXPECT_EQ(health_.landmarks_archived, 1U) << "the other was seen too rarely";
}

TEST_F(MapOfAVehicle, RemovesWhatIsRarelyFound) {
  LocalMap local_map;
  local_map.reset({}, SearchParameters{});
  const LandmarkId good = add(1.0F);
  const LandmarkId poor = add(1.5F);
  estimate_->landmarks().find(poor)->measured = 3;
  const LandmarkId library = add(2.0F);
  TrackedLandmark& unseen = *estimate_->landmarks().find(library);
  unseen.from_library = true;
  unseen.measured = 0;
  unseen.predicted = 4;
  auto f = frame();
  local_map.remove_unreliable(f, *estimate_, archive_);
  EXPECT_EQ(estimate_->size(), 1);
  EXPECT_GE(estimate_->filter().find(good), 0);
  EXPECT_FALSE(archive_.policy().allows(library));
}

TEST_F(MapOfAVehicle, RemovesNothingThatTheFrameCannotPayFor) {
  LocalMap local_map;
  local_map.reset({}, SearchParameters{});
  const LandmarkId poor = add(1.5F);
  estimate_->landmarks().find(poor)->measured = 3;
  work_.spend(kUnits);
  auto f = frame();
  local_map.remove_unreliable(f, *estimate_, archive_);
  EXPECT_EQ(estimate_->size(), 1);
}

/// A landmark on the floor whose height is known well enough is held there.
TEST_F(MapOfAVehicle, UsesALandmarkOnTheFloorOnce) {
  TrackedLandmark landmark;
  landmark.id = estimate_->next_id()++;
  ASSERT_TRUE(ok(estimate_->filter().add_landmark(landmark.id, {1.0F, 2.0F, 0.05F},
                                                  0.0036F * Matrix3<float>::Identity())));
  const int slot = estimate_->filter().find(landmark.id);
  auto f = frame();
  estimate_->constrain_to_floor(f, landmark);
  EXPECT_EQ(landmark.floor, FloorTest::kDone);
  EXPECT_LT(estimate_->filter().mean_landmark(slot).z(), 0.01F);
  const float height = estimate_->filter().mean_landmark(slot).z();
  estimate_->constrain_to_floor(f, landmark);
  EXPECT_EQ(estimate_->filter().mean_landmark(slot).z(), height);
}

/// Where the body tilts, heights are not used until enough of them lie on a floor; then also those
/// that proved it.
TEST_F(MapOfAVehicle, WhereTheBodyTiltsTheFloorMustProveItself) {
  start({1e-5F, 1e-5F, 1.0F});
  auto f = frame();
  TrackedLandmark first;
  for (int i = 0; i < 16; ++i) {
    TrackedLandmark landmark;
    landmark.id = estimate_->next_id()++;
    const float height_m = i < 8 ? 0.03F : 0.5F;
    ASSERT_TRUE(ok(estimate_->filter().add_landmark(landmark.id, {1.0F, 2.0F, height_m},
                                                    9e-4F * Matrix3<float>::Identity())));
    estimate_->constrain_to_floor(f, landmark);
    if (i < 15) {
      EXPECT_EQ(landmark.floor, FloorTest::kCounted) << i;
    }
    if (i == 0) {
      first = landmark;
      continue;
    }
    const int slot = estimate_->filter().find(landmark.id);
    ASSERT_TRUE(ok(estimate_->filter().remove_landmark(slot)));
  }
  const int slot = estimate_->filter().find(first.id);
  EXPECT_NEAR(estimate_->filter().mean_landmark(slot).z(), 0.03F, 1e-4F);
  estimate_->constrain_to_floor(f, first);
  EXPECT_EQ(first.floor, FloorTest::kDone);
  EXPECT_LT(estimate_->filter().mean_landmark(slot).z(), 0.015F);
}

TEST(FloorProof, ARoadProvesNothing) {
  FloorProof proof;
  proof.reset(false);
  EXPECT_TRUE(proof.proven());
  proof.reset(true);
  for (int i = 0; i < 500; ++i) {
    const float height_m = 0.02F * static_cast<float>(i % 50) - 0.2F;  // a fifth lies below
    proof.note(height_m, square(height_m / 0.05F), 3.84F);
    EXPECT_FALSE(proof.proven()) << i;
  }
}

TEST(FloorProof, AFloorProvesItselfAndMayEnd) {
  FloorProof proof;
  proof.reset(true);
  for (int i = 0; i < 200; ++i) {
    proof.note(0.1F * static_cast<float>(i % 2), static_cast<float>(9 * (i % 2)), 3.84F);
    EXPECT_EQ(proof.proven(), i >= 15) << i;
  }
  for (int i = 0; i < 20; ++i) proof.note(-0.3F, 20.0F, 3.84F);
  EXPECT_FALSE(proof.proven());
}

/// GIVEN a body that tilts WHEN a landmark appears higher than expected THEN the camera's pose has
/// pitched, and what is seen then lies where the tilted camera sees it.
TEST_F(MapOfAVehicle, TheCamerasPoseHasTheTilt) {
  start(TiltParameters<float>::car());
  const LandmarkId first = add(1.0F);
  const LandmarkId second = add(-1.0F);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(ok(estimate_->filter().predict_tilt(0.5F)));
  Estimate::Matches matches;
  for (const LandmarkId id : {first, second}) {
    PixelPrediction<float> seen;
    ASSERT_TRUE(ok(estimate_->predict(estimate_->filter().find(id), seen)));
    PixelMatch<float> match;
    match.id = id;
    match.slot = seen.slot;
    match.pixel = seen.pixel + Vector2<float>(0.0F, -3.0F);
    matches.push_back(match);
  }
  auto f = frame();
  EXPECT_EQ(estimate_->update(f, matches, 2).inliers, 2);
  // It looks to its left: what rises in the picture means that its left side went down.
  EXPECT_LT(estimate_->filter().tilt().roll, -0.001F);
  const Vector3<float> axis = estimate_->T_world_camera().rotation * Vector3<float>::UnitZ();
  EXPECT_NEAR(axis.z(), sin(estimate_->filter().tilt().roll), 1e-4F);
  EXPECT_LT(estimate_->tilt_covariance()(1, 1), estimate_->tilt_noise(100.0F)(1));
}

TEST_F(MapOfAVehicle, DoesNotTestAnUncertainHeight) {
  TrackedLandmark landmark;
  landmark.id = estimate_->next_id()++;
  ASSERT_TRUE(ok(estimate_->filter().add_landmark(landmark.id, {1.0F, 2.0F, 0.05F},
                                                  0.01F * Matrix3<float>::Identity())));
  auto f = frame();
  estimate_->constrain_to_floor(f, landmark);
  EXPECT_EQ(landmark.floor, FloorTest::kOpen);
}

}  // namespace
}  // namespace cairn
