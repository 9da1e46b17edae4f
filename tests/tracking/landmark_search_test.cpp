#include "cairn/tracking/landmark_search.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "plane_scene.hpp"

namespace cairn {
namespace {

/// GIVEN landmarks made of a picture of a wall, and a filter that expects each where it is.
class SearchOfLandmarks : public ::testing::Test {
 protected:
  static constexpr int kCapacity = 16;
  static constexpr double kDepth = 2.0;

  /// As search_landmarks asks it.
  struct Filter {
    std::vector<PixelPrediction<float>> predictions;
    PinholeCamera<float> image_camera;
    int size() const { return static_cast<int>(predictions.size()); }
    LandmarkId id(int slot) const { return predictions[static_cast<std::size_t>(slot)].id; }
    Status predict(int slot, PixelPrediction<float>& prediction) const {
      prediction = predictions[static_cast<std::size_t>(slot)];
      return prediction.p_camera.z() > 0.0F ? Status::kOk : Status::kOutOfView;
    }
    const PinholeCamera<float>& camera() const { return image_camera; }
    Rigid<float> T_world_camera() const { return {}; }
  };

  static const std::vector<std::uint8_t>& picture() {
    static const std::vector<std::uint8_t> pixels =
        test::PlaneScene(kDepth).render(test::small_camera(), {});
    return pixels;
  }

  /// Landmark k + 1 is expected with a deviation of 1 + k / 4 px.
  SearchOfLandmarks() {
    filter_.image_camera = test::to_float(test::small_camera());
    FastScratch<320> fast;
    FastReport report;
    Corner corners[kCapacity];
    EXPECT_TRUE(ok(detect_fast(image(), {60, 60, 260, 180}, 40, fast, corners, kCapacity, report)));
    for (int k = 0; k < report.found - report.dropped; ++k)
      add(corners[k], 1.0F + 0.25F * static_cast<float>(k));
    EXPECT_GE(filter_.size(), 8);
  }
  static ImageView image() { return test::view(picture(), test::small_camera()); }

  void add(const Corner& corner, float sigma_px) {
    TrackedLandmark landmark;
    landmark.id = static_cast<LandmarkId>(filter_.size() + 1);
    if (!ok(make_appearance(image(), corner.x, corner.y, Rigid<float>(), landmark.appearance))) {
      return;
    }
    PixelPrediction<float> prediction;
    prediction.id = landmark.id;
    prediction.slot = filter_.size();
    prediction.pixel = Vector2<float>(static_cast<float>(corner.x), static_cast<float>(corner.y));
    prediction.covariance = sigma_px * sigma_px * Matrix2<float>::Identity();
    prediction.p_camera =
        static_cast<float>(kDepth) * filter_.image_camera.unproject(prediction.pixel);
    filter_.predictions.push_back(prediction);
    landmarks_.add(landmark);
  }
  void search(int most, WorkBudget& budget, SearchPass pass = SearchPass::kAll,
              SearchOrder order = SearchOrder::kMostUncertain) {
    matches_.clear();
    totals_ = SearchTotals();
    search_landmarks(image(), filter_, pass, order, landmarks_, parameters_, most, *scratch_,
                     matches_, totals_, budget);
  }
  void search(int most, SearchPass pass = SearchPass::kAll) {
    WorkBudget unlimited;
    search(most, unlimited, pass);
  }
  int count() const { return filter_.size(); }
  int most_work(int slot) const {
    return most_search_work(filter_.predictions[static_cast<std::size_t>(slot)], Appearance{},
                            parameters_);
  }

