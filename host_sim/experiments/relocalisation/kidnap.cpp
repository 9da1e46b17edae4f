#include "host_sim/experiments/relocalisation/kidnap.hpp"

#include <algorithm>
#include <memory>
#include <random>

#include <Eigen/LU>

#include "cairn/runtime/replay.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/replay/core_trackers.hpp"
#include "host_sim/sources/hall_source.hpp"
#include "host_sim/trackers/input_log_file.hpp"

namespace cairn::host {
namespace {

using Vehicle =
    VehicleTracker<DefaultConfig, GroupIekfSlam<float, DefaultConfig::kMaxLandmarks, 3>>;

constexpr int kLapFrames = 2400;

std::unique_ptr<FrameSource> hall_from(const KidnapSettings& settings, int first, int count) {
  HallOptions options;
  options.width = settings.width;
  options.seed = settings.seed;
  options.first_frame = first;
  options.frame_count = count;
  return make_hall_source(options);
}

void start(Vehicle& tracker, const SourceInfo& info, const Frame& first, std::uint64_t seed) {
  const Rigid<double>& pose = *first.true_T_world_vehicle;
  const Vector3<double> forward = pose.rotation * Vector3<double>::UnitX();
  TrackerOptions options;
  options.seed = seed;
  options.start_x_m = pose.translation.x();
  options.start_y_m = pose.translation.y();
  options.start_theta_rad = cairn::atan2(forward.y(), forward.x());
  static_cast<void>(start_replay(to_log_header(options, info, first.t_us), tracker));
}

FrameReport feed(Vehicle& tracker, const Frame& frame, const cv::Mat& picture) {
  for (const OdometrySample& sample : frame.odometry) {
    static_cast<void>(tracker.add_odometry(sample));
  }
  FrameReport report;
  static_cast<void>(tracker.process_frame(to_view(picture), frame.t_us, TickSource{}, report));
  return report;
}

/// In the map, which both trackers of a trial share.
PlanarPose<double> pose_in_map(const Vehicle& tracker) {
  const Rigid<double> T_map_vehicle = to_double(tracker.T_map_vehicle());
  const Vector3<double> forward = T_map_vehicle.rotation * Vector3<double>::UnitX();
  return {T_map_vehicle.translation.head<2>(), cairn::atan2(forward.y(), forward.x())};
}

double position_error(const Vehicle& tracker, const Frame& frame) {
  const Vector2<double> p = pose_in_map(tracker).position;
  return (p - frame.true_T_world_vehicle->translation.head<2>()).norm();
}

double distance_squared(const Vehicle& a, const Vehicle& b, const Matrix3<double>& more) {
  const PlanarPose<double> pa = pose_in_map(a);
  const PlanarPose<double> pb = pose_in_map(b);
  const Vector3<double> d(pa.position.x() - pb.position.x(), pa.position.y() - pb.position.y(),
                          wrap_angle(pa.heading - pb.heading));
  const Matrix3<double> P = (a.covariance_in_map() + b.covariance_in_map()).cast<double>() + more;
  return d.dot(P.inverse() * d);
}

/// A trial while its frames go by.
struct Running {
  KidnapTrial trial;
  std::unique_ptr<Vehicle> tracker;
  Matrix3<double> open = Matrix3<double>::Zero();  ///< covariance when the picture comes back
  int good = 0;  ///< frames tracked in a row since the picture is back

