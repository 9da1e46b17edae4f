#include "host_sim/recorded/starry_night.hpp"

#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cairn/geometry/rigid.hpp"

#include "host_sim/io/input_error.hpp"
#include "host_sim/world/gaussian.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

constexpr const char* kPoseHeader =
    "t_s,x,y,z,th1,th2,th3(axis-angle C_vk_i),vx,vy,vz(body),wx,wy,wz(body gyro)\n";
constexpr const char* kPixelHeader = "k,t_s,landmark(1..20),u_left,v_left,u_right,v_right\n";

/// A camera that sways and turns before twenty points (without turns no focal length can be seen);
/// the last 20 of its 220 frames have no true pose.
void write_sway(const TemporaryFolder& folder) {
  GaussianRandom random(3);
  std::vector<Vector3<double>> points;
  points.reserve(20);
  for (int i = 0; i < 20; ++i) {
    points.push_back(Vector3<double>{random.uniform(-0.8, 0.8), random.uniform(-0.6, 0.6),
                                     random.uniform(1.5, 3.0)});
  }
  std::string poses = kPoseHeader;
  std::string pixels = kPixelHeader;
  for (int k = 0; k < 220; ++k) {
    const double t_s = k / 11.0;
    const Vector3<double> r(0.3 * std::sin(0.7 * t_s), 0.2 * std::sin(1.1 * t_s), 0.1 * t_s / 20.0);
    const Matrix3<double> turn =
        rotation_exp(Vector3<double>(0.10 * std::sin(0.9 * t_s), 0.20 * std::sin(0.5 * t_s), 0.0))
            .toRotationMatrix();
    if (k < 200) {
      poses +=
          fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},0,0,0,0,0,0,0,0,0\n", t_s, r.x(), r.y(), r.z());
    }
    for (int i = 0; i < 20; ++i) {
      const Vector3<double> p = turn.transpose() * (points[static_cast<std::size_t>(i)] - r);
      const double u = 484.5 * p.x() / p.z() + 321.68 + 0.3 * random.normal();
      const double v = 484.5 * p.y() / p.z() + 247.48 + 0.3 * random.normal();
      if (u < 0.0 || u > 639.0 || v < 0.0 || v > 479.0) continue;
      pixels += fmt::format("{},{:.6f},{},{:.4f},{:.4f},0,0\n", k, t_s, i + 1, u, v);
    }
  }
  folder.write("gt_imu.csv", poses);
  folder.write("obs.csv", pixels);
}

RunOptions options_of(const TemporaryFolder& folder) {
  RunOptions options;
  options.out = folder.path() / "out";
  options.handheld.sigma_px = 0.5;
  return options;
}

nlohmann::json run(const RunOptions& options, const TemporaryFolder& folder) {
  EXPECT_EQ(run_starry_night(options, folder.path().string()), ExitCode::kOk);
  std::ifstream file(options.out / "summary.json");
  return nlohmann::json::parse(file);
}

TEST(StarryNight, TracksPointsAlsoAfterTheTruthEnds) {
  const TemporaryFolder folder;
  write_sway(folder);
  const nlohmann::json summary = run(options_of(folder), folder);
  EXPECT_EQ(summary["frames"], 220);
  EXPECT_GT(summary["tracked"], 210);
  EXPECT_LT(summary["trajectory"]["ate_rmse_m"], 0.02);
}

TEST(StarryNight, EstimatesAWrongFocalLength) {
  const TemporaryFolder folder;
  write_sway(folder);
  RunOptions options = options_of(folder);
  options.handheld.focal_error = 0.05;
  options.handheld.estimate_focal_length = true;
  const nlohmann::json summary = run(options, folder);
  EXPECT_NEAR(summary["focal_px"], 484.5, 8.0);
}

TEST(StarryNight, RefusesWhatItCannotDo) {
  const TemporaryFolder folder;
  write_sway(folder);
  RunOptions options = options_of(folder);
  options.handheld.measurement = "freak";
  EXPECT_THROW((void)run_starry_night(options, folder.path().string()), UsageError);
  folder.write("obs.csv", std::string(kPixelHeader) + "0,0.0,21,1,1,1,1\n");
  EXPECT_THROW((void)run_starry_night(options_of(folder), folder.path().string()), InputError);
}

}  // namespace
}  // namespace cairn::host
