#include "cairn/tracking/active_search.hpp"

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using test::PlaneScene;

/// GIVEN a landmark taken from a first view of a plane, and a second view of known pose.
class ActiveSearch : public ::testing::Test {
 protected:
  static constexpr double kDepth = 2.0;

  ActiveSearch() : first_(scene_.render(camera_, Rigid<double>{})) {
    second_ = scene_.render(camera_, T_second_);
    FastScratch<320> scratch;
    FastReport report;
    EXPECT_TRUE(ok(detect_fast(test::view(first_, camera_), {60, 60, 260, 180}, 40, scratch,
                               corners_, kCorners, report)));
    count_ = report.found - report.dropped;
  }

  bool prepare(const Corner& corner, double sigma_px) {
    if (!ok(make_appearance(test::view(first_, camera_), corner.x, corner.y, Rigid<float>{},
                            appearance_))) {
      return false;
    }
    const Vector3<double> p_world = kDepth * camera_.unproject({corner.x, corner.y});
    const Vector3<double> p_camera = T_second_.inverse() * p_world;
    EXPECT_TRUE(ok(camera_.project(p_camera, truth_)));
    Matrix2<double> warp;
    EXPECT_TRUE(ok(predict_warp(camera_, Rigid<double>{}, T_second_, p_camera, warp)));
    warp_ = warp.cast<float>();
    prediction_.pixel = truth_.cast<float>();
    prediction_.covariance = static_cast<float>(sigma_px * sigma_px) * Matrix2<float>::Identity();
    prediction_.p_camera = p_camera.cast<float>();
    return true;
  }

  struct Outcome {
    int tried = 0;
    int found = 0;
    int by_descriptor = 0;
    int precise = 0;  ///< within half a pixel of the truth
    double rms_px = 0.0;
  };

  Outcome search_all(double sigma_px, float offset_px) {
    Outcome outcome;
    double sum = 0.0;
    for (int i = 0; i < count_; ++i) {
      if (!prepare(corners_[i], sigma_px)) continue;
      prediction_.pixel +=
          offset_px * Vector2<float>(i % 2 == 0 ? 1.0F : -0.8F, i % 3 == 0 ? -1.0F : 0.5F);
      Vector2<float> pixel;
      SearchReport report;
      ++outcome.tried;
      if (!ok(search_landmark(test::view(second_, camera_), prediction_, appearance_, warp_,
                              parameters_, scratch_, pixel, report))) {
        continue;
      }
      ++outcome.found;
      outcome.by_descriptor += report.by_descriptor ? 1 : 0;
      const double error_squared = (pixel.cast<double>() - truth_).squaredNorm();
      outcome.precise += error_squared < 0.25 ? 1 : 0;
      sum += error_squared;
    }
    outcome.rms_px = outcome.found > 0 ? std::sqrt(sum / outcome.found) : 0.0;
    return outcome;
  }

  static constexpr int kCorners = 64;
  static constexpr SearchMethod kMethods[] = {SearchMethod::kDescriptor, SearchMethod::kPatch};
  PinholeCamera<double> camera_ = test::small_camera();
  PlaneScene scene_{kDepth};
  Rigid<double> T_second_{rotation_exp(Vector3<double>(0.01, -0.02, 0.15)), {0.08, -0.05, 0.25}};
  std::vector<std::uint8_t> first_, second_;
  Corner corners_[kCorners];
  int count_ = 0;
  Appearance appearance_;
  Matrix2<float> warp_;
  Vector2<double> truth_;
  PixelPrediction<float> prediction_;
  SearchParameters parameters_;
  SearchScratch scratch_;
};

TEST_F(ActiveSearch, FindsLandmarksToAFractionOfAPixel) {
  // WHEN the prediction is about a pixel off, and said to be
  const Outcome near = search_all(1.0, 1.0F);
  // THEN nearly all are found.
  ASSERT_GE(near.tried, 20);
  EXPECT_GE(near.found * 10, near.tried * 8);
  EXPECT_LT(near.rms_px, 0.25);
}

TEST_F(ActiveSearch, FindsLandmarksByTheirDescriptorWhenThePredictionIsFarOff) {
  // WHEN the prediction is several pixels off. FAST fires again on about half of the turned
  // corners.
  const Outcome far = search_all(4.0, 4.0F);
  ASSERT_GE(far.tried, 20);
  EXPECT_GE(far.found * 3, far.tried);
  EXPECT_GE(far.by_descriptor, far.found);
  EXPECT_LT(far.rms_px, 0.25);
}

