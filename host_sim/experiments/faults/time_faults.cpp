#include <algorithm>

#include <fmt/format.h>

#include "cairn/base/time.hpp"

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_scene.hpp"

namespace cairn::host {
namespace {

constexpr std::int64_t kHour_us = 3600LL * 1000 * 1000;
constexpr int kAll = 1000000;  // to the end of the drive

int count_of(const std::map<std::string, int>& counts, const char* name) {
  const auto found = counts.find(name);
  return found == counts.end() ? 0 : found->second;
}

void shift(FaultStep& step, std::int64_t by_us) {
  step.frame.t_us += by_us;
  for (OdometrySample& sample : step.frame.odometry) sample.t_us += by_us;
}

FaultJudge time_judge(FaultMode mode, const std::string& injected, const std::string& expected) {
  return {FaultComponent::kTime, mode, injected, expected};
}

/// A frame of a wrong stamp among good ones.
FaultOutcome one_wrong_stamp(const FaultScene& scene, const char* what, std::int64_t by_us,
                             bool odometry) {
  FaultJudge judge = time_judge(FaultMode::kWrong, what,
                                "that one refused, the state unchanged, the next one used");
  const FaultDrive drive = scene.drive(1, [=](int /*k*/, FaultStep& step) {
    if (!odometry) step.frame.t_us += by_us;
    if (odometry) {
      for (OdometrySample& sample : step.frame.odometry) sample.t_us += by_us;
    }
  });
  describe(judge, drive);
  expect_honest(judge, drive);
  const int refused = odometry ? drive.refused_odometry : drive.refused;
  judge.expect(refused == 1, fmt::format("{} refused", refused));
  judge.expect(drive.losses == 0, "lost");
  return judge.outcome();
}

/// Every stamp from the fault on is another clock's.
FaultOutcome other_clock(const FaultScene& scene, const char* what, std::int64_t by_us) {
  FaultJudge judge = time_judge(FaultMode::kWrong, what,
                                "taken after at most 5 frames, never tracking while wrong");
  const FaultDrive drive =
      scene.drive(kAll, [by_us](int /*k*/, FaultStep& step) { shift(step, by_us); });
  describe(judge, drive);
  expect_honest(judge, drive);
  judge.expect(drive.refused <= 5, fmt::format("{} frames refused", drive.refused));
  return judge.outcome();
}

/// A counter of 32 bits that wraps half a second after the fault's begin; `extended` by
/// WrappingClock or taken as it is.
FaultOutcome wrapping_counter(const FaultScene& scene, bool extended) {
  const std::int64_t begin = scene.frames()[static_cast<std::size_t>(scene.settings().from)].t_us;
  constexpr std::int64_t kWrap = std::int64_t{1} << 32;
  const std::int64_t offset = kWrap - begin - 500000;
  WrappingClock clock;
  FaultJudge judge = time_judge(
      FaultMode::kWrong,
      extended ? "32-bit microseconds that wrap, extended by WrappingClock"
               : "32-bit microseconds that wrap, as they are",
      extended ? "nothing refused" : "taken after at most 5 frames, never tracking while wrong");
  // The whole drive is on the counter's clock, so that its begin is no jump.
  const int before = std::min(scene.settings().from, 60);
  TrackerOptions options = scene.options();
  start_at(scene.frames()[static_cast<std::size_t>(scene.settings().from - before)], options);
  const std::unique_ptr<Tracker> tracker = make_tracker(options, scene.info());
  const auto on_counter = [&](std::int64_t t_us) {
    const auto counter = static_cast<std::uint32_t>(t_us + offset);
    return extended ? clock.extend(counter) : static_cast<std::int64_t>(counter);
  };
  const FaultDrive drive =
      scene.drive(*tracker, scene.settings().from - before, kAll, [&](int k, FaultStep& step) {
        if (k == 0) step.frame.odometry.clear();
        for (OdometrySample& sample : step.frame.odometry) sample.t_us = on_counter(sample.t_us);
        step.frame.t_us = on_counter(step.frame.t_us);
      });
  describe(judge, drive);
  judge.expect(drive.not_finite == 0 && drive.not_positive == 0, "not finite, positive definite");
  judge.expect(drive.refused <= (extended ? 0 : 5),
               fmt::format("{} frames refused", drive.refused));
  return judge.outcome();
}

}  // namespace

FaultOutcomes inject_frame_order(const FaultScene& scene) {
  FaultOutcomes outcomes;
  {
    FaultJudge judge = time_judge(FaultMode::kStuck, "every frame twice for 1 s",
                                  "the second one duplicate, the state unchanged");
    const FaultDrive drive =
        scene.drive(kOneSecond, [](int /*k*/, FaultStep& step) { step.repeated = true; });
    describe(judge, drive);
    expect_honest(judge, drive);
    judge.expect(count_of(drive.statuses, "duplicate") == kOneSecond, "not all called duplicate");
    judge.expect(drive.losses == 0, "lost");
    outcomes.push_back(judge.outcome());
  }
  const std::vector<Frame>& frames = scene.frames();
  const int from = scene.settings().from;
  {
    FaultJudge judge = time_judge(FaultMode::kWrong, "pairs of frames swapped for 1 s",
                                  "the older one refused as time_backwards, the state unchanged");
    const FaultDrive drive = scene.drive(kOneSecond, [&frames, from](int k, FaultStep& step) {
      const std::vector<OdometrySample> odometry = step.frame.odometry;
      const int other = from + (k % 2 == 0 ? k + 1 : k - 1);
      step.frame = frames[static_cast<std::size_t>(other)];
      step.frame.odometry = odometry;
    });
    describe(judge, drive);
    expect_honest(judge, drive);
    judge.expect(count_of(drive.statuses, "time_backwards") == kOneSecond / 2,
                 "not each older one refused");
    judge.expect(drive.losses == 0, "lost");
    outcomes.push_back(judge.outcome());
  }
  {
    constexpr int kLate = 6;
    FaultJudge judge = time_judge(FaultMode::kDelayed, "frames 200 ms late for 1 s",
                                  "not lost, never tracking while wrong");
    const FaultDrive drive = scene.drive(kOneSecond, [&frames, from](int k, FaultStep& step) {
      const std::vector<OdometrySample> odometry = step.frame.odometry;
      step.dropped = k < kLate;
      step.frame = frames[static_cast<std::size_t>(from + std::max(k - kLate, 0))];
      step.frame.odometry = odometry;
    });
    describe(judge, drive);
    outcomes.push_back(expect_honest(judge, drive).expect(drive.losses == 0, "lost").outcome());
  }
  return outcomes;
}

FaultOutcomes inject_time_jumps(const FaultScene& scene) {
  FaultOutcomes outcomes = {one_wrong_stamp(scene, "one frame's stamp 1 h ahead", kHour_us, false),
                            one_wrong_stamp(scene, "one frame's stamp 1 h back", -kHour_us, false),
                            other_clock(scene, "every stamp 1 h ahead from here on", kHour_us),
                            other_clock(scene, "every stamp 1 h back from here on", -kHour_us),
                            wrapping_counter(scene, true),
                            wrapping_counter(scene, false)};
  if (scene.vehicle()) {
    outcomes.push_back(one_wrong_stamp(scene, "one odometry stamp 1 h ahead", kHour_us, true));
    outcomes.push_back(one_wrong_stamp(scene, "one odometry stamp 1 h back", -kHour_us, true));
  }
  FaultJudge judge = time_judge(FaultMode::kStuck, "the clock stands for 1 s",
                                "every frame refused, the state unchanged; then it goes on");
  const std::int64_t stood =
      scene.frames()[static_cast<std::size_t>(scene.settings().from - 1)].t_us;
  const FaultDrive drive = scene.drive(kOneSecond, [stood](int /*k*/, FaultStep& step) {
    step.frame.t_us = stood;
    for (OdometrySample& sample : step.frame.odometry) sample.t_us = stood;
  });
  describe(judge, drive);
  expect_honest(judge, drive);
  judge.expect(drive.refused == kOneSecond, fmt::format("{} refused", drive.refused));
  outcomes.push_back(judge.outcome());
  return outcomes;
}

}  // namespace cairn::host
