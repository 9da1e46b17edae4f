#include "host_sim/calibration/calibration.hpp"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "host_sim/calibration/calibration_file.hpp"
#include "host_sim/calibration/calibration_pictures.hpp"
#include "host_sim/io/camera_file.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

constexpr int kSquare_px = 30;
const cv::Size kSize(480, 360);

PinholeCamera<double> lens(double f) {
  PinholeCamera<double> c;
  c.width = kSize.width;
  c.height = kSize.height;
  c.fx = f;
  c.fy = 1.01 * f;
  c.cx = 243.5;
  c.cy = 177.0;
  return c;
}

PinholeCamera<double> radtan() {
  PinholeCamera<double> c = lens(375.0);
  c.k1 = -0.25;
  c.k2 = 0.08;
  c.p1 = 5e-4;
  c.p2 = -8e-4;
  return c;
}

PinholeCamera<double> fisheye() {
  PinholeCamera<double> c = lens(247.5);
  c.lens = Lens::kFisheye;
  c.k1 = -0.02;
  c.k2 = 0.01;
  c.k3 = -0.004;
  return c;
}

/// A picture of the board at `translation` (squares, the board's middle) turned by `rotation`.
cv::Mat photograph(const PinholeCamera<double>& camera, const BoardDetector& board,
                   const Vector3<double>& rotation, const Vector3<double>& translation) {
  const cv::Mat print = board.picture(kSquare_px);
  const Matrix3<double> R = rotation_exp(rotation).toRotationMatrix();
  cv::Mat x(camera.height, camera.width, CV_32F), y(camera.height, camera.width, CV_32F);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vector3<double> ray = camera.unproject({u, v});
      const Vector3<double> normal = R.col(2);
      const double depth = normal.dot(translation) / normal.dot(ray);
      const Vector3<double> on_board = R.transpose() * (depth * ray - translation);
      const bool hit = depth > 0.0;
      x.at<float>(v, u) =
          hit ? static_cast<float>(on_board.x() * kSquare_px + 0.5 * print.cols) : -9e3F;
      y.at<float>(v, u) =
          hit ? static_cast<float>(on_board.y() * kSquare_px + 0.5 * print.rows) : -9e3F;
    }
  }
  cv::Mat picture;
  cv::remap(print, picture, x, y, cv::INTER_AREA, cv::BORDER_CONSTANT, 120);
  cv::GaussianBlur(picture, picture, {3, 3}, 0.7);
  return picture;
}

struct Sight {
  Vector3<double> rotation, translation;
};

/// Boards all over the picture of a lens, tilted every way.
std::vector<Sight> sights(double distance, double spread) {
  std::vector<Sight> all;
  int i = 0;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      const double tilt = 0.5;
      const double turn = 0.7 * i++;
      all.push_back({{tilt * std::cos(turn), tilt * std::sin(turn), 0.1 * x},
                     {spread * x, 0.75 * spread * y, distance + 0.5 * std::cos(2.0 * turn)}});
    }
  }
  for (const double turn : {0.0, 1.6, 3.1, 4.7}) {
    all.push_back({{0.6 * std::cos(turn), 0.6 * std::sin(turn), 0.0}, {0.0, 0.0, 0.75 * distance}});
  }
  return all;
}

std::vector<BoardView> photographs(const PinholeCamera<double>& camera, const BoardDetector& board,
                                   double distance, double spread) {
  std::vector<BoardView> views;
  for (const Sight& sight : sights(distance, spread)) {
    BoardView view;
    view.name = "picture " + std::to_string(views.size());
    if (board.find(photograph(camera, board, sight.rotation, sight.translation), view)) {
      views.push_back(view);
    }
  }
  return views;
}

BoardOptions chessboard() {
  BoardOptions options;
  options.squares = {8, 6};
  return options;
}

