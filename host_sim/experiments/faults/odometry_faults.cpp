#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_scene.hpp"

namespace cairn::host {
namespace {

constexpr const char* kHonest = "never tracking while wrong";

using SampleChange = std::function<void(int k, OdometrySample& sample)>;

Injection on_samples(const SampleChange& change) {
  return [change](int k, FaultStep& step) {
    for (OdometrySample& sample : step.frame.odometry) change(k, sample);
  };
}

/// Readings that the tracker must refuse.
FaultOutcome refused(const FaultScene& scene, const std::string& injected, int length,
                     const SampleChange& change) {
  FaultJudge judge(FaultComponent::kOdometry, FaultMode::kGarbage,
                   fmt::format("{} for {} samples", injected, length),
                   "each refused and counted, the state unchanged; never tracking while wrong");
  int samples = 0;
  const FaultDrive drive = scene.drive(length, on_samples([&](int k, OdometrySample& sample) {
                                         ++samples;
                                         change(k, sample);
                                       }));
  describe(judge, drive);
  expect_honest(judge, drive);
  judge.expect(drive.refused_odometry == samples,
               fmt::format("{} of {} refused", drive.refused_odometry, samples));
  return judge.outcome();
}

FaultOutcome honest(const FaultScene& scene, FaultMode mode, const std::string& injected,
                    const Injection& injection,
                    FaultComponent component = FaultComponent::kOdometry) {
  FaultJudge judge(component, mode, injected + " for 2 s", kHonest);
  const FaultDrive drive = scene.drive(kTwoSeconds, injection);
  describe(judge, drive);
  return expect_honest(judge, drive).outcome();
}

FaultOutcomes skipped(FaultComponent component) {
  return {FaultJudge(component, FaultMode::kOff, "-", "-").skipped("the input has no odometry")};
}

FaultOutcome gyro(const FaultScene& scene) {
  if (!scene.has_gyro()) {
    return FaultJudge(FaultComponent::kGyro, FaultMode::kOff, "-", "-")
        .skipped("the input's odometry has no yaw rate");
  }
  return honest(scene, FaultMode::kWrong, "yaw rate 0.05 rad/s off",
                on_samples([](int, OdometrySample& sample) { sample.turn += 0.05F; }),
                FaultComponent::kGyro);
}

}  // namespace

FaultOutcomes inject_odometry_garbage(const FaultScene& scene) {
  if (!scene.vehicle()) return skipped(FaultComponent::kOdometry);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  constexpr float kDenormal = std::numeric_limits<float>::denorm_min();
  FaultOutcomes outcomes = {
      refused(scene, "speed NaN", 1, [](int, OdometrySample& s) { s.speed_mps = kNan; }),
      refused(scene, "speed NaN", kTwoSeconds, [](int, OdometrySample& s) { s.speed_mps = kNan; }),
      refused(scene, "turn infinite", 10, [](int, OdometrySample& s) { s.turn = kInfinite; }),
      refused(scene, "speed 1e9 m/s", 1, [](int, OdometrySample& s) { s.speed_mps = 1e9F; }),
      refused(scene, "speed 1e38 m/s", 10, [](int, OdometrySample& s) { s.speed_mps = -1e38F; })};
  FaultJudge judge(FaultComponent::kOdometry, FaultMode::kGarbage, "one speed denormal",
                   "taken as 0; never tracking while wrong");
  const FaultDrive drive =
      scene.drive(1, on_samples([](int, OdometrySample& s) { s.speed_mps = kDenormal; }));
  describe(judge, drive);
  outcomes.push_back(expect_honest(judge, drive).outcome());
  return outcomes;
}

FaultOutcomes inject_wrong_odometry(const FaultScene& scene) {
  if (!scene.vehicle()) return skipped(FaultComponent::kOdometry);
  OdometrySample first;
  std::vector<OdometrySample> queue;
  const auto each = [&](FaultMode mode, const char* injected, const SampleChange& change) {
    return honest(scene, mode, injected, on_samples(change));
  };
  FaultOutcomes outcomes = {
      honest(scene, FaultMode::kOff, "no sample",
             [](int, FaultStep& step) { step.frame.odometry.clear(); }),
      each(FaultMode::kStuck, "the same reading",
           [&first](int k, OdometrySample& s) {
             if (k == 0) first = s;
             s.speed_mps = first.speed_mps;
             s.turn = first.turn;
           }),
      each(FaultMode::kStuck, "0 m/s while it drives",
           [](int, OdometrySample& s) { s.speed_mps = 0.0F; }),
      each(FaultMode::kWrong, "speed 20 % too high",
           [](int, OdometrySample& s) { s.speed_mps *= 1.2F; }),
      each(FaultMode::kWrong, "speed with the other sign",
           [](int, OdometrySample& s) { s.speed_mps = -s.speed_mps; }),
      each(FaultMode::kWrong, "speed in km/h", [](int, OdometrySample& s) { s.speed_mps *= 3.6F; }),
      each(FaultMode::kWrong, "turn in degrees", [](int, OdometrySample& s) { s.turn *= 57.3F; }),
      each(FaultMode::kIntermittent, "wheels spin at 3 m/s, half a second",
           [](int k, OdometrySample& s) {
             if (k < 15) s.speed_mps = 3.0F;
           }),
      each(FaultMode::kIntermittent, "each 20th sample 5 m/s",
           [](int k, OdometrySample& s) {
             if (k % 20 == 19) s.speed_mps = 5.0F;
           }),
      honest(scene, FaultMode::kSlow, "one sample in six",
             [](int k, FaultStep& step) {
               if (k % 6 != 5) step.frame.odometry.clear();
             }),
      each(FaultMode::kDelayed, "readings 200 ms late under new stamps",
           [&queue](int, OdometrySample& s) {
             queue.push_back(s);
             const OdometrySample& late = queue[queue.size() > 6 ? queue.size() - 7 : 0];
             s.speed_mps = late.speed_mps;
             s.turn = late.turn;
           })};
  outcomes.push_back(gyro(scene));
  return outcomes;
}

}  // namespace cairn::host
