#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/base/config.hpp"
#include "cairn/tracking/handheld_local_map.hpp"
#include "cairn/tracking/handheld_map_reuse.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using Config = TinyConfig;
using Estimate = HandheldEstimate<Config::kMaxFeatures>;
using LocalMap = HandheldLocalMap<Config>;
using Archive = HandheldArchive<Config>;

/// GIVEN a hand-held camera before a wall, with a filter that has just started.
class HandheldMap : public ::testing::Test {
 protected:
  HandheldMap() {
    EXPECT_TRUE(ok(estimate_->initialise(camera_, MonoParameters<float>{})));
    local_map_.reset({});
    local_map_.begin_frame(image_);
    archive_->reset({});
    work_.reset(100000, 8);
    work_.begin(0);
  }
  HandheldFrame<Config> frame() {
    return {{image_, camera_, work_, random_, report_, health_}, *scratch_};
  }
  /// A feature whose inverse depth has a relative standard deviation.
  LandmarkId add(float u, float relative_sigma) {
    TrackedLandmark landmark;
    landmark.id = estimate_->next_id()++;
    landmark.predicted = landmark.measured = 12;
    EXPECT_TRUE(
        ok(estimate_->filter().add_feature(landmark.id, {u, 120.0F}, 0.5F, 0.5F * relative_sigma)));
    EXPECT_TRUE(estimate_->landmarks().add(landmark));
    return landmark.id;
  }
  void archive_all() {
    Estimate::Matches matches;
    for (int slot = 0; slot < estimate_->size(); ++slot) {
      PixelMatch<float> match;
      match.id = estimate_->id(slot);
      match.slot = slot;
      match.inlier = true;
      matches.push_back(match);
    }
    auto f = frame();
    archive_->archive_due(f, *estimate_, matches);
  }

  const PinholeCamera<float> camera_ = test::to_float(test::small_camera());
  const std::vector<std::uint8_t> pixels_ = test::PlaneScene(2.0).render(test::small_camera(), {});
  const ImageView image_ = test::view(pixels_, test::small_camera());
  std::unique_ptr<Estimate> estimate_ = std::make_unique<Estimate>();
  std::unique_ptr<Archive> archive_ = std::make_unique<Archive>();
  std::unique_ptr<HandheldScratch<Config>> scratch_ = std::make_unique<HandheldScratch<Config>>();
  LocalMap local_map_;
  FrameWork work_;
  Random random_;
  FrameReport report_;
  Health health_;
};

TEST_F(HandheldMap, BeginsFeaturesAtCornersOfTheImage) {
  auto f = frame();
  const int added = local_map_.add_features(f, *estimate_);
  EXPECT_GT(added, 2);
  EXPECT_EQ(estimate_->size(), added);
  EXPECT_EQ(estimate_->landmarks().size(), added);
  EXPECT_EQ(report_.added, added);
  EXPECT_EQ(estimate_->next_id(), static_cast<LandmarkId>(added + 1));
}

TEST_F(HandheldMap, BeginsNoneThatTheFrameCannotPayFor) {
  work_.spend(100000);
  auto f = frame();
  EXPECT_EQ(local_map_.add_features(f, *estimate_), 0);
  work_.end(0, report_, health_);
  EXPECT_EQ(report_.cut, FrameCut::kNoMapping);
}

TEST_F(HandheldMap, RemovesWhatIsGoneAndArchivesWhatWasSeenOften) {
  const LandmarkId often = add(100.0F, 0.05F);
  const LandmarkId seldom = add(140.0F, 0.05F);
  const LandmarkId good = add(180.0F, 0.05F);
  estimate_->landmarks().find(often)->misses = 11;
  estimate_->landmarks().find(seldom)->frames_out_of_view = 11;
  estimate_->landmarks().find(seldom)->predicted = 5;
  estimate_->landmarks().find(seldom)->measured = 5;
  std::vector<LandmarkId> archived;
  auto f = frame();
  local_map_.remove_unreliable(f, *estimate_, [&](int slot, TrackedLandmark& landmark) {
    EXPECT_EQ(estimate_->id(slot), landmark.id);
    archived.push_back(landmark.id);
  });
  EXPECT_EQ(archived, std::vector<LandmarkId>{often});
  ASSERT_EQ(estimate_->size(), 1);
  EXPECT_EQ(estimate_->id(0), good);
  EXPECT_EQ(report_.removed, 2);
}

TEST_F(HandheldMap, ArchivesMatureFeaturesAndRenewsThemAsTheirSightingsDouble) {
  const LandmarkId id = add(160.0F, 0.05F);
  TrackedLandmark& landmark = *estimate_->landmarks().find(id);
  landmark.measured = 11;
  archive_all();
  EXPECT_EQ(archive_->library().size(), 0);
  for (int sightings = 12; sightings <= 48; ++sightings) {
    landmark.predicted = landmark.measured = sightings;
    archive_all();
  }
  EXPECT_EQ(health_.landmarks_archived, 3U) << "at 12, 24 and 48";
  ASSERT_EQ(archive_->library().size(), 1);
  EXPECT_EQ(archive_->library()[0].sightings, 48);
  EXPECT_NEAR(archive_->library()[0].p_map.z(), 2.0F, 1e-3F);
}

/// The part of the depth's variance that all features share is left out of their records.
TEST_F(HandheldMap, ArchivesNoFeatureOfUncertainDepth) {
  add(120.0F, 0.05F);
  const LandmarkId far = add(160.0F, 0.3F);
  archive_all();
  EXPECT_EQ(archive_->library().size(), 1);
  EXPECT_EQ(archive_->library().find(far), -1);
  const float along = archive_->library()[0].covariance(2, 2);
  EXPECT_LT(along, square(2.0F * 0.02F)) << "the best known depth has nothing of its own";
}

TEST_F(HandheldMap, ArchivesFourInAFrame) {
  for (int k = 0; k < 6; ++k) add(80.0F + 25.0F * static_cast<float>(k), 0.05F);
  archive_all();
  EXPECT_EQ(archive_->library().size(), 4);
  for (TrackedLandmark& landmark : estimate_->landmarks()) {
    landmark.predicted = landmark.measured = 13;
  }
  archive_all();
  EXPECT_EQ(archive_->library().size(), 6);
}

}  // namespace
}  // namespace cairn