/// Rendered once.
const std::vector<BoardView>& chessboards_of_radtan() {
  static const std::vector<BoardView> views =
      photographs(radtan(), BoardDetector(chessboard()), 12.5, 3.3);
  return views;
}

BoardOptions charuco() {
  BoardOptions options;
  options.charuco = true;
  options.squares = {8, 6};
  options.dictionary = "4X4_50";
  return options;
}

TEST(Calibration, TheCoresLensesAreOpenCvs) {
  PinholeCamera<double> rational = lens(300.0);
  rational.k1 = 0.52;
  rational.k2 = -2.69;
  rational.p1 = 6e-4;
  rational.p2 = -2e-4;
  rational.k3 = 1.53;
  rational.k4 = 0.40;
  rational.k5 = -2.51;
  rational.k6 = 1.46;
  const std::vector<cv::Point3d> points = {{0.3, -0.2, 1.0}, {-1.0, 0.7, 2.0}, {0.01, 0.0, 1.0}};
  for (const PinholeCamera<double>& c : {radtan(), rational, fisheye()}) {
    const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
    const cv::Vec3d none(0, 0, 0);
    std::vector<cv::Point2d> expected;
    if (c.lens == Lens::kFisheye) {
      cv::fisheye::projectPoints(points, expected, none, none, K,
                                 cv::Vec4d(c.k1, c.k2, c.k3, c.k4));
    } else {
      const std::vector<double> d = {c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.k5, c.k6};
      cv::projectPoints(points, none, none, K, d, expected);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vector2<double> pixel;
      ASSERT_TRUE(ok(c.project({points[i].x, points[i].y, points[i].z}, pixel)));
      EXPECT_NEAR(pixel.x(), expected[i].x, 1e-9);
      EXPECT_NEAR(pixel.y(), expected[i].y, 1e-9);
    }
  }
}

TEST(Calibration, FindsACameraByChessboards) {
  const PinholeCamera<double> camera = radtan();
  const std::vector<BoardView>& views = chessboards_of_radtan();
  ASSERT_GE(views.size(), 12U);
  const Calibration found = calibrate("test", views, kSize, CalibratedModel::kRadialTangential);
  EXPECT_NEAR(found.fx, camera.fx, 0.005 * camera.fx);
  EXPECT_NEAR(found.fy, camera.fy, 0.005 * camera.fy);
  EXPECT_NEAR(found.cx, camera.cx, 1.0);
  EXPECT_NEAR(found.cy, camera.cy, 1.0);
  EXPECT_NEAR(found.coefficients[0], camera.k1, 0.01);
  EXPECT_EQ(found.coefficients.size(), 5U);
  EXPECT_LT(found.rms_px, 0.15);
  ASSERT_TRUE(found.focal_sigma.has_value());
  EXPECT_LT(*found.focal_sigma, 0.002);
  const Coverage coverage = coverage_of(views, kSize);
  EXPECT_GT(coverage.share(), 0.5);
  EXPECT_TRUE(doubts_about(found, coverage).empty());
}

/// WHEN the pictures do not tell numerator and denominator of a rational lens apart, THEN the
/// denominator is left out: the two would cancel each other with any coefficients.
TEST(Calibration, ARationalLensHasNoCoefficientsThatThePicturesDoNotTell) {
  const PinholeCamera<double> camera = radtan();
  const Calibration found =
      calibrate("test", chessboards_of_radtan(), kSize, CalibratedModel::kRational);
  ASSERT_EQ(found.coefficients.size(), 8U);
  EXPECT_NEAR(found.coefficients[0], camera.k1, 0.01);
  EXPECT_NEAR(found.coefficients[1], camera.k2, 0.05);
  for (int i = 5; i < 8; ++i) EXPECT_EQ(found.coefficients[static_cast<std::size_t>(i)], 0.0);
  EXPECT_LT(found.rms_px, 0.15);
  EXPECT_NEAR(found.fx, camera.fx, 0.005 * camera.fx);
}

