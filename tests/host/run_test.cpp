#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host_sim/base/statistics.hpp"
#include "host_sim/evaluation/registration_error.hpp"
#include "host_sim/evaluation/trajectory_evaluation.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/reports/report.py.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/reports/run_outputs.hpp"
#include "host_sim/reports/run_summary.hpp"
#include "host_sim/reports/run_trajectory.hpp"
#include "host_sim/running/runner.hpp"
#include "host_sim/sources/hall_source.hpp"
#include "host_sim/world/gaussian.hpp"
#include "temporary_folder.hpp"
#include "truth_tracker.hpp"

namespace cairn::host {
namespace {

TEST(Statistics, NearestRankPercentiles) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Statistics s = statistics_of(values);
  EXPECT_EQ(s.p50, 50.0);
  EXPECT_EQ(s.p95, 95.0);
  EXPECT_EQ(s.p99, 99.0);
  EXPECT_EQ(s.max, 100.0);
  EXPECT_EQ(s.mean, 50.5);
  EXPECT_EQ(share_above(values, 41.57), 0.59);
  EXPECT_EQ(statistics_of({}).n, 0);
}

TEST(Statistics, ChiSquareBandAgreesWithTables) {
  EXPECT_NEAR(chi_square_band_95(3).low, 0.2158, 1e-3);
  EXPECT_NEAR(chi_square_band_95(3).high, 9.3484, 1e-3);
  EXPECT_NEAR(chi_square_band_95(40).low, 24.433, 2e-3);
  EXPECT_NEAR(chi_square_band_95(40).high, 59.342, 2e-3);
}

std::vector<Rigid<double>> random_path(int count) {
  GaussianRandom random(4);
  std::vector<Rigid<double>> path;
  path.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    path.push_back(
        {rotation_exp(Vector3<double>{random.normal(), random.normal(), random.normal()}),
         {random.normal(), random.normal(), random.normal()}});
  }
  return path;
}

TEST(TrajectoryEvaluation, Sim3UndoesScaleRotationAndShift) {
  const std::vector<Rigid<double>> truth = random_path(30);
  const Rigid<double> T{rotation_exp(Vector3<double>(0.4, -1.0, 2.0)), {3.0, -4.0, 5.0}};
  std::vector<Rigid<double>> estimate;
  for (const Rigid<double>& pose : truth) {
    Rigid<double> moved = T * pose;
    moved.translation *= 0.25;
    estimate.push_back(moved);
  }
  const auto sim3 = evaluate_trajectory(estimate, truth, Alignment::kSim3);
  ASSERT_TRUE(sim3.has_value());
  EXPECT_NEAR(sim3->scale, 4.0, 1e-9);
  EXPECT_NEAR(sim3->ate_rmse_m, 0.0, 1e-9);
  EXPECT_NEAR(sim3->rotation_rmse_deg, 0.0, 1e-6);
  const Rigid<double>& moved = sim3->T_truth_estimate;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vector3<double> p =
        moved.rotation * (sim3->scale * estimate[i].translation) + moved.translation;
    EXPECT_NEAR((p - truth[i].translation).norm(), 0.0, 1e-9);
  }
  const auto se3 = evaluate_trajectory(estimate, truth, Alignment::kSe3);
  EXPECT_GT(se3->ate_rmse_m, 0.5);
  EXPECT_NEAR(se3->rotation_rmse_deg, 0.0, 1e-6);
  EXPECT_FALSE(evaluate_trajectory({}, {}, Alignment::kStart).has_value());
}

