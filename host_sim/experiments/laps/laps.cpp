#include "host_sim/experiments/laps/laps.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <unistd.h>

#include <Eigen/LU>
#include <fmt/format.h>

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/interruption.hpp"

namespace cairn::host {
namespace {

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double pages = 0.0;
  double resident = 0.0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

double heading_of(const Rigid<double>& pose) {
  const Vector3<double> forward = pose.rotation * Vector3<double>::UnitX();
  return cairn::atan2(forward.y(), forward.x());
}

Vector3<double> error_of(double x_m, double y_m, double heading, const Rigid<double>& truth) {
  return {x_m - truth.translation.x(), y_m - truth.translation.y(),
          wrap_angle(heading - heading_of(truth))};
}

/// Sums over the frames of one lap.
class LapSums {
 public:
  LapSums(int lap, const Rigid<double>& T_vehicle_camera)
      : T_camera_vehicle_(T_vehicle_camera.inverse()) {
    result_.lap = lap;
  }

  void add(const FrameReport& report, const PlanarPoseEstimate& pose, const Rigid<double>& truth,
           double ms) {
    ++result_.frames;
    if (report.state == TrackingState::kTracking) ++result_.tracked;
    if (report.state == TrackingState::kLost) ++result_.lost;
    const Rigid<double> reported = to_double(report.T_map_camera) * T_camera_vehicle_;
    const Vector3<double> in_map =
        error_of(reported.translation.x(), reported.translation.y(), heading_of(reported), truth);
    const Vector3<double> in_filter = error_of(pose.x_m, pose.y_m, pose.theta_rad, truth);
    map_squares_ += in_map.head<2>().squaredNorm();
    filter_squares_ += in_filter.head<2>().squaredNorm();
    result_.map_worst_m = std::max(result_.map_worst_m, in_map.head<2>().norm());
    const double nees = in_map.dot(pose.map_covariance.inverse() * in_map);
    nees_ += nees;
    result_.worst_nees = std::max(result_.worst_nees, nees);
    filter_nees_ += in_filter.dot(pose.filter_covariance.inverse() * in_filter);
    sigma_ += std::sqrt(pose.map_covariance(0, 0) + pose.map_covariance(1, 1));
    filter_sigma_ += std::sqrt(pose.filter_covariance(0, 0) + pose.filter_covariance(1, 1));
    ms_ += ms;
  }

  LapResult result(int library) const {
    LapResult result = result_;
    const double n = std::max(1, result_.frames);
    result.map_rms_m = std::sqrt(map_squares_ / n);
    result.filter_rms_m = std::sqrt(filter_squares_ / n);
    result.nees = nees_ / n;
    result.filter_nees = filter_nees_ / n;
    result.sigma_m = sigma_ / n;
    result.filter_sigma_m = filter_sigma_ / n;
    result.frame_ms = ms_ / n;
    result.library = library;
    result.memory_mb = resident_mb();
    return result;
  }

 private:
  Rigid<double> T_camera_vehicle_;
  LapResult result_;
  double map_squares_ = 0.0;
  double filter_squares_ = 0.0;
  double nees_ = 0.0;
  double filter_nees_ = 0.0;
  double sigma_ = 0.0;
  double filter_sigma_ = 0.0;
  double ms_ = 0.0;
};

double processor_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace

std::vector<LapResult> run_laps(FrameSource& source, const TrackerOptions& options,
                                const std::function<void(const LapResult&)>& done) {
  const SourceInfo& info = source.info();
  if (!info.lap_frames.has_value()) throw InputError(info.name, "expected a path of laps");
  const std::unique_ptr<Tracker> tracker = make_tracker(options, info);
  std::vector<LapResult> laps;
  LapSums sums(1, info.T_vehicle_camera);
  Frame frame;
  FrameReport report;
  cv::Mat overlay;
  for (int i = 0; interrupted() == 0 && source.next(frame); ++i) {
    if (i > 0 && i % *info.lap_frames == 0) {
      laps.push_back(sums.result(tracker->library_size()));
      done(laps.back());
      sums = LapSums(static_cast<int>(laps.size()) + 1, info.T_vehicle_camera);
    }
    frame.grey.copyTo(overlay);
    const double before = processor_ms();
    static_cast<void>(tracker->process(frame, overlay, report));
    const double ms = processor_ms() - before;
    const auto pose = tracker->vehicle_pose();
    if (!pose.has_value() || !frame.true_T_world_vehicle.has_value()) {
      throw InputError(info.name, "expected a vehicle whose true pose is known");
    }
    sums.add(report, *pose, *frame.true_T_world_vehicle, ms);
  }
  const LapResult last = sums.result(tracker->library_size());
  if (last.frames == *info.lap_frames) {
    laps.push_back(last);
    done(last);
  }
  return laps;
}

std::string laps_header() {
  return "lap,frames,tracked,lost,map_rms_m,map_worst_m,sigma_m,nees,worst_nees,filter_rms_m,"
         "filter_sigma_m,filter_nees,library,memory_mb,frame_ms\n";
}

std::string laps_row(const LapResult& lap) {
  return fmt::format(
      "{},{},{},{},{:.4f},{:.4f},{:.4f},{:.3f},{:.3f},{:.4f},{:.4f},{:.3f},{},{:.2f},{:.3f}\n",
      lap.lap, lap.frames, lap.tracked, lap.lost, lap.map_rms_m, lap.map_worst_m, lap.sigma_m,
      lap.nees, lap.worst_nees, lap.filter_rms_m, lap.filter_sigma_m, lap.filter_nees, lap.library,
      lap.memory_mb, lap.frame_ms);
}

}  // namespace cairn::host
