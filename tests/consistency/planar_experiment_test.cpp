#include <cmath>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"

#include "host_sim/base/statistics.hpp"
#include "host_sim/experiments/consistency/experiment.hpp"
#include "host_sim/experiments/consistency/filter.hpp"
#include "host_sim/experiments/consistency/reference/reduced_lifted.hpp"
#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

ExperimentConfig small_experiment() {
  ExperimentConfig config;
  config.runs = 6;
  config.seed = 7;
  config.filters = {"dense-ekf", "ri-ekf"};
  config.simulation.loop_s = 10.0;
  config.simulation.heading_variance_rad2 = 0.03;
  config.threads = 1;
  return config;
}

void expect_equal(const ExperimentResult& a, const ExperimentResult& b) {
  ASSERT_EQ(a.runs_done, b.runs_done);
  ASSERT_EQ(a.filters.size(), b.filters.size());
  for (std::size_t f = 0; f < a.filters.size(); ++f) {
    EXPECT_EQ(a.filters[f].nees.raw(), b.filters[f].nees.raw());
    EXPECT_EQ(a.filters[f].position_squared.raw(), b.filters[f].position_squared.raw());
    EXPECT_EQ(a.filters[f].heading_squared.raw(), b.filters[f].heading_squared.raw());
    EXPECT_EQ(a.filters[f].landmark_nees.raw(), b.filters[f].landmark_nees.raw());
    EXPECT_EQ(a.filters[f].landmark_count, b.filters[f].landmark_count);
  }
}

TEST(PlanarExperiment, SameResultForAnyNumberOfThreads) {
  ExperimentConfig config = small_experiment();
  const ExperimentResult one = run_experiment(config, {});
  config.threads = 3;
  expect_equal(one, run_experiment(config, {}));
  EXPECT_GT(one.filters[0].nees.raw().back(), 0);
}

TEST(PlanarExperiment, FixedPointGivesTheFiguresOfDouble) {
  // Not the EKF in float: its NEES is large, and differs by more.
  const std::vector<std::vector<std::string>> sets = {
      {"group-iekf", "group-iekf-float", "group-iekf-fixed"}, {"ekf", "ekf-fixed"}};
  for (const std::vector<std::string>& filters : sets) {
    ExperimentConfig config = small_experiment();
    config.filters = filters;
    const ExperimentResult result = run_experiment(config, {});
    const LoopFigures expected = loop_figures(result, result.filters[0], 1);
    for (const FilterSums& sums : result.filters) {
      const LoopFigures figures = loop_figures(result, sums, 1);
      EXPECT_NEAR(figures.nees_mean, expected.nees_mean, 1e-3) << sums.filter;
      EXPECT_NEAR(figures.position_rmse_m, expected.position_rmse_m, 1e-4) << sums.filter;
      EXPECT_NEAR(figures.landmark_nees_mean, expected.landmark_nees_mean, 1e-3) << sums.filter;
      EXPECT_EQ(sums.saturations, 0) << sums.filter;
    }
  }
}

TEST(PlanarExperiment, CountsWhatDoesNotFitFixedPoint) {
  ExperimentConfig config = small_experiment();
  config.filters = {"group-iekf-fixed"};
  config.runs = 1;
  config.simulation.observation_sigma_m = 800.0;  // deviations beyond those of a row
  config.simulation.range_m = 20.0;
  EXPECT_GT(run_experiment(config, {}).filters[0].saturations, 0);
}

TEST(PlanarExperiment, MergedShardsEqualTheWholeInAnyOrder) {
  ExperimentConfig config = small_experiment();
  const ExperimentResult whole = run_experiment(config, {});
  config.shard.count = 4;
  config.shard.index = 3;
  ExperimentResult merged = run_experiment(config, {});
  for (const int index : {1, 4, 2}) {
    config.shard.index = index;
    merge_experiment(merged, run_experiment(config, {}));
  }
  expect_equal(whole, merged);
  EXPECT_FALSE(merged.sample.empty());
}

TEST(PlanarExperiment, MergeRefusesAnotherExperimentAndAShardTwice) {
  ExperimentConfig config = small_experiment();
  config.runs = 2;
  config.shard.count = 2;
  ExperimentResult first = run_experiment(config, {});
  EXPECT_THROW(merge_experiment(first, run_experiment(config, {})), std::invalid_argument);
  config.shard.index = 2;
  config.seed = 8;
  EXPECT_THROW(merge_experiment(first, run_experiment(config, {})), std::invalid_argument);
}

TEST(PlanarExperiment, AnotherSeedGivesAnotherWorld) {
  const SimulationConfig config;
  const SimulatedRun a = simulate_run(config, 1, 0);
  const SimulatedRun b = simulate_run(config, 1, 1);
  const SimulatedRun c = simulate_run(config, 2, 0);
  EXPECT_NE(a.landmarks[0], b.landmarks[0]);
  EXPECT_NE(a.landmarks[0], c.landmarks[0]);
  EXPECT_EQ(a.landmarks[0], simulate_run(config, 1, 0).landmarks[0]);
}