TEST(TrajectoryEvaluation, StartComparesAsEstimated) {
  std::vector<Rigid<double>> truth(5), estimate(5);
  for (int i = 0; i < 5; ++i) {
    truth[i].translation.x() = i;
    estimate[i] = truth[i];
    estimate[i].translation.y() = 0.1 * i;
    estimate[i].rotation = rotation_exp(Vector3<double>(0.0, 0.0, 0.02));
  }
  const auto e = evaluate_trajectory(estimate, truth, Alignment::kStart);
  EXPECT_NEAR(e->ate_rmse_m, 0.1 * std::sqrt(6.0), 1e-12);
  EXPECT_NEAR(e->final_drift_m, 0.4, 1e-12);
  EXPECT_NEAR(e->heading_rmse_deg, 0.02 * 180.0 / kPi<double>, 1e-9);
  EXPECT_NEAR(e->rotation_rmse_deg, 0.0, 1e-6);  // a constant turn is an alignment
}

PinholeCamera<double> test_camera() {
  PinholeCamera<double> camera;
  camera.fx = camera.fy = 500.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.width = 640;
  camera.height = 480;
  return camera;
}

/// A camera that goes right past points 4 m and 6 m ahead; the estimate is `scale` times that.
std::vector<RegistrationInput> sliding_camera(double scale, double jump_m) {
  std::vector<RegistrationInput> frames;
  const PinholeCamera<double> camera = test_camera();
  for (int i = 0; i < 10; ++i) {
    RegistrationInput frame;
    Rigid<double> pose;
    pose.translation.x() = scale * (0.1 * i + (i >= 5 ? jump_m : 0.0));
    frame.T_world_camera = pose;
    std::uint32_t id = 1;
    for (const Vector3<double>& p :
         {Vector3<double>(0.2, 0.1, 4.0), Vector3<double>(0.6, 0, 6.0)}) {
      ScenePointView view;
      view.id = id++;
      view.p_camera = p - Vector3<double>(0.1 * i, 0.0, 0.0);
      EXPECT_TRUE(ok(camera.project(view.p_camera, view.pixel)));
      frame.views.push_back(view);
    }
    frames.push_back(frame);
  }
  return frames;
}

TEST(RegistrationError, ZeroForTheTruthAndExactForAJump) {
  const RegistrationSettings settings;
  const auto exact = evaluate_registration(sliding_camera(1.0, 0.0), test_camera(), settings);
  EXPECT_EQ(exact.points, 2);
  EXPECT_FALSE(exact.frame_px[0].has_value());  // anchored here
  for (int i = 1; i < 10; ++i) EXPECT_NEAR(*exact.frame_px[i], 0.0, 1e-9);
  const auto jump = evaluate_registration(sliding_camera(1.0, 0.04), test_camera(), settings);
  EXPECT_NEAR(*jump.frame_px[4], 0.0, 1e-9);
  EXPECT_NEAR(*jump.frame_px[5], 0.5 * (500 * 0.04 / 4.0 + 500 * 0.04 / 6.0), 1e-9);
}

TEST(RegistrationError, FindsTheOneScaleThatVideoDoesNotGive) {
  RegistrationSettings settings;
  settings.map_scale.reset();
  const auto result = evaluate_registration(sliding_camera(0.37, 0.0), test_camera(), settings);
  EXPECT_NEAR(result.map_scale, 0.37, 1e-4);
  EXPECT_NEAR(*result.frame_px[9], 0.0, 0.01);
}

/// A camera whose focal length is taken for a tenth longer sees all points a tenth nearer to its
/// axis: an object at the point's depth stays on it as long as pose and camera agree.
TEST(RegistrationError, IsOfTheCameraThatObjectsAreDrawnWith) {
  auto frames = sliding_camera(1.0, 0.0);
  for (RegistrationInput& frame : frames) {
    frame.focal_scale = 1.1;
    frame.T_world_camera->translation.x() /= 1.1;
  }
  const auto own = evaluate_registration(frames, test_camera(), {});
  for (int i = 1; i < 10; ++i) EXPECT_NEAR(*own.frame_px[i], 0.0, 1e-9);
  for (RegistrationInput& frame : frames) frame.focal_scale = 1.0;
  EXPECT_GT(*evaluate_registration(frames, test_camera(), {}).frame_px[9], 5.0);
}

