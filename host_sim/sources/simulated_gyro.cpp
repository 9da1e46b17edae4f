#include "host_sim/sources/simulated_gyro.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

constexpr double kLongestStep_s = 0.2;

double seconds(std::int64_t later_us, std::int64_t earlier_us) {
  return 1e-6 * static_cast<double>(later_us - earlier_us);
}

Vector3<double> turn_between(const TimedPose& a, const TimedPose& b) {
  return rotation_log(a.pose.rotation.conjugate() * b.pose.rotation);
}

/// Rates at the poses, in their own axes: mean of the steps around them.
std::vector<Vector3<double>> rates_of(const std::vector<TimedPose>& truth) {
  std::vector<Vector3<double>> rates(truth.size(), Vector3<double>::Zero());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    double time = 0.0;
    for (std::size_t j = i > 0 ? i - 1 : i; j < std::min(i + 1, truth.size() - 1); ++j) {
      const double step = seconds(truth[j + 1].t_us, truth[j].t_us);
      if (step > kLongestStep_s) continue;
      rates[i] += turn_between(truth[j], truth[j + 1]);
      time += step;
    }
    if (time > 0.0) rates[i] /= time;
  }
  return rates;
}

/// Rotation vector from the first pose of a step at a share of it, and its end rates.
Vector3<double> hermite(const Vector3<double>& turn, const Vector3<double>& first,
                        const Vector3<double>& last, double step_s, double share) {
  const double s2 = share * share;
  const double s3 = s2 * share;
  return (s3 - 2.0 * s2 + share) * step_s * first + (-2.0 * s3 + 3.0 * s2) * turn +
         (s3 - s2) * step_s * last;
}

}  // namespace

std::vector<AngularRateSample> simulate_gyro(const std::vector<TimedPose>& truth,
                                             const GyroSimulation& settings) {
  GaussianRandom random(stream_seed(settings.seed, 0x6790U));
  const std::vector<Vector3<double>> rates = rates_of(truth);
  Vector3<double> bias;
  for (int i = 0; i < 3; ++i) bias(i) = random.normal(settings.bias_sigma_radps);
  const double period_s = 1.0 / settings.rate_hz;
  const double noise = settings.noise_density * std::sqrt(settings.rate_hz);
  const double walk = settings.bias_walk * std::sqrt(period_s);
  std::vector<AngularRateSample> samples;
  std::size_t step = 0;
  const auto count =
      static_cast<std::int64_t>(seconds(truth.back().t_us, truth.front().t_us) * settings.rate_hz);
  for (std::int64_t k = 0; k <= count; ++k) {
    const auto t_us = truth.front().t_us + std::llround(1e6 * period_s * static_cast<double>(k));
    Vector3<double> drawn;
    for (int i = 0; i < 3; ++i) {
      bias(i) += random.normal(walk);
      drawn(i) = random.normal(noise);
    }
    while (step + 2 < truth.size() && truth[step + 1].t_us <= t_us) ++step;
    const double step_s = seconds(truth[step + 1].t_us, truth[step].t_us);
    if (step_s > kLongestStep_s) continue;
    constexpr double kHalf = 1e-3;  // of the step
    const Vector3<double> turn = turn_between(truth[step], truth[step + 1]);
    const Vector3<double>& first = rates[step];
    const Vector3<double>& last = rates[step + 1];
    const double share = seconds(t_us, truth[step].t_us) / step_s;
    const Vector3<double> before = hermite(turn, first, last, step_s, share - kHalf);
    const Vector3<double> after = hermite(turn, first, last, step_s, share + kHalf);
    const Vector3<double> rate =
        rotation_log(rotation_exp(before).conjugate() * rotation_exp(after)) /
        (2.0 * kHalf * step_s);
    AngularRateSample sample;
    sample.t_us = t_us + std::llround(1e6 * settings.delay_s);
    const Vector3<double> own = settings.R_camera_gyro.conjugate() * rate + bias + drawn;
    for (int i = 0; i < 3; ++i) {
      sample.rate_radps(i) =
          static_cast<float>(std::clamp(own(i), -settings.range_radps, settings.range_radps));
    }
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace cairn::host
