#include <algorithm>
#include <cstring>
#include <new>
#include <vector>

#include <fmt/format.h>

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_core.hpp"
#include "host_sim/experiments/faults/pictures.hpp"

namespace cairn::host {
namespace {

int frames_of(const FaultScene& scene) {
  const int all = static_cast<int>(scene.frames().size());
  return scene.settings().brief ? std::min(all, 90) : all;
}

struct FullMap {
  std::uint64_t hash = 0;
  int most_landmarks = 0;
  int library = 0;
  int most_work = 0;
  Health health;
  std::uint32_t library_replaced = 0;
};

template <class Core>
FullMap fill_map(const FaultScene& scene) {
  FullMap result;
  const auto core = std::make_unique<Core>();
  CoreRun<Core> run(scene, *core);
  if (!ok(run.start())) return result;
  for (int i = 0; i < static_cast<int>(scene.frames().size()); ++i) {
    static_cast<void>(run.step(i));
    result.most_landmarks = std::max(result.most_landmarks, run.report().landmarks);
    result.most_work = std::max(result.most_work, run.report().work);
  }
  result.hash = run.hash();
  result.library = core->library().size();
  result.health = core->health();
  result.library_replaced = core->library_health().landmarks_replaced;
  return result;
}

/// A tick counter that goes on by `step` with every reading.
struct FaultTicks {
  std::uint32_t tick = 0;
  std::uint32_t step = 0;

