#include "host_sim/io/camera_file.hpp"

#include <gtest/gtest.h>

#include "camera_texts.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

std::string replaced(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.replace(at, part.size(), by);
}

std::string problem_of(const TemporaryFolder& folder, const std::string& text,
                       const std::string& name = "cam.yaml") {
  return message_of([&] { read_camera_file(folder.write(name, text)); });
}

TEST(CameraFile, ReadsEveryFormatAndEveryCoefficient) {
  const TemporaryFolder folder;
  for (const char* text : {kOpenCv, kOpenCvXml, kOpenCvJson, kPython, kRos, kRosTopic, kKalibr,
                           kEuroc, kOrbSlam2, kOrbSlam3, kVins, kBasalt, kColmap}) {
    PinholeCamera<double> c;
    ASSERT_NO_THROW(c = read_camera_file(folder.write("c.yaml", text)).camera) << text;
    EXPECT_EQ(c.fx, 510.0) << text;
    EXPECT_EQ(c.fy, 520.0) << text;
    EXPECT_EQ(c.cx, 320.0) << text;
    EXPECT_EQ(c.cy, 240.0) << text;
    EXPECT_EQ(c.k1, 0.1) << text;
    EXPECT_EQ(c.k2, -0.2) << text;
    EXPECT_EQ(c.p1, 0.001) << text;
    EXPECT_EQ(c.p2, -0.002) << text;
    EXPECT_EQ(c.k3, 0.0) << text;
    EXPECT_EQ(c.width, 640) << text;
    EXPECT_EQ(c.height, 480) << text;
  }
}

TEST(CameraFile, ReadsOpenVslamAndItsSuccessor) {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& text) {
    PinholeCamera<double> c;
    ASSERT_NO_THROW(c = read_camera_file(folder.write("c.yaml", text)).camera) << text;
    EXPECT_EQ(c.fx, 510.0) << text;
    EXPECT_EQ(c.k2, -0.2) << text;
    EXPECT_EQ(c.width, 640) << text;
    EXPECT_EQ(c.height, 480) << text;
  };
  const std::string sizes = replaced(replaced(kOrbSlam2, "Camera.width: 640", "Camera.cols: 640"),
                                     "Camera.height", "Camera.rows");
  check(sizes + "Camera.model: \"perspective\"\nCamera.setup: \"monocular\"\n");
  check(
      "Camera:\n  name: TUM\n  setup: monocular\n  model: perspective\n  fx: 510\n  fy: 520\n"
      "  cx: 320\n  cy: 240\n  k1: 0.1\n  k2: -0.2\n  cols: 640\n  rows: 480\n");
  EXPECT_TRUE(says(problem_of(folder,
                              "Camera:\n  fx: 510\n  fy: 520\n  cx: 320\n  cy: 240\n"
                              "  model: equirectangular\n  cols: 640\n  rows: 480\n"),
                   {"'Camera.model'", "equirectangular"}));
}

TEST(CameraFile, TheSizeHasTheNamesOfEveryFormat) {
  const TemporaryFolder folder;
  const std::string plain = "fx: 510\nfy: 520\ncx: 320\ncy: 240\n";
  for (const char* size :
       {"width: 640\nheight: 480\n", "image_width: 640\nimage_height: 480\n",
        "cols: 640\nrows: 480\n", "resolution: [640, 480]\n", "image_size: [640, 480]\n"}) {
    PinholeCamera<double> c;
    ASSERT_NO_THROW(c = read_camera_file(folder.write("c.yaml", plain + size)).camera) << size;
    EXPECT_EQ(c.width, 640) << size;
    EXPECT_EQ(c.height, 480) << size;
  }
  EXPECT_TRUE(says(problem_of(folder, plain + "resolution: [640]\n"), {"'resolution'", "height"}));
  EXPECT_TRUE(says(problem_of(folder, plain + "width: 640\nresolution: [640, 480]\n"),
                   {"'image_height'", "missing"}));
  EXPECT_TRUE(says(problem_of(folder, plain + "width: 640\ncols: 640\nheight: 480\n"),
                   {"'cols'", "'width'", "both"}));
}

