#include "cairn/tracking/place_sightings.hpp"

#include "archived_wall.hpp"

namespace cairn {
namespace {

using Sightings = PlaceSightings<DefaultConfig>;

/// GIVEN an archive of a wall, and a camera that looks at it from elsewhere.
class PlaceSightingsOfAWall : public test::ArchivedWall {
 protected:
  PlaceSightingsOfAWall() {
    archive_grid();
    look_from(pose_);
  }
  /// `aside`: of the pose that is tried, from the true one.
  float look(float aside) {
    Rigid<float> tried = test::to_float(pose_);
    tried.translation.x() += aside;
    sightings_->move_to(tried);
    work_.begin(0);
    return sightings_->look(frame_, *features_, *archive_, parameters_, 8);
  }

  const Rigid<double> pose_{rotation_exp(Vector3<double>(0.0, 0.05, 0.02)), {-0.3, 0.05, 0.2}};
  const Sightings::Parameters parameters_;
  std::unique_ptr<Sightings> sightings_ = std::make_unique<Sightings>();
};

TEST_F(PlaceSightingsOfAWall, MoveAPoseToWhereTheLandmarksAgree) {
  EXPECT_GE(look(0.08F), 8.0F);
  const Rigid<float> off = test::to_float(pose_).inverse() * sightings_->place().T_map_camera;
  EXPECT_LT(off.translation.norm(), 0.02F);
  EXPECT_LE(work_.budget().spent(), Sightings::look_work(8));
}

TEST_F(PlaceSightingsOfAWall, FindNoMoreThanByChanceWhereThePoseIsWrong) {
  EXPECT_LT(look(0.7F), 0.0F);
}

TEST_F(PlaceSightingsOfAWall, HoldThePoseForSureOnlyAsFarAsTheyDetermineIt) {
  ASSERT_GE(look(0.02F), 8.0F);
  Sightings::Parameters parameters;
  parameters.position_sigma = 0.1F;
  EXPECT_TRUE(sightings_->pose_is_sure(archive_->library(), parameters));
  parameters.position_sigma = 1e-5F;
  EXPECT_FALSE(sightings_->pose_is_sure(archive_->library(), parameters));
}

}  // namespace
}  // namespace cairn
