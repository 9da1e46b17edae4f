#include "cairn/tracking/feature_supply.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

/// GIVEN an image of 320x240: cells of 40x40 on a grey ground, with the bright dots that a test
/// puts there.
class SupplyOfFeatures : public ::testing::Test {
 protected:
  using Supply = FeatureSupply<320>;
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  static constexpr int kCell = 40;

  SupplyOfFeatures() : pixels_(kWidth * kHeight, 60) {
    parameters_.min_margin_px = 8;
    parameters_.margin_share = 0.0F;
    parameters_.min_distance_share = 14.5F / kHeight;
    parameters_.few_points = 0;
    supply_.begin(kWidth, kHeight);
  }
  /// Brightest in its middle: one corner, not several as good as each other.
  void put_dot(int x, int y) {
    for (int row = y - 1; row <= y + 1; ++row) {
      std::fill_n(pixels_.begin() + row * kWidth + x - 1, 3, std::uint8_t{150});
    }
    pixels_[static_cast<std::size_t>(y * kWidth + x)] = 220;
  }
  void put_dot_in_every_cell() {
    for (int y = kCell / 2; y < kHeight; y += kCell) {
      for (int x = kCell / 2; x < kWidth; x += kCell) put_dot(x, y);
    }
  }
  std::vector<Corner> find(int wanted, WorkBudget& budget) {
    Corner corners[Supply::kCells];
    report_ = Supply::Report();
    const ImageView image{pixels_.data(), kWidth, kHeight, kWidth};
    const int found = supply_.find(image, parameters_, wanted, *scratch_, corners, report_, budget);
    return {corners, corners + found};
  }
  std::vector<Corner> find(int wanted) {
    WorkBudget unlimited;
    return find(wanted, unlimited);
  }
  static int cell_of(const Corner& corner) {
    return corner.y / kCell * Supply::kColumns + corner.x / kCell;
  }

  std::vector<std::uint8_t> pixels_;
  Supply supply_;
  Supply::Parameters parameters_;
  Supply::Report report_;
  std::unique_ptr<Supply::Scratch> scratch_ = std::make_unique<Supply::Scratch>();
};

TEST_F(SupplyOfFeatures, TakesOneCornerOfACell) {
  put_dot_in_every_cell();
  const std::vector<Corner> corners = find(8);
  ASSERT_EQ(corners.size(), 8U);
  std::set<int> cells;
  for (const Corner& corner : corners) cells.insert(cell_of(corner));
  EXPECT_EQ(cells.size(), 8U);
}

/// Wherever the only dot is, a round of four frames finds it, and once.
TEST_F(SupplyOfFeatures, GoesThroughAllCellsInFourFrames) {
  for (int y = kCell / 2; y < kHeight; y += kCell) {
    for (int x = kCell / 2; x < kWidth; x += kCell) {
      std::fill(pixels_.begin(), pixels_.end(), std::uint8_t{60});
      put_dot(x, y);
      int found = 0;
      for (int frame = 0; frame < 4; ++frame) {
        supply_.begin(kWidth, kHeight);
        for (const Corner& corner : find(6)) {
          EXPECT_EQ(corner.x, x);
          EXPECT_EQ(corner.y, y);
          ++found;
        }
        EXPECT_EQ(report_.cells_searched, parameters_.cells_per_frame);
      }
      EXPECT_EQ(found, 1) << x << ' ' << y;
    }
  }
}

TEST_F(SupplyOfFeatures, LeavesCellsThatHaveALandmark) {
  put_dot_in_every_cell();
  for (int y = kCell / 2; y < kHeight; y += kCell) {
    for (int x = kCell / 2; x < kWidth; x += kCell) {
      if (x != 100 || y != 140) {
        supply_.occupy(static_cast<float>(x), static_cast<float>(y));
      }
    }
  }
  const std::vector<Corner> corners = find(8);
  ASSERT_EQ(corners.size(), 1U);
  EXPECT_EQ(cell_of(corners[0]), 3 * Supply::kColumns + 2);
  EXPECT_EQ(report_.cells_searched, 1);
}

TEST_F(SupplyOfFeatures, KeepsItsDistanceAcrossCells) {
  put_dot(84, 100);               // its corners at 80 to 88, in the cell from 80 on
  supply_.occupy(78.0F, 100.0F);  // in the cell before it
  for (int frame = 0; frame < 4; ++frame) EXPECT_TRUE(find(8).empty());
  supply_.begin(kWidth, kHeight);
  supply_.occupy(60.0F, 100.0F);
  int found = 0;
  for (int frame = 0; frame < 4; ++frame) found += static_cast<int>(find(8).size());
  EXPECT_EQ(found, 1);
}

