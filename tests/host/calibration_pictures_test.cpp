#include "host_sim/calibration/calibration_pictures.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/calibration/calibration.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

TEST(Calibration, ChoosesBoardsThatDiffer) {
  std::vector<BoardView> views;
  const auto add = [&](float x, float y, float size) {
    BoardView view;
    for (int i = 0; i < 4; ++i) {
      const bool right = i % 2 == 1, low = i >= 2;
      const float column = right ? 1.0F : 0.0F, row = low ? 1.0F : 0.0F;
      view.points.emplace_back(column, row, 0.0F);
      view.pixels.emplace_back(x + size * column, y + size * row);
    }
    views.push_back(view);
  };
  for (int i = 0; i < 20; ++i) add(300.0F + static_cast<float>(i), 200.0F, 60.0F);
  add(10.0F, 10.0F, 60.0F);
  add(550.0F, 400.0F, 60.0F);
  add(200.0F, 100.0F, 300.0F);
  const std::vector<std::size_t> chosen = choose_views(views, {640, 480}, 4);
  ASSERT_EQ(chosen.size(), 4U);
  EXPECT_LT(chosen[0], 20U);
  EXPECT_EQ(chosen[1], 20U);
  EXPECT_EQ(chosen[2], 21U);
  EXPECT_EQ(chosen[3], 22U);
  EXPECT_EQ(choose_views(views, {640, 480}, 100).size(), views.size());
}

TEST(Calibration, PicturesMayHaveAnyNamesButOneSize) {
  const TemporaryFolder folder;
  const cv::Mat grey(48, 64, CV_8UC1, cv::Scalar(9));
  cv::imwrite((folder.path() / "IMG_20240131_235958.png").string(), grey);
  cv::imwrite((folder.path() / "b.png").string(), grey);
  int count = 0;
  const auto take = [&](const std::string&, const cv::Mat&, int) { ++count; };
  take_calibration_pictures(folder.path(), 100, take);
  EXPECT_EQ(count, 2);
  cv::imwrite((folder.path() / "c.png").string(), cv::Mat(grey.t()));
  EXPECT_TRUE(says(message_of([&] { take_calibration_pictures(folder.path(), 100, take); }),
                   {"c.png", "64x48", "48x64"}));
}

}  // namespace
}  // namespace cairn::host
