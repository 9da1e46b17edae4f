#include "host_sim/trackers/vehicle_adapter.hpp"

#include <fmt/format.h>

#include "cairn/runtime/replay.hpp"
#include "cairn/tracking/gyro_yaw.hpp"

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/replay/core_trackers.hpp"
#include "host_sim/replay/scene_objects.hpp"
#include "host_sim/trackers/host_ticks.hpp"
#include "host_sim/trackers/input_log_file.hpp"
#include "host_sim/trackers/landmark_list.hpp"
#include "host_sim/trackers/state_hash.hpp"

namespace cairn::host {
namespace {

template <class Config, class Filter>
class VehicleAdapter : public Tracker {
 public:
  using Core = VehicleTracker<Config, Filter>;

  VehicleAdapter(const TrackerOptions& options, const SourceInfo& source)
      : core_(std::make_unique<Core>()),
        header_(to_log_header(options, source, 0)),
        work_limit_(options.work_limit),
        filter_name_(options.filter),
        source_name_(source.name) {
    if (source.gyro) use_gyro(*source.gyro);
    start(0);
  }

  VehicleAdapter(const VehicleAdapter& other)
      : Tracker(other),
        core_(std::make_unique<Core>(*other.core_)),
        gyro_(other.gyro_),
        with_gyro_(other.with_gyro_),
        wheels_sigma_(other.wheels_sigma_),
        header_(other.header_),
        work_limit_(other.work_limit_),
        objects_(other.objects_),
        filter_name_(other.filter_name_),
        source_name_(other.source_name_),
        started_(other.started_) {}
  VehicleAdapter& operator=(const VehicleAdapter&) = delete;

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
    const Status status =
        core_->process_frame(to_view(frame.grey), frame.t_us, host_ticks(), report);
    report.status = status;
    if (report.t_us == frame.t_us) {
      objects_.draw(*core_, to_mutable_view(overlay), host_ticks(), report);
    }
    return status;
  }

  Status add_odometry(const OdometrySample& sample) override { return core_->add_odometry(sample); }
  Status set_work_limit(int units) override { return core_->set_work_limit(units); }
  std::unique_ptr<Tracker> clone() const override {
    return std::make_unique<VehicleAdapter>(*this);
  }
  std::uint64_t state_hash() const override { return hash_of_state(*core_); }

  std::vector<MapLandmark> landmarks() const override { return landmarks_in_map(*core_); }

  std::vector<LandmarkId> measured() const override {
    std::vector<LandmarkId> ids;
    for (const TrackedLandmark& landmark : core_->frames().landmarks()) {
      if (landmark.searched && landmark.misses == 0) ids.push_back(landmark.id);
    }
    return ids;
  }
  int library_size() const override { return core_->library().size(); }

  int landmark_capacity() const override { return Core::kMaxLandmarks; }
  Health health() const override { return core_->health(); }

  std::optional<PlanarPoseEstimate> vehicle_pose() const override {
    const PlanarPose<float> pose = core_->filter().pose();
    PlanarPoseEstimate estimate;
    estimate.x_m = static_cast<double>(pose.position.x());
    estimate.y_m = static_cast<double>(pose.position.y());
    estimate.theta_rad = static_cast<double>(pose.heading);
    estimate.covariance = core_->pose_covariance().template cast<double>();
    estimate.filter_covariance = core_->filter().pose_covariance().template cast<double>();
    estimate.map_covariance = core_->map_pose_covariance().template cast<double>();
    estimate.in_map_covariance = core_->covariance_in_map().template cast<double>();
    return estimate;
  }
  std::optional<Matrix3<double>> position_covariance() const override {
    Matrix3<double> covariance = Matrix3<double>::Zero();
    covariance.topLeftCorner<2, 2>() =
        core_->filter().pose_covariance().template topLeftCorner<2, 2>().template cast<double>();
    return covariance;
  }
  std::optional<MountOffset> mount_offset() const override { return core_->mount_offset(); }
  std::optional<GroundCheck> ground() const override { return core_->ground(); }
  std::optional<YawCheck> yaw() const override { return core_->yaw(); }
  const Augmenter* objects() const override { return &objects_.augmenter(); }

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
    const Status status = start_replay(header_, *core_);
    if (!ok(status)) {
      throw InputError(source_name_, fmt::format("camera, mounting or odometry noise refused: {}",
                                                 to_string(status)));
    }
    if (work_limit_) static_cast<void>(core_->set_work_limit(*work_limit_));
  }

  std::unique_ptr<Core> core_;
  GyroYaw gyro_;
  bool with_gyro_ = false;
  float wheels_sigma_ = 0.0F;  ///< of the wheels' own yaw rate, rad/s a sample
  InputLogHeader header_;
  std::optional<int> work_limit_;
  SceneObjects objects_{kVehicleObjectHeight};
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
  const PinholeCamera<double>& camera = source.camera;
  if (camera.width <= DefaultConfig::kMaxImageWidth &&
      camera.height <= DefaultConfig::kMaxImageHeight) {
    return make_with_config<DefaultConfig>(options, source);
  }
  return make_with_config<LargeConfig>(options, source);
}

}  // namespace cairn::host
