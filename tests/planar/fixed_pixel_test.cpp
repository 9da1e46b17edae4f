#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "fixed_camera_drive.hpp"

namespace cairn {
namespace {

using Drive = planar_test::FixedCameraDrive<20>;

constexpr double kSameMean = 1e-4;        // m, rad
constexpr double kSameCovariance = 1e-4;  // of the deviations

void expect_equal(const Drive& drive) {
  ASSERT_TRUE(drive.good());
  EXPECT_LT(drive.mean_difference(), kSameMean);
  EXPECT_LT(drive.covariance_difference(), kSameCovariance);
}

void drive_in_circles(Drive& drive, int steps) {
  for (int k = 0; k < steps; ++k) {
    drive.move();
    drive.look();
    ASSERT_TRUE(drive.good()) << k;
    if (k % 9 == 8) drive.forget(static_cast<LandmarkId>(1 + k % Drive::kWorld));
    if (k % 50 == 49) expect_equal(drive);
  }
  EXPECT_GT(drive.used(), 4 * steps);
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

TEST(FixedPixels, EqualDouble) {
  Drive drive(1, false);
  drive_in_circles(drive, 300);
}

TEST(FixedPixels, EqualDoubleOnABodyThatTilts) {
  Drive drive(2, true);
  drive_in_circles(drive, 300);
}

/// Whether the landmark has a window.
bool compare_window(Drive& drive, int slot) {
  const int other = drive.reference().find(drive.fixed().landmark_id(slot));
  PixelPrediction<double> expected;
  FixedPixelPrediction fixed;
  const Status status = drive.fixed().predict_pixel(slot, drive.camera(), drive.mount(),
                                                    FixedPixel::nearest(0.5), fixed);
  EXPECT_EQ(status, drive.reference().predict_pixel(other, drive.double_camera(),
                                                    drive.double_mount(), 0.5, expected));
  if (!ok(status)) return false;
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(fixed.pixel[i].to_double(), expected.pixel(i), 0.02);
  const double scale = expected.covariance(0, 0) + expected.covariance(1, 1);
  EXPECT_NEAR(fixed.xx.to_double(), expected.covariance(0, 0), 1e-3 * scale);
  EXPECT_NEAR(fixed.xy.to_double(), expected.covariance(0, 1), 1e-3 * scale);
  EXPECT_NEAR(fixed.yy.to_double(), expected.covariance(1, 1), 1e-3 * scale);
  return true;
}

TEST(FixedPixels, WindowsEqualDouble) {
  Drive drive(3, true);
  int compared = 0;
  for (int k = 0; k < 40; ++k) {
    drive.move();
    ASSERT_TRUE(drive.good());
    for (int slot = 0; slot < drive.fixed().landmark_count(); ++slot) {
      if (compare_window(drive, slot)) ++compared;
    }
    drive.look();
  }
  EXPECT_GT(compared, 100);
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

/// As plan_searches() makes it.
std::vector<PixelPrediction<double>> plan_in_double(Drive& drive) {
  std::vector<PixelPrediction<double>> plan;
  for (int slot = 0; slot < drive.fixed().landmark_count(); ++slot) {
    const int other = drive.reference().find(drive.fixed().landmark_id(slot));
    PixelPrediction<double> prediction;
    if (ok(drive.reference().predict_pixel(other, drive.double_camera(), drive.double_mount(), 0.5,
                                           prediction)) &&
        drive.double_camera().contains(prediction.pixel, 2.0)) {
      prediction.id = drive.fixed().landmark_id(slot);
      plan.push_back(prediction);
    }
  }
  std::stable_sort(plan.begin(), plan.end(), [](const auto& a, const auto& b) {
    return a.covariance.determinant() > b.covariance.determinant();
  });
  return plan;
}

TEST(FixedPixels, PlansTheSearchesOfDouble) {
  for (const bool tilts : {false, true}) {
    Drive drive(9, tilts);
    int planned = 0;
    for (int k = 0; k < 60; ++k) {
      drive.move();
      FixedVector<FixedPlannedPixel, 20> plan;
      ASSERT_EQ(
          drive.fixed().plan_pixels(drive.camera(), drive.mount(), FixedPixel::nearest(0.5), plan),
          Status::kOk);
      const auto expected = plan_in_double(drive);
      ASSERT_EQ(plan.size(), static_cast<int>(expected.size())) << k;
      for (int i = 0; i < plan.size(); ++i) {
        const FixedPixelPrediction& window = plan[i].prediction;
        const PixelPrediction<double>& of_double = expected[static_cast<std::size_t>(i)];
        ASSERT_EQ(window.id, of_double.id) << k;
        EXPECT_EQ(drive.fixed().landmark_id(window.slot), window.id);
        for (int a = 0; a < 2; ++a) {
          EXPECT_NEAR(window.pixel[a].to_double(), of_double.pixel(a), 0.02);
        }
        for (int a = 0; a < 3; ++a) {
          EXPECT_NEAR(window.p_camera[a].to_double(), of_double.p_camera(a), 1e-4);
        }
        const double determinant = of_double.covariance.determinant();
        EXPECT_NEAR(plan[i].priority.to_double(), determinant, 2e-3 * determinant + 1e-3);
      }
      planned += plan.size();
      drive.look();
    }
    EXPECT_GT(planned, 200);
    EXPECT_EQ(drive.fixed().saturations(), 0U);
  }
}

TEST(FixedPixels, HeightsEqualDouble) {
  Drive drive(4, true);
  for (int k = 0; k < 20; ++k) {
    drive.move();
    drive.look();
    const LandmarkId id = drive.fixed().landmark_id(0);
    const auto height = FixedLength::nearest(0.3);
    const auto sigma = FixedLength::nearest(0.02);
    const Status status = drive.fixed().update_height(id, height, sigma, FixedScore::nearest(6.63));
    ASSERT_EQ(status,
              drive.reference().update_height(id, height.to_double(), sigma.to_double(), 6.63));
  }
  expect_equal(drive);
}

/// Level: PlanarSlam::update() knows the tilt's part of an innovation in update_pixels() alone.
TEST(FixedPixels, RestsWhereDoubleRests) {
  Drive drive(5, false, 4.0);
  for (int k = 0; k < 120; ++k) {
    const bool rests = k % 40 > 20;
    drive.move(rests ? 0.0 : 0.1, rests ? 0.0 : 0.02);
    drive.look();
    ASSERT_TRUE(drive.good()) << k;
  }
}

TEST(FixedPixels, RefusesWhatItCannotUseAndStaysAsItWas) {
  Drive drive(6, true);
  for (int k = 0; k < 5; ++k) {
    drive.move();
    drive.look();
  }
  auto& filter = drive.fixed();
  const auto hash_of = [&filter] {
    Hash64 hash;
    filter.hash(hash);
    return hash.value();
  };
  const std::uint64_t before = hash_of();
  FixedUpdateReport report;
  FixedPixelMatch match;
  const FixedPixel sigma = FixedPixel::nearest(0.5);
  FixedCamera broken = drive.camera();
  broken.fy = FixedPixel();
  EXPECT_EQ(filter.update_pixels(broken, drive.mount(), sigma, &match, 1, report),
            Status::kBadConfig);
  EXPECT_EQ(filter.update_pixels(drive.camera(), drive.mount(), {}, &match, 1, report),
            Status::kInvalidArgument);
  EXPECT_EQ(filter.update_pixels(drive.camera(), drive.mount(), sigma, nullptr, 1, report),
            Status::kInvalidArgument);
  EXPECT_EQ(filter.update_pixels(drive.camera(), drive.mount(), sigma, &match, 1000, report),
            Status::kInvalidArgument);
  FixedMount bent = drive.mount();
  bent.w = FixedRatio::most();
  EXPECT_EQ(filter.update_pixels(drive.camera(), bent, sigma, &match, 1, report),
            Status::kInvalidArgument);
  FixedPixelPrediction prediction;
  EXPECT_EQ(filter.predict_pixel(99, drive.camera(), drive.mount(), sigma, prediction),
            Status::kNotFound);
  FixedVector<FixedPlannedPixel, 20> plan;
  EXPECT_EQ(filter.plan_pixels(broken, drive.mount(), sigma, plan), Status::kBadConfig);
  EXPECT_EQ(filter.plan_pixels(drive.camera(), bent, sigma, plan), Status::kInvalidArgument);
  EXPECT_EQ(filter.update_height(99, {}, FixedLength::nearest(0.1), FixedScore::nearest(6.63)),
            Status::kNotFound);
  EXPECT_EQ(filter.update_height(1, {}, {}, FixedScore::nearest(6.63)), Status::kInvalidArgument);
  EXPECT_EQ(filter.predict_tilt(FixedOffset::from_raw(-1)), Status::kInvalidArgument);
  const FixedLength y[3] = {};
  EXPECT_EQ(filter.add_landmark(77, y, {}), Status::kInvalidArgument);
  EXPECT_EQ(filter.add_landmark(77, {}, {}, {}), Status::kInvalidArgument);
  EXPECT_EQ(hash_of(), before);
}

}  // namespace
}  // namespace cairn
