#include "host_sim/experiments/relocalisation/cut.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/evaluation/trajectory_evaluation.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {
namespace {

struct Recording {
  SourceInfo info;
  std::vector<Frame> frames;
  std::vector<FrameReport> undisturbed;
};

const Frame& frame_at(const Recording& recording, int index) {
  return recording.frames[static_cast<std::size_t>(index)];
}

FrameReport feed(Tracker& tracker, const Frame& frame) {
  FrameReport report;
  cv::Mat overlay = frame.grey.clone();
  static_cast<void>(tracker.process(frame, overlay, report));
  return report;
}

/// What the undisturbed estimate before a trial says of the poses after it: its last pose, moved as
/// the truth moved, in its scale.
struct Expectation {
  double scale = 1.0;  ///< true length of one unit of the estimate
  Rigid<double> last;
  int frame = 0;  ///< of `last`

  double error_m(const Recording& recording, const Rigid<double>& pose, int present) const {
    const Rigid<double> moved = frame_at(recording, frame).true_T_world_camera->inverse() *
                                *frame_at(recording, present).true_T_world_camera;
    const Vector3<double> p = last.translation + last.rotation * (moved.translation / scale);
    return scale * (pose.translation - p).norm();
  }
};

std::optional<Expectation> expectation_before(const Recording& recording, int start) {
  std::vector<Rigid<double>> estimate, truth;
  for (int i = 0; i < start; ++i) {
    const FrameReport& report = recording.undisturbed[static_cast<std::size_t>(i)];
    if (report.state != TrackingState::kTracking) continue;
    estimate.push_back(to_double(report.T_map_camera));
    truth.push_back(*frame_at(recording, i).true_T_world_camera);
  }
  const auto aligned = evaluate_trajectory(estimate, truth, Alignment::kSim3);
  if (!aligned.has_value()) return std::nullopt;
  const FrameReport& last = recording.undisturbed[static_cast<std::size_t>(start - 1)];
  return Expectation{aligned->scale, to_double(last.T_map_camera), start - 1};
}

/// Median distance of a tracker's landmarks from its camera, m.
double median_distance_m(const Tracker& tracker, const FrameReport& report, double scale) {
  std::vector<double> distances;
  for (const MapLandmark& landmark : tracker.landmarks()) {
    distances.push_back((landmark.p_map - report.T_map_camera.translation.cast<double>()).norm() *
                        scale);
  }
  if (distances.empty()) return 1.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

/// Share of what a frame shows, at a depth, that another one showed too; none at another roll.
double shared_view(const Recording& recording, int present, int before, double depth_m) {
  constexpr int kColumns = 8;
  constexpr int kRows = 6;
  constexpr double kMostRoll = 0.5;
  const PinholeCamera<double>& c = recording.info.camera;
  const Rigid<double> T = frame_at(recording, before).true_T_world_camera->inverse() *
                          *frame_at(recording, present).true_T_world_camera;
  const Vector3<double> right = T.rotation * Vector3<double>::UnitX();
  if (std::abs(std::atan2(right.y(), right.x())) > kMostRoll) return 0.0;
  int shared = 0;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const int column = i % kColumns, row = i / kColumns;
    const Vector2<double> pixel(c.width * (column + 0.5) / kColumns,
                                c.height * (row + 0.5) / kRows);
    Vector2<double> seen;
    const Vector3<double> p = T * Vector3<double>(depth_m * c.unproject(pixel));
    shared += ok(c.project(p, seen)) && c.contains(seen) ? 1 : 0;
  }
  return static_cast<double>(shared) / (kColumns * kRows);
}

bool seen_before(const Recording& recording, int present, int start, double depth_m) {
  constexpr int kBack = 200;
  constexpr int kStep = 4;
  for (int i = start - 1; i >= std::max(0, start - kBack); i -= kStep) {
    if (shared_view(recording, present, i, depth_m) >= 0.5) return true;
  }
  return false;
}

/// The frames of a trial: their indices, black ones first as -1.
std::vector<int> frames_of(const CutTrial& trial, const CutSettings& settings, int count) {
  std::vector<int> frames;
  for (int i = 0; i < trial.length && trial.kind != CutKind::kCut; ++i) frames.push_back(-1);
  const int back = trial.start + trial.length;
  for (int i = 0; i < settings.watched; ++i) {
    const int index = trial.kind == CutKind::kReturn ? trial.start - 1 - i : back + i;
    if (index >= 0 && index < count) frames.push_back(index);
  }
  return frames;
}

CutTrial run_trial(const Recording& recording, Tracker& tracker, CutTrial trial,
                   const CutSettings& settings) {
  constexpr int kLasting = 5;
  const auto expected = expectation_before(recording, trial.start);
  const FrameReport& last = recording.undisturbed[static_cast<std::size_t>(trial.start - 1)];
  const double depth_m = median_distance_m(tracker, last, expected ? expected->scale : 1.0);
  const auto step_us = static_cast<std::int64_t>(1e6 / recording.info.frame_rate_hz);
  trial.library = tracker.library_size();
  Frame frame;
  frame.t_us = frame_at(recording, trial.start - 1).t_us;
  if (trial.kind == CutKind::kCut) frame.t_us += trial.length * step_us;
  FrameReport report;
  int good = 0;
  int back = 0;
  int end = trial.start - 1;
  for (const int index : frames_of(trial, settings, static_cast<int>(recording.frames.size()))) {
    frame.t_us += step_us;
    frame.grey = index < 0 ? cv::Mat(cv::Mat::zeros(frame_at(recording, 0).grey.size(), CV_8UC1))
                           : frame_at(recording, index).grey;
    report = feed(tracker, frame);
    trial.said_lost = trial.said_lost || report.state == TrackingState::kLost;
    if (index < 0) continue;
    end = index;
    if (trial.frames_to_seen < 0 && seen_before(recording, index, trial.start, depth_m)) {
      trial.frames_to_seen = back;
    }
    ++back;
    if (report.status != Status::kRepeatedImage) {
      good = report.state == TrackingState::kTracking ? good + 1 : 0;
    }
    if (trial.frames_to_recovery < 0 && good >= kLasting) {
      trial.frames_to_recovery = back - (kLasting - 1);
      if (expected) {
        trial.recovery_error_m =
            expected->error_m(recording, to_double(report.T_map_camera), index);
      }
    }
  }
  trial.tracking = report.state == TrackingState::kTracking;
  if (!expected) return trial;
  trial.error_m = expected->error_m(recording, to_double(report.T_map_camera), end);
  trial.undisturbed_error_m = expected->error_m(
      recording, to_double(recording.undisturbed[static_cast<std::size_t>(end)].T_map_camera), end);
  return trial;
}

std::vector<CutTrial> plan(const CutSettings& settings, int frames) {
  std::vector<CutTrial> trials;
  for (const CutKind kind : kCutKinds) {
    for (const int length : settings.lengths) {
      const int last = kind == CutKind::kReturn ? frames - 1 : frames - length - settings.watched;
      if (last < settings.first_start) {
        throw UsageError("the recording is too short for its trials");
      }
      for (int i = 0; i < settings.trials; ++i) {
        CutTrial trial;
        trial.number = static_cast<int>(trials.size());
        trial.kind = kind;
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

const char* to_string(CutKind kind) {
  switch (kind) {
    case CutKind::kBlack:
      return "black";
    case CutKind::kReturn:
      return "return";
    default:
      return "cut";
  }
}

std::vector<CutTrial> run_cut_trials(FrameSource& source, const CutSettings& settings,
                                     const Shard& shard,
                                     const std::function<void(int, int)>& progress) {
  Recording recording;
  recording.info = source.info();
  Frame frame;
  while (source.next(frame)) {
    recording.frames.push_back(frame);
    recording.frames.back().grey = frame.grey.clone();
  }
  std::vector<CutTrial> trials = plan(settings, static_cast<int>(recording.frames.size()));
  const auto elsewhere_done = [&](const CutTrial& trial) {
    return !shard.has(static_cast<std::size_t>(trial.number));
  };
  trials.erase(std::remove_if(trials.begin(), trials.end(), elsewhere_done), trials.end());
  TrackerOptions options;
  options.mode = Mode::kHandheld;
  options.filter = settings.filter;
  options.seed = settings.seed;
  const std::unique_ptr<Tracker> undisturbed = make_tracker(options, source.info());
  std::vector<std::unique_ptr<Tracker>> copies(trials.size());
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (trials[i].start == static_cast<int>(k)) copies[i] = undisturbed->clone();
    }
    recording.undisturbed.push_back(feed(*undisturbed, recording.frames[k]));
  }
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i] = run_trial(recording, *copies[i], trials[i], settings);
    copies[i].reset();
    progress(static_cast<int>(i + 1), static_cast<int>(trials.size()));
  }
  return trials;
}

}  // namespace cairn::host
