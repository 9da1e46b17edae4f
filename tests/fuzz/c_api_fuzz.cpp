// The C interface: its three trackers and its objects, every call with arbitrary values and NULL in
// any order.
#include <algorithm>
#include <vector>

#include "c_calls.hpp"
#include "tracker_scene.hpp"

namespace cairn::fuzz {
namespace {

constexpr int kWidth = SmallConfig::kMaxImageWidth;
constexpr int kHeight = SmallConfig::kMaxImageHeight;
constexpr int kMostLandmarks = CAIRN_WINDOW_MAX_LANDMARKS;

cairn_camera usual_camera() {
  const PinholeCamera<double> scene = scene_camera();
  cairn_camera camera = {};
  camera.fx = static_cast<float>(scene.fx);
  camera.fy = static_cast<float>(scene.fy);
  camera.cx = static_cast<float>(scene.cx);
  camera.cy = static_cast<float>(scene.cy);
  camera.width = kWidth;
  camera.height = kHeight;
  return camera;
}

template <int Count>
void change(Input& input, float* const (&numbers)[Count]) {
  if (input.byte() > 128) *numbers[input.below(Count)] = input.wild();
}

struct Vehicle {
  using Object = cairn_vehicle;
  using Memory = cairn_vehicle_memory;
  static constexpr std::size_t kMapBytes = CAIRN_VEHICLE_MAP_BYTES;

  static cairn_status initialise(Input& input, void* memory, std::size_t bytes, Object** made) {
    const bool usual = input.flag();
    cairn_camera camera = usual_camera();
    cairn_transform mount = {0.70710678F, -0.70710678F, 0.0F, 0.0F, 0.0F, 0.0F, 1.0F};
    cairn_vehicle_start start = {};
    cairn_vehicle_parameters parameters = cairn_vehicle_default_parameters();
    if (usual)
      return cairn_vehicle_initialise(memory, bytes, &camera, &mount, nullptr, nullptr, made);
    float* const numbers[] = {&camera.fx,
                              &camera.k1,
                              &camera.k4,
                              &mount.qw,
                              &mount.z,
                              &start.x_m,
                              &start.heading_rad,
                              &start.position_variance,
                              &parameters.sigma_speed_mps,
                              &parameters.sigma_turn,
                              &parameters.wheelbase_m,
                              &parameters.sample_period_s,
                              &parameters.floor_sigma_m,
                              &parameters.sigma_pitch_rad,
                              &parameters.tilt_time_constant_s};
    change(input, numbers);
    if (input.byte() > 200) parameters.work_limit = static_cast<std::int32_t>(input.word());
    if (input.byte() > 200) parameters.max_step_us = input.time();
    if (input.byte() > 200) start.t_us = input.time();
    return cairn_vehicle_initialise(memory, bytes, input.byte() > 4 ? &camera : nullptr,
                                    input.byte() > 4 ? &mount : nullptr, &start, &parameters, made);
  }
  static cairn_status reset(Input& input, Object* tracker) {
    cairn_vehicle_start start = {};
    start.t_us = input.time();
    start.x_m = input.number(-10.0F, 10.0F);
    start.heading_variance = input.number(0.0F, 0.1F);
    return cairn_vehicle_reset(tracker, input.flag() ? &start : nullptr);
  }
  static void sample(Input& input, Object* tracker, std::int64_t t_us) {
    cairn_odometry sample = {};
    sample.t_us = input.byte() > 20 ? t_us : input.time();
    sample.kind = input.flag() ? CAIRN_TWIST : CAIRN_ACKERMANN;
    sample.speed_mps = input.number(0.0F, 1.2F);
    sample.turn = input.number(-0.5F, 0.5F);
    static_cast<void>(cairn_vehicle_add_odometry(tracker, input.byte() > 2 ? &sample : nullptr));
  }
  static void check(const Object* tracker) {
    cairn_vehicle_pose pose;
    PROMISE(1, cairn_vehicle_get_pose(tracker, &pose) == CAIRN_OK);
    PROMISE(4, is_finite(pose.x_m) && is_finite(pose.y_m) && is_finite(pose.heading_rad));
    for (const int i : {0, 4, 8}) PROMISE(5, pose.covariance[i] >= 0.0F);
  }
};

/// What the trackers of a camera alone have in common.
void check_covariance(cairn_status status, const float (&covariance)[36]) {
  PROMISE(1, status == CAIRN_OK);
  for (const float element : covariance) PROMISE(4, is_finite(element));
  for (int i = 0; i < 6; ++i) PROMISE(5, covariance[7 * i] >= 0.0F);
}

struct Handheld {
  using Object = cairn_handheld;
  using Memory = cairn_handheld_memory;
  static constexpr std::size_t kMapBytes = CAIRN_HANDHELD_MAP_BYTES;

