// WindowTracker: frames and a gyroscope's samples with arbitrary values in any order, from a cold
// and a warm start.
#include "cairn/runtime/window_augmentation.hpp"
#include "cairn/runtime/window_tracker.hpp"

#include "drawn_scene.hpp"
#include "tracker_scene.hpp"

namespace cairn::fuzz {
namespace {

using Tracker = WindowTracker<SmallConfig>;

class Run : TrackerRun<Tracker> {
 public:
  Run() : TrackerRun(kAlways, Tracker::kMaxFeatures) {
    PROMISE(1, ok(tracker_.initialise(test::to_float(scene_camera()), Tracker::Parameters())));
  }

  void usual_frame() { show_next(); }
  void dark_frame() { show_dark(); }

  void step(Input& input) {
    const int kind = input.below(kVideoSteps + 4);
    switch (kind - kVideoSteps) {
      case 0:
        wild_sample(input);
        break;
      case 1:
        usual_samples(input);
        break;
      case 2:
        restart(input);
        break;
      case 3:
        draw(input);
        break;
      default:
        video_step(kind, input);
    }
    check();
  }

 private:
  /// Up to the next frame's time, of a gyroscope that turns at a rate of its own.
  void usual_samples(Input& input) {
    AngularRateSample sample;
    for (int i = 0; i < 3; ++i) sample.rate_radps(i) = input.number(-2.0F, 2.0F);
    const int step_us = input.between(400, 20000);
    for (int k = step_us; k <= kFrameUs; k += step_us) {
      sample.t_us = later(t_us_, k);
      add(sample);
    }
  }

  void wild_sample(Input& input) {
    AngularRateSample sample;
    sample.t_us = input.flag() ? later(t_us_, input.between(-50000, 50000)) : input.time();
    for (int i = 0; i < 3; ++i) {
      sample.rate_radps(i) = input.flag() ? input.wild() : input.number(-40.0F, 40.0F);
    }
    add(sample);
  }

  void add(const AngularRateSample& sample) {
    const Before before(tracker_);
    const GyroReport gyro = tracker_.gyro().report();
    const NoAllocation none;
    const Status status = tracker_.add_angular_rate(sample);
    const GyroReport after = tracker_.gyro().report();
    const bool taken = ok(status) || status == Status::kGated;
    PROMISE(3, before.unchanged());
    PROMISE(3, after.samples == gyro.samples + (taken ? 1U : 0U));
    PROMISE(3, after.refused == gyro.refused + (taken ? 0U : 1U));
  }

  void restart(Input& input) {
    PinholeCamera<float> camera = test::to_float(scene_camera());
    Tracker::Parameters parameters;
    float* const numbers[] = {&camera.fx,
                              &camera.cy,
                              &camera.k1,
                              &camera.p2,
                              &parameters.sigma_px,
                              &parameters.window.focal_sigma,
                              &parameters.window.start_gain,
                              &parameters.window.start_margin,
                              &parameters.gyro.R_camera_gyro.w(),
                              &parameters.gyro.noise_density,
                              &parameters.gyro.bias_sigma_radps,
                              &parameters.gyro.time_sigma_s,
                              &parameters.gyro.range_radps,
                              &parameters.readout.row_time_s,
                              &parameters.readout.column_time_s};
    if (input.flag()) parameters.readout.row_time_s = 2e-4F;
    change(input, numbers);
    if (input.byte() > 240) camera.lens = Lens::kFisheye;
    TrackerRun::restart(parameters, [&] { return tracker_.initialise(camera, parameters); });
  }

  void draw(Input& input) {
    ObjectPlacement placement;
    draw_frame(tracker_, tracker_.T_world_camera(), placement, input);
    place_at(tracker_, input);
  }

  void check() const {
    PROMISE(4, good_pose(tracker_.T_world_camera()));
    const Matrix<float, 6, 6>& covariance = tracker_.pose_covariance();
    PROMISE(4, covariance.allFinite());
    for (int i = 0; i < 6; ++i) PROMISE(5, covariance(i, i) >= 0.0F);
    const GyroReport gyro = tracker_.gyro().report();
    PROMISE(4, gyro.bias_radps.allFinite() && is_finite(gyro.bias_sigma_radps));
    PROMISE(4, is_finite(gyro.time_offset_s) && is_finite(gyro.time_offset_sigma_s));
    PROMISE(4, is_finite(gyro.difference) && gyro.products.allFinite());
    const GyroTurn& turn = tracker_.gyro().turn();
    PROMISE(4, turn.rotation.allFinite() && is_finite(turn.variance) && turn.variance >= 0.0F);
    PROMISE(6, tracker_.feature_count() <= Tracker::kMaxFeatures);
    PROMISE(6, tracker_.library().size() <= SmallConfig::kLibraryLandmarks);
    for (int i = 0; i < tracker_.feature_count(); ++i) {
      Vector3<float> at;
      Matrix3<float> own;
      if (!ok(tracker_.feature_position(i, at, own))) continue;
      PROMISE(4, at.allFinite() && own.allFinite());
    }
  }

  /// Prediction, and the searches and poses that no limit leaves out.
  static constexpr int kAlways = 3000;
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  return run_from_start<Run>(bytes, size, kWarmFrames, kTrackerSteps);
}
