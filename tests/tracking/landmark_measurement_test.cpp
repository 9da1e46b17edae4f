#include "cairn/tracking/landmark_measurement.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "plane_scene.hpp"

namespace cairn {
namespace {

constexpr int kCapacity = 8;
using Measurement = LandmarkMeasurement<kCapacity>;

/// As search_landmarks() asks it.
struct Filter {
  FixedVector<PixelPrediction<float>, kCapacity> predictions;
  PinholeCamera<float> image_camera;
  int size() const { return predictions.size(); }
  LandmarkId id(int slot) const { return predictions[slot].id; }
  Status predict(int slot, PixelPrediction<float>& prediction) const {
    prediction = predictions[slot];
    return Status::kOk;
  }
  const PinholeCamera<float>& camera() const { return image_camera; }
  Rigid<float> T_world_camera() const { return {}; }
};

/// GIVEN landmarks made of a picture of a wall, and a filter that expects each where it is.
class MeasurementOfAWall : public ::testing::Test {
 protected:
  static constexpr int kUnits = 100000;

  MeasurementOfAWall() {
    filter_.image_camera = camera_;
    FastScratch<320> fast;
    FastReport report;
    Corner corners[kCapacity];
    EXPECT_TRUE(ok(detect_fast(image_, {60, 60, 260, 180}, 40, fast, corners, kCapacity, report)));
    for (int k = 0; k < report.found - report.dropped; ++k) add(corners[k]);
    EXPECT_GE(filter_.size(), 6);
    measurement_.reset({});
    work_.reset(kUnits, 8);
    work_.begin(0);
  }
  void add(const Corner& corner) {
    TrackedLandmark landmark;
    landmark.id = static_cast<LandmarkId>(filter_.size() + 1);
    if (!ok(make_appearance(image_, corner.x, corner.y, Rigid<float>(), landmark.appearance))) {
      return;
    }
    PixelPrediction<float> prediction;
    prediction.id = landmark.id;
    prediction.slot = filter_.size();
    prediction.pixel = Vector2<float>(static_cast<float>(corner.x), static_cast<float>(corner.y));
    prediction.covariance = 2.0F * Matrix2<float>::Identity();
    prediction.p_camera = 2.0F * camera_.unproject(prediction.pixel);
    filter_.predictions.push_back(prediction);
    landmarks_.add(landmark);
  }
  void search(SearchPass pass, int most, int units = kUnits) {
    FrameContext frame{image_, camera_, work_, random_, report_, health_};
    measurement_.search(frame, filter_, landmarks_, pass, SearchOrder::kMostUncertain, most, units,
                        *scratch_);
  }

  const PinholeCamera<float> camera_ = test::to_float(test::small_camera());
  const std::vector<std::uint8_t> pixels_ = test::PlaneScene(2.0).render(test::small_camera(), {});
  const ImageView image_ = test::view(pixels_, test::small_camera());
  Filter filter_;
  Measurement::Landmarks landmarks_;
  Measurement measurement_;
  std::unique_ptr<SearchScratch> scratch_ = std::make_unique<SearchScratch>();
  FrameWork work_;
  Random random_;
  FrameReport report_;
  Health health_;
};

TEST_F(MeasurementOfAWall, CountsTwoPassesOfAFrameTogether) {
  search(SearchPass::kAll, 4);
  EXPECT_EQ(measurement_.counts().searched, 4);
  EXPECT_EQ(measurement_.not_searched(), filter_.size() - 4);
  EXPECT_EQ(report_.cut, FrameCut::kNone) << "the count was spent, not the work";
  search(SearchPass::kRest, kCapacity);
  EXPECT_EQ(measurement_.counts().searched, filter_.size());
  EXPECT_EQ(measurement_.counts().matches, filter_.size());
  EXPECT_EQ(measurement_.deferred(), 0);
  measurement_.begin();
  EXPECT_EQ(measurement_.counts().searched, 0);
  EXPECT_TRUE(measurement_.matches().empty());
}

TEST_F(MeasurementOfAWall, SaysWhetherItCouldSearch) {
  search(SearchPass::kAll, kCapacity, 0);
  EXPECT_FALSE(measurement_.counts().could_search);
  EXPECT_EQ(measurement_.deferred(), filter_.size());
  work_.end(measurement_.deferred(), report_, health_);
  EXPECT_EQ(report_.cut, FrameCut::kPredictionOnly);
}

TEST_F(MeasurementOfAWall, LeavesOutWhatTheUpdateCannotPay) {
  work_.spend(kUnits - 35);
  EXPECT_EQ(affordable_matches(8, work_, [](int n) { return 10 * n; }), 3);
  EXPECT_EQ(affordable_matches(0, work_, [](int n) { return 10 * n; }), 0);
  PixelUpdate update;
  update.inliers = 3;
  update.left_out = 5;
  measurement_.note_update(update);
  EXPECT_EQ(measurement_.counts().inliers, 3);
  EXPECT_EQ(measurement_.deferred(), 5);
}

/// A frame in which too few agree says nothing about those that were not found.
TEST_F(MeasurementOfAWall, ForgetsTheSearchesOfAFrame) {
  search(SearchPass::kAll, 4);
  Measurement::forget_searches(landmarks_);
  for (const TrackedLandmark& landmark : landmarks_) {
    EXPECT_EQ(landmark.predicted, 0);
    EXPECT_EQ(landmark.misses, 0);
    EXPECT_FALSE(landmark.searched);
  }
  Measurement::forget_searches(landmarks_);
  for (const TrackedLandmark& landmark : landmarks_) EXPECT_EQ(landmark.predicted, 0);
}

TEST_F(MeasurementOfAWall, NotesInliersInTheirRecords) {
  search(SearchPass::kAll, kCapacity);
  TrackedLandmark& landmark = *landmarks_.find(1);
  landmark.from_library = true;
  Measurement::note_inlier(landmark, report_);
  EXPECT_EQ(landmark.measured, 1);
  EXPECT_EQ(landmark.misses, 0);
  EXPECT_EQ(report_.from_library, 1);
}

}  // namespace
}  // namespace cairn
