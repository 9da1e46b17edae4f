#include "host_sim/recorded/recorded_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "cairn/numeric/math.hpp"

#include "host_sim/base/statistics.hpp"
#include "host_sim/evaluation/planar_nees.hpp"
#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSamplePeriod = 0.1;
constexpr double kSameInstant = 1e-6;
constexpr double kLargestTruthGap = 0.25;
constexpr double kLargestStep = 1.0;  ///< longer gaps of odometry are integrated in pieces

/// Adds the wall time of its life to `spent_us`.
class Timer {
 public:
  explicit Timer(double& spent_us) : spent_us_(spent_us), start_(Clock::now()) {}
  ~Timer() {
    const std::chrono::duration<double, std::micro> spent = Clock::now() - start_;
    spent_us_ += spent.count();
  }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  double& spent_us_;
  Clock::time_point start_;
};

/// Drives the filter through the merged time line of odometry, scans and samples.
class Runner {
 public:
  Runner(const Recording& recording, const RecordedRunOptions& options)
      : recording_(recording),
        options_(options),
        filter_(make_recorded_filter(options.filter, !recording.known_landmarks)),
        associator_(options.association) {}

  RecordedRun run() {
    start();
    const double end = std::min(
        recording_.end_s, options_.longest_s.value_or(std::numeric_limits<double>::infinity()));
    double sample_t = 0.0;
    while (now_ <= end + kSameInstant) {
      const double next = std::min({next_odometry(), next_scan(), sample_t});
      if (next > end + kSameInstant) break;
      propagate_to(next);
      while (next_odometry() <= now_ + kSameInstant) ++odometry_;
      while (next_scan() <= now_ + kSameInstant) take_scan(recording_.scans[scan_++]);
      if (sample_t <= now_ + kSameInstant) {
        take_sample(sample_t);
        sample_t = static_cast<double>(++sample_count_) * kSamplePeriod;
      }
    }
    run_.landmarks = filter_->landmarks();
    run_.health = filter_->health();
    run_.saturations = filter_->saturations();
    run_.tentative_dropped = associator_.tentative_dropped();
    return run_;
  }

 private:
  void start() {
    RecordedTruth truth;
    Pose2 pose;
    if (recording_.truth_has_heading && truth_at(recording_, 0.0, kLargestTruthGap, truth)) {
      pose.position = truth.position;
      pose.heading = truth.heading;
    }
    GaussianRandom source(stream_seed(options_.seed, 0), kExperimentPhase);
    const auto draw = [&source](const std::optional<double>& variance) {
      const double normal = source.normal();
      return variance ? normal * std::sqrt(*variance) : 0.0;
    };
    pose.position.x() += draw(options_.start_position_variance);
    pose.position.y() += draw(options_.start_position_variance);
    pose.heading = wrap_angle(pose.heading + draw(options_.start_heading_variance));
    const double position = options_.start_position_variance.value_or(kKnownStartVariance);
    const double heading = options_.start_heading_variance.value_or(kKnownStartVariance);
    const Eigen::Matrix3d covariance =
        Eigen::Vector3d(position, position, heading).asDiagonal().toDenseMatrix();
    note(filter_->initialise(pose, covariance, options_.parameters));
  }

  double next_odometry() const {
    return odometry_ + 1 < recording_.odometry.size() ? recording_.odometry[odometry_ + 1].t_s
                                                      : std::numeric_limits<double>::infinity();
  }
  double next_scan() const {
    return scan_ < recording_.scans.size() ? recording_.scans[scan_].t_s
                                           : std::numeric_limits<double>::infinity();
  }

