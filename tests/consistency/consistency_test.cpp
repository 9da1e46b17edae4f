// Paper A's experiment 4.1 with 50 runs a cell: fixed seed, chi-square bands.
// docs/results/consistency.md holds the same for 200 and 1,000 runs.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/experiments/consistency/experiment.hpp"
#include "host_sim/experiments/consistency/operation_count.hpp"

namespace cairn::host {
namespace {

constexpr int kRuns = 50;
constexpr std::uint64_t kSeed = 1;
constexpr double kDegree = 0.017453292519943295;

enum class Odometry { kBase, kS1 };

ExperimentConfig experiment(Odometry odometry, double heading_variance,
                            const std::vector<std::string>& filters) {
  ExperimentConfig config;
  config.runs = kRuns;
  config.seed = kSeed;
  config.filters = filters;
  config.threads = 1;
  config.simulation.heading_variance_rad2 = heading_variance;
  if (odometry == Odometry::kBase) {
    config.simulation.speed_sigma_mps = 0.05;
    config.simulation.steering_sigma_rad = 2.0 * kDegree;
  }
  return config;
}

LoopFigures figures(const ExperimentResult& result, std::size_t filter, int loop) {
  return loop_figures(result, result.filters[filter], loop);
}

void expect_in_band(const ExperimentResult& result, std::size_t filter) {
  for (int loop = 0; loop < result.config.simulation.loops; ++loop) {
    EXPECT_GE(figures(result, filter, loop).inside_percent, 95.0)
        << result.filters[filter].filter << ", loop " << loop + 1 << ", mean NEES "
        << figures(result, filter, loop).nees_mean;
  }
}

class Cell : public ::testing::TestWithParam<Odometry> {};

TEST_P(Cell, LowVarianceGroupFilterStaysInTheBand) {
  const auto result =
      run_experiment(experiment(GetParam(), 0.001, {"ekf", "group-iekf", "ri-ekf"}), {});
  expect_in_band(result, 1);
  for (int loop = 0; loop < 2; ++loop) {
    EXPECT_LE(figures(result, 1, loop).position_rmse_m,
              1.005 * figures(result, 2, loop).position_rmse_m);
    EXPECT_LE(figures(result, 1, loop).position_rmse_m,
              1.02 * figures(result, 0, loop).position_rmse_m);
  }
  EXPECT_GT(figures(result, 0, 1).nees_mean, figures(result, 0, 0).nees_mean);
  EXPECT_GT(figures(result, 0, 1).nees_mean, 1.1 * figures(result, 1, 1).nees_mean);
}

TEST_P(Cell, HighVarianceEkfIsLostAndGroupFilterIsNot) {
  const auto result =
      run_experiment(experiment(GetParam(), 0.03, {"ekf", "group-iekf", "ri-ekf"}), {});
  expect_in_band(result, 1);
  EXPECT_GT(figures(result, 0, 1).nees_mean, 20.0);
  EXPECT_LE(figures(result, 0, 1).inside_percent, 1.0);
  for (int loop = 0; loop < 2; ++loop) {
    EXPECT_LE(figures(result, 1, loop).position_rmse_m,
              0.97 * figures(result, 0, loop).position_rmse_m);
    EXPECT_LE(figures(result, 1, loop).position_rmse_m,
              1.005 * figures(result, 2, loop).position_rmse_m);
    EXPECT_NEAR(figures(result, 1, loop).landmark_nees_mean, 2.0, 0.6);
    EXPECT_GT(figures(result, 0, loop).landmark_nees_mean, 4.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Consistency, Cell, ::testing::Values(Odometry::kBase, Odometry::kS1),
                         [](const auto& cell) {
                           return cell.param == Odometry::kBase ? "Base" : "S1";
                         });

TEST(Consistency, PapersFilterStaysLongerThanTheEkfAndThenLeaves) {
  const auto result = run_experiment(
      experiment(Odometry::kS1, 0.03, {"ekf", "reduced-jacobian", "group-iekf"}), {});
  EXPECT_LT(figures(result, 1, 0).nees_mean, 0.4 * figures(result, 0, 0).nees_mean);
  EXPECT_LT(figures(result, 1, 1).nees_mean, 0.2 * figures(result, 0, 1).nees_mean);
  EXPECT_GT(figures(result, 1, 1).nees_mean, 1.1 * figures(result, 2, 1).nees_mean);
}

TEST(Consistency, KnownStartShowsThePapersFilterDrifting) {
  ExperimentConfig config =
      experiment(Odometry::kS1, 1e-6, {"ekf", "reduced-jacobian", "group-iekf"});
  config.simulation.position_variance_m2 = 1e-6;
  const auto result = run_experiment(config, {});
  expect_in_band(result, 2);
  EXPECT_GT(figures(result, 1, 1).nees_mean, 10.0);
  for (int loop = 0; loop < 2; ++loop) {
    EXPECT_LE(figures(result, 2, loop).position_rmse_m,
              1.01 * figures(result, 0, loop).position_rmse_m);
  }
}

TEST(Consistency, WideStartIsReadOutByItsMoments) {
  const auto result = run_experiment(experiment(Odometry::kS1, 0.1, {"group-iekf", "ri-ekf"}), {});
  expect_in_band(result, 0);
  const auto wider = run_experiment(experiment(Odometry::kS1, 0.3, {"group-iekf", "ri-ekf"}), {});
  for (int loop = 0; loop < 2; ++loop) {
    EXPECT_GE(figures(wider, 0, loop).nees_mean, 2.4);
    EXPECT_LE(figures(wider, 0, loop).nees_mean, 3.5);
    EXPECT_GT(figures(wider, 1, loop).nees_mean, 2.0 * figures(wider, 0, loop).nees_mean);
  }
}

TEST(Consistency, TenDegreesOfSteeringNoise) {
  for (const double variance : {0.001, 0.03}) {
    ExperimentConfig config = experiment(Odometry::kS1, variance, {"group-iekf"});
    config.simulation.steering_sigma_rad = 10.0 * kDegree;
    const auto result = run_experiment(config, {});
    for (int loop = 0; loop < 2; ++loop) EXPECT_LE(figures(result, 0, loop).nees_mean, 3.35);
  }
}

TEST(Consistency, FullLiftedFilterIsTheReducedOne) {
  ExperimentConfig config = experiment(Odometry::kS1, 0.03, {"lifted-iekf", "reduced-jacobian"});
  config.runs = 2;
  config.simulation.loops = 1;
  config.simulation.landmarks = 12;
  const auto result = run_experiment(config, {});
  for (int k = 0; k < result.config.simulation.steps(); ++k) {
    EXPECT_NEAR(result.filters[0].nees.mean(k, 2), result.filters[1].nees.mean(k, 2), 3e-6);
  }
}

TEST(Consistency, GroupFilterPredictsInFewerOperationsThanTheEkf) {
  SimulationConfig config;
  config.loops = 1;
  const OperationCount ekf = count_operations("ekf", config);
  const OperationCount group = count_operations("group-iekf", config);
  const OperationCount lifted = count_operations("lifted-iekf", config);
  EXPECT_LT(group.per_predict, ekf.per_predict);
  EXPECT_GT(lifted.per_predict + lifted.per_update, 5.0 * (ekf.per_predict + ekf.per_update));
}

}  // namespace
}  // namespace cairn::host