TEST(CameraFile, LineEndsOfEverySystemAreRead) {
  const TemporaryFolder folder;
  for (const char* text : {kOpenCv, kOrbSlam2, kKalibr, kColmap}) {
    for (const char* end : {"\r", "\r\n"}) {
      std::string other;
      for (const char* c = text; *c != '\0'; ++c) other += *c == '\n' ? end : std::string(1, *c);
      PinholeCamera<double> c;
      ASSERT_NO_THROW(c = read_camera_file(folder.write("c.yaml", other)).camera) << other;
      EXPECT_EQ(c.fx, 510.0);
      EXPECT_EQ(c.height, 480);
    }
  }
}

TEST(CameraFile, AnIniFileIsNamed) {
  const TemporaryFolder folder;
  EXPECT_TRUE(says(problem_of(folder, "# oST version 5.0 parameters\n\n[image]\n\nwidth\n640\n"),
                   {"INI file", "[image]", "YAML"}));
  EXPECT_TRUE(says(problem_of(folder, "[LEFT_CAM_HD]\r\nfx=525\r\n"), {"INI", "LEFT_CAM_HD"}));
}

TEST(CameraFile, ReadsTheThirdRadialCoefficient) {
  const TemporaryFolder folder;
  const auto k3 = [&](const std::string& text) {
    return read_camera_file(folder.write("c.yaml", text)).camera.k3;
  };
  EXPECT_EQ(k3(replaced(kOpenCv, "-0.002, 0. ]", "-0.002, 0.05 ]")), 0.05);
  EXPECT_EQ(k3(std::string(kOrbSlam2) + "Camera.k3: 0.05\n"), 0.05);
  EXPECT_EQ(k3(std::string(kOrbSlam3) + "Camera1.k3: 0.05\n"), 0.05);
  EXPECT_EQ(k3(replaced(kBasalt, "\"k3\": 0", "\"k3\": 0.05")), 0.05);
}

TEST(CameraFile, RefusesEveryOtherLensModelByName) {
  const TemporaryFolder folder;
  const auto problem = [&](const char* text, const std::string& part, const std::string& by) {
    return problem_of(folder, replaced(text, part, by));
  };
  EXPECT_TRUE(says(problem(kOrbSlam3, "PinHole", "Rectified stereo"),
                   {"'Camera.type'", "Rectified stereo", "pinhole"}));
  EXPECT_TRUE(says(problem(kOpenCv, "fisheye_model: 0", "fisheye_model: 2"), {"'fisheye_model'"}));
  EXPECT_TRUE(says(problem(kKalibr, "pinhole", "ds"), {"'cam0.camera_model'", "'ds'"}));
  EXPECT_TRUE(says(problem(kEuroc, "radial-tangential", "fov"), {"'distortion_model'", "fov"}));
  EXPECT_TRUE(says(problem(kVins, "PINHOLE", "MEI"), {"'model_type'", "MEI"}));
  EXPECT_TRUE(says(problem(kBasalt, "pinhole-radtan8", "eucm"), {"camera_type'", "eucm"}));
  EXPECT_TRUE(
      says(problem(kColmap, "OPENCV", "THIN_PRISM_FISHEYE"), {"cam.yaml:3", "THIN_PRISM_FISHEYE"}));
}