  Filter filter_;
  TrackedLandmarks<kCapacity> landmarks_;
  SearchParameters parameters_;
  std::unique_ptr<SearchScratch> scratch_ = std::make_unique<SearchScratch>();
  FixedVector<PixelMatch<float>, kCapacity> matches_;
  SearchTotals totals_;
};

TEST_F(SearchOfLandmarks, FindsThemAllTheMostUncertainFirst) {
  search(kCapacity);
  ASSERT_EQ(matches_.size(), count());
  EXPECT_EQ(totals_.searched, count());
  EXPECT_EQ(totals_.deferred, 0);
  for (int i = 0; i < matches_.size(); ++i) {
    EXPECT_EQ(matches_[i].id, static_cast<LandmarkId>(count() - i));
    const int slot = matches_[i].slot;
    EXPECT_EQ(filter_.id(slot), matches_[i].id);
    const Vector2<float> off =
        matches_[i].pixel - filter_.predictions[static_cast<std::size_t>(slot)].pixel;
    EXPECT_LT(off.norm(), 1.0F);
    const TrackedLandmark& landmark = *landmarks_.find(matches_[i].id);
    EXPECT_TRUE(landmark.searched);
    EXPECT_EQ(landmark.predicted, 1);
    EXPECT_EQ(landmark.misses, 1);  // until the filter has used the match
  }
}

TEST_F(SearchOfLandmarks, DefersTheBestKnownBeyondTheCount) {
  search(3);
  EXPECT_EQ(totals_.searched, 3);
  EXPECT_EQ(totals_.deferred, count() - 3);
  EXPECT_TRUE(landmarks_.find(static_cast<LandmarkId>(count()))->searched);
  EXPECT_FALSE(landmarks_.find(1)->searched);
  EXPECT_EQ(landmarks_.find(1)->predicted, 0);
}

TEST_F(SearchOfLandmarks, TakesTheRestInASecondPass) {
  search(3);
  search(kCapacity, SearchPass::kRest);
  EXPECT_EQ(totals_.searched, count() - 3);
  for (const TrackedLandmark& landmark : landmarks_) EXPECT_EQ(landmark.predicted, 1);
}

TEST_F(SearchOfLandmarks, StaysWithinTheWork) {
  WorkBudget budget(3 * most_work(count() - 1));
  search(kCapacity, budget);
  EXPECT_GE(budget.left(), 0);
  EXPECT_GE(totals_.searched, 3);
  EXPECT_EQ(totals_.searched + totals_.deferred, count());
  WorkBudget none(0);
  search(kCapacity, none);
  EXPECT_EQ(totals_.searched, 0);
  EXPECT_EQ(totals_.deferred, count());
  EXPECT_EQ(none.spent(), 0);
}

/// An update with small windows makes the others smaller: they may come first where the work does
/// not suffice for all.
TEST_F(SearchOfLandmarks, BeginsWithTheBestKnownWhenCut) {
  WorkBudget enough;
  search(kCapacity, enough, SearchPass::kAll, SearchOrder::kBestKnown);
  EXPECT_EQ(matches_[0].id, static_cast<LandmarkId>(count()));
  WorkBudget little(2 * most_work(0));
  search(kCapacity, little, SearchPass::kAll, SearchOrder::kBestKnown);
  ASSERT_FALSE(matches_.empty());
  EXPECT_EQ(matches_[0].id, 1U);
  EXPECT_GT(totals_.deferred, 0);
}

TEST_F(SearchOfLandmarks, CountsFramesOutOfView) {
  filter_.predictions[0].pixel.x() = -20.0F;
  filter_.predictions[1].p_camera.z() = -1.0F;
  search(kCapacity);
  search(kCapacity);
  EXPECT_EQ(totals_.searched, count() - 2);
  EXPECT_EQ(totals_.deferred, 0);
  EXPECT_EQ(landmarks_.find(1)->frames_out_of_view, 2);
  EXPECT_EQ(landmarks_.find(2)->frames_out_of_view, 2);
  EXPECT_EQ(landmarks_.find(1)->predicted, 0);
  filter_.predictions[0].pixel = filter_.predictions[2].pixel;
  search(kCapacity);
  EXPECT_EQ(landmarks_.find(1)->frames_out_of_view, 0);
}

TEST_F(SearchOfLandmarks, LeavesOutWhatTheTrackerHasNoRecordOf) {
  landmarks_.remove(static_cast<LandmarkId>(count()));  // a remembered position, say
  search(kCapacity);
  EXPECT_EQ(totals_.searched, count() - 1);
}

}  // namespace
}  // namespace cairn