TEST_F(SupplyOfFeatures, KeepsOutOfTheMargin) {
  put_dot_in_every_cell();
  parameters_.min_margin_px = 48;
  parameters_.cells_per_frame = Supply::kCells;
  const std::vector<Corner> corners = find(Supply::kCells);
  EXPECT_FALSE(corners.empty());
  for (const Corner& corner : corners) {
    EXPECT_GE(corner.x, 48);
    EXPECT_GE(corner.y, 48);
    EXPECT_LT(corner.x, kWidth - 48);
    EXPECT_LT(corner.y, kHeight - 48);
  }
}

TEST_F(SupplyOfFeatures, EndsWhereTheWorkDoes) {
  put_dot_in_every_cell();
  WorkBudget enough_for_one(supply_.cell_work());
  EXPECT_EQ(find(8, enough_for_one).size(), 1U);
  EXPECT_GE(enough_for_one.left(), 0);
  WorkBudget none(supply_.cell_work() - 1);
  EXPECT_TRUE(find(8, none).empty());
  EXPECT_EQ(none.spent(), 0);
}

TEST_F(SupplyOfFeatures, KeepsAMarginThatGrowsWithThePicture) {
  put_dot_in_every_cell();
  parameters_.margin_share = 0.2F;
  parameters_.cells_per_frame = Supply::kCells;
  const std::vector<Corner> corners = find(Supply::kCells);
  EXPECT_FALSE(corners.empty());
  for (const Corner& corner : corners) {
    EXPECT_GE(corner.y, kHeight / 5);
    EXPECT_LT(corner.y, kHeight - kHeight / 5);
  }
}

/// Dots of a tenth of the contrast: dim to the nominal threshold.
TEST_F(SupplyOfFeatures, LowersTheThresholdWhereThereAreFewCorners) {
  put_dot_in_every_cell();
  for (std::uint8_t& pixel : pixels_) pixel = static_cast<std::uint8_t>(60 + (pixel - 60) / 10);
  parameters_.few_points = 12;
  EXPECT_TRUE(find(8).empty());
  for (int frame = 0; frame < 8; ++frame) {
    supply_.begin(kWidth, kHeight);
    static_cast<void>(find(8));
  }
  supply_.begin(kWidth, kHeight);
  EXPECT_EQ(find(8).size(), 8U);
  EXPECT_GE(supply_.threshold(), parameters_.lowest_threshold);
}

TEST_F(SupplyOfFeatures, RaisesTheThresholdToItsNominalValueAgain) {
  parameters_.few_points = 12;
  for (int frame = 0; frame < 8; ++frame) static_cast<void>(find(8));
  EXPECT_EQ(supply_.threshold(), parameters_.lowest_threshold);
  put_dot_in_every_cell();
  for (int frame = 0; frame < 16; ++frame) {
    supply_.begin(kWidth, kHeight);
    EXPECT_EQ(find(8).size(), 8U);
  }
  EXPECT_EQ(supply_.threshold(), parameters_.fast_threshold);
}

/// A plain wall in a picture with enough landmarks says nothing about the light.
TEST_F(SupplyOfFeatures, KeepsTheThresholdWhileEnoughLandmarksAreInView) {
  parameters_.few_points = 12;
  for (int k = 0; k < 12; ++k) supply_.occupy(10.0F + 20.0F * static_cast<float>(k), 20.0F);
  for (int frame = 0; frame < 8; ++frame) EXPECT_TRUE(find(8).empty());
  EXPECT_EQ(supply_.threshold(), parameters_.fast_threshold);
}

TEST_F(SupplyOfFeatures, IgnoresPlacesOutsideTheImage) {
  put_dot_in_every_cell();
  supply_.occupy(-3.0F, 20.0F);
  supply_.occupy(20.0F, 400.0F);
  supply_.occupy(330.0F, 20.0F);
  EXPECT_EQ(find(8).size(), 8U);
}

TEST_F(SupplyOfFeatures, ProposesNothingInCellsThatAreLeftBehind) {
  put_dot_in_every_cell();
  supply_.close_cells([](const Vector2<float>& middle) { return middle.x() >= 100.0F; });
  std::set<int> columns;
  parameters_.cells_per_frame = Supply::kCells;
  for (const Corner& corner : find(Supply::kCells)) columns.insert(corner.x / kCell);
  EXPECT_EQ(columns, (std::set<int>{0, 1})) << "the middles of the third column lie at 100";
}

/// A descriptor's 29 px would leave a small picture nothing.
TEST_F(SupplyOfFeatures, TakesNoMoreOfASmallPictureForTheMarginThanItsShare) {
  put_dot_in_every_cell();
  parameters_.cells_per_frame = Supply::kCells;
  parameters_.min_margin_px = 29;
  EXPECT_EQ(find(Supply::kCells).size(), 24U) << "the outer cells' dots lie 20 px from the border";
  parameters_.most_margin_share = 19.5F / kHeight;
  supply_.begin(kWidth, kHeight);
  EXPECT_EQ(find(Supply::kCells).size(), 48U);
}

}  // namespace
}  // namespace cairn
