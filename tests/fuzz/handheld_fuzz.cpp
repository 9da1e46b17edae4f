// HandheldTracker: calls with arbitrary values in any order, from a cold and a warm start.
#include "cairn/runtime/handheld_tracker.hpp"

#include "drawn_scene.hpp"
#include "tracker_scene.hpp"

namespace cairn::fuzz {
namespace {

using Tracker = HandheldTracker<SmallConfig>;

class Run : TrackerRun<Tracker> {
 public:
  Run() : TrackerRun(kAlways, SmallConfig::kMaxFeatures) {
    PROMISE(1, ok(tracker_.initialise(test::to_float(scene_camera()), Tracker::Parameters())));
  }

  void usual_frame() { show_next(); }
  void dark_frame() { show_dark(); }

  void step(Input& input) {
    const int kind = input.below(kVideoSteps + 2);
    switch (kind - kVideoSteps) {
      case 0:
        input.flag() ? load_changed_map(tracker_, input) : restart(input);
        break;
      case 1:
        draw(input);
        break;
      default:
        video_step(kind, input);
    }
    check();
  }

 private:
  void restart(Input& input) {
    PinholeCamera<float> camera = test::to_float(scene_camera());
    Tracker::Parameters parameters;
    float* const numbers[] = {&camera.fx,
                              &camera.cy,
                              &camera.k1,
                              &camera.p2,
                              &parameters.filter.sigma_px,
                              &parameters.filter.velocity_noise,
                              &parameters.filter.fading_factor,
                              &parameters.filter.initial_inverse_depth};
    change(input, numbers);
    TrackerRun::restart(parameters, [&] { return tracker_.initialise(camera, parameters); });
  }

  void draw(Input& input) {
    const Rigid<float> T_map_camera = tracker_.filter().T_world_camera();
    ObjectPlacement placement;
    draw_frame(tracker_, T_map_camera, placement, input);
    place_at(tracker_.filter(), input);
  }

  void check() const {
    const auto& filter = tracker_.filter();
    PROMISE(4, good_pose(filter.T_world_camera()));
    const Matrix<float, 6, 6> covariance = filter.pose_covariance();
    PROMISE(4, covariance.allFinite());
    for (int i = 0; i < 6; ++i) PROMISE(5, covariance(i, i) >= 0.0F);
    PROMISE(6, filter.feature_count() <= SmallConfig::kMaxFeatures);
    PROMISE(6, tracker_.library().size() <= SmallConfig::kLibraryLandmarks);
  }

  static constexpr int kAlways = 400;
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  return run_from_start<Run>(bytes, size, kWarmFrames, kTrackerSteps);
}
