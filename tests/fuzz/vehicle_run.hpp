#pragma once

#include "cairn/runtime/augmentation.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"
#include "cairn/tracking/gyro_yaw.hpp"

#include "drawn_scene.hpp"
#include "tracker_scene.hpp"

namespace cairn::fuzz {

/// The camera looks to the left; the vehicle drives along the wall.
inline Rigid<float> vehicle_mount() {
  return {{0.70710678F, -0.70710678F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
}

/// Calls of a VehicleTracker with arbitrary values in any order, with and without a gyroscope in
/// the place of the wheels' yaw rate.
template <class Filter>
class VehicleRun : TrackerRun<VehicleTracker<SmallConfig, Filter>> {
  using Tracker = VehicleTracker<SmallConfig, Filter>;
  using Base = TrackerRun<Tracker>;
  using Base::frame_;
  using Base::t_us_;
  using Base::tracker_;

 public:
  VehicleRun() : Base(kAlways, SmallConfig::kMaxLandmarks) {
    typename Tracker::Start still;
    still.covariance = 1e-6F * Matrix3<float>::Identity();
    PROMISE(1, ok(tracker_.initialise(test::to_float(scene_camera()), vehicle_mount(), still,
                                      typename Tracker::Parameters())));
    gyro_.reset(GyroParameters(), vehicle_mount());
  }

  void usual_frame() {
    t_us_ = later(t_us_, kFrameUs);
    OdometrySample sample;
    sample.t_us = t_us_;
    sample.speed_mps = frame_ % kPictures == 0 ? 0.0F : 0.6F;
    add(sample);
    Base::show(picture(frame_++));
  }
  void dark_frame() { Base::show_dark(); }

  void step(Input& input) {
    switch (input.below(12)) {
      case 0:
      case 1:
        usual_frame();
        break;
      case 2:
        frame_ = input.below(kPictures);
        usual_frame();
        break;
      case 3:
        wild_odometry(input);
        break;
      case 4:
        Base::show_odd(input);
        break;
      case 5:
        Base::leap(input);
        usual_frame();
        break;
      case 6:
        Base::change_limit(input, 12000);
        break;
      case 7:
        load_changed_map(tracker_, input);
        break;
      case 8:
        restart(input);
        break;
      case 9:
        rates(input);
        break;
      case 10:
        replaces_turns_ = input.flag();
        break;
      case 11:
        draw(input);
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
    const Before before(tracker_);
    const NoAllocation none;
    const Status status = tracker_.add_odometry(sample);
    const bool refused = status == Status::kNonFiniteInput || status == Status::kInvalidArgument ||
                         status == Status::kTimeBackwards || status == Status::kNotInitialised;
    PROMISE(3, !refused || before.unchanged());
  }

  void restart(Input& input) {
    PinholeCamera<float> camera = test::to_float(scene_camera());
    Rigid<float> at = vehicle_mount();
    typename Tracker::Start start;
    start.covariance = 1e-6F * Matrix3<float>::Identity();
    typename Tracker::Parameters parameters;
    if (input.flag()) parameters.filter.tilt = TiltParameters<float>::rover();
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
                              &parameters.filter.gate,
                              &parameters.filter.tilt.sigma_roll_rad,
                              &parameters.filter.tilt.time_constant_s};
    Base::change(input, numbers);
    if (input.byte() > 240) camera.lens = Lens::kFisheye;
    start.t_us = input.flag() ? t_us_ : input.time();
    const auto initialise = [&] { return tracker_.initialise(camera, at, start, parameters); };
    if (Base::restart(parameters, initialise)) t_us_ = start.t_us;
  }

  void draw(Input& input) {
    ObjectPlacement placement;
    for (int i = 0; i < 3; ++i) placement.p_vehicle_object(i) = 0.02F * input.byte() - 1.0F;
    draw_frame(tracker_, tracker_.T_world_camera(), placement, input);
  }

  void check() const {
    const Filter& filter = tracker_.filter();
    const PlanarPose<float> pose = filter.pose();
    PROMISE(4, pose.position.allFinite() && is_finite(pose.heading));
    check_covariance(filter.pose_covariance());
    check_covariance(tracker_.pose_covariance());
    check_covariance(tracker_.map_pose_covariance());
    check_covariance(tracker_.covariance_in_map());
    PROMISE(4, good_pose(tracker_.T_map_vehicle()) && good_pose(tracker_.T_world_map()));
    PROMISE(6, filter.landmark_count() <= SmallConfig::kMaxLandmarks);
    for (int slot = 0; slot < filter.landmark_count(); ++slot) {
      PROMISE(4, filter.landmark_position(slot).allFinite());
      check_covariance(filter.landmark_covariance(slot));
    }
    PROMISE(6, tracker_.library().size() <= SmallConfig::kLibraryLandmarks);
  }
  static void check_covariance(const Matrix3<float>& covariance) {
    PROMISE(4, covariance.allFinite());
    for (int i = 0; i < 3; ++i) PROMISE(5, covariance(i, i) >= 0.0F);
  }

  /// Prediction and plan, which no limit leaves out.
  static constexpr int kAlways = 400;

  GyroYaw gyro_;
  bool replaces_turns_ = false;
};

}  // namespace cairn::fuzz