TEST(CameraFile, ReadsAFisheyeInEveryFormat) {
  const TemporaryFolder folder;
  const std::string list = "[0.1, -0.2, 0.001, -0.002]";
  const std::string fisheye_list = "[-0.02, 0.01, -0.003, 0.001]";
  const std::string keys = "k1: 0.1\nCamera.k2: -0.2\nCamera.p1: 0.001\nCamera.p2: -0.002\n";
  const std::string keys_of_fisheye =
      "k1: -0.02\nCamera.k2: 0.01\nCamera.k3: -0.003\nCamera.k4: 0.001\n";
  const std::string vins =
      "%YAML:1.0\nmodel_type: KANNALA_BRANDT\nimage_width: 640\nimage_height: 480\n"
      "projection_parameters: {k2: -0.02, k3: 0.01, k4: -0.003, k5: 0.001, mu: 510, mv: 520, "
      "u0: 320, v0: 240}\n";
  const std::string plain =
      "fx: 510\nfy: 520\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\nlens: fisheye\nk1: -0.02\n"
      "k2: 0.01\nk3: -0.003\nk4: 0.001\n";
  const std::string files[] = {
      replaced(
          replaced(replaced(kOpenCv, "fisheye_model: 0", "fisheye_model: 1"), "rows: 5", "rows: 4"),
          "[ 0.1, -0.2, 0.001, -0.002, 0. ]", fisheye_list),
      replaced(replaced(replaced(kRos, "plumb_bob", "equidistant"), "cols: 5", "cols: 4"),
               "[0.1, -0.2, 0.001, -0.002, 0]", fisheye_list),
      replaced(replaced(kKalibr, "radtan", "equidistant"), list, fisheye_list),
      replaced(replaced(kEuroc, "radial-tangential", "equidistant"), list, fisheye_list),
      replaced(replaced(kOrbSlam2, "Camera.fx", "Camera.type: KannalaBrandt8\nCamera.fx"), keys,
               keys_of_fisheye),
      vins,
      R"({"value0": {"intrinsics": [{"camera_type": "kb4", "intrinsics": {"fx": 510, "fy": 520,
      "cx": 320, "cy": 240, "k1": -0.02, "k2": 0.01, "k3": -0.003, "k4": 0.001}}],
      "resolution": [[640, 480]]}})",
      "1 OPENCV_FISHEYE 640 480 510 520 320.5 240.5 -0.02 0.01 -0.003 0.001\n",
      plain,
      R"({"camera_matrix": [[510, 0, 320], [0, 520, 240], [0, 0, 1]], "cam_type": "fisheye",
      "dist_coefs": [[-0.02], [0.01], [-0.003], [0.001]], "resolution": [640, 480]})"};
  for (const std::string& text : files) {
    PinholeCamera<double> c;
    ASSERT_NO_THROW(c = read_camera_file(folder.write("c.yaml", text)).camera) << text;
    EXPECT_EQ(c.lens, Lens::kFisheye) << text;
    EXPECT_EQ(c.fx, 510.0) << text;
    EXPECT_EQ(c.cy, 240.0) << text;
    EXPECT_EQ(c.k1, -0.02) << text;
    EXPECT_EQ(c.k2, 0.01) << text;
    EXPECT_EQ(c.k3, -0.003) << text;
    EXPECT_EQ(c.k4, 0.001) << text;
    EXPECT_EQ(c.p1, 0.0) << text;
  }
  const std::string five = replaced(kRos, "plumb_bob", "equidistant");
  EXPECT_TRUE(says(problem_of(folder, five), {"'distortion_coefficients'", "k1 k2 k3 k4"}));
  EXPECT_TRUE(says(problem_of(folder, files[8] + "p1: 0.01\n"), {"'p1'", "not read"}));
}

