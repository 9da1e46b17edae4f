// What judges beside a tracker: health, a gyroscope's calibration, clocks that wrap, low-passed
// odometry.
#include "cairn/base/time.hpp"
#include "cairn/planar/steady_ackermann.hpp"
#include "cairn/runtime/health_monitor.hpp"
#include "cairn/tracking/gyro_calibration.hpp"

#include "fuzz_input.hpp"

namespace cairn::fuzz {
namespace {

constexpr int kSteps = 40;

void try_health(Input& input) {
  HealthMonitor monitor;
  HealthLimits limits;
  if (input.flag()) limits.window_s = input.number(0.1F, 5.0F);
  if (input.flag()) limits.max_position_sigma_m = input.number(0.1F, 5.0F);
  const Status set = monitor.reset(limits);
  PROMISE(1, ok(set) == ok(limits.validate()));
  Health health;
  std::int64_t t_us = 0;
  for (int i = 0; i < kSteps && !input.empty(); ++i) {
    t_us = input.byte() > 20 ? t_us + 33333 : input.time();
    std::uint32_t* const counters[] = {&health.time_errors, &health.images_refused, &health.resets,
                                       &health.losses, &health.covariance_repairs};
    *counters[input.below(5)] += input.byte() > 250 ? input.word() : input.below(3);
    FrameReport report;
    report.t_us = t_us;
    report.state = static_cast<TrackingState>(input.below(4));
    report.matches = input.byte() > 250 ? static_cast<int>(input.word()) : input.below(30);
    report.inliers = input.below(report.matches > 0 && report.matches < 256 ? report.matches : 1);
    report.update.nis = input.number(0.0F, 100.0F);
    report.update.nis_dof = input.below(60);
    PoseSigma sigma;
    sigma.position_m = input.number(0.0F, 1.0F);
    sigma.heading_rad = input.number(0.0F, 0.2F);
    const auto status = input.byte() > 200 ? Status::kTimeBackwards : Status::kOk;
    const NoAllocation none;
    monitor.note(t_us, status, report, health, sigma);
    PROMISE(6, monitor.record_count() >= 0 && monitor.record_count() <= HealthMonitor::kRecords);
    for (int k = 0; k < monitor.record_count(); ++k) {
      PROMISE(1, to_string(monitor.record(k).event) != nullptr);
    }
    PROMISE(1, monitor.healthy() == (monitor.score() < 1.0F));
    t_us = t_us > 0 && t_us < 1000000000000LL ? t_us : 0;
  }
}

void try_calibration(Input& input) {
  GyroCalibration calibration;
  GyroParameters parameters;
  if (input.flag()) parameters.bias_sigma_radps = input.number(1e-4F, 0.1F);
  if (input.flag()) parameters.time_sigma_s = input.number(0.0F, 0.02F);
  if (!ok(parameters.validate())) return;
  calibration.reset(parameters);
  for (int i = 0; i < kSteps && !input.empty(); ++i) {
    GyroTurn turn;
    turn.seconds = 0.001F * static_cast<float>(1 + input.below(100));
    const auto rate = [&] { return 0.02F * static_cast<float>(input.byte()) - 2.56F; };
    const float x = rate();
    const float y = rate();
    turn.rotation = turn.seconds * Vector3<float>(x, y, rate());
    turn.variance = 1e-6F * static_cast<float>(input.byte());
    SeenAttitude seen;
    seen.R_world_camera = rotation_exp(Vector3<float>(rate(), 0.0F, 0.0F));
    seen.variance = 1e-6F * static_cast<float>(input.byte());
    seen.focal_sigma = 1e-3F * static_cast<float>(input.byte());
    seen.lens_sigma = 1e-4F * static_cast<float>(input.byte());
    const NoAllocation none;
    if (input.byte() > 240) {
      calibration.skip();
    } else {
      static_cast<void>(calibration.add(turn, seen));
    }
    calibration.age(turn.seconds);
    PROMISE(4, calibration.bias().allFinite() && is_finite(calibration.time_offset_s()));
    PROMISE(5, calibration.bias_sigma() >= 0.0F && calibration.time_offset_sigma_s() >= 0.0F);
    PROMISE(4, is_finite(calibration.difference()) && calibration.products().allFinite());
    PROMISE(5, calibration.variance_of(turn) >= 0.0F);
  }
}

void try_clock(Input& input) {
  WrappingClock clock;
  std::int64_t newest = clock.extend(input.word());
  for (int i = 0; i < kSteps && !input.empty(); ++i) {
    const std::uint32_t counter =
        input.flag() ? input.word() : static_cast<std::uint32_t>(newest) + input.byte();
    const std::int64_t time = clock.extend(counter);
    PROMISE(1, static_cast<std::uint32_t>(time) == counter);
    PROMISE(1, difference_us(time, newest) < (std::int64_t{1} << 31));
    newest = time > newest ? time : newest;
    static_cast<void>(difference_us(input.time(), input.time()));
  }
}

void try_odometry(Input& input) {
  SteadyAckermann<float> steady(input.byte() > 20 ? 0.5F : 0.0F);
  for (int i = 0; i < kSteps && !input.empty(); ++i) {
    const PlanarIncrement<float> increment = steady.increment(
        input.number(-3.0F, 3.0F), input.number(-0.7F, 0.7F), input.number(0.0F, 0.2F),
        input.number(0.2F, 3.0F), input.number(0.0F, 0.2F), input.number(0.0F, 0.1F));
    if (!ok(validate(increment))) continue;
    PROMISE(4, increment.covariance.allFinite() && is_finite(increment.turn_rad));
    const Displacement<float> moved = displacement(increment);
    PROMISE(4, moved.u.allFinite() && moved.by_turn.allFinite());
  }
}

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  count_allocations();
  Input input(bytes, size);
  switch (input.below(4)) {
    case 0:
      try_health(input);
      break;
    case 1:
      try_calibration(input);
      break;
    case 2:
      try_clock(input);
      break;
    default:
      try_odometry(input);
      break;
  }
  return 0;
}