  static cairn_status initialise(Input& input, void* memory, std::size_t bytes, Object** made) {
    cairn_camera camera = usual_camera();
    cairn_handheld_parameters parameters = cairn_handheld_default_parameters();
    if (input.flag()) return cairn_handheld_initialise(memory, bytes, &camera, nullptr, made);
    float* const numbers[] = {&camera.fy,
                              &camera.k2,
                              &parameters.sigma_px,
                              &parameters.least_velocity_noise,
                              &parameters.most_velocity_noise,
                              &parameters.most_rate_noise,
                              &parameters.fading_factor};
    change(input, numbers);
    parameters.estimate_focal_length = input.flag();
    if (input.byte() > 200) parameters.work_limit = static_cast<std::int32_t>(input.word());
    if (input.byte() > 200) parameters.max_step_us = input.time();
    return cairn_handheld_initialise(memory, bytes, input.byte() > 4 ? &camera : nullptr,
                                     &parameters, made);
  }
  static cairn_status reset(Input&, Object* tracker) { return cairn_handheld_reset(tracker); }
  static void sample(Input&, Object*, std::int64_t) {}
  static void check(const Object* tracker) {
    float covariance[36];
    check_covariance(cairn_handheld_get_covariance(tracker, covariance), covariance);
  }
};

struct Window {
  using Object = cairn_window;
  using Memory = cairn_window_memory;
  static constexpr std::size_t kMapBytes = 0;

  static cairn_status initialise(Input& input, void* memory, std::size_t bytes, Object** made) {
    cairn_camera camera = usual_camera();
    cairn_window_parameters parameters = cairn_window_default_parameters();
    if (input.flag()) return cairn_window_initialise(memory, bytes, &camera, nullptr, made);
    float* const numbers[] = {&camera.cx,
                              &camera.p1,
                              &parameters.sigma_px,
                              &parameters.focal_sigma,
                              &parameters.row_time_s,
                              &parameters.column_time_s,
                              &parameters.gyro.qx,
                              &parameters.gyro.noise_density,
                              &parameters.gyro.bias_walk,
                              &parameters.gyro.range_radps};
    change(input, numbers);
    if (input.byte() > 200) parameters.work_limit = static_cast<std::int32_t>(input.word());
    if (input.byte() > 200) parameters.max_step_us = input.time();
    if (input.byte() > 240) camera.lens = CAIRN_LENS_FISHEYE;
    return cairn_window_initialise(memory, bytes, input.byte() > 4 ? &camera : nullptr, &parameters,
                                   made);
  }
  static cairn_status reset(Input&, Object* tracker) { return cairn_window_reset(tracker); }
  static void sample(Input& input, Object* tracker, std::int64_t t_us) {
    cairn_angular_rate sample = {};
    sample.t_us = input.byte() > 20 ? later(t_us, 1000 * input.below(33)) : input.time();
    sample.x_radps = input.number(-2.0F, 2.0F);
    sample.z_radps = input.number(-2.0F, 2.0F);
    static_cast<void>(cairn_window_add_angular_rate(tracker, input.byte() > 2 ? &sample : nullptr));
  }
  static void check(const Object* tracker) {
    float covariance[36];
    check_covariance(cairn_window_get_covariance(tracker, covariance), covariance);
    cairn_gyro gyro;
    PROMISE(1, cairn_window_get_gyro(tracker, &gyro) == CAIRN_OK);
    PROMISE(4, is_finite(gyro.time_offset_s) && is_finite(gyro.bias_z_radps));
    float scale = 0.0F;
    float sigma = 0.0F;
    PROMISE(1, cairn_window_get_focal_scale(tracker, &scale, &sigma) == CAIRN_OK);
    PROMISE(4, scale > 0.0F && is_finite(scale) && sigma >= 0.0F && is_finite(sigma));
  }
};

template <class Api>
class Run {
  using Object = typename Api::Object;