TEST(CameraFile, ReadsEightCoefficients) {
  const TemporaryFolder folder;
  const std::string rational = "0.52, -2.69, 0.0006, -0.0002, 1.53, 0.4, -2.51, 1.46";
  const std::string files[] = {
      replaced(kOpenCv, "0.1, -0.2, 0.001, -0.002, 0.", rational),
      replaced(replaced(kRos, "plumb_bob", "rational_polynomial"), "0.1, -0.2, 0.001, -0.002, 0",
               rational),
      replaced(kBasalt,
               "\"k1\": 0.1, \"k2\": -0.2, \"p1\": 0.001, \"p2\": -0.002,\n    \"k3\": 0, "
               "\"k4\": 0, \"k5\": 0, \"k6\": 0",
               "\"k1\": 0.52, \"k2\": -2.69, \"p1\": 0.0006, \"p2\": -0.0002,\n    \"k3\": 1.53, "
               "\"k4\": 0.4, \"k5\": -2.51, \"k6\": 1.46"),
      "1 FULL_OPENCV 640 480 510 520 320.5 240.5 0.52 -2.69 0.0006 -0.0002 1.53 0.4 -2.51 1.46\n"};
  for (const std::string& text : files) {
    PinholeCamera<double> c;
    ASSERT_NO_THROW(c = read_camera_file(folder.write("c.yaml", text)).camera) << text;
    EXPECT_TRUE(c.is_rational()) << text;
    EXPECT_EQ(c.k3, 1.53) << text;
    EXPECT_EQ(c.k4, 0.4) << text;
    EXPECT_EQ(c.k5, -2.51) << text;
    EXPECT_EQ(c.k6, 1.46) << text;
  }
  EXPECT_TRUE(says(problem_of(folder, replaced(kRos, "0.1, -0.2, 0.001, -0.002, 0", rational)),
                   {"'distortion_coefficients'", "as the lens model says"}));
  EXPECT_TRUE(says(problem_of(folder, replaced(kOpenCv, "0.1, -0.2, 0.001, -0.002, 0.",
                                               rational + ", 0.1, 0, 0, 0")),
                   {"'distortion_coefficients'", "thin prism"}));
}

TEST(CameraFile, AFisheyePictureWithoutRaysNamesTheCrop) {
  const TemporaryFolder folder;
  // As in TUM-VI: the corners are 108 degrees off the axis.
  const std::string text =
      "fx: 190.98\nfy: 190.97\ncx: 254.93\ncy: 256.90\nwidth: 512\nheight: 512\nlens: fisheye\n"
      "k1: 0.0034824\nk2: 0.0007150\nk3: -0.0020532\nk4: 0.00020294\n";
  EXPECT_TRUE(says(problem_of(folder, text), {"80 degrees", "--crop 3"}));
  EXPECT_NO_THROW(read_camera_file(folder.write("c.yaml", text), LensCheck::kLater));
}

TEST(CameraFile, ReadsTheCamerasPlaceOnTheBody) {
  const TemporaryFolder folder;
  const std::string pose = "[[0,0,1,0.35],[-1,0,0,0],[0,-1,0,1],[0,0,0,1]]";
  const Vector3<double> ahead(0, 0, 1);
  const auto place = [&](const std::string& text) {
    return read_camera_file(folder.write("c.yaml", text)).T_body_camera;
  };
  EXPECT_FALSE(place(kRos).has_value());
  EXPECT_NEAR((*place(kEuroc) * ahead).z(), 1.0, 1e-12);
  const auto in_imu = place(replaced(kKalibr, "cam0:\n", "cam0:\n  T_imu_cam: " + pose + "\n"));
  EXPECT_NEAR((*in_imu * ahead).x(), 1.35, 1e-12);
  const auto of_imu = place(replaced(kKalibr, "cam0:\n", "cam0:\n  T_cam_imu: " + pose + "\n"));
  EXPECT_NEAR((of_imu->inverse() * ahead).x(), 1.35, 1e-12);
}

