#include <csignal>
#include <cstring>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "cairn/numeric/random.hpp"

#include "host_sim/experiments/faults/fault_classes.hpp"
#include "host_sim/experiments/faults/fault_core.hpp"

namespace cairn::host {
namespace {

constexpr int kWatched = 30;  // one second
constexpr unsigned kLongest_s = 60;

/// What became of one flipped bit; crosses from child to parent as bytes.
struct FlipEnd {
  bool told = false;      ///< a state, a status or a counter says so
  bool harmless = false;  ///< the pose is the undisturbed one within 5 cm
};

template <class Core>
FlipEnd watch(const FaultScene& scene, Core& core, const Vector3<float>& undisturbed) {
  FlipEnd end;
  CoreRun<Core> run(scene, core);
  const Health before = core.health();
  const Health filter_before = core.filter().health();
  const int first = scene.settings().from;
  for (int k = 0; k < kWatched; ++k) {
    const Status status = run.step(first + k);
    end.told = end.told || !ok(status) || run.report().state != TrackingState::kTracking;
  }
  const Health& after = core.health();
  const Health& filter_after = core.filter().health();
  end.told = end.told || after.resets != before.resets ||
             filter_after.covariance_repairs != filter_before.covariance_repairs ||
             filter_after.resets != filter_before.resets ||
             filter_after.innovations_singular != filter_before.innovations_singular;
  end.harmless = (run.report().T_map_camera.translation - undisturbed).norm() < 0.05F;
  return end;
}

/// Runs watch() with bit `bit` of the filter flipped, in a process of its own: a wrong count or
/// pointer may end it.
template <class Core>
int watch_in_child(const FaultScene& scene, const Core& core, std::size_t bit,
                   const Vector3<float>& undisturbed, FlipEnd& end) {
  int channel[2] = {-1, -1};
  if (pipe(channel) != 0) return -1;
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGSEGV, SIG_DFL);
    alarm(kLongest_s);
    const auto copy = std::make_unique<Core>(core);
    // The filter is private to the tracker, its bytes are not: this is what a cosmic ray does.
    auto* object = reinterpret_cast<unsigned char*>(copy.get());
    auto* bytes = object + (reinterpret_cast<const unsigned char*>(&copy->filter()) - object);
    bytes[bit / 8] = static_cast<unsigned char>(bytes[bit / 8] ^ (1U << (bit % 8)));
    const FlipEnd result = watch(scene, *copy, undisturbed);
    const ssize_t written = write(channel[1], &result, sizeof result);
    _exit(written == static_cast<ssize_t>(sizeof result) ? 0 : 1);
  }
  close(channel[1]);
  const bool whole =
      child > 0 && read(channel[0], &end, sizeof end) == static_cast<ssize_t>(sizeof end);
  close(channel[0]);
  int status = 0;
  if (child > 0) waitpid(child, &status, 0);
  return whole ? 0 : 1;
}

template <class Core>
FaultOutcome flips(const FaultScene& scene) {
  const int count = scene.settings().brief ? 24 : 200;
  FaultJudge judge(FaultComponent::kMemory, FaultMode::kGarbage,
                   fmt::format("one bit of the filter flipped, {} times", count),
                   "how many are noticed within 1 s is reported, not promised");
  const auto core = std::make_unique<Core>();
  CoreRun<Core> run(scene, *core);
  static_cast<void>(run.start());
  for (int i = 0; i < scene.settings().from; ++i) static_cast<void>(run.step(i));
  const auto reference = std::make_unique<Core>(*core);
  CoreRun<Core> undisturbed(scene, *reference);
  for (int k = 0; k < kWatched; ++k) static_cast<void>(undisturbed.step(scene.settings().from + k));
  const Vector3<float> pose = undisturbed.report().T_map_camera.translation;
  Random random(scene.settings().seed);
  int told = 0, harmless = 0, ended = 0, silent = 0;
  constexpr auto kBits = static_cast<std::uint32_t>(8 * sizeof(core->filter()));
  for (int i = 0; i < count; ++i) {
    FlipEnd end;
    if (watch_in_child(scene, *core, random.next() % kBits, pose, end) != 0) {
      ++ended;
    } else if (end.told) {
      ++told;
    } else if (end.harmless) {
      ++harmless;
    } else {
      ++silent;
    }
  }
  judge.saw(fmt::format("harmless {}, noticed {}, ended the program {}, silent {}", harmless, told,
                        ended, silent));
  return judge.reported();
}

}  // namespace

FaultOutcomes inject_bit_flips(const FaultScene& scene) {
  FaultJudge judge(FaultComponent::kMemory, FaultMode::kGarbage, "bits flipped in the filter", "-");
  if (scene.rest() < kWatched) return {judge.skipped("the input ends within a second")};
  return with_core<DefaultConfig>(
      scene, [&](auto type) { return FaultOutcomes{flips<typename decltype(type)::Type>(scene)}; });
}

}  // namespace cairn::host