TEST(Calibration, FindsACameraByBoardsSeenInPart) {
  const PinholeCamera<double> camera = radtan();
  const BoardDetector board(charuco());
  const std::vector<BoardView> views = photographs(camera, board, 9.0, 4.0);
  ASSERT_GE(views.size(), 8U);
  bool in_part = false;
  for (const BoardView& view : views) {
    in_part = in_part || view.pixels.size() < static_cast<std::size_t>(board.corner_count());
  }
  EXPECT_TRUE(in_part);
  const Calibration found = calibrate("test", views, kSize, CalibratedModel::kRadialTangential);
  EXPECT_NEAR(found.fx, camera.fx, 2.5);
  EXPECT_NEAR(found.cx, camera.cx, 2.5);
  EXPECT_LT(found.rms_px, 0.3);
}

TEST(Calibration, FindsAFisheyeAndWritesAFileThatIsRead) {
  const TemporaryFolder folder;
  const PinholeCamera<double> camera = fisheye();
  const BoardDetector board(chessboard());
  const std::vector<BoardView> views = photographs(camera, board, 9.0, 4.0);
  ASSERT_GE(views.size(), 10U);
  const Calibration found = calibrate("test", views, kSize, CalibratedModel::kFisheye);
  EXPECT_NEAR(found.fx, camera.fx, 2.0);
  EXPECT_NEAR(found.fy, camera.fy, 2.0);
  EXPECT_NEAR(found.coefficients[0], camera.k1, 0.02);
  EXPECT_LT(found.rms_px, 0.2);
  const std::string text = camera_file_text(found, coverage_of(views, kSize), "how");
  const CameraFile file = read_camera_file(folder.write("camera.yaml", text));
  EXPECT_EQ(file.camera.lens, Lens::kFisheye);
  EXPECT_NEAR(file.camera.fx, found.fx, 1e-5);
  EXPECT_NEAR(file.camera.k4, found.coefficients[3], 1e-8);
  EXPECT_EQ(file.camera.width, kSize.width);
}

TEST(Calibration, ABoardThatDoesNotFitIsNamedAndLeftOut) {
  std::vector<BoardView> views = chessboards_of_radtan();
  const Calibration before = calibrate("test", views, kSize, CalibratedModel::kRadialTangential);
  for (cv::Point2f& p : views[4].pixels)
    p.x += 0.03F * (p.y - 180.0F) * (p.y - 180.0F) / 100.0F + 0.02F * p.y;
  views[4].pixels[3] += cv::Point2f(9.0F, -7.0F);
  const Calibration found = calibrate("test", views, kSize, CalibratedModel::kRadialTangential);
  EXPECT_FALSE(found.views[4].used);
  EXPECT_EQ(found.views[4].name, views[4].name);
  EXPECT_GT(found.views[4].rms_px, 0.5);
  EXPECT_TRUE(found.views[3].used);
  EXPECT_NEAR(found.fx, before.fx, 1.0);
}

