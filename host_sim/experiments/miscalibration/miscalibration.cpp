#include "host_sim/experiments/miscalibration/miscalibration.hpp"

#include <memory>

#include <Eigen/LU>
#include <fmt/format.h>

#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/interruption.hpp"
#include "host_sim/running/mount_run.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {
namespace {

constexpr double kDegree = kPi<double> / 180.0;
constexpr double kOutside = 21.11;  // 99.99 % of 3 degrees of freedom

/// Angle about an axis of the vehicle.
void turn(SourceInfo& told, const Vector3<double>& axis, double angle_rad) {
  Quaternion<double>& rotation = told.T_vehicle_camera.rotation;
  rotation = rotation_exp(Vector3<double>(angle_rad * axis)) * rotation;
}

Miscalibration focal_length(double percent) {
  return {fmt::format("focal length {:+.0f} %", percent), [percent](SourceInfo& told) {
            told.camera.fx *= 1.0 + 0.01 * percent;
            told.camera.fy *= 1.0 + 0.01 * percent;
          }};
}

Miscalibration principal_point(double px) {
  return {fmt::format("principal point {:+.0f} px to the right", px),
          [px](SourceInfo& told) { told.camera.cx += px; }};
}

Miscalibration height(double percent) {
  return {fmt::format("camera height {:+.0f} %", percent), [percent](SourceInfo& told) {
            told.T_vehicle_camera.translation.z() *= 1.0 + 0.01 * percent;
          }};
}

Miscalibration pitch(double degrees) {
  return {fmt::format("pitch {:+.0f} deg", degrees),
          [degrees](SourceInfo& told) { turn(told, Vector3<double>::UnitY(), degrees * kDegree); }};
}

Miscalibration yaw(double degrees) {
  return {fmt::format("yaw {:+.0f} deg", degrees),
          [degrees](SourceInfo& told) { turn(told, Vector3<double>::UnitZ(), degrees * kDegree); }};
}

Miscalibration speed(double percent) {
  return {fmt::format("odometry's speed {:+.0f} %", percent), [](SourceInfo&) {},
          1.0 + 0.01 * percent};
}

double heading_of(const Rigid<double>& pose) {
  const Vector3<double> forward = pose.rotation * Vector3<double>::UnitX();
  return cairn::atan2(forward.y(), forward.x());
}

/// One tracker that was told something wrong.
class Misled {
 public:
  Misled(const Miscalibration& wrong, const SourceInfo& info, const Frame& first,
         std::uint64_t seed)
      : speed_factor_(wrong.speed_factor), start_us_(first.t_us) {
    result_.told = wrong.name;
    SourceInfo told = info;
    wrong.tell(told);
    TrackerOptions options;
    options.seed = seed;
    options.tilt = told.tilt;
    const Rigid<double>& truth = *first.true_T_world_vehicle;
    options.start_x_m = truth.translation.x();
    options.start_y_m = truth.translation.y();
    options.start_theta_rad = heading_of(truth);
    tracker_ = make_tracker(options, told);
  }

  void add(const Frame& frame) {
    Frame shown = frame;
    for (OdometrySample& sample : shown.odometry) {
      sample.speed_mps *= static_cast<float>(speed_factor_);
    }
    frame.grey.copyTo(overlay_);
    FrameReport report;
    static_cast<void>(tracker_->process(shown, overlay_, report));
    ++result_.frames;
    note_claim(report, frame);
    note_suspicion(frame.t_us);
  }

  MiscalibrationResult result() const {
    MiscalibrationResult result = result_;
    if (result.first_s >= 0.0) result.said = say();
    return result;
  }

 private:
  enum class Suspect : std::uint8_t { kMount, kGround, kYawRate };

  void note_claim(const FrameReport& report, const Frame& frame) {
    if (report.state != TrackingState::kTracking || !frame.true_T_world_vehicle) return;
    ++result_.tracked;
    const PlanarPoseEstimate pose = tracker_->vehicle_pose().value();
    const Rigid<double>& truth = *frame.true_T_world_vehicle;
    const Vector3<double> error(pose.x_m - truth.translation.x(), pose.y_m - truth.translation.y(),
                                wrap_angle(pose.theta_rad - heading_of(truth)));
    result_.wrong += error.dot(pose.covariance.inverse() * error) > kOutside ? 1 : 0;
  }

  void note_suspicion(std::int64_t t_us) {
    const MountOffset offset = tracker_->mount_offset().value();
    const bool ground = tracker_->ground()->suspect();
    const bool yaw_rate = tracker_->yaw()->suspect();
    if (!ground && !yaw_rate && !offset.any_suspect()) return;
    ++result_.suspect_frames;
    if (result_.first_s >= 0.0) return;
    result_.first_s = 1e-6 * static_cast<double>(t_us - start_us_);
    suspect_ = ground ? Suspect::kGround : yaw_rate ? Suspect::kYawRate : Suspect::kMount;
    if (suspect_ != Suspect::kMount) return;
    while (!offset.suspect[part_]) part_ = static_cast<MountOffset::Part>(part_ + 1);
  }

  std::string say() const {
    switch (suspect_) {
      case Suspect::kGround:
        return fmt::format("ground {:.2f} heights below",
                           static_cast<double>(tracker_->ground()->ratio()));
      case Suspect::kYawRate:
        return fmt::format("yaw rate {:+.2f} times", static_cast<double>(tracker_->yaw()->ratio()));
      default:
        return describe(tracker_->mount_offset().value(), part_);
    }
  }

  double speed_factor_;
  std::int64_t start_us_;
  std::unique_ptr<Tracker> tracker_;
  cv::Mat overlay_;
  MiscalibrationResult result_;
  Suspect suspect_ = Suspect::kMount;
  MountOffset::Part part_ = MountOffset::kYaw;
};

}  // namespace

const std::vector<Miscalibration>& miscalibrations() {
  static const std::vector<Miscalibration> list = {{"nothing wrong", [](SourceInfo&) {}},
                                                   focal_length(5.0),
                                                   focal_length(-5.0),
                                                   principal_point(20.0),
                                                   principal_point(-20.0),
                                                   height(20.0),
                                                   height(-20.0),
                                                   pitch(2.0),
                                                   pitch(-2.0),
                                                   yaw(5.0),
                                                   yaw(-5.0),
                                                   speed(-20.0),
                                                   speed(20.0)};
  return list;
}

std::vector<MiscalibrationResult> tell_wrongly(FrameSource& source,
                                               const std::vector<Miscalibration>& wrong,
                                               std::uint64_t seed) {
  const SourceInfo& info = source.info();
  if (!info.odometry.has_value()) throw InputError(info.name, "expected a vehicle with odometry");
  std::vector<std::unique_ptr<Misled>> trackers;
  Frame frame;
  while (interrupted() == 0 && source.next(frame)) {
    if (trackers.empty()) {
      if (!frame.true_T_world_vehicle) throw InputError(info.name, "expected a true pose");
      for (const Miscalibration& one : wrong) {
        trackers.push_back(std::make_unique<Misled>(one, info, frame, seed));
      }
    }
    for (const auto& tracker : trackers) tracker->add(frame);
  }
  std::vector<MiscalibrationResult> results;
  for (const auto& tracker : trackers) results.push_back(tracker->result());
  return results;
}

}  // namespace cairn::host
