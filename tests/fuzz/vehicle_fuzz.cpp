// VehicleTracker: calls with arbitrary values in any order, from a cold and a warm start, with and
// without a gyroscope in the place of the wheels' yaw rate.
#include "cairn/numeric/positive_definite.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"
#include "cairn/tracking/gyro_yaw.hpp"

#include "tracker_scene.hpp"

namespace cairn::fuzz {
namespace {

using Filter = GroupIekfSlam<float, SmallConfig::kMaxLandmarks, 3>;
using Tracker = VehicleTracker<SmallConfig, Filter>;

/// The camera looks to the left; the vehicle drives along the wall.
Rigid<float> mount() {
  return {{0.70710678F, -0.70710678F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
}

Tracker::Start still() {
  Tracker::Start start;
  start.covariance = 1e-6F * Matrix3<float>::Identity();
  return start;
}

class Run : TrackerRun<Tracker> {
 public:
  Run() : TrackerRun(kAlways, SmallConfig::kMaxLandmarks) {
    PROMISE(1, ok(tracker_.initialise(test::to_float(scene_camera()), mount(), still(),
                                      Tracker::Parameters())));
    gyro_.reset(GyroParameters(), mount());
  }

  void usual_frame() {
    t_us_ = later(t_us_, kFrameUs);
    OdometrySample sample;
    sample.t_us = t_us_;
    sample.speed_mps = frame_ % kPictures == 0 ? 0.0F : 0.6F;
    add(sample);
    show(picture(frame_++));
  }

  void step(Input& input) {
    switch (input.below(10)) {
      case 0:
      case 1:
        usual_frame();
        break;
      case 2:
        wild_odometry(input);
        break;
      case 3:
        show_odd(input);
        break;
      case 4:
        leap(input);
        usual_frame();
        break;
      case 5:
        change_limit(input, 12000);
        break;
      case 6:
        load_changed_map(tracker_, input);
        break;
      case 7:
        restart(input);
        break;
      case 8:
        rates(input);
        break;
      case 9:
        replaces_turns_ = input.flag();
        break;
    }
    check();
  }

 private:
  void wild_odometry(Input& input) {
    OdometrySample sample;
    sample.t_us = input.flag() ? later(t_us_, 1000) : input.time();
    sample.kind = static_cast<OdometrySample::Kind>(input.below(2));
    sample.speed_mps = input.flag() ? input.wild() : input.number(-3.0F, 3.0F);
    sample.turn = input.flag() ? input.wild() : input.number(-2.0F, 2.0F);
    add(sample);
  }

  /// Samples of a gyroscope: a usual stretch up to the next frame's time, or a wild one.
  void rates(Input& input) {
    AngularRateSample sample;
    const bool wild = input.flag();
    for (int i = 0; i < 3; ++i) sample.rate_radps(i) = input.number(-2.0F, 2.0F);
    const int step_us = input.between(400, 20000);
    for (int k = step_us; k <= kFrameUs; k += step_us) {
      sample.t_us = wild && input.flag() ? input.time() : later(t_us_, k);
      Health counts;
      const NoAllocation none;
      static_cast<void>(gyro_.add(sample, counts));
      if (wild) break;
    }
  }

  void add(OdometrySample sample) {
    if (replaces_turns_) {
      const bool finite = is_finite(sample.turn);
      sample = gyro_.replace(sample, 0.05F);
      PROMISE(4, !finite || is_finite(sample.turn));
      PROMISE(4, is_finite(gyro_.bias_radps()) && gyro_.bias_sigma_radps() >= 0.0F);
    }
    const std::uint64_t before = state_of(tracker_);
    const NoAllocation none;
    const Status status = tracker_.add_odometry(sample);
    const bool refused = status == Status::kNonFiniteInput || status == Status::kInvalidArgument ||
                         status == Status::kTimeBackwards || status == Status::kNotInitialised;
    PROMISE(3, !refused || state_of(tracker_) == before);
  }

  void restart(Input& input) {
    PinholeCamera<float> camera = test::to_float(scene_camera());
    Rigid<float> at = mount();
    Tracker::Start start = still();
    Tracker::Parameters parameters;
    float* const numbers[] = {&camera.fx,
                              &camera.cy,
                              &camera.k1,
                              &at.translation.z(),
                              &at.rotation.w(),
                              &start.pose.heading,
                              &start.pose.position.x(),
                              &start.covariance(0, 0),
                              &start.covariance(1, 2),
                              &parameters.sigma_px,
                              &parameters.odometry.sigma_speed_mps,
                              &parameters.odometry.wheelbase_m,
                              &parameters.filter.gate};
    change(input, numbers);
    start.t_us = input.flag() ? t_us_ : input.time();
    const auto initialise = [&] { return tracker_.initialise(camera, at, start, parameters); };
    if (TrackerRun::restart(parameters, initialise)) t_us_ = start.t_us;
  }

  void check() const {
    const Filter& filter = tracker_.filter();
    const PlanarPose<float> pose = filter.pose();
    PROMISE(4, pose.position.allFinite() && is_finite(pose.heading));
    const Matrix3<float> covariance = filter.pose_covariance();
    PROMISE(4, covariance.allFinite());
    for (int i = 0; i < 3; ++i) PROMISE(5, covariance(i, i) >= 0.0F);
    PROMISE(6, filter.landmark_count() <= SmallConfig::kMaxLandmarks);
    for (int slot = 0; slot < filter.landmark_count(); ++slot) {
      PROMISE(4, filter.landmark_position(slot).allFinite());
      const Matrix3<float> own = filter.landmark_covariance(slot);
      PROMISE(4, own.allFinite());
      for (int i = 0; i < 3; ++i) PROMISE(5, own(i, i) >= 0.0F);
    }
    PROMISE(6, tracker_.library().size() <= SmallConfig::kLibraryLandmarks);
  }

  /// Prediction and plan, which no limit leaves out.
  static constexpr int kAlways = 400;

  GyroYaw gyro_;
  bool replaces_turns_ = false;
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  return run_from_start<Run>(bytes, size, 20, 40);
}