TEST(CameraFile, NoCoefficientIsDropped) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) { return problem_of(folder, text); };
  const std::string plain = "fx: 510\nfy: 520\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\n";
  EXPECT_EQ(problem(plain + "k4: 0\nk5: 0.0\n"), "no error");
  EXPECT_TRUE(says(problem(plain + "k4: 0.1\n"), {"'k4'", "not read"}));
  EXPECT_TRUE(says(problem(plain + "xi: 1.2\n"), {"'xi'", "not read"}));
  EXPECT_TRUE(says(problem(plain + "alpha: 0.6\n"), {"'alpha'"}));
  EXPECT_TRUE(says(problem(plain + "r1: 0.1\nr2: -0.2\n"), {"'r1'", "not read"}));
  EXPECT_TRUE(says(problem(plain + "kappa1: 0.1\n"), {"'kappa1'", "not read"}));
  EXPECT_TRUE(says(problem(plain + "skew: 0.6\n"), {"'skew'"}));
  EXPECT_TRUE(says(problem(plain + "coefficients: [0.1, 0, 0, 0]\n"), {"'coefficients'"}));
  EXPECT_TRUE(says(problem(plain + "lens_distortion: {k1: 0.1}\n"), {"'lens_distortion'"}));
  EXPECT_TRUE(says(problem(std::string(kOrbSlam2) + "Camera.k4: -0.2\n"), {"'Camera.k4'"}));
  EXPECT_TRUE(says(problem(std::string(kOrbSlam3) + "Camera1.k4: -0.2\n"), {"'Camera1.k4'"}));
  EXPECT_TRUE(says(problem(std::string(kRos) + "binning_x: 2\n"), {"'binning_x'"}));
  EXPECT_TRUE(says(problem(std::string(kRos) + "roi: {x_offset: 40}\n"),
                   {"'roi.x_offset'", "whole picture"}));
  EXPECT_TRUE(says(problem(std::string(kOpenCv) + "D: [0.1, 0, 0, 0]\n"), {"'D'", "both"}));
  EXPECT_TRUE(says(problem(replaced(kPython, "dist_coeff", "distCoeffs1")), {"'distCoeffs1'"}));
  EXPECT_TRUE(says(problem(replaced(kRos, "-0.002, 0]", "-0.002, 0., 0.3, 0., 0.]")),
                   {"'distortion_coefficients'", "k1 k2 p1 p2 k3 alone"}));
  EXPECT_TRUE(says(problem(replaced(kOpenCv, "0.1, -0.2, 0.001, -0.002, 0. ]", "0.1, -0.2 ]")),
                   {"'distortion_coefficients'", "found 2"}));
  EXPECT_TRUE(says(problem(replaced(kEuroc, "distortion_coefficients", "coefficients")),
                   {"'distortion_coefficients'", "missing"}));
  EXPECT_TRUE(says(problem(replaced(kEuroc, "radial-tangential", "none")),
                   {"'distortion_coefficients'", "no coefficients"}));
  EXPECT_TRUE(says(problem(replaced(kBasalt, "\"k6\": 0", "\"k7\": 0.1")), {"k7"}));
  EXPECT_TRUE(says(problem(std::string(kColmap) + "2 PINHOLE 640 480 510 520 320 240\n"),
                   {"cam.yaml:4", "one camera"}));
}

TEST(CameraFile, EveryNumberThatIsAnnouncedIsThere) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) {
    return message_of([&] { read_camera_file(folder.write("c.yaml", text)); });
  };
  const auto opencv = [&](const std::string& rows, const std::string& cols) {
    return problem(
        "image_width: 640\nimage_height: 480\ncamera_matrix: [[500, 0, 320], [0, 500, 240], [0, 0, "
        "1]]\ndistortion_coefficients:\n  rows: " +
        rows + "\n  cols: " + cols + "\n  data: [-0.2, 0.05, 0.001, 0.001]\n");
  };
  EXPECT_EQ(opencv("1", "4"), "no error");
  EXPECT_EQ(opencv("4", "1"), "no error");
  EXPECT_TRUE(says(opencv("1", "5"), {"distortion_coefficients", "rows and cols", "5", "4"}));

  // A fisheye of three coefficients is one that lost its last.
  const std::string plain = "fx: 300\nfy: 300\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\n";
  EXPECT_EQ(problem(plain + "lens: fisheye\nk1: 0.01\nk2: 0\nk3: 0\nk4: 0\n"), "no error");
  EXPECT_TRUE(says(problem(plain + "lens: fisheye\nk1: 0.01\nk2: 0\nk3: 0\n"), {"k4", "missing"}));
  std::string orb = "Camera.type: KannalaBrandt8\nCamera.fx: 300\nCamera.fy: 300\nCamera.cx: 320\n";
  orb += "Camera.cy: 240\nCamera.width: 640\nCamera.height: 480\nCamera.k1: 0.01\n";
  EXPECT_TRUE(says(problem(orb), {"Camera.k2", "missing"}));
}

