// Magnitudes of what the group filter computes with, in double, over simulated and recorded drives:
// what a fixed-point form must hold. A report, not a test:
//   planar_ranges RUNS [lost-in-the-woods:DIR | mrclam:DIR:ROBOT]...

#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "cairn/planar/group_iekf_slam.hpp"

#include "host_sim/experiments/consistency/simulation.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/recorded/association.hpp"
#include "host_sim/recorded/recording.hpp"

namespace {

using namespace cairn;
using namespace cairn::host;

/// Smallest (but for zeros) and largest magnitude of each kind of number.
class Ranges {
 public:
  void add(const std::string& kind, double value) {
    const double size = std::abs(value);
    if (!(size > 0.0)) return;
    auto& range = ranges_.try_emplace(kind, size, size).first->second;
    range.first = std::min(range.first, size);
    range.second = std::max(range.second, size);
  }
  void print(const std::string& name) const {
    for (const auto& [kind, range] : ranges_) {
      fmt::print("{:<18} {:<34} {:>10.2e} {:>10.2e} {:>5.0f} bits\n", name, kind, range.first,
                 range.second, std::log2(range.second / range.first));
    }
  }

 private:
  std::map<std::string, std::pair<double, double>> ranges_;
};

class Filter : public GroupIekfSlam<double, 64> {
 public:
  /// What an update starts from and ends with.
  void note(Ranges& ranges) const {
    const int n = state_size();
    Eigen::MatrixXd P(n, n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) P(i, j) = model_.covariance()(i, j);
    }
    for (int i = 0; i < n; ++i) {
      ranges.add(i == 0 ? "P, variance of the heading" : "P, variance of a position", P(i, i));
      for (int j = 1; j < i; ++j) ranges.add("P, covariance of positions", P(i, j));
    }
    const Eigen::LLT<Eigen::MatrixXd> llt(P);
    if (llt.info() == Eigen::Success) {
      const Eigen::MatrixXd S = llt.matrixL();
      for (int i = 0; i < n; ++i) {
        ranges.add("S, length of a row", S.row(i).norm());
        ranges.add("S, diagonal, share of its row", S(i, i) / S.row(i).norm());
        ranges.add("D of L D L^T", S(i, i) * S(i, i));
        for (int j = 0; j < i; ++j) ranges.add("L of L D L^T", S(i, j) / S(j, j));
      }
    }
    for (int slot = 0; slot < landmark_count(); ++slot) {
      ranges.add("landmark, m from the anchor", mean_landmark(slot).norm());
    }
  }
  void note_sighting(int slot, const Eigen::Matrix2d& R, Ranges& ranges) const {
    const Eigen::Matrix2d relative = relative_landmark_covariance(slot);
    const Eigen::Matrix2d S = relative + R;
    ranges.add("innovation covariance", S(0, 0));
    ranges.add("innovation covariance", S(1, 1));
    const Eigen::Matrix2d gain = relative * S.inverse();
    ranges.add("gain on the sighted landmark", gain(0, 0));
    ranges.add("gain on the sighted landmark", gain(1, 1));
    const int l = 3 + 2 * slot;
    const auto& P = model_.covariance();
    ranges.add("gain on the heading, rad / m", (P(0, l) - P(0, 1)) / S(0, 0));
  }
};

void note_step(const Increment& step, Ranges& ranges) {
  ranges.add("increment, m", step.distance_m);
  ranges.add("increment, rad", step.turn_rad);
  ranges.add("increment, variance m^2", step.covariance(0, 0));
  ranges.add("increment, variance rad^2", step.covariance(1, 1));
}

bool good(Status status) {
  if (!ok(status)) fmt::print("{}\n", to_string(status));
  return ok(status);
}