/// What pictures that were undistorted badly leave: a lens that folds back at 0.97 of the focal
/// length, in front of the corners of the picture, and boards that reach to 0.6 of it.
TEST(Calibration, BoardsInTheMiddleMakeNoLensThatFoldsAtTheBorder) {
  PinholeCamera<double> camera = lens(250.0);
  camera.k1 = -0.05;
  camera.k2 = 0.15;
  camera.k3 = -0.2;
  ASSERT_FALSE(ok(camera.validate()));
  std::vector<BoardView> views;
  for (int i = 0; i < 14; ++i) {
    const Matrix3<double> R =
        rotation_exp(Vector3<double>(0.5 * std::cos(0.7 * i), 0.5 * std::sin(0.7 * i), 0.1))
            .toRotationMatrix();
    const Vector3<double> t(1.2 * std::cos(1.3 * i), 0.8 * std::sin(1.7 * i),
                            8.0 + 2.0 * std::cos(1.4 * i));
    BoardView view;
    for (int k = 0; k < 35; ++k) {
      const Vector3<double> point(k % 7 - 3, k % 5 - 2, 0.0);
      const Vector3<double> seen = R * point + t;
      if (std::hypot(seen.x(), seen.y()) > 0.6 * seen.z()) continue;
      const double r2 = seen.head<2>().squaredNorm() / (seen.z() * seen.z());
      const double d = 1.0 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3));
      view.points.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()), 0.0F);
      view.pixels.emplace_back(static_cast<float>(camera.cx + camera.fx * d * seen.x() / seen.z()),
                               static_cast<float>(camera.cy + camera.fy * d * seen.y() / seen.z()));
    }
    views.push_back(view);
  }
  const Calibration found = calibrate("test", views, kSize, CalibratedModel::kRadialTangential);
  EXPECT_TRUE(ok(camera_of(found).validate()));
  EXPECT_EQ(found.coefficients[4], 0.0);
  EXPECT_NEAR(found.fx, camera.fx, 0.005 * camera.fx);
  EXPECT_LT(found.rms_px, 0.1);
}

TEST(Calibration, SaysWhatIsWrong) {
  const PinholeCamera<double> camera = radtan();
  const BoardDetector board(chessboard());
  // The same place and no tilt: the focal length is not to be told from the distance.
  std::vector<BoardView> views;
  for (const double x : {-0.5, -0.2, 0.0, 0.2, 0.5}) {
    BoardView view;
    ASSERT_TRUE(board.find(photograph(camera, board, {0.01, 0.0, 0.0}, {x, 0.0, 16.0}), view));
    views.push_back(view);
  }
  const Calibration found = calibrate("test", views, kSize, CalibratedModel::kRadialTangential);
  std::string all;
  for (const std::string& doubt : doubts_about(found, coverage_of(views, kSize))) all += doubt;
  EXPECT_TRUE(says(all, {"5 boards are few", "cover", "tilt the board"}));
  views.resize(3);
  EXPECT_TRUE(says(
      message_of([&] { calibrate("video.mp4", views, kSize, CalibratedModel::kRadialTangential); }),
      {"video.mp4", "4 or more boards", "found 3"}));
}

TEST(Calibration, TakesTheSharpestFrameOfASlot) {
  const TemporaryFolder folder;
  const BoardDetector board(chessboard());
  const cv::Mat sharp = photograph(radtan(), board, {0.2, 0.1, 0.0}, {0.0, 0.0, 14.0});
  cv::Mat blurred, colour;
  cv::GaussianBlur(sharp, blurred, {15, 15}, 5.0);
  const std::filesystem::path path = folder.path() / "board.avi";
  cv::VideoWriter writer(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0,
                         sharp.size());
  if (!writer.isOpened()) GTEST_SKIP() << "OpenCV has no encoder for Motion JPEG";
  for (int i = 0; i < 10; ++i) {
    cv::cvtColor(i == 3 || i == 7 ? sharp : blurred, colour, cv::COLOR_GRAY2BGR);
    writer.write(colour);
  }
  writer.release();
  std::vector<std::string> names;
  take_calibration_pictures(path, 100, [&](const std::string& name, const cv::Mat& grey, int) {
    names.push_back(name);
    EXPECT_EQ(grey.size(), sharp.size());
  });
  EXPECT_EQ(names, (std::vector<std::string>{"frame 3", "frame 7"}));
}

TEST(Calibration, BoardsThatCannotBeAreRefused) {
  BoardOptions options = charuco();
  options.squares = {12, 12};
  EXPECT_THROW(BoardDetector{options}, UsageError);  // 72 markers of 50
  options = charuco();
  options.marker_ratio = 1.0;
  EXPECT_THROW(BoardDetector{options}, UsageError);
  options = chessboard();
  options.squares = {2, 6};
  EXPECT_THROW(BoardDetector{options}, UsageError);
}

}  // namespace
}  // namespace cairn::host
