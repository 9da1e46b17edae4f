// HandheldTracker: calls with arbitrary values in any order, from a cold and a warm start.
#include <algorithm>

#include "cairn/runtime/handheld_tracker.hpp"

#include "tracker_scene.hpp"

namespace cairn::fuzz {
namespace {

using Tracker = HandheldTracker<SmallConfig>;

class Run {
 public:
  Run() {
    PROMISE(1, ok(tracker_.initialise(test::to_float(scene_camera()), Tracker::Parameters())));
  }

  void film(int frames) {
    for (int i = 0; i < frames; ++i) usual_frame();
  }

  void step(Input& input) {
    switch (input.below(7)) {
      case 0:
      case 1:
        usual_frame();
        break;
      case 2:
        frame_ = input.below(kPictures);
        usual_frame();
        break;
      case 3:
        odd_frame(input);
        break;
      case 4:
        t_us_ = later(input.time(), t_us_);
        usual_frame();
        break;
      case 5:
        change_work_limit(tracker_, input, 14000, limit_);
        break;
      case 6:
        input.flag() ? load_changed_map(tracker_, input) : restart(input);
        break;
    }
    check();
  }

 private:
  void usual_frame() {
    t_us_ = later(t_us_, kFrameUs);
    // There and back, so that every step is small.
    const int at = frame_++ % (2 * kPictures - 2);
    process(picture(at < kPictures ? at : 2 * kPictures - 2 - at));
  }

  void odd_frame(Input& input) {
    const OddPicture odd(input);
    if (input.flag()) t_us_ = later(t_us_, kFrameUs);
    process(odd.view());
  }

  void process(const ImageView& image) {
    FrameReport report;
    if (!process_frame(tracker_, image, t_us_, report)) return;
    PROMISE(4, good_pose(report.T_map_camera));
    PROMISE(6, report.work <= std::max(limit_, kAlways));
    PROMISE(6, report.inliers <= report.matches && report.landmarks <= SmallConfig::kMaxFeatures);
  }

  void restart(Input& input) {
    PinholeCamera<float> camera = test::to_float(scene_camera());
    Tracker::Parameters parameters;
    for (int changes = input.below(3); changes > 0; --changes) {
      float* const numbers[] = {&camera.fx,
                                &camera.cy,
                                &camera.k1,
                                &camera.p2,
                                &parameters.filter.sigma_px,
                                &parameters.filter.velocity_noise,
                                &parameters.filter.fading_factor,
                                &parameters.filter.initial_inverse_depth};
      *numbers[input.below(8)] = input.wild();
    }
    const std::uint64_t before = state_of(tracker_);
    const NoAllocation none;
    const Status status = tracker_.initialise(camera, parameters);
    PROMISE(3, ok(status) || state_of(tracker_) == before);
    if (ok(status)) limit_ = parameters.work_limit;
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

  Tracker tracker_;
  std::int64_t t_us_ = 0;
  int frame_ = 0;
  int limit_ = Tracker::Parameters().work_limit;
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  count_allocations();
  static const std::unique_ptr<Run> cold = std::make_unique<Run>();
  static const std::unique_ptr<Run> warm = [] {
    auto run = std::make_unique<Run>();
    run->film(24);
    return run;
  }();
  Input input(bytes, size);
  const auto run = std::make_unique<Run>(input.flag() ? *warm : *cold);
  for (int i = 0; i < 40 && !input.empty(); ++i) run->step(input);
  return 0;
}
