#include "host_sim/trackers/vehicle_adapter.hpp"

#include <fmt/format.h>

#include "cairn/runtime/replay.hpp"
#include "cairn/tracking/gyro_yaw.hpp"

#include "host_sim/replay/core_trackers.hpp"
#include "host_sim/trackers/core_adapter.hpp"
#include "host_sim/trackers/input_log_file.hpp"
#include "host_sim/trackers/landmark_list.hpp"

namespace cairn::host {
namespace {

template <class Filter>
DirectionOfTravel<float> travel_of(const Filter& filter) {
  return filter.travel();
}
template <int MaxLandmarks>
DirectionOfTravel<float> travel_of(const FixedVehicleSlam<MaxLandmarks>& /*filter*/) {
  return {};
}

template <class Config, class Filter>
class VehicleAdapter : public CoreAdapter<VehicleTracker<Config, Filter>> {
 public:
  using Core = VehicleTracker<Config, Filter>;

  VehicleAdapter(const TrackerOptions& options, const SourceInfo& source)
      : CoreAdapter<Core>(kVehicleObjectHeight),
        header_(to_log_header(options, source, 0)),
        travel_sigma_rad_(options.travel_sigma_rad),
        work_limit_(options.work_limit),
        filter_name_(options.filter),
        source_name_(source.name) {
    if (source.gyro) use_gyro(*source.gyro);
    start(0);
  }

  Status process(const Frame& frame, cv::Mat& overlay, FrameReport& report) override {
    if (!started_) {
      // The start pose is that of the first frame: odometry before it is not integrated.
      start(frame.t_us);
      started_ = true;
    }
    Health gyro_health;  // what is refused is counted by the integrator
    for (const AngularRateSample& sample : frame.gyro) {
      static_cast<void>(gyro_.add(sample, gyro_health));
    }
    for (const OdometrySample& sample : frame.odometry) {
      // A refused sample is counted in Health; the frame is tracked all the same.
      static_cast<void>(add_odometry(with_gyro_ ? gyro_.replace(sample, wheels_sigma_) : sample));
    }
    return this->process_frame(frame, overlay, report);
  }

  Status add_odometry(const OdometrySample& sample) override {
    return this->core().add_odometry(sample);
  }
  std::unique_ptr<Tracker> clone() const override {
    return std::make_unique<VehicleAdapter>(*this);
  }

  std::vector<MapLandmark> landmarks() const override { return landmarks_in_map(this->core()); }

  std::vector<LandmarkId> measured() const override {
    std::vector<LandmarkId> ids;
    for (const TrackedLandmark& landmark : this->core().frames().landmarks()) {
      if (landmark.searched && landmark.misses == 0) ids.push_back(landmark.id);
    }
    return ids;
  }
  int landmark_capacity() const override { return Core::kMaxLandmarks; }

  std::optional<PlanarPoseEstimate> vehicle_pose() const override {
    const PlanarPose<float> pose = this->core().filter().pose();
    PlanarPoseEstimate estimate;
    estimate.x_m = static_cast<double>(pose.position.x());
    estimate.y_m = static_cast<double>(pose.position.y());
    estimate.theta_rad = static_cast<double>(pose.heading);
    estimate.covariance = this->core().pose_covariance().template cast<double>();
    estimate.filter_covariance = this->core().filter().pose_covariance().template cast<double>();
    estimate.map_covariance = this->core().map_pose_covariance().template cast<double>();
    estimate.in_map_covariance = this->core().covariance_in_map().template cast<double>();
    return estimate;
  }
  std::optional<Matrix3<double>> position_covariance() const override {
    Matrix3<double> covariance = Matrix3<double>::Zero();
    covariance.topLeftCorner<2, 2>() = this->core()
                                           .filter()
                                           .pose_covariance()
                                           .template topLeftCorner<2, 2>()
                                           .template cast<double>();
    return covariance;
  }
  std::optional<MountOffset> mount_offset() const override { return this->core().mount_offset(); }
  std::optional<GroundCheck> ground() const override { return this->core().ground(); }
  std::optional<YawCheck> yaw() const override { return this->core().yaw(); }
  std::optional<DirectionOfTravel<float>> travel() const override {
    const DirectionOfTravel<float> travel = travel_of(this->core().filter());
    return travel.variance > 0.0F ? std::optional(travel) : std::nullopt;
  }

  nlohmann::json description() const override {
    return {{"mode", "vehicle"},
            {"filter", filter_name_},
            {"max_landmarks", Core::kMaxLandmarks},
            {"tracker_bytes", sizeof(Core)},
            {"filter_bytes", sizeof(Filter)}};
  }

 private:
  /// The yaw rate is the gyroscope's from now on, with its noise.
  void use_gyro(const GyroParameters& gyro) {
    with_gyro_ = true;
    gyro_.reset(gyro, header_.T_vehicle_camera);
    const bool twist = header_.odometry_kind == OdometrySample::Kind::kTwist;
    wheels_sigma_ = twist ? header_.turn_sigma : 0.0F;
    header_.turn_sigma = GyroYaw::sigma_turn(gyro, header_.odometry_period_s);
  }
  /// As a replay of the run's log starts.
  void start(std::int64_t t_us) {
    header_.start_t_us = t_us;
    typename Core::Parameters parameters;
    if (travel_sigma_rad_) {
      parameters.filter.travel_sigma_rad = static_cast<float>(*travel_sigma_rad_);
    }
    const Status status = start_replay(header_, this->core(), parameters);
    if (!ok(status)) {
      throw InputError(source_name_, fmt::format("camera, mounting or odometry noise refused: {}",
                                                 to_string(status)));
    }
    if (work_limit_) static_cast<void>(this->core().set_work_limit(*work_limit_));
  }

  GyroYaw gyro_;
  bool with_gyro_ = false;
  float wheels_sigma_ = 0.0F;  ///< of the wheels' own yaw rate, rad/s a sample
  InputLogHeader header_;
  std::optional<double> travel_sigma_rad_;
  std::optional<int> work_limit_;
  std::string filter_name_;
  std::string source_name_;
  bool started_ = false;
};

template <class Config>
std::unique_ptr<Tracker> make_with_config(const TrackerOptions& options, const SourceInfo& source) {
  constexpr int kMax = Config::kMaxLandmarks;
  if (options.filter == "ekf") {
    return std::make_unique<VehicleAdapter<Config, EkfSlam<float, kMax, 3>>>(options, source);
  }
  if (options.filter == "lifted-iekf") {
    return std::make_unique<VehicleAdapter<Config, LiftedIekfSlam<float, kMax, 3>>>(options,
                                                                                    source);
  }
  if (options.filter == "group-iekf-fixed") {
    return std::make_unique<VehicleAdapter<Config, FixedVehicleSlam<kMax>>>(options, source);
  }
  return std::make_unique<VehicleAdapter<Config, GroupIekfSlam<float, kMax, 3>>>(options, source);
}

}  // namespace

std::unique_ptr<Tracker> make_vehicle_tracker(const TrackerOptions& options,
                                              const SourceInfo& source) {
  return with_config_for(
      source, [&](auto config) { return make_with_config<decltype(config)>(options, source); });
}

}  // namespace cairn::host