  bool blind(int frame) const { return frame < trial.start + trial.length; }
  bool over(int frame, int watched) const { return frame >= trial.start + trial.length + watched; }
};

void step(Running& running, int number, const Frame& frame, const cv::Mat& wrong_picture) {
  constexpr int kLasting = 5;
  const bool blind = running.blind(number);
  const FrameReport report = feed(*running.tracker, frame, blind ? wrong_picture : frame.grey);
  if (blind) {
    running.open = running.tracker->covariance_in_map().cast<double>();
    return;
  }
  running.trial.relocalised = running.trial.relocalised || report.relocalised;
  running.good = report.state == TrackingState::kTracking ? running.good + 1 : 0;
  if (running.trial.frames_to_recovery < 0 && running.good >= kLasting) {
    running.trial.frames_to_recovery =
        number + 1 - (running.trial.start + running.trial.length) - (kLasting - 1);
  }
}

std::vector<KidnapTrial> plan(const KidnapSettings& settings) {
  std::mt19937_64 random(settings.seed);
  std::vector<KidnapTrial> trials;
  for (const KidnapKind kind : {KidnapKind::kBlack, KidnapKind::kOtherPlace}) {
    for (const int length : settings.lengths) {
      for (int i = 0; i < settings.trials; ++i) {
        KidnapTrial trial;
        trial.number = static_cast<int>(trials.size());
        trial.kind = kind;
        trial.length = length;
        const auto range =
            static_cast<std::uint64_t>(settings.last_frame - settings.first_frame + 1);
        trial.start = settings.first_frame + static_cast<int>(random() % range);
        trials.push_back(trial);
      }
    }
  }
  return trials;
}

}  // namespace

const char* to_string(KidnapKind kind) {
  return kind == KidnapKind::kBlack ? "black" : "other place";
}

std::vector<KidnapTrial> run_kidnap_trials(const KidnapSettings& settings, const Shard& shard,
                                           const std::function<void(int, int)>& progress) {
  std::vector<KidnapTrial> trials = plan(settings);
  const auto elsewhere_done = [&](const KidnapTrial& trial) {
    return !shard.has(static_cast<std::size_t>(trial.number));
  };
  trials.erase(std::remove_if(trials.begin(), trials.end(), elsewhere_done), trials.end());
  int end = 0;
  for (const KidnapTrial& t : trials)
    end = std::max(end, t.start + t.length + settings.watched + 1);
  const auto source = hall_from(settings, 0, end);
  const auto other = hall_from(settings, kLapFrames / 2 + settings.first_frame, end);
  auto undisturbed = std::make_unique<Vehicle>();
  std::vector<Running> running;
  std::vector<KidnapTrial> done;
  Frame frame;
  Frame elsewhere;
  for (int number = 0; source->next(frame); ++number) {
    if (number == 0) start(*undisturbed, source->info(), frame, settings.seed);
    for (const KidnapTrial& trial : trials) {
      if (trial.start != number) continue;
      running.push_back(
          {trial, std::make_unique<Vehicle>(*undisturbed), Matrix3<double>::Zero(), 0});
    }
    static_cast<void>(feed(*undisturbed, frame, frame.grey));
    const cv::Mat black = cv::Mat::zeros(frame.grey.size(), CV_8UC1);
    if (number >= settings.first_frame && !other->next(elsewhere)) break;
    for (std::size_t i = 0; i < running.size();) {
      Running& r = running[i];
      step(r, number, frame, r.trial.kind == KidnapKind::kBlack ? black : elsewhere.grey);
      if (!r.over(number, settings.watched)) {
        ++i;
        continue;
      }
      r.trial.error_m = position_error(*r.tracker, frame);
      r.trial.undisturbed_error_m = position_error(*undisturbed, frame);
      r.trial.claimed_squared = distance_squared(*r.tracker, *undisturbed, Matrix3<double>::Zero());
      r.trial.jump_squared = distance_squared(*r.tracker, *undisturbed, r.open);
      r.trial.claimed = r.tracker->state() == TrackingState::kTracking;
      done.push_back(r.trial);
      if (i + 1 != running.size()) running[i] = std::move(running.back());
      running.pop_back();
    }
    progress(number + 1, end);
  }
  std::sort(done.begin(), done.end(),
            [](const KidnapTrial& a, const KidnapTrial& b) { return a.number < b.number; });
  return done;
}

}  // namespace cairn::host