TEST_F(ActiveSearch, FindsMoreLandmarksByTheirPatches) {
  // The plane's rectangles look alike, so that a few are taken for a neighbour in a wide window.
  for (const double sigma_px : {1.0, 4.0}) {
    const auto offset_px = static_cast<float>(sigma_px);
    parameters_.method = SearchMethod::kDescriptor;
    const Outcome by_descriptor = search_all(sigma_px, offset_px);
    parameters_.method = SearchMethod::kPatch;
    const Outcome by_patch = search_all(sigma_px, offset_px);
    ASSERT_GE(by_patch.tried, 20);
    EXPECT_GE(by_patch.found, by_descriptor.found) << sigma_px;
    EXPECT_GE(by_patch.precise * 10, by_patch.tried * 8) << sigma_px;
    EXPECT_GE(by_patch.precise, by_descriptor.precise) << sigma_px;
    EXPECT_EQ(by_patch.by_descriptor, 0);
  }
}

TEST_F(ActiveSearch, FindsNoPatchInNoise) {
  parameters_.method = SearchMethod::kPatch;
  std::vector<std::uint8_t> noise(second_.size());
  Random random(5);
  for (std::uint8_t& value : noise) value = static_cast<std::uint8_t>(random.next() >> 24U);
  int tried = 0;
  for (int i = 0; i < count_; ++i) {
    if (!prepare(corners_[i], 4.0)) continue;
    ++tried;
    const Vector2<float> before(-1.0F, -2.0F);
    Vector2<float> pixel = before;
    SearchReport report;
    EXPECT_EQ(search_landmark(test::view(noise, camera_), prediction_, appearance_, warp_,
                              parameters_, scratch_, pixel, report),
              Status::kNotFound);
    EXPECT_EQ(pixel, before);
  }
  ASSERT_GE(tried, 10);
}

TEST_F(ActiveSearch, FindsNothingInAnotherPlace) {
  const auto other = PlaneScene(kDepth, 0.11, 99).render(camera_, T_second_);
  int tried = 0;
  int found = 0;
  for (int i = 0; i < count_; ++i) {
    if (!prepare(corners_[i], 4.0)) continue;
    Vector2<float> pixel;
    SearchReport report;
    ++tried;
    found += ok(search_landmark(test::view(other, camera_), prediction_, appearance_, warp_,
                                parameters_, scratch_, pixel, report));
  }
  ASSERT_GE(tried, 10);
  EXPECT_LE(found * 10, tried);
}

TEST_F(ActiveSearch, RefusesAnImpossibleCovariance) {
  ASSERT_GT(count_, 0);
  prepare(corners_[0], 4.0);
  prediction_.covariance.setZero();
  for (const SearchMethod method : kMethods) {
    parameters_.method = method;
    Vector2<float> pixel;
    SearchReport report;
    EXPECT_EQ(search_landmark(test::view(second_, camera_), prediction_, appearance_, warp_,
                              parameters_, scratch_, pixel, report),
              Status::kSingular);
  }
}

TEST_F(ActiveSearch, StaysInsideItsBoundsWhereverThePredictionLies) {
  ASSERT_GT(count_, 0);
  ASSERT_TRUE(prepare(corners_[0], 30.0));
  for (int v = -50; v < 300; v += 25) {
    for (int u = -50; u < 380; u += 25) {
      prediction_.pixel = Vector2<float>(static_cast<float>(u), static_cast<float>(v));
      for (const SearchMethod method : kMethods) {
        parameters_.method = method;
        Vector2<float> pixel;
        SearchReport report;
        static_cast<void>(search_landmark(test::view(second_, camera_), prediction_, appearance_,
                                          warp_, parameters_, scratch_, pixel, report));
        EXPECT_LE(report.descriptors, SearchParameters::kMaxCorners);
      }
    }
  }
}

TEST_F(ActiveSearch, FindsWhatHasNoDescriptorByItsPatch) {
  ASSERT_GT(count_, 0);
  ASSERT_TRUE(prepare(corners_[0], 2.0));
  appearance_.has_descriptor = false;
  for (const SearchMethod method : kMethods) {
    parameters_.method = method;
    Vector2<float> pixel;
    SearchReport report;
    ASSERT_TRUE(ok(search_landmark(test::view(second_, camera_), prediction_, appearance_, warp_,
                                   parameters_, scratch_, pixel, report)));
    EXPECT_EQ(report.descriptors, 0);
    EXPECT_LT((pixel - truth_.cast<float>()).norm(), 0.5F);
    EXPECT_LE(report.work, most_search_work(prediction_, appearance_, parameters_));
  }
}

}  // namespace
}  // namespace cairn
