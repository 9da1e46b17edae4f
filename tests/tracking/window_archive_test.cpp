#include "archived_wall.hpp"

namespace cairn {
namespace {

using WindowArchiveOfAWall = test::ArchivedWall;
const Vector2<float> kPixel(150.0F, 110.0F);

TEST_F(WindowArchiveOfAWall, TakesAFeatureThatWasSeenOftenAndWhoseDepthIsKnown) {
  follow(1, kPixel, 0.02F);
  follow(2, {80.0F, 60.0F}, 0.2F);
  follow(3, {80.0F, 160.0F}, 0.02F).sightings = kMature - 1;
  archive_due();
  ASSERT_EQ(archive_->library().size(), 1);
  EXPECT_EQ(archive_->library()[0].id, 1U);
  const Vector3<float> expected = kDepth * camera_.unproject(kPixel);
  EXPECT_LT((archive_->library()[0].p_map - expected).norm(), 1e-4F);
  EXPECT_EQ(health_.landmarks_archived, 1U);
}

TEST_F(WindowArchiveOfAWall, TakesAPointFoundAgainForTheSame) {
  follow(1, kPixel, 0.02F);
  follow(2, kPixel + Vector2<float>(2.0F, 0.0F), 0.02F);
  follow(3, kPixel + Vector2<float>(20.0F, 0.0F), 0.02F);
  archive_due();
  EXPECT_EQ(archive_->library().size(), 2);
  EXPECT_EQ(archive_->library().find(2), -1);
}

TEST_F(WindowArchiveOfAWall, FindsItsLandmarksInAnotherView) {
  archive_grid();
  ASSERT_GE(archive_->library().size(), 30);
  const Rigid<double> pose{rotation_exp(Vector3<double>(0.0, 0.05, 0.02)), {-0.3, 0.05, 0.2}};
  look_from(pose);
  constexpr int kLeast = 26214;  // correlation, 0.8
  int in_view = 0;
  int found = 0;
  for (int slot = 0; slot < archive_->library().size(); ++slot) {
    Vector2<float> expected;
    Vector2<float> pixel;
    if (!archive_->expected_pixel(camera_, slot, test::to_float(pose), expected)) continue;
    ++in_view;
    if (archive_->find(frame_, *features_, slot, test::to_float(pose), expected, 4, kLeast,
                       pixel)) {
      ++found;
      EXPECT_LT((pixel - expected).norm(), 2.0F);
    }
  }
  EXPECT_GE(in_view, 20);
  EXPECT_GE(10 * found, 9 * in_view);
}

TEST_F(WindowArchiveOfAWall, ExpectsNothingBehindTheCamera) {
  follow(1, kPixel, 0.02F);
  archive_due();
  const Rigid<float> beyond{Quaternion<float>::Identity(), {0.0F, 0.0F, 3.0F}};
  Vector2<float> pixel;
  EXPECT_TRUE(archive_->expected_pixel(camera_, 0, Rigid<float>(), pixel));
  EXPECT_FALSE(archive_->expected_pixel(camera_, 0, beyond, pixel));
}

}  // namespace
}  // namespace cairn