 public:
  explicit Run(Input& input) {
    PROMISE(1, cairn_objects_initialise(&object_memory_, sizeof object_memory_, 0.2F, &objects_) ==
                   CAIRN_OK);
    initialise(input);
  }

  void step(Input& input) {
    switch (input.below(10)) {
      case 0:
      case 1:
      case 2:
        frame(input);
        break;
      case 3:
        odd_frame(input);
        break;
      case 4:
        Api::sample(input, tracker_, t_us_);
        break;
      case 5:
        place_and_draw(input);
        break;
      case 6:
        maps(input);
        break;
      case 7:
        settings(input);
        break;
      case 8:
        nothing();
        break;
      case 9:
        input.flag() ? initialise(input) : reset(input);
        break;
    }
    check();
  }

 private:
  void initialise(Input& input) {
    const std::size_t less = input.byte() > 240 ? input.word() % 4096 : 0;
    const std::size_t offset = input.byte() > 240 ? 4 : 0;
    const NoAllocation none;
    const cairn_status status =
        Api::initialise(input, memory_.bytes + offset, sizeof memory_ - less - offset, &tracker_);
    PROMISE(1, (status == CAIRN_OK) == (tracker_ != nullptr));
    t_us_ = 0;
  }
  void reset(Input& input) {
    const NoAllocation none;
    if (Api::reset(input, tracker_) == CAIRN_OK) t_us_ = 0;
  }

  void frame(Input& input) {
    t_us_ = input.byte() > 10 ? later(t_us_, kFrameUs) : input.time();
    if (input.flag()) Api::sample(input, tracker_, t_us_);
    frame_ = input.byte() > 40 ? frame_ + 1 : input.below(kPictures);
    show(picture(frame_));
  }
  void odd_frame(Input& input) {
    const OddPicture odd(input);
    if (input.flag()) t_us_ = later(t_us_, kFrameUs);
    show(odd.view());
  }
  void show(const ImageView& view) {
    const cairn_image image = {view.data, view.width, view.height, view.stride};
    cairn_report report = {};
    report.t_us = t_us_ == 7 ? 8 : 7;
    const std::int64_t untouched = report.t_us;
    const NoAllocation none;
    const cairn_status status = process(tracker_, &image, t_us_, &report);
    if (report.t_us == untouched) {
      PROMISE(1, status != CAIRN_OK);
      return;
    }
    const cairn_transform& pose = report.T_map_camera;
    PROMISE(4, is_finite(pose.x + pose.y + pose.z));
    const float squared = square(pose.qw) + square(pose.qx) + square(pose.qy) + square(pose.qz);
    PROMISE(4, squared > 0.98F && squared < 1.02F);
  }

  void place_and_draw(Input& input) {
    static std::vector<std::uint8_t> pixels(static_cast<std::size_t>((kWidth + 4) * kHeight));
    cairn_canvas canvas = {pixels.data(), kWidth, kHeight, kWidth + input.below(5)};
    if (input.byte() > 250) canvas.data = nullptr;
    if (input.byte() > 250) canvas.height = static_cast<std::int32_t>(input.word());
    std::int32_t before = 0;
    std::int32_t after = 0;
    const NoAllocation none;
    PROMISE(1, cairn_objects_count(objects_, &before) == CAIRN_OK);
    const cairn_status placed =
        place_object(tracker_, objects_, input.number(-1.0F, 112.0F), input.number(-1.0F, 84.0F));
    PROMISE(1, cairn_objects_count(objects_, &after) == CAIRN_OK);
    PROMISE(3, after == before + (placed == CAIRN_OK ? 1 : 0));
    cairn_transform at;
    const cairn_status there = cairn_objects_get_place(
        objects_, input.byte() > 250 ? static_cast<std::int32_t>(input.word()) : after - 1, &at);
    PROMISE(1, there == CAIRN_OK || there == CAIRN_NOT_FOUND);
    std::int32_t drawn = 0;
    if (draw(tracker_, objects_, &canvas, &drawn) == CAIRN_OK) {
      PROMISE(6, drawn >= 0 && drawn <= after);
    }
    if (!cairn_objects_wants_one(objects_) && input.byte() > 200) {
      at = {1.0F, 0.0F, 0.0F, input.number(-1.0F, 1.0F), input.number(-1.0F, 1.0F), 0.0F, 1.0F};
      static_cast<void>(cairn_objects_place(objects_, &at));
    }
  }