TEST(PlanarExperiment, PathIsClosedAndInsideTheField) {
  const SimulationConfig config;
  const SimulatedRun run = simulate_run(config, 1, 0);
  const auto loop = static_cast<std::size_t>(config.steps_per_loop());
  EXPECT_LT((run.steps[loop - 1].truth.position - run.true_start.position).norm(), 0.01);
  EXPECT_LT((run.steps.back().truth.position - run.true_start.position).norm(), 0.02);
  for (const auto& step : run.steps) {
    EXPECT_LT(step.truth.position.cwiseAbs().maxCoeff(), config.field_half_width_m);
  }
}

TEST(PlanarExperiment, BandsAreThoseOfTheLiterature) {
  // Exact chi-square quantiles of 3 N degrees of freedom, divided by N.
  EXPECT_NEAR(average_nees_band(50, 3).low, 2.3597, 6e-5);
  EXPECT_NEAR(average_nees_band(50, 3).high, 3.7160, 6e-5);
  EXPECT_NEAR(average_nees_band(200, 3).low, 2.6701, 6e-5);
  EXPECT_NEAR(average_nees_band(200, 3).high, 3.3488, 6e-5);
  EXPECT_NEAR(average_nees_band(2, 3).low, 0.6187, 6e-5);
  EXPECT_NEAR(average_nees_band(2, 3).high, 7.2247, 6e-5);
}

TEST(PlanarExperiment, GaussianRandomHasUnitVarianceAndNoMean) {
  GaussianRandom source(3);
  double sum = 0.0;
  double squares = 0.0;
  double fourth = 0.0;
  constexpr int kSamples = 200000;
  for (int i = 0; i < kSamples; ++i) {
    const double x = source.normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 0.01);
  EXPECT_NEAR(squares / kSamples, 1.0, 0.015);
  EXPECT_NEAR(fourth / kSamples, 3.0, 0.1);
}

TEST(ReducedLifted, MonomialMomentsAreThoseOfSamples) {
  Increment step;
  step.distance_m = 0.4;
  step.turn_rad = 0.3;
  step.covariance << 0.01, 0.006, 0.006, 0.09;
  const MonomialMoments moments = monomial_moments(step);
  GaussianRandom source(5);
  OdometryMonomials mean = OdometryMonomials::Zero();
  Eigen::Matrix<double, 6, 6> second = Eigen::Matrix<double, 6, 6>::Zero();
  constexpr int kSamples = 400000;
  const Eigen::Matrix2d root = step.covariance.llt().matrixL();
  for (int i = 0; i < kSamples; ++i) {
    const double n0 = source.normal();
    const double n1 = source.normal();
    const Eigen::Vector2d noise = root * Eigen::Vector2d(n0, n1);
    const double u1 = step.distance_m + noise(0);
    const double a = step.turn_rad + noise(1);
    OdometryMonomials m;
    m << 1.0, u1, std::sin(a), std::cos(a), u1 * std::sin(a), u1 * std::cos(a);
    mean += m / kSamples;
    second += m * m.transpose() / kSamples;
  }
  EXPECT_LT((moments.mean - mean).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT((moments.covariance - (second - mean * mean.transpose())).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(ReducedLifted, BothNoisesAgreeForSmallUncertainty) {
  SimulationConfig config;
  config.speed_sigma_mps = 1e-3;
  config.steering_sigma_rad = 1e-3;
  config.position_variance_m2 = 1e-6;
  config.heading_variance_rad2 = 1e-6;
  config.loop_s = 10.0;
  const SimulatedRun run = simulate_run(config, 11, 0);
  const auto jacobian = make_filter_under_test("reduced-jacobian", config.landmarks);
  const auto moments = make_filter_under_test("reduced-moments", config.landmarks);
  for (auto* filter : {jacobian.get(), moments.get()}) {
    filter->initialise(run.estimated_start, run.start_covariance);
    for (const auto& step : run.steps) {
      filter->predict(step.odometry);
      if (step.has_update) filter->update(step.sightings, config.observation_sigma_m);
    }
  }
  const PoseEstimate a = jacobian->pose();
  const PoseEstimate b = moments->pose();
  EXPECT_LT((a.pose.position - b.pose.position).norm(), 1e-4);
  EXPECT_LT((a.covariance - b.covariance).cwiseAbs().maxCoeff(),
            1e-3 * a.covariance.cwiseAbs().maxCoeff());
}

TEST(InvariantEkf, KeepsFirstEstimateFiltersCompany) {
  // Two independent ways to keep the unobservable directions: the same NEES to a few percent, where
  // the plain filter is several times off.
  ExperimentConfig config = small_experiment();
  config.simulation.loop_s = 80.0;
  config.simulation.loops = 1;
  config.runs = 4;
  config.filters = {"ri-ekf", "fej-ekf", "dense-ekf"};
  const ExperimentResult result = run_experiment(config, {});
  const double invariant = loop_figures(result, result.filters[0], 0).nees_mean;
  const double first = loop_figures(result, result.filters[1], 0).nees_mean;
  const double plain = loop_figures(result, result.filters[2], 0).nees_mean;
  EXPECT_NEAR(invariant / first, 1.0, 0.05);
  EXPECT_GT(plain, 2.0 * invariant);
}

}  // namespace
}  // namespace cairn::host