  TickSource source() {
    return {[](void* opaque) {
              auto* ticks = static_cast<FaultTicks*>(opaque);
              ticks->tick += ticks->step;
              return ticks->tick;
            },
            this};
  }
};

struct Ticked {
  std::uint64_t hash = 0;
  std::uint32_t most_ticks = 0;
};

template <class Core>
Ticked run_with(const FaultScene& scene, const TickSource& ticks) {
  Ticked result;
  const auto core = std::make_unique<Core>();
  CoreRun<Core> run(scene, *core);
  static_cast<void>(run.start());
  for (int i = 0; i < frames_of(scene); ++i) {
    static_cast<void>(run.step(i, ticks));
    for (const std::uint32_t stage : run.report().stage_ticks) {
      result.most_ticks = std::max(result.most_ticks, stage);
    }
  }
  result.hash = run.hash();
  return result;
}

template <class Core>
FaultOutcomes tick_faults(const FaultScene& scene) {
  constexpr std::uint32_t kPlausible = 1000000;  // a stage reads the counter far less often
  FaultTicks usual{0, 7};
  const Ticked plain = run_with<Core>(scene, usual.source());
  const auto against = [&](FaultMode mode, const char* what, const TickSource& ticks,
                           std::uint32_t most) {
    FaultJudge judge(FaultComponent::kTime, mode, what,
                     "the same result to the bit; differences right over the wrap, 0 for unknown");
    const Ticked ticked = run_with<Core>(scene, ticks);
    judge.saw(fmt::format("largest stage {} ticks", ticked.most_ticks));
    judge.expect(ticked.hash == plain.hash, "another result");
    return judge.expect(ticked.most_ticks <= most, "impossible ticks").outcome();
  };
  FaultTicks standing{42, 0};
  FaultTicks wrapping{0xFFFFFF00U, 7};
  FaultTicks slow{0, 7000000};
  return {against(FaultMode::kOff, "no tick counter", TickSource(), 0),
          against(FaultMode::kStuck, "a counter that stands", standing.source(), 0),
          against(FaultMode::kWrong, "a counter that wraps at 2^32", wrapping.source(), kPlausible),
          against(FaultMode::kSlow, "a core that is a million times slower", slow.source(),
                  0xFFFFFFFFU)};
}

template <class Core>
FaultOutcome overwriting(const FaultScene& scene) {
  constexpr std::size_t kGuard = 4096;
  constexpr unsigned char kPattern = 0xA5;
  FaultJudge judge(
      FaultComponent::kMemory, FaultMode::kGarbage,
      "noise, black and odd pictures and wild odometry, guard bytes on both sides",
      "no byte beside the tracker changes (stack guard: port_fault test of the boards)");
  std::vector<unsigned char> memory(sizeof(Core) + 2 * kGuard + alignof(Core), kPattern);
  void* place = memory.data() + kGuard;
  std::size_t room = memory.size() - kGuard;
  std::align(alignof(Core), sizeof(Core), place, room);
  Core* const core = new (place) Core;
  CoreRun<Core> run(scene, *core);
  static_cast<void>(run.start());
  for (int i = 0; i < frames_of(scene); ++i) {
    Frame input = scene.frames()[static_cast<std::size_t>(i)];
    cv::Mat picture = input.grey;
    if (i % 5 == 1) picture = noise(picture, static_cast<std::uint64_t>(i));
    if (i % 7 == 2) picture = flat(picture, 0);
    if (i % 11 == 3) picture = cv::Mat(1, 3, CV_8UC1, {9});
    for (OdometrySample& sample : input.odometry) {
      if (i % 13 == 4) sample.speed_mps = 1e30F;
      if (i % 17 == 5) sample.turn = -1e30F;
    }
    static_cast<void>(run.step(input, picture, TickSource()));
  }
  core->~Core();
  const auto begin = static_cast<std::size_t>(static_cast<unsigned char*>(place) - memory.data());
  int changed = 0;
  for (std::size_t i = 0; i < memory.size(); ++i) {
    if (i >= begin && i < begin + sizeof(Core)) continue;
    if (memory[i] != kPattern) ++changed;
  }
  judge.saw(fmt::format("{} guard bytes changed", changed));
  return judge.expect(changed == 0, "written beside the tracker").outcome();
}

template <class Core>
FaultOutcomes call_order(const FaultScene& scene) {
  FaultOutcomes outcomes;
  const auto fresh = std::make_unique<Core>();
  {
    FaultJudge judge(FaultComponent::kCalls, FaultMode::kWrong,
                     "frame and odometry before initialise", "not_initialised, unchanged");
    const std::uint64_t state = hash_of_state(*fresh);
    CoreRun<Core> run(scene, *fresh);
    const Status frame = run.step(1);
    judge.saw(cairn::to_string(frame));
    judge.expect(frame == Status::kNotInitialised, "not refused");
    outcomes.push_back(judge.expect(hash_of_state(*fresh) == state, "changed").outcome());
  }
  const auto other = std::make_unique<Core>();
  const auto again = std::make_unique<Core>();
  CoreRun<Core> a(scene, *fresh);
  CoreRun<Core> b(scene, *other);
  CoreRun<Core> c(scene, *again);
  static_cast<void>(a.start());
  static_cast<void>(c.start());
  for (int i = 0; i < 10; ++i) static_cast<void>(c.step(i));
  static_cast<void>(b.start());
  static_cast<void>(c.start());
  // Frames of a restarted tracker count from its start: compare the estimates, not the counters.
  bool equal = true;
  for (int i = 0; i < frames_of(scene); ++i) {
    static_cast<void>(a.step(i));
    static_cast<void>(b.step(i));
    static_cast<void>(c.step(i));
    equal = equal && hash_of_state(*fresh) == hash_of_state(*other);
  }
  FaultJudge two(FaultComponent::kCalls, FaultMode::kWrong, "two instances, frame by frame in turn",
                 "both as one alone");
  outcomes.push_back(two.saw(equal ? "equal in every frame" : "they differ")
                         .expect(equal, "one changes the other")
                         .outcome());
  FaultJudge twice(FaultComponent::kCalls, FaultMode::kWrong,
                   "initialise in mid-run, then the drive again", "as started once");
  const bool pose_equal =
      (a.report().T_world_camera.translation - c.report().T_world_camera.translation).isZero(0.05F);
  outcomes.push_back(
      twice.saw(fmt::format("{} landmarks, alone {}", c.report().landmarks, a.report().landmarks))
          .expect(pose_equal && c.report().state == a.report().state, "another pose or state")
          .outcome());
  return outcomes;
}

}  // namespace

FaultOutcomes inject_full_map(const FaultScene& scene) {
  FaultJudge judge(FaultComponent::kMap, FaultMode::kWrong, "a drive with the tiny capacities",
                   "never more landmarks than fit, replaced by rule, work within the limit, twice "
                   "the same");
  const PinholeCamera<double>& camera = scene.info().camera;
  if (camera.width > TinyConfig::kMaxImageWidth || camera.height > TinyConfig::kMaxImageHeight) {
    return {judge.skipped("pictures of at most 320x240 fit the tiny tracker")};
  }
  return with_core<TinyConfig>(scene, [&](auto type) -> FaultOutcomes {
    using Core = typename decltype(type)::Type;
    const FullMap first = fill_map<Core>(scene);
    const FullMap second = fill_map<Core>(scene);
    const int capacity = scene.vehicle() ? TinyConfig::kMaxLandmarks : TinyConfig::kMaxFeatures;
    judge.saw(fmt::format("{} of {} landmarks, library {} of {}, most work {}",
                          first.most_landmarks, capacity, first.library,
                          TinyConfig::kLibraryLandmarks, first.most_work));
    judge.counted(grown_counters(Health(), first.health));
    judge.counted(fmt::format("library landmarks_replaced +{}", first.library_replaced));
    judge.expect(first.hash == second.hash, "not the same twice");
    judge.expect(first.most_landmarks <= capacity, "more than fit");
    judge.expect(first.library <= TinyConfig::kLibraryLandmarks, "library too full");
    judge.expect(first.most_work <= scene.settings().work_limit, "too much work");
    return {judge.outcome()};
  });
}

FaultOutcomes inject_call_order(const FaultScene& scene) {
  return with_core<DefaultConfig>(
      scene, [&](auto type) { return call_order<typename decltype(type)::Type>(scene); });
}

FaultOutcomes inject_tick_wrap(const FaultScene& scene) {
  return with_core<DefaultConfig>(
      scene, [&](auto type) { return tick_faults<typename decltype(type)::Type>(scene); });
}

FaultOutcomes inject_overwriting(const FaultScene& scene) {
  return with_core<DefaultConfig>(scene, [&](auto type) {
    return FaultOutcomes{overwriting<typename decltype(type)::Type>(scene)};
  });
}

}  // namespace cairn::host
