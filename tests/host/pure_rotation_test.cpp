#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/experiments/turntable/turntable_room.hpp"
#include "host_sim/running/runner.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

/// Writes a folder of the TUM RGB-D format: a camera on its axis turns by 70 deg, so that no depth
/// can be seen. Returns the camera file.
std::filesystem::path write_pure_rotation(const TemporaryFolder& folder, std::uint64_t seed) {
  PointsScenario scenario;
  scenario.motion.experiment = TurntableExperiment::kYaw70;
  scenario.motion.rate_dps = 30.0;
  scenario.width = 640;
  scenario.height = 480;
  scenario.focal_px = 525.0;
  scenario.seed = seed;
  const std::vector<TurntablePose> poses = turntable_poses(scenario.motion);
  const std::vector<cv::Mat> video = render_turntable(scenario, 2.0);
  std::string list, truth;
  for (std::size_t k = 0; k < video.size(); ++k) {
    const double t_s = 1305031102.0 + static_cast<double>(k) / scenario.motion.fps;
    const std::string name = fmt::format("rgb-{}.bmp", k);
    cv::imwrite((folder.path() / name).string(), video[k]);
    const Quaternion<double> q(poses[k].rotation);
    list += fmt::format("{:.4f} {}\n", t_s, name);
    truth +=
        fmt::format("{:.4f} 0 0 0 {:.9f} {:.9f} {:.9f} {:.9f}\n", t_s, q.x(), q.y(), q.z(), q.w());
  }
  folder.write("rgb.txt", list);
  folder.write("groundtruth.txt", truth);
  return folder.write("camera.yaml",
                      "fx: 525\nfy: 525\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n");
}

RunRecord track(const std::filesystem::path& folder, const std::filesystem::path& camera) {
  const auto source = make_tum_rgbd_source(folder, camera, {});
  Frame frame;
  EXPECT_TRUE(source->next(frame));
  TrackerOptions options;
  options.mode = Mode::kHandheld;
  options.filter = kMonoFilter;
  options.filter = "mono";
  const std::unique_ptr<Tracker> tracker = make_tracker(options, source->info());
  RunnerSettings settings;
  settings.out = folder;
  settings.video = false;
  settings.pictures = 0;
  return run_frames(*source, frame, *tracker, settings);
}

TEST(PureRotation, IsNeverLostSilently) {
  const TemporaryFolder folder;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const RunRecord record = track(folder.path(), write_pure_rotation(folder, seed));
    ASSERT_GT(record.frames.size(), 80U);
    const FrameRecord* first = nullptr;
    int tracked = 0;
    double turned_deg = 0.0;
    double worst_deg = 0.0;
    for (const FrameRecord& frame : record.frames) {
      if (!frame.has_pose()) continue;
      if (first == nullptr) first = &frame;
      constexpr double kDegrees = 57.29577951308232;
      const Quaternion<double> estimated =
          (first->report.T_world_camera.rotation.conjugate() * frame.report.T_world_camera.rotation)
              .cast<double>()
              .normalized();
      const Quaternion<double> truth =
          first->true_T_world_camera->rotation.conjugate() * frame.true_T_world_camera->rotation;
      worst_deg = std::max(worst_deg, kDegrees * estimated.angularDistance(truth));
      turned_deg = kDegrees * truth.angularDistance(Quaternion<double>::Identity());
      ++tracked;
    }
    EXPECT_LT(worst_deg, 5.0) << "seed " << seed;
    // Tracking may be lost, but not at once: half of the rotation is tracked.
    EXPECT_GT(tracked, 40) << "seed " << seed;
    EXPECT_GT(turned_deg, 35.0) << "seed " << seed;
    RecordProperty("worst_deg", std::to_string(worst_deg));
    RecordProperty("tracked", tracked);
  }
}

}  // namespace
}  // namespace cairn::host
