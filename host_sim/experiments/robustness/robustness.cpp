#include "host_sim/experiments/robustness/robustness.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "host_sim/evaluation/trajectory_evaluation.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/running/runner.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {
namespace {

constexpr std::size_t kLeastPoses = 10;
constexpr double kThreeSigmaDof3 = 14.156;  // chi-square, 99.73 %

struct Window {
  int number = 0;
  Playback playback;
  std::size_t first = 0;  ///< index of its first frame
  std::uint64_t seed = 0;
};

std::vector<Window> windows_of(std::size_t frames, const RobustnessSettings& settings) {
  std::vector<Window> windows;
  const auto length = static_cast<std::size_t>(settings.window_frames);
  for (const Playback& playback : settings.playbacks) {
    for (std::size_t first = 0; first + length <= frames;
         first += static_cast<std::size_t>(settings.step_frames)) {
      for (int seed = 1; seed <= settings.seeds; ++seed) {
        windows.push_back(
            {static_cast<int>(windows.size()), playback, first, static_cast<std::uint64_t>(seed)});
      }
    }
  }
  return windows;
}

Rigid<double> to_double(const Rigid<float>& pose) {
  return {pose.rotation.cast<double>().normalized(), pose.translation.cast<double>()};
}

void judge(const RunRecord& record, const RobustnessSettings& settings, bool truth,
           WindowResult& result) {
  const std::size_t count = record.frames.size();
  const std::size_t skipped = count >= 60 ? 30 : 15;
  std::size_t counted = 0, tracked = 0, sure = 0, judged = 0, inside = 0;
  std::vector<Rigid<double>> estimate, reference;
  for (std::size_t i = std::min(skipped, count); i < count; ++i) {
    const FrameRecord& frame = record.frames[i];
    ++counted;
    sure += frame.report.state == TrackingState::kTracking ? 1 : 0;
    if (!frame.has_pose()) continue;
    ++tracked;
    if (frame.nees.has_value()) {
      ++judged;
      inside += *frame.nees <= kThreeSigmaDof3 ? 1 : 0;
    }
    if (!frame.true_T_world_camera.has_value()) continue;
    estimate.push_back(to_double(frame.report.T_map_camera));
    reference.push_back(*frame.true_T_world_camera);
  }
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
  };
  result.tracked = share(tracked, counted);
  result.sure = share(sure, counted);
  if (judged > 0) result.attitude_inside = share(inside, judged);
  if (estimate.size() >= kLeastPoses) {
    if (const auto errors = evaluate_trajectory(estimate, reference, Alignment::kSim3)) {
      result.ate_m = errors->ate_rmse_m;
      result.rotation_deg = errors->rotation_rmse_deg;
    }
  }
  const bool accurate =
      !truth || (result.ate_m.has_value() && *result.ate_m <= settings.max_ate_m &&
                 *result.rotation_deg <= settings.max_rotation_deg);
  result.success = result.tracked >= settings.least_tracked && accurate;
  result.silent = !result.success && result.sure >= settings.least_tracked;
}

/// The work of one thread and the lock around what threads share.
class Worker {
 public:
  Worker(const SourceInfo& info, const std::vector<Frame>& frames,
         const RobustnessSettings& settings, const std::vector<Window>& windows,
         RobustnessResult& result, const std::function<void(int, int)>& progress)
      : info_(info),
        frames_(frames),
        settings_(settings),
        windows_(windows),
        result_(result),
        progress_(progress) {}

  void work() {
    try {
      for (std::size_t next = next_++; next < windows_.size() && !stop_; next = next_++) {
        result_.windows[next] = track(windows_[next]);
        const std::lock_guard<std::mutex> lock(mutex_);
        ++done_;
        if (progress_) progress_(done_, static_cast<int>(windows_.size()));
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
      if (!error_) error_ = std::current_exception();
    }
  }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  WindowResult track(const Window& window) const {
    const auto begin = frames_.begin() + static_cast<std::ptrdiff_t>(window.first);
    const std::vector<Frame> cut(begin, begin + settings_.window_frames);
    SourceInfo info = info_;
    info.readout = played_readout(info_.readout, window.playback);
    const auto source = make_memory_source(info, play(cut, window.playback));
    TrackerOptions options;
    options.mode = Mode::kHandheld;
    options.filter = settings_.filter;
    options.seed = window.seed;
    const std::unique_ptr<Tracker> tracker = make_tracker(options, info);
    RunnerSettings runner;
    runner.video = false;
    runner.pictures = 0;
    runner.progress = false;
    Frame frame;
    static_cast<void>(source->next(frame));
    const RunRecord record = run_frames(*source, frame, *tracker, runner);
    WindowResult result;
    result.number = window.number;
    result.playback = window.playback;
    result.first_frame = cut.front().number;
    result.frames = static_cast<int>(record.frames.size());
    result.seed = window.seed;
    result.losses = record.health.losses;
    judge(record, settings_, result_.truth, result);
    return result;
  }

  const SourceInfo& info_;
  const std::vector<Frame>& frames_;
  const RobustnessSettings& settings_;
  const std::vector<Window>& windows_;
  RobustnessResult& result_;
  const std::function<void(int, int)>& progress_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  int done_ = 0;
  std::exception_ptr error_;
  std::mutex mutex_;
};

}  // namespace

RobustnessResult measure_robustness(const std::string& name, const SourceInfo& info,
                                    const std::vector<Frame>& frames,
                                    const RobustnessSettings& settings,
                                    const std::function<void(int, int)>& progress) {
  std::vector<Window> windows = windows_of(frames.size(), settings);
  if (windows.empty()) {
    throw InputError(name, fmt::format("expected at least {} frames, one window, found {}",
                                       settings.window_frames, frames.size()));
  }
  RobustnessResult result;
  result.windows_of_all_shards = static_cast<int>(windows.size());
  const auto of_another_shard = [&](const Window& window) {
    return !settings.shard.has(static_cast<std::size_t>(window.number));
  };
  windows.erase(std::remove_if(windows.begin(), windows.end(), of_another_shard), windows.end());
  result.source = name;
  result.truth = std::any_of(frames.begin(), frames.end(), [](const Frame& frame) {
    return frame.true_T_world_camera.has_value();
  });
  result.windows.resize(windows.size());
  Worker worker(info, frames, settings, windows, result, progress);
  const int machine = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int wanted = settings.threads > 0 ? settings.threads : machine;
  std::vector<std::thread> threads;
  for (int i = 1; i < std::min(wanted, static_cast<int>(windows.size())); ++i) {
    threads.emplace_back([&worker] { worker.work(); });
  }
  worker.work();
  for (std::thread& thread : threads) thread.join();
  worker.rethrow();
  return result;
}

}  // namespace cairn::host