TEST(CameraFile, ChecksTheCameraMatrix) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& matrix) {
    return problem_of(folder, "image_width: 640\nimage_height: 480\nK: " + matrix + "\n");
  };
  EXPECT_EQ(problem("[525, 1e-14, 308, 0, 524, 236, 0, 0, 1]"), "no error");
  EXPECT_TRUE(says(problem("[525, 0, 0, 0, 524, 0, 308, 236, 1]"), {"'K'", "column by column"}));
  EXPECT_TRUE(says(problem("[[525, 0, 0], [0, 524, 0], [308, 236, 1]]"), {"column by column"}));
  EXPECT_TRUE(says(problem("[525, 31, 308, 0, 524, 236, 0, 0, 1]"), {"'K'", "skew", "31"}));
  EXPECT_TRUE(says(problem("[525, 0, 308, 0, 524, 236, 0, 0, 0]"), {"'K'", "last row"}));
  EXPECT_TRUE(says(problem("[525, 0, 308, 2, 524, 236, 0, 0, 1]"), {"'K'", "found 2"}));
  EXPECT_TRUE(says(problem("[-525, 0, 308, 0, 524, 236, 0, 0, 1]"), {"'K'", "above zero"}));
  EXPECT_TRUE(says(problem("[525, 0, 308, 0, 0, 524, 236, 0, 0, 0, 1, 0]"), {"'K'", "3x3"}));
  EXPECT_TRUE(says(problem("{rows: 1, cols: 9, data: [525, 0, 308, 0, 524, 236, 0, 0, 1]}"),
                   {"'K'", "3x3"}));
  EXPECT_TRUE(says(problem("[525, 0, 308, 0, .nan, 236, 0, 0, 1]"), {"'K'", "'.nan'"}));
  EXPECT_TRUE(says(problem("[525, 0, 1308, 0, 524, 236, 0, 0, 1]"), {"principal point", "1308"}));
}

TEST(CameraFile, RefusesACameraThatCannotBeMeant) {
  const TemporaryFolder folder;
  const auto problem = [&](double f, double c, const std::string& more) {
    const std::string focal = std::to_string(f), centre = std::to_string(c);
    return problem_of(folder, "fx: " + focal + "\nfy: " + focal + "\ncx: " + centre +
                                  "\ncy: " + centre + "\nwidth: 640\nheight: 480\n" + more);
  };
  EXPECT_EQ(problem(500, 240, ""), "no error");
  EXPECT_TRUE(says(problem(0.82, 0.48, ""), {"in pixels", "0.82"}));
  EXPECT_TRUE(says(problem(3.6, 240, ""), {"in pixels", "3.6"}));
  EXPECT_TRUE(says(problem(5e5, 240, ""), {"in pixels"}));
  EXPECT_TRUE(says(problem_of(folder, "fx: 900\nfy: 90\ncx: 8\ncy: 8\nwidth: 640\nheight: 480\n"),
                   {"factor of 3", "fy 90"}));
  EXPECT_TRUE(says(problem(500, 240, "p1: -0.047\n"), {"tangential", "-0.047", "fisheye"}));
  EXPECT_TRUE(says(problem(300, 240, "k1: -0.3\n"), {"folds back at pixel", "k1 -0.3"}));
  EXPECT_TRUE(says(problem(500, 240, "k2: 2e4\n"), {"enlarges", "100 times", "k2 20000"}));
  EXPECT_TRUE(says(problem_of(folder, "fx: 50\nfy: 50\ncx: 8\ncy: 8\nwidth: 50000\nheight: 480\n"),
                   {"'width'", "16 to 16384", "50000"}));
}

TEST(CameraFile, ACentreInSharesOrOfATurnedPictureIsRefused) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& cx, const std::string& cy) {
    return problem_of(
        folder, "fx: 525\nfy: 525\ncx: " + cx + "\ncy: " + cy + "\nwidth: 640\nheight: 480\n");
  };
  EXPECT_TRUE(says(problem("0.5", "0.5"), {"in pixels", "cx 0.5", "shares"}));
  EXPECT_TRUE(says(problem("241.5", "318"), {"640x480", "cx 241.5 cy 318", "480x640"}));
  EXPECT_EQ(problem("270", "290"), "no error");
  EXPECT_EQ(problem("0.5", "240"), "no error");
}