  void propagate_to(double t) {
    const RecordedOdometry& sample = recording_.odometry[odometry_];
    while (t - now_ > kSameInstant) {
      const double dt = std::min(t - now_, kLargestStep);
      Increment increment = twist_increment(sample.speed_mps, sample.turn_radps, dt, 0.0, 0.0,
                                            IncrementModel::kExactArc);
      increment.covariance = dt * sample.density;
      increment.covariance(1, 0) = increment.covariance(0, 1);
      double spent_us = 0.0;
      {
        const Timer timer(spent_us);
        note(filter_->predict(increment));
        if (recording_.slip_density > 0.0) {
          note(filter_->widen_pose(recording_.slip_density * dt, 0.0));
        }
      }
      run_.predict.values_us.push_back(static_cast<float>(spent_us));
      step_.predict_us += spent_us;
      now_ += dt;
    }
    now_ = t;
  }

  void take_scan(const RecordedScan& scan) {
    {
      const Timer timer(step_.scan_us);
      use_scan(scan);
    }
    step_.t_s = scan.t_s;
    step_.sightings = static_cast<int>(scan.sightings.size());
    step_.landmarks = filter_->landmark_count();
    run_.sightings += step_.sightings;
    run_.scan.values_us.push_back(static_cast<float>(step_.scan_us));
    run_.steps.push_back(step_);
    step_ = RecordedStep{};
  }

  void use_scan(const RecordedScan& scan) {
    AssociatedScan associated;
    if (recording_.known_landmarks) {
      for (const auto& sighting : scan.sightings) {
        const auto observation = to_observation(sighting, recording_.noise);
        (filter_->knows(observation.id) ? associated.known : associated.confirmed)
            .push_back(observation);
      }
    } else {
      associated = associator_.associate(scan, recording_, *filter_);
      run_.ambiguous += associated.ambiguous;
    }
    for (auto* list : {&associated.known, &associated.confirmed}) {
      for (auto& observation : *list) {
        observation.sigma_range *= options_.noise_scale;
        observation.sigma_bearing *= options_.noise_scale;
      }
    }
    UpdateReport report;
    if (!associated.known.empty()) {
      note(filter_->update(associated.known, recording_.sensor_offset_m, report));
      run_.nis_sum += report.nis;
      run_.nis_dof += report.nis_dof;
      step_.matches = report.matches;
      step_.used = report.nis_dof / 2;
    }
    for (const auto& observation : associated.confirmed) {
      if (filter_->knows(observation.id)) continue;  // seen twice in its first scan
      Eigen::Vector2d point;
      Eigen::Matrix2d covariance;
      to_point(observation, recording_.sensor_offset_m, point, covariance);
      note(filter_->add_landmark(observation.id, point, covariance, nullptr));
    }
  }

  void take_sample(double t) {
    RecordedSample sample;
    sample.t_s = t;
    sample.pose = filter_->mean_pose();
    RecordedTruth truth;
    if (truth_at(recording_, t, kLargestTruthGap, truth)) {
      sample.truth = truth;
      if (recording_.truth_has_heading) {
        Pose2 true_pose;
        true_pose.position = truth.position;
        true_pose.heading = truth.heading;
        sample.nees = pose_nees(filter_->estimate(), true_pose);
      }
    }
    run_.samples.push_back(sample);
  }

  void note(Status status) {
    if (ok(status)) return;
    ++run_.refused_calls;
    step_.status = status;
  }

  const Recording& recording_;
  const RecordedRunOptions& options_;
  std::unique_ptr<RecordedFilter> filter_;
  Associator associator_;
  RecordedRun run_;
  RecordedStep step_;
  double now_ = 0.0;
  std::size_t odometry_ = 0;
  std::size_t scan_ = 0;
  std::int64_t sample_count_ = 0;
};

