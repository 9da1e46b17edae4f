#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/calibration/calibration_file.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/trackers/window_adapter.hpp"
#include "input_messages.hpp"
#include "video_options.hpp"

namespace cairn::host {
namespace {

std::string with_sigma(const std::string& sigma) {
  return std::string(kVideoCamera) + "focal_sigma: " + sigma + "\n";
}

TEST(FocalSigma, OfACameraFileReachesTheTracker) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 2);
  const HandheldOptions asked;
  const auto told = [&] {
    return window_focal_sigma_e4(asked, make_video_source(options)->info());
  };
  const std::uint16_t own = told();
  EXPECT_EQ(own, 1000U);
  options.camera = folder.write("known.yaml", with_sigma("0.0052"));
  EXPECT_EQ(told(), 52U);
  options.camera.clear();
  options.hfov_deg = 60.0;
  EXPECT_EQ(told(), 2000U);
}

TEST(FocalSigma, OfTheCommandLineGoesBeforeTheFiles) {
  const TemporaryFolder folder;
  VideoOptions options = pictures(folder, 2);
  options.camera = folder.write("known.yaml", with_sigma("0.0052"));
  HandheldOptions asked;
  asked.focal_sigma = 0.0;
  EXPECT_EQ(window_focal_sigma_e4(asked, make_video_source(options)->info()), 0U);
}

TEST(FocalSigma, IsReadInTheDataSetsThatTakeACameraFile) {
  const TemporaryFolder folder;
  const auto camera = folder.write("known.yaml", with_sigma("0.01"));
  const cv::Mat picture(240, 320, CV_8UC1, cv::Scalar(50));
  folder.write("tum/groundtruth.txt", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  folder.write("tum/rgb.txt", "0.1 rgb/0.png\n0.2 rgb/1.png\n");
  std::string list;
  for (const int i : {0, 1}) {
    for (const char* where : {"tum/rgb", "mav0/cam0/data"}) {
      std::filesystem::create_directories(folder.path() / where);
      cv::imwrite((folder.path() / where / (std::to_string(i) + ".png")).string(), picture);
    }
    list += std::to_string(100000000 * (i + 1)) + "," + std::to_string(i) + ".png\n";
  }
  folder.write("mav0/cam0/data.csv", list);
  const auto tum =
      make_tum_rgbd_source(folder.path() / "tum", camera, {}, LensCheck::kWholePicture);
  EXPECT_EQ(tum->info().focal_sigma, 0.01);
  const auto euroc = make_euroc_source(folder.path(), camera, {}, LensCheck::kWholePicture);
  EXPECT_EQ(euroc->info().focal_sigma, 0.01);
}

TEST(FocalSigma, OutsideItsDomainIsRefused) {
  const TemporaryFolder folder;
  for (const char* sigma : {"0.51", "-0.01", "5 %"}) {
    EXPECT_TRUE(
        says(message_of([&] { read_camera_file(folder.write("c.yaml", with_sigma(sigma))); }),
             {"c.yaml", "'focal_sigma'", sigma}));
  }
}

TEST(FocalSigma, OfACalibrationIsNeverLessThanWhatItsCornersDoNotShow) {
  const TemporaryFolder folder;
  Calibration calibration;
  calibration.size = {320, 240};
  calibration.fx = calibration.fy = 250.0;
  calibration.cx = 160.0;
  calibration.cy = 120.0;
  calibration.coefficients = {0.0, 0.0, 0.0, 0.0, 0.0};
  const auto written = [&] {
    return read_camera_file(folder.write("c.yaml", camera_file_text(calibration, {}, "how")))
        .focal_sigma;
  };
  EXPECT_FALSE(written().has_value());
  calibration.focal_sigma = 0.0003;
  EXPECT_NEAR(written().value(), 0.005, 1e-4);
  calibration.focal_sigma = 0.02;
  EXPECT_NEAR(written().value(), 0.0206, 1e-4);
}

}  // namespace
}  // namespace cairn::host
