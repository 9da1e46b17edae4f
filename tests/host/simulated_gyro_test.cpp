#include "host_sim/sources/simulated_gyro.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace cairn::host {
namespace {

/// A camera that turns about an axis at a constant rate, 30 poses a second.
std::vector<TimedPose> turning(const Vector3<double>& rate_radps, int poses,
                               std::int64_t step_us = 33333) {
  std::vector<TimedPose> truth(static_cast<std::size_t>(poses));
  for (int k = 0; k < poses; ++k) {
    TimedPose& at = truth[static_cast<std::size_t>(k)];
    at.t_us = 5000000 + k * step_us;
    at.pose.rotation =
        rotation_exp(Vector3<double>(rate_radps * (1e-6 * static_cast<double>(k * step_us))));
  }
  return truth;
}

GyroSimulation perfect() {
  GyroSimulation settings;
  settings.noise_density = settings.bias_sigma_radps = settings.bias_walk = 0.0;
  return settings;
}

TEST(SimulatedGyro, ReadsTheRateInItsOwnAxes) {
  const Vector3<double> rate(0.3, -0.2, 0.5);
  const auto truth = turning(rate, 31);
  const auto samples = simulate_gyro(truth, perfect());
  ASSERT_EQ(samples.size(), 200U);  // 0.99999 s at 200 Hz
  for (std::size_t k = 0; k < samples.size(); ++k) {
    EXPECT_EQ(samples[k].t_us, 5000000 + 5000 * static_cast<std::int64_t>(k));
    EXPECT_LT((samples[k].rate_radps.cast<double>() - rate).norm(), 1e-5) << k;
  }
  GyroSimulation mounted = perfect();
  mounted.R_camera_gyro = rotation_exp(Vector3<double>(0.0, 0.0, 1.5707963267948966));
  // The sensor's x axis is the camera's y axis.
  const Vector3<double> own = simulate_gyro(truth, mounted)[50].rate_radps.cast<double>();
  EXPECT_LT((own - Vector3<double>(-0.2, -0.3, 0.5)).norm(), 1e-5);
}

TEST(SimulatedGyro, SamplesThatAreIntegratedGiveTheTurn) {
  std::vector<TimedPose> truth = turning(Vector3<double>(0.0, 0.0, 0.0), 61);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double t_s = 1e-6 * static_cast<double>(truth[k].t_us - truth[0].t_us);
    truth[k].pose.rotation = rotation_exp(
        Vector3<double>(0.2 * std::sin(5.0 * t_s), 0.3 * (1.0 - std::cos(4.0 * t_s)), 0.1 * t_s));
  }
  GyroSimulation settings = perfect();
  settings.rate_hz = 1000.0;
  const auto samples = simulate_gyro(truth, settings);
  Quaternion<double> turned = truth.front().pose.rotation;
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    const Vector3<double> middle =
        0.5 * (samples[k].rate_radps + samples[k + 1].rate_radps).cast<double>();
    turned = turned * rotation_exp(Vector3<double>(1e-3 * middle));
  }
  // The last sample is within 1 ms of the last pose.
  const Vector3<double> off = rotation_log(turned.conjugate() * truth.back().pose.rotation);
  EXPECT_LT(off.norm(), 3e-3);
}

TEST(SimulatedGyro, HasTheNoiseAndTheBiasThatAreAsked) {
  const auto truth = turning(Vector3<double>(0.0, 0.0, 0.0), 901);
  GyroSimulation noisy = perfect();
  noisy.noise_density = 2e-3;
  double sum = 0.0;
  const auto samples = simulate_gyro(truth, noisy);
  for (const AngularRateSample& sample : samples) {
    sum += sample.rate_radps.cast<double>().squaredNorm();
  }
  const double sigma = std::sqrt(sum / (3.0 * static_cast<double>(samples.size())));
  EXPECT_NEAR(sigma, 2e-3 * std::sqrt(200.0), 0.03 * sigma);

  double squared = 0.0;
  GyroSimulation biased = perfect();
  biased.bias_sigma_radps = 0.02;
  for (biased.seed = 1; biased.seed <= 200; ++biased.seed) {
    const auto of_seed = simulate_gyro(turning(Vector3<double>(0.0, 0.0, 0.0), 3), biased);
    EXPECT_EQ(of_seed.front().rate_radps, of_seed.back().rate_radps);
    squared += of_seed.front().rate_radps.cast<double>().squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squared / 600.0), 0.02, 2e-3);
}

TEST(SimulatedGyro, DelaysClipsAndLeavesGaps) {
  const Vector3<double> fast(0.0, 0.0, 3.0);
  GyroSimulation settings = perfect();
  settings.delay_s = 0.012;
  settings.range_radps = 2.0;
  std::vector<TimedPose> truth = turning(fast, 20);
  const auto samples = simulate_gyro(truth, settings);
  EXPECT_EQ(samples.front().t_us, 5012000);
  for (const AngularRateSample& sample : samples) EXPECT_EQ(sample.rate_radps.z(), 2.0F);

  // A step of 1 s tells no rate.
  for (std::size_t k = 10; k < truth.size(); ++k) truth[k].t_us += 1000000;
  const auto parted = simulate_gyro(truth, perfect());
  for (const AngularRateSample& sample : parted) {
    EXPECT_TRUE(sample.t_us < truth[9].t_us || sample.t_us >= truth[10].t_us) << sample.t_us;
    EXPECT_NEAR(sample.rate_radps.z(), 3.0F, 1e-4F) << sample.t_us;
  }
  EXPECT_TRUE(simulate_gyro(turning(fast, 5, 500000), perfect()).empty());
}

TEST(SimulatedGyro, TheSameSeedGivesTheSameBytes) {
  const auto truth = turning(Vector3<double>(0.1, 0.2, 0.3), 10);
  GyroSimulation settings;
  const auto first = simulate_gyro(truth, settings);
  const auto again = simulate_gyro(truth, settings);
  settings.seed = 2;
  const auto other = simulate_gyro(truth, settings);
  ASSERT_EQ(first.size(), other.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(first[k].rate_radps, again[k].rate_radps);
    EXPECT_NE(first[k].rate_radps, other[k].rate_radps);
  }
}

}  // namespace
}  // namespace cairn::host