double root_mean(double sum, int count) {
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

void map_errors(const Recording& recording, const RecordedRun& run, RecordedErrors& errors) {
  std::vector<Eigen::Vector2d> estimated;
  std::vector<Eigen::Vector2d> real;
  double nees = 0.0;
  for (const auto& landmark : run.landmarks) {
    const auto found = recording.true_landmarks.find(static_cast<int>(landmark.id));
    if (found == recording.true_landmarks.end()) continue;
    estimated.push_back(landmark.position);
    real.push_back(found->second);
    nees += landmark_nees({landmark.position, landmark.covariance}, found->second);
  }
  errors.map_landmarks = static_cast<int>(estimated.size());
  if (estimated.size() < 3 || !recording.known_landmarks) return;
  Eigen::Matrix2d rotation;
  Eigen::Vector2d translation;
  align_se2(estimated, real, rotation, translation);
  double plain = 0.0;
  double aligned = 0.0;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    plain += (estimated[i] - real[i]).squaredNorm();
    aligned += (rotation * estimated[i] + translation - real[i]).squaredNorm();
  }
  errors.map_rmse_m = root_mean(plain, errors.map_landmarks);
  errors.map_aligned_rmse_m = root_mean(aligned, errors.map_landmarks);
  errors.map_nees_mean = nees / errors.map_landmarks;
}

}  // namespace

double StepTimes::mean() const {
  double sum = 0.0;
  for (const float value : values_us) sum += static_cast<double>(value);
  return values_us.empty() ? 0.0 : sum / static_cast<double>(values_us.size());
}

double StepTimes::quantile(double q) const {
  if (values_us.empty()) return 0.0;
  std::vector<float> sorted = values_us;
  std::sort(sorted.begin(), sorted.end());
  const auto last = static_cast<double>(sorted.size() - 1);
  return static_cast<double>(sorted[static_cast<std::size_t>(std::llround(q * last))]);
}

RecordedRun run_recorded(const Recording& recording, const RecordedRunOptions& options) {
  return Runner(recording, options).run();
}

void align_se2(const std::vector<Eigen::Vector2d>& from, const std::vector<Eigen::Vector2d>& to,
               Eigen::Matrix2d& rotation, Eigen::Vector2d& translation) {
  Eigen::Vector2d mean_from = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_to = Eigen::Vector2d::Zero();
  const auto count = static_cast<double>(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    mean_from += from[i] / count;
    mean_to += to[i] / count;
  }
  double cosine = 0.0;
  double sine = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d a = from[i] - mean_from;
    const Eigen::Vector2d b = to[i] - mean_to;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  rotation = rotation2(std::atan2(sine, cosine));
  translation = mean_to - rotation * mean_from;
}

RecordedErrors recorded_errors(const Recording& recording, const RecordedRun& run) {
  const Band band = chi_square_band_95(3);
  RecordedErrors errors;
  std::vector<Eigen::Vector2d> estimated;
  std::vector<Eigen::Vector2d> real;
  double position = 0.0;
  double heading = 0.0;
  int inside = 0;
  for (const auto& sample : run.samples) {
    if (!sample.truth) continue;
    estimated.push_back(sample.pose.position);
    real.push_back(sample.truth->position);
    const double distance = (estimated.back() - real.back()).norm();
    position += distance * distance;
    heading += square(wrap_angle(sample.pose.heading - sample.truth->heading));
    errors.nees_mean += sample.nees;
    if (band.contains(sample.nees)) ++inside;
    errors.final_drift_m = distance;
  }
  errors.samples = static_cast<int>(estimated.size());
  map_errors(recording, run, errors);
  if (errors.samples == 0) return errors;
  errors.position_rmse_m = root_mean(position, errors.samples);
  errors.heading_rmse_rad = root_mean(heading, errors.samples);
  errors.nees_mean /= errors.samples;
  errors.nees_inside_percent = 100.0 * inside / errors.samples;

  Eigen::Matrix2d rotation;
  Eigen::Vector2d translation;
  align_se2(estimated, real, rotation, translation);
  std::vector<double> distances;
  double aligned = 0.0;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    distances.push_back((rotation * estimated[i] + translation - real[i]).norm());
    aligned += distances.back() * distances.back();
  }
  std::sort(distances.begin(), distances.end());
  errors.aligned_rmse_m = root_mean(aligned, errors.samples);
  errors.aligned_median_m = distances[distances.size() / 2];
  errors.aligned_p95_m = distances[distances.size() * 95 / 100];
  return errors;
}

}  // namespace cairn::host
