#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/runtime/window_tracker.hpp"

#include "two_walls.hpp"
#include "vga_camera.hpp"

namespace cairn {
namespace {

using Tracker = WindowTracker<TinyConfig>;
using Image = std::vector<std::uint8_t>;

constexpr std::int64_t kStepUs = 33333;
constexpr std::int64_t kSampleUs = 5000;
constexpr double kSwing_rad = 0.16;
constexpr double kSwing_hz = 1.2;

double seconds(std::int64_t t_us) {
  return 1e-6 * static_cast<double>(t_us);
}

/// A camera that walks along two walls and swings about its y axis.
double swing(double t_s) {
  double sine = 0.0;
  double cosine = 0.0;
  sin_cos(2.0 * kPi<double> * kSwing_hz * t_s, sine, cosine);
  return kSwing_rad * sine;
}
double swing_rate(double t_s) {
  double sine = 0.0;
  double cosine = 0.0;
  sin_cos(2.0 * kPi<double> * kSwing_hz * t_s, sine, cosine);
  return 2.0 * kPi<double> * kSwing_hz * kSwing_rad * cosine;
}
Rigid<double> pose_of(int k) {
  const double t = 0.002 * k;
  return {rotation_exp(Vector3<double>(0.0, swing(seconds(k * kStepUs)), 0.0)), {-4 * t, t, 0}};
}
const Image& walls(int k) {
  static std::vector<Image> images;
  while (static_cast<int>(images.size()) <= k) {
    images.push_back(test::render_two_walls(pose_of(static_cast<int>(images.size()))));
  }
  return images[static_cast<std::size_t>(k)];
}

struct Walk {
  std::unique_ptr<Tracker> tracker = std::make_unique<Tracker>();
  FrameReport report;
  std::int64_t next_us = 0;
  float sign = 1.0F;  ///< of the samples

  Walk() { EXPECT_TRUE(ok(tracker->initialise(test::to_float(test::small_camera()), {}))); }
  void sense(int k) {
    for (; next_us <= k * kStepUs; next_us += kSampleUs) {
      const auto rate = static_cast<float>(swing_rate(seconds(next_us)));
      EXPECT_TRUE(ok(tracker->add_angular_rate({next_us, {0.0F, sign * rate, 0.0F}})));
    }
  }
  void show(const Image& image, int k) {
    static_cast<void>(tracker->process_frame(test::view(image, test::small_camera()), k * kStepUs,
                                             TickSource{}, report));
  }
  std::uint64_t hash() const {
    Hash64 hash;
    tracker->hash(hash);
    return hash.value();
  }
  float attitude_error(int k) const {
    const Quaternion<double> truth = pose_of(0).rotation.conjugate() * pose_of(k).rotation;
    const Quaternion<float> off = report.T_map_camera.rotation.conjugate() * truth.cast<float>();
    return sqrt(rotation_log(off).squaredNorm());
  }
};

TEST(WindowGyro, AgreesAndItsBiasIsFound) {
  Walk run;
  for (int k = 0; k < 60; ++k) {
    run.sense(k);
    run.show(walls(k), k);
    ASSERT_NE(run.report.state, TrackingState::kLost) << k;
  }
  const GyroReport gyro = run.tracker->gyro().report();
  EXPECT_EQ(gyro.trust, GyroTrust::kAgrees);
  EXPECT_LT(gyro.difference, 0.1F);
  EXPECT_LT(gyro.bias_sigma_radps, 0.02F);
  EXPECT_LT(gyro.bias_radps.norm(), 3.0F * gyro.bias_sigma_radps);
  EXPECT_LT(run.attitude_error(59), 0.02F);
}

/// WHEN the pictures are black for three frames of a turn, THEN the attitude goes on by the
/// gyroscope, as does the reported covariance; without one it stays behind.
TEST(WindowGyro, CarriesTheAttitudeThroughTheDark) {
  const Image black(walls(0).size(), 0);
  float error[2] = {};
  float variance[2] = {};
  for (const bool with : {false, true}) {
    Walk run;
    int k = 0;
    for (; k < 50; ++k) {
      if (with) run.sense(k);
      run.show(walls(k), k);
    }
    Image dark = black;
    for (; k < 53; ++k) {
      if (with) run.sense(k);
      dark[0] = static_cast<std::uint8_t>(k);  // no picture twice
      run.show(dark, k);
      EXPECT_NE(run.report.state, TrackingState::kTracking);
    }
    error[with ? 1 : 0] = run.attitude_error(52);
    variance[with ? 1 : 0] = run.tracker->pose_covariance()(4, 4);
  }
  EXPECT_GT(error[0], 0.08F);
  EXPECT_LT(error[1], 0.02F);
  EXPECT_GT(variance[0], square(0.08F));
  EXPECT_LT(variance[1], square(0.05F));
}

TEST(WindowGyro, OneThatIsMountedTheOtherWayIsSaidAndNotBelieved) {
  Walk run;
  run.sign = -1.0F;
  for (int k = 0; k < 60; ++k) {
    run.sense(k);
    run.show(walls(k), k);
  }
  EXPECT_EQ(run.tracker->gyro().report().trust, GyroTrust::kContradicted);
  EXPECT_GT(run.tracker->gyro().report().difference, 2.0F);
  EXPECT_NE(run.report.state, TrackingState::kLost);
  EXPECT_LT(run.attitude_error(59), 0.03F);
}

TEST(WindowGyro, SamplesThatAreRefusedChangeNothing) {
  Walk with;
  Walk without;
  for (int k = 0; k < 20; ++k) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(with.tracker->add_angular_rate({k * kStepUs, {nan, 0.0F, 0.0F}}),
              Status::kNonFiniteInput);
    with.show(walls(k), k);
    without.show(walls(k), k);
    ASSERT_EQ(with.hash(), without.hash()) << k;
  }
  EXPECT_EQ(with.tracker->health().non_finite_inputs, 20U);
}

/// Stamps of another clock do not disturb the frames.
TEST(WindowGyro, SamplesOfAnotherClockAreOfNoUse) {
  Walk with;
  Walk without;
  for (int k = 0; k < 30; ++k) {
    for (int i = 0; i < 6; ++i) {
      EXPECT_TRUE(ok(with.tracker->add_angular_rate(
          {1700000000000000 + k * kStepUs + i * kSampleUs, {0.0F, 3.0F, 0.0F}})));
    }
    with.show(walls(k), k);
    without.show(walls(k), k);
    ASSERT_EQ(with.hash(), without.hash()) << k;
  }
  EXPECT_EQ(with.tracker->gyro().report().trust, GyroTrust::kUnproven);
}

TEST(WindowGyro, RefusesSamplesBeforeItIsInitialisedAndBadParameters) {
  const auto tracker = std::make_unique<Tracker>();
  EXPECT_EQ(tracker->add_angular_rate({}), Status::kNotInitialised);
  Tracker::Parameters parameters;
  parameters.gyro.noise_density = -1.0F;
  EXPECT_EQ(tracker->initialise(test::to_float(test::small_camera()), parameters),
            Status::kBadConfig);
}

}  // namespace
}  // namespace cairn
