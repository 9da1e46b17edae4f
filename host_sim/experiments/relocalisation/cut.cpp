#include "host_sim/experiments/relocalisation/cut.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/evaluation/trajectory_evaluation.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/replay/core_trackers.hpp"

namespace cairn::host {
namespace {

using Tracker = HandheldTracker<DefaultConfig>;

FrameReport feed(Tracker& tracker, const Frame& frame, const cv::Mat& picture) {
  FrameReport report;
  static_cast<void>(tracker.process_frame(to_view(picture), frame.t_us, TickSource{}, report));
  return report;
}

struct Recording {
  std::vector<Frame> frames;
  std::vector<FrameReport> undisturbed;
};

/// Position error of a pose at a frame, the undisturbed estimate before `start` laid over the
/// truth. Nothing where that is not enough.
std::optional<double> error_m(const Recording& recording, int start, const Rigid<double>& pose,
                              int frame) {
  std::vector<Rigid<double>> estimate, truth;
  for (int i = 0; i < start; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (recording.undisturbed[k].state != TrackingState::kTracking) continue;
    estimate.push_back(to_double(recording.undisturbed[k].T_map_camera));
    truth.push_back(*recording.frames[k].true_T_world_camera);
  }
  const auto aligned = evaluate_trajectory(estimate, truth, Alignment::kSim3);
  if (!aligned.has_value()) return std::nullopt;
  const Rigid<double>& from = estimate.front();
  const Rigid<double>& to = aligned->aligned.front();
  const Quaternion<double> turn = to.rotation * from.rotation.conjugate();
  const Vector3<double> p =
      to.translation + aligned->scale * (turn * (pose.translation - from.translation));
  return (p - recording.frames[static_cast<std::size_t>(frame)].true_T_world_camera->translation)
      .norm();
}

CutTrial run_trial(const Recording& recording, Tracker& tracker, CutTrial trial, int watched) {
  constexpr int kLasting = 5;
  const int back = trial.start + trial.length;
  const int end = std::min(back + watched, static_cast<int>(recording.frames.size()));
  const cv::Mat black = cv::Mat::zeros(recording.frames.front().grey.size(), CV_8UC1);
  trial.library = tracker.library().size();
  FrameReport report;
  int good = 0;
  for (int i = trial.black ? trial.start : back; i < end; ++i) {
    const Frame& frame = recording.frames[static_cast<std::size_t>(i)];
    report = feed(tracker, frame, i < back ? black : frame.grey);
    trial.said_lost = trial.said_lost || report.state == TrackingState::kLost;
    if (i < back) continue;
    good = report.state == TrackingState::kTracking ? good + 1 : 0;
    if (trial.frames_to_recovery < 0 && good >= kLasting) {
      trial.frames_to_recovery = i + 1 - back - (kLasting - 1);
    }
  }
  trial.tracking = report.state == TrackingState::kTracking;
  const auto at = [&](const Rigid<float>& pose) {
    return error_m(recording, trial.start, to_double(pose), end - 1).value_or(0.0);
  };
  trial.error_m = at(report.T_map_camera);
  trial.undisturbed_error_m =
      at(recording.undisturbed[static_cast<std::size_t>(end - 1)].T_map_camera);
  return trial;
}

std::vector<CutTrial> plan(const CutSettings& settings, int frames) {
  std::vector<CutTrial> trials;
  for (const bool black : {false, true}) {
    for (const int length : settings.lengths) {
      const int last = frames - length - settings.watched;
      if (last < settings.first_start) {
        throw UsageError("the recording is too short for its trials");
      }
      for (int i = 0; i < settings.trials; ++i) {
        CutTrial trial;
        trial.black = black;
        trial.length = length;
        trial.start = settings.first_start +
                      (last - settings.first_start) * i / std::max(1, settings.trials - 1);
        trials.push_back(trial);
      }
    }
  }
  return trials;
}

}  // namespace

std::vector<CutTrial> run_cut_trials(FrameSource& source, const CutSettings& settings,
                                     const std::function<void(int, int)>& progress) {
  Recording recording;
  Frame frame;
  while (source.next(frame)) {
    recording.frames.push_back(frame);
    recording.frames.back().grey = frame.grey.clone();
  }
  std::vector<CutTrial> trials = plan(settings, static_cast<int>(recording.frames.size()));
  Tracker::Parameters parameters;
  parameters.seed = settings.seed;
  auto undisturbed = std::make_unique<Tracker>();
  const Status status = undisturbed->initialise(to_float(source.info().camera), parameters);
  if (!ok(status)) throw InputError(source.info().name, "camera refused");
  std::vector<std::unique_ptr<Tracker>> copies(trials.size());
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (trials[i].start == static_cast<int>(k)) {
        copies[i] = std::make_unique<Tracker>(*undisturbed);
      }
    }
    recording.undisturbed.push_back(
        feed(*undisturbed, recording.frames[k], recording.frames[k].grey));
  }
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i] = run_trial(recording, *copies[i], trials[i], settings.watched);
    copies[i].reset();
    progress(static_cast<int>(i + 1), static_cast<int>(trials.size()));
  }
  return trials;
}

}  // namespace cairn::host