TEST(CameraFile, TheFoldIsNamedByItsPixel) {
  const TemporaryFolder folder;
  const std::string problem =
      problem_of(folder, "fx: 300\nfy: 300\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\nk1: -0.3\n");
  // r (1 - 0.3 r^2) is largest at r = 1 / sqrt(0.9), 0.7027: 210.8 px from the principal point.
  EXPECT_TRUE(says(problem, {"pixel (151, 113)"}));
}

TEST(CameraFile, NamesTheKeyThatIsMissingOrWrong) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) { return problem_of(folder, text); };
  EXPECT_TRUE(says(problem(replaced(kOrbSlam2, "Camera.fx: 510\n", "")),
                   {"cam.yaml", "Camera.fx", "missing", "focal length"}));
  EXPECT_TRUE(says(problem(replaced(kOrbSlam2, "Camera.width: 640\n", "")),
                   {"cam.yaml", "Camera.width", "missing"}));
  EXPECT_TRUE(says(problem(replaced(kKalibr, "  intrinsics: [510, 520, 320, 240]\n", "")),
                   {"cam.yaml", "cam0.intrinsics", "missing"}));
  EXPECT_TRUE(says(problem("image_width: 640\nimage_height: 480\n"),
                   {"cam.yaml", "camera_matrix", "missing", "focal length"}));
  EXPECT_TRUE(says(problem(replaced(kOpenCv, "5.1e+02,", "")), {"'camera_matrix'", "9, found 8"}));
  EXPECT_TRUE(says(problem(replaced(kOrbSlam2, "Camera.fx: 510", "Camera.fx: 510,5")),
                   {"'Camera.fx'", "'510,5'"}));
  EXPECT_TRUE(says(problem(std::string(kRos) + "fx: 500\n"), {"'fx'", "one calibration"}));
  EXPECT_TRUE(says(problem(std::string(kRos) + "width: 641\n"), {"both"}));
  EXPECT_TRUE(says(problem("<a><b>1</b></a>"), {"cam.yaml", "opencv_storage"}));
}

TEST(CameraFile, BrokenAndHostileFilesAreRefusedByLine) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) { return problem_of(folder, text); };
  EXPECT_TRUE(says(problem("a: [1, 2\nb: 3\n"), {"cam.yaml:", "expected YAML"}));
  EXPECT_TRUE(says(problem("fx: 1\nfy: 2\nfx: 3\n"), {"cam.yaml:3", "'fx'", "again"}));
  EXPECT_TRUE(says(problem("fx: 1\n---\nfx: 2\n"), {"cam.yaml", "one YAML document"}));
  EXPECT_TRUE(says(problem("a: &a [x]\nb: *a\n"), {"cam.yaml:2", "alias"}));
  EXPECT_TRUE(says(problem("just words\n"), {"cam.yaml", "keys and values"}));
  EXPECT_TRUE(says(problem(""), {"cam.yaml", "keys and values"}));
  EXPECT_TRUE(says(problem(std::string("fx: 1\0", 6)), {"zero byte"}));
  EXPECT_TRUE(says(problem("K: {\"dat\xFF\": 1}\nimage_width: 640\n"), {"'K'", "expected"}));
  EXPECT_TRUE(says(problem("1 PINHOLE 640\r480 500 500 320 240\n"), {"cam.yaml:1", "HEIGHT"}));
  std::string deep = "a: ";
  for (int i = 0; i < 40; ++i) deep += "[1,";
  deep += std::string(40, ']');
  EXPECT_TRUE(says(problem(deep), {"cam.yaml:1", "32 levels"}));
  EXPECT_TRUE(says(problem(std::string(100000, '[')), {"cam.yaml:1", "expected"}));
  std::string xml;
  for (int i = 0; i < 50000; ++i) xml += "<a>";
  EXPECT_TRUE(says(problem("<?xml version=\"1.0\"?>" + xml), {"32 levels"}));
  std::string many = "a: [";
  for (int i = 0; i < 600000; ++i) many += "1,";
  EXPECT_TRUE(says(problem(many), {"500000 values"}));
  EXPECT_TRUE(says(problem(std::string(9 << 20, '#')), {"at most 8388608 bytes"}));
}