TEST(RegistrationError, LostFramesHaveNone) {
  auto frames = sliding_camera(1.0, 0.0);
  frames[3].T_world_camera.reset();
  const auto result = evaluate_registration(frames, test_camera(), {});
  EXPECT_FALSE(result.frame_px[3].has_value());
  EXPECT_TRUE(result.frame_px[4].has_value());
}

struct HallRun {
  RunRecord record;
  SourceInfo info;
};

HallRun run_truth(const std::filesystem::path& out, double offset_m) {
  HallOptions options;
  options.width = 320;
  options.frame_count = 20;
  const auto source = make_hall_source(options);
  TruthTracker tracker(source->info().T_vehicle_camera);
  tracker.offset_from(10, offset_m);
  Frame frame;
  EXPECT_TRUE(source->next(frame));
  RunnerSettings settings;
  settings.out = out;
  return {run_frames(*source, frame, tracker, settings), source->info()};
}

TEST(Runner, WritesTheContractsFilesWithTrueFigures) {
  const TemporaryFolder folder;
  const HallRun run = run_truth(folder.path(), 0.05);
  const RegistrationResult registration =
      evaluate_registration(run.record.registration_input, run.info.camera, {});
  const RunTrajectory trajectory = evaluate_run(run.record, Mode::kVehicle);
  const nlohmann::json summary = summarise(run.record, trajectory, registration, 41.57, run.info);
  RunIdentity identity;
  identity.source = "hall-small";
  identity.options.filter = "truth";
  write_manifest(folder.path(), identity, run.info, run.record);
  write_frames(folder.path(), run.record, registration);
  write_trajectories(folder.path(), run.record, Mode::kVehicle);
  write_landmarks(folder.path(), run.record);
  write_uncertainty(folder.path(), run.record);
  write_health(folder.path(), run.record);
  write_json(folder.path() / "summary.json", summary);

  EXPECT_EQ(summary["frames"], 20);
  EXPECT_EQ(summary["tracked"], 20);
  EXPECT_EQ(summary["lost"], 0);
  EXPECT_NEAR(summary["trajectory"]["ate_rmse_m"].get<double>(), 0.05 * std::sqrt(0.5), 1e-9);
  EXPECT_EQ(summary["trajectory"]["aligned"], "start");
  EXPECT_NEAR(summary["nees"]["mean"].get<double>(), 12.5, 1e-6);  // 0.05^2 / 1e-4, half the frames
  EXPECT_NEAR(summary["latency_ms"]["stages"]["features"]["p50"].get<double>(), 0.003, 1e-9);
  EXPECT_TRUE(summary["nis"]["mean"].is_null());
  EXPECT_EQ(summary["map"]["capacity"], 64);
  EXPECT_GT(summary["registration_px"]["max"].get<double>(), 1.0);
  EXPECT_NEAR(summary["travel"]["left_deg"].get<double>(), 0.40107, 1e-4);
  EXPECT_NEAR(summary["travel"]["sigma_deg"].get<double>(), 0.0573, 1e-4);

  LineReader lines(folder.path() / "frames.csv");
  TextLine line;
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line.text,
            "frame,t_us,status,preprocess_ms,pose_prediction_ms,features_ms,pose_update_ms,"
            "render_ms,total_ms,corners,candidates,matches,inliers,landmarks,registration_px");
  int rows = 0;
  while (lines.next(line)) ++rows;
  EXPECT_EQ(rows, 20);
  const auto estimate = read_tum(folder.path() / "trajectory.tum");
  const auto truth = read_tum(folder.path() / "truth.tum");
  ASSERT_EQ(estimate.size(), 20U);
  EXPECT_NEAR(estimate[15].pose.translation.y() - truth[15].pose.translation.y(), 0.05, 1e-7);
  EXPECT_FALSE(run.record.overlay.empty());
  EXPECT_TRUE(std::filesystem::exists(run.record.overlay));
  const std::string uncertainty =
      read_text(folder.path() / "uncertainty.csv", 1U << 16U, "a table");
  EXPECT_EQ(std::count(uncertainty.begin(), uncertainty.end(), '\n'), 21);
  EXPECT_EQ(summary["video"]["file"], run.record.overlay.filename().string());
  const auto problem = draw_with_python("report.html", kReportScript, folder.path());
  if (problem.has_value()) GTEST_SKIP() << *problem;
  const std::string page = read_text(folder.path() / "report.html", 1U << 25U, "a page");
  EXPECT_GT(page.size(), 20000U);
  // The verdict comes before all else. What the charts draw: tests/report.
  const std::string headline = summary["verdict"]["headline"].get<std::string>();
  const std::size_t at = page.find(headline);
  ASSERT_NE(at, std::string::npos);
  EXPECT_LT(at, page.find("<div class='cards'>"));
  EXPECT_NE(page.find("NEES 12.5"), std::string::npos);
  EXPECT_NE(page.find("drives 0.4 degrees to the left"), std::string::npos);
  EXPECT_NE(page.find("0.40 &plusmn; 0.06&deg;"), std::string::npos);
  const auto count = [&](const std::string& part) {
    int n = 0;
    for (std::size_t i = page.find(part); i != std::string::npos; i = page.find(part, i + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("data-chart="), 7);
  EXPECT_EQ(count("<video "), 1);
  EXPECT_NE(page.find("Leon Sorokin"), std::string::npos) << "the licence of the charts' library";
  EXPECT_EQ(count("<img "), static_cast<int>(run.record.pictures.size()));
}

/// WHEN the direction of travel is told with a sigma, THEN the filter begins with it; at 0, and in
/// filters without that state, nothing is estimated.
TEST(Runner, TellsTheTrackerHowWellTheDirectionOfTravelIsKnown) {
  HallOptions hall;
  hall.width = 320;
  hall.frame_count = 1;
  const SourceInfo source = make_hall_source(hall)->info();
  const auto travel_of = [&](const char* filter, std::optional<double> sigma_rad) {
    TrackerOptions options;
    options.filter = filter;
    options.travel_sigma_rad = sigma_rad;
    return make_tracker(options, source)->travel();
  };
  ASSERT_TRUE(travel_of("group-iekf", 0.02).has_value());
  EXPECT_FLOAT_EQ(travel_of("group-iekf", 0.02)->variance, 4e-4F);
  ASSERT_TRUE(travel_of("group-iekf", std::nullopt).has_value());
  EXPECT_FLOAT_EQ(travel_of("group-iekf", std::nullopt)->variance, 0.0035F * 0.0035F);
  EXPECT_FALSE(travel_of("group-iekf", 0.0).has_value());
  for (const char* filter : {"group-iekf-fixed", "lifted-iekf", "ekf"}) {
    EXPECT_FALSE(travel_of(filter, std::nullopt).has_value()) << filter;
  }
}

TEST(Runner, HealthTableHasWhatGrewInEachFrame) {
  const TemporaryFolder folder;
  RunRecord record;
  record.frames.resize(3);
  for (int i = 0; i < 3; ++i) record.frames[static_cast<std::size_t>(i)].number = 7 + i;
  record.frames[1].health.losses = 1;
  record.frames[2].health.losses = 1;
  record.frames[2].health.landmarks_added = 5;
  write_health(folder.path(), record);
  EXPECT_EQ(read_text(folder.path() / "health.csv", 1U << 16U, "a table"),
            "frame,t_us,counter,grew\n8,0,losses,1\n9,0,landmarks_added,5\n");
}

TEST(Runner, LogHashFollowsWhatTheTrackerDecidedAlone) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_truth(folder.path(), 0.0).record.log_hash,
            run_truth(folder.path(), 0.0).record.log_hash);
  EXPECT_NE(run_truth(folder.path(), 0.0).record.log_hash,
            run_truth(folder.path(), 1e-3).record.log_hash);
}

}  // namespace
}  // namespace cairn::host