bool simulated(int runs, double heading_variance) {
  Ranges ranges;
  SimulationConfig config;
  config.heading_variance_rad2 = heading_variance;
  const Eigen::Matrix2d R =
      config.observation_sigma_m * config.observation_sigma_m * Eigen::Matrix2d::Identity();
  PlanarParameters<double> parameters;
  parameters.gate = 1e30;
  parameters.reacquire_after = 0;
  for (int number = 0; number < runs; ++number) {
    const SimulatedRun run = simulate_run(config, 1, number);
    const auto filter = std::make_unique<Filter>();
    if (!good(filter->initialise(run.estimated_start, run.start_covariance, parameters)))
      return false;
    for (const SimulatedStep& step : run.steps) {
      note_step(step.odometry, ranges);
      if (!good(filter->predict(step.odometry))) return false;
      if (!step.has_update) continue;
      std::vector<PointObservation<double>> seen;
      for (const auto& s : step.sightings) {
        seen.push_back({static_cast<LandmarkId>(s.landmark + 1), s.point, R});
        const int slot = filter->find(seen.back().id);
        if (slot >= 0) filter->note_sighting(slot, R, ranges);
      }
      UpdateReport report;
      if (!good(filter->update_points({seen.data(), static_cast<int>(seen.size())}, report))) {
        return false;
      }
      for (const auto& s : seen) {
        if (filter->find(s.id) < 0 && !good(filter->add_landmark(s.id, s.y, s.R))) return false;
      }
      filter->note(ranges);
    }
  }
  ranges.print(fmt::format("simulated, {}", heading_variance));
  return true;
}

bool recorded(const std::string& source) {
  const std::size_t colon = source.find(':');
  const std::string kind = source.substr(0, colon);
  const std::string rest = source.substr(colon + 1);
  const bool mrclam = kind == "mrclam";
  const Recording recording = mrclam ? read_mrclam(rest.substr(0, rest.rfind(':')),
                                                   rest.back() - '0', RecordingProfile::kPlain)
                                     : read_lost_in_the_woods(rest, RecordingProfile::kPlain);
  Ranges ranges;
  const auto filter = std::make_unique<Filter>();
  Pose2 start;
  const Eigen::Matrix3d known = kKnownStartVariance * Eigen::Matrix3d::Identity();
  if (!good(filter->initialise(start, known))) return false;
  std::size_t next = 0;
  for (std::size_t k = 0; k + 1 < recording.odometry.size(); ++k) {
    const RecordedOdometry& sample = recording.odometry[k];
    const double dt = std::min(recording.odometry[k + 1].t_s - sample.t_s, 1.0);
    Increment step = twist_increment(sample.speed_mps, sample.turn_radps, dt, 0.0, 0.0,
                                     IncrementModel::kExactArc);
    step.covariance = dt * sample.density;
    note_step(step, ranges);
    if (!good(filter->predict(step)) ||
        !good(filter->widen_pose(recording.slip_density * dt, 0.0))) {
      return false;
    }
    for (; next < recording.scans.size() &&
           recording.scans[next].t_s <= recording.odometry[k + 1].t_s;
         ++next) {
      std::vector<RangeBearingObservation<double>> seen;
      std::vector<RangeBearingObservation<double>> fresh;
      for (const auto& sighting : recording.scans[next].sightings) {
        const auto o = to_observation(sighting, recording.noise);
        const int slot = filter->find(o.id);
        (slot >= 0 ? seen : fresh).push_back(o);
        Eigen::Vector2d point;
        Eigen::Matrix2d R;
        to_point(o, recording.sensor_offset_m, point, R);
        if (slot >= 0) filter->note_sighting(slot, R, ranges);
      }
      UpdateReport report;
      if (!seen.empty() &&
          !good(filter->update_range_bearing({seen.data(), static_cast<int>(seen.size())},
                                             recording.sensor_offset_m, report))) {
        return false;
      }
      for (const auto& o : fresh) {
        Eigen::Vector2d point;
        Eigen::Matrix2d R;
        to_point(o, recording.sensor_offset_m, point, R);
        if (filter->find(o.id) < 0 && !good(filter->add_landmark(o.id, point, R))) return false;
      }
      if (next % 20 == 0) filter->note(ranges);
    }
  }
  ranges.print(kind);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const int runs = std::atoi(argv[1]);
  bool success = simulated(runs, 0.001) && simulated(runs, 0.03);
  for (int i = 2; i < argc && success; ++i) success = recorded(argv[i]);
  return success ? 0 : 1;
}