TEST(CameraFile, ReadsTheMountingAndChecksIt) {
  const TemporaryFolder folder;
  const auto with = [](const std::string& mounting) {
    return std::string(kKalibr) + "T_vehicle_camera: " + mounting + "\n";
  };
  const CameraFile file = read_camera_file(
      folder.write("c.yaml", with("[[0,0,1,0.35],[-1,0,0,0],[0,-1,0,1],[0,0,0,1]]")));
  ASSERT_TRUE(file.T_vehicle_camera.has_value());
  EXPECT_FALSE(file.tilt.has_value());
  EXPECT_NEAR((*file.T_vehicle_camera * Vector3<double>(0, 0, 1)).x(), 1.35, 1e-12);
  EXPECT_TRUE(says(problem_of(folder, with("[0,0,1,0.35,-1,0,0,0,0,-1,0,1]")),
                   {"'T_vehicle_camera'", "4x4"}));
  EXPECT_TRUE(says(problem_of(folder, with("[0,0,2,0.35,-1,0,0,0,0,-1,0,1,0,0,0,1]")),
                   {"'T_vehicle_camera'", "rotation"}));
  EXPECT_TRUE(says(problem_of(folder, with("[0,-1,0,0,0,0,-1,0,1,0,0,0,0.35,0,1,1]")),
                   {"'T_vehicle_camera'", "last row"}));
  EXPECT_TRUE(says(problem_of(folder, with("[[0,0,1,350],[-1,0,0,0],[0,-1,0,0],[0,0,0,1]]")),
                   {"'T_vehicle_camera'", "in m", "350 m"}));
}

TEST(CameraFile, ReadsTheSuspensionAndChecksIt) {
  const TemporaryFolder folder;
  const std::string kalibr = kKalibr;
  const CameraFile car = read_camera_file(folder.write("c.yaml", kalibr + "suspension: car\n"));
  ASSERT_TRUE(car.tilt.has_value());
  EXPECT_EQ(car.tilt->sigma_roll_rad, TiltParameters<double>::car().sigma_roll_rad);
  const CameraFile flat = read_camera_file(folder.write("c.yaml", kalibr + "suspension: flat\n"));
  ASSERT_TRUE(flat.tilt.has_value());
  EXPECT_FALSE(flat.tilt->tilts());
  EXPECT_TRUE(says(problem_of(folder, kalibr + "suspension: boat\n"),
                   {"'suspension'", "flat, car or rover", "boat"}));
}

TEST(CameraFile, SensorDistortionOfOpenEkfMonoSlamIsConverted) {
  const TemporaryFolder folder;
  const PinholeCamera<double> c =
      read_camera_file(folder.write("config.yml",
                                    "%YAML:1.0\nRunConfiguration:\n  CameraCalibration: \"S3\"\n"
                                    "CameraCalibration:\n  S3:\n    PixelsX: \"640\"\n"
                                    "    PixelsY: \"480\"\n    FX: \"525\"\n    FY: \"524\"\n"
                                    "    K1: \"-7.613e-003\"\n    K2: \"9.388e-004\"\n"
                                    "    CX: \"308.6\"\n    CY: \"236.5\"\n    DX: \"0.00702\"\n"))
          .camera;
  for (const double r_px : {50.0, 150.0, 250.0, 350.0}) {
    const double rd_mm = r_px * 0.00702;
    const double square = rd_mm * rd_mm;
    const double undistorted = r_px / c.fx * (1.0 - 7.613e-3 * square + 9.388e-4 * square * square);
    Vector2<double> pixel;
    ASSERT_TRUE(ok(c.project({undistorted, 0.0, 1.0}, pixel)));
    EXPECT_NEAR(pixel.x() - c.cx, r_px, 0.6) << r_px;
  }
}

}  // namespace
}  // namespace cairn::host