  void maps(Input& input) {
    if constexpr (Api::kMapBytes > 0) {
      static std::vector<std::uint8_t> map(Api::kMapBytes);
      std::size_t used = 0;
      const NoAllocation none;
      if (input.byte() > 240) {
        static_cast<void>(save_map(tracker_, map.data(), input.word() % map.size(), &used));
        return;
      }
      const cairn_status saved = save_map(tracker_, map.data(), map.size(), &used);
      PROMISE(8, saved == CAIRN_OK || tracker_ == nullptr);
      if (saved != CAIRN_OK) return;
      const bool whole = input.flag();
      if (!whole) map[input.word() % used] ^= static_cast<std::uint8_t>(1 + input.below(255));
      const cairn_status loaded = load_map(tracker_, map.data(), used);
      PROMISE(8, whole == (loaded == CAIRN_OK));
    } else {
      static_cast<void>(input);
    }
  }

  void settings(Input& input) {
    const auto units = static_cast<std::int32_t>(input.word());
    const NoAllocation none;
    PROMISE(1,
            tracker_ == nullptr || (set_work_limit(tracker_, units) == CAIRN_OK) == (units >= 0));
    const auto no_ticks = [](void*) -> std::uint32_t { return 0; };
    static_cast<void>(set_ticks(tracker_, input.flag() ? no_ticks : nullptr));
  }

  /// NULL for everything.
  void nothing() {
    const NoAllocation none;
    Object* const no_tracker = nullptr;
    const cairn_image image = {};
    PROMISE(1, process(no_tracker, &image, 0, nullptr) == CAIRN_INVALID_ARGUMENT);
    PROMISE(1, process(tracker_, nullptr, 0, nullptr) == CAIRN_INVALID_ARGUMENT);
    PROMISE(1, set_work_limit(no_tracker, 1) == CAIRN_INVALID_ARGUMENT);
    PROMISE(1, set_ticks(no_tracker, nullptr) == CAIRN_INVALID_ARGUMENT);
    PROMISE(1, get_landmarks(no_tracker, nullptr, 0, nullptr) == CAIRN_INVALID_ARGUMENT);
    PROMISE(1, get_health(tracker_, nullptr) == CAIRN_INVALID_ARGUMENT);
    PROMISE(1, hash_of(no_tracker) == 0);
    PROMISE(1, draw(tracker_, nullptr, nullptr, nullptr) == CAIRN_INVALID_ARGUMENT);
    PROMISE(1, place_object(tracker_, nullptr, 1.0F, 1.0F) == CAIRN_INVALID_ARGUMENT);
    PROMISE(1, cairn_objects_place(nullptr, nullptr) == CAIRN_INVALID_ARGUMENT);
  }

  void check() const {
    if (tracker_ == nullptr) return;
    const NoAllocation none;
    Api::check(tracker_);
    cairn_landmark landmarks[kMostLandmarks];
    std::size_t count = 0;
    PROMISE(1, get_landmarks(tracker_, landmarks, kMostLandmarks, &count) == CAIRN_OK);
    PROMISE(6, count <= kMostLandmarks);
    for (std::size_t i = 0; i < count; ++i) {
      for (const float coordinate : landmarks[i].position) PROMISE(4, is_finite(coordinate));
    }
    cairn_health health;
    PROMISE(1, get_health(tracker_, &health) == CAIRN_OK);
  }

  typename Api::Memory memory_;
  cairn_objects_memory object_memory_;
  Object* tracker_ = nullptr;
  cairn_objects* objects_ = nullptr;
  std::int64_t t_us_ = 0;
  int frame_ = 0;
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  return run_one_of<Run<Vehicle>, Run<Handheld>, Run<Window>>(bytes, size, 6 * kTrackerSteps);
}
