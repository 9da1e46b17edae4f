#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "cairn/base/config.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/map/map_file.hpp"
#include "cairn/runtime/input_log.hpp"

#include "fuzz_input.hpp"
#include "plane_scene.hpp"

namespace cairn::fuzz {

/// Small, so that a frame takes a fraction of a millisecond.
struct SmallConfig : TinyConfig {
  static constexpr int kMaxImageWidth = 112;
  static constexpr int kMaxImageHeight = 84;
  static constexpr int kMaxLandmarks = 12;
  static constexpr int kMaxFeatures = 12;
  static constexpr int kMaxSeeds = 8;
  static constexpr int kLibraryLandmarks = 24;
  static constexpr int kMaxKeyframes = 4;
  static constexpr int kRelocalisationFeatures = 32;
  static constexpr int kRelocalisationMatches = 32;
};

inline constexpr int kPictures = 16;
inline constexpr int kWarmFrames = 2 * kPictures;
inline constexpr int kTrackerSteps = 6;
inline constexpr double kStep_m = 0.02;
inline constexpr std::int64_t kFrameUs = 33333;

inline PinholeCamera<double> scene_camera() {
  PinholeCamera<double> camera;
  camera.fx = camera.fy = 91.0;
  camera.cx = 55.5;
  camera.cy = 41.5;
  camera.width = SmallConfig::kMaxImageWidth;
  camera.height = SmallConfig::kMaxImageHeight;
  return camera;
}

/// What a camera sees that moves to the right along a wall.
inline const std::vector<std::vector<std::uint8_t>>& pictures() {
  static const std::vector<std::vector<std::uint8_t>> all = [] {
    const test::PlaneScene wall(2.0, 0.3);
    std::vector<std::vector<std::uint8_t>> made;
    for (int i = 0; i < kPictures; ++i) {
      made.push_back(wall.render(scene_camera(), {Quaternion<double>::Identity(),
                                                  Vector3<double>(i * kStep_m, 0.0, 0.0)}));
    }
    return made;
  }();
  return all;
}

inline ImageView picture(int index) {
  return test::view(pictures()[static_cast<std::size_t>(index % kPictures)], scene_camera());
}

/// A picture of the right or a wrong size, of noise or none.
class OddPicture {
 public:
  explicit OddPicture(Input& input)
      : picture_(width_of(input), height_of(input), 0, input), kind_(input.below(8)) {}

  ImageView view() const {
    if (kind_ == 0) return {nullptr, picture_.width, picture_.height, picture_.width};
    if (kind_ == 1) return {picture_.bytes.get(), picture_.width, picture_.height, 0};
    if (kind_ == 2) return {picture_.bytes.get(), -1, picture_.height, picture_.width};
    return {picture_.bytes.get(), picture_.width, picture_.height, picture_.stride};
  }

 private:
  struct Sized : ExactPicture {
    Sized(int w, int h, int extra, Input& input) : ExactPicture(w, h, w + extra, input) {}
  };
  static int width_of(Input& input) {
    return input.flag() ? SmallConfig::kMaxImageWidth : 1 + input.below(200);
  }
  static int height_of(Input& input) {
    return input.flag() ? SmallConfig::kMaxImageHeight : 1 + input.below(200);
  }

  Sized picture_;
  int kind_;
};

/// A map in memory.
struct MapBytes {
  static constexpr int kRoom = 8192;
  std::uint8_t bytes[kRoom] = {};
  int size = 0;

  ByteSink sink() {
    return {[](void* context, const std::uint8_t* from, int count) {
              auto* map = static_cast<MapBytes*>(context);
              if (map->size + count > kRoom) return false;
              std::memcpy(map->bytes + map->size, from, static_cast<std::size_t>(count));
              map->size += count;
              return true;
            },
            this};
  }
  ByteSource source() {
    return {
        [](void* context, std::uint32_t offset, std::uint8_t* to, int count) {
          auto* map = static_cast<MapBytes*>(context);
          if (offset + static_cast<std::uint32_t>(count) > static_cast<std::uint32_t>(map->size)) {
            return false;
          }
          std::memcpy(to, map->bytes + offset, static_cast<std::size_t>(count));
          return true;
        },
        this, static_cast<std::uint32_t>(size)};
  }
  /// Makes the checksum right after a change: damage that only values can tell.
  void seal() {
    if (size < kMapHeaderBytes + kMapTrailerBytes) return;
    const std::uint32_t crc = detail::crc32(0, bytes, size - kMapTrailerBytes);
    std::uint8_t encoded[4];
    detail::encode_u32(crc, encoded);
    std::memcpy(bytes + size - kMapTrailerBytes, encoded, sizeof encoded);
  }
};

/// `t_us + by_us`, held at the ends of the type.
inline std::int64_t later(std::int64_t t_us, std::int64_t by_us) {
  std::int64_t sum = 0;
  if (!__builtin_add_overflow(t_us, by_us, &sum)) return sum;
  return by_us > 0 ? std::numeric_limits<std::int64_t>::max()
                   : std::numeric_limits<std::int64_t>::min();
}

template <class Pose>
bool good_pose(const Pose& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
         abs(pose.rotation.norm() - 1.0F) < 1e-2F;
}

/// One frame at `t_us`; whether the tracker accepted it. A refused one leaves its state.
template <class Tracker>
bool process_frame(Tracker& tracker, const ImageView& image, std::int64_t t_us,
                   FrameReport& report) {
  const Before before(tracker);
  const std::int64_t untouched = t_us == 7 ? 8 : 7;
  report.t_us = untouched;
  const NoAllocation none;
  const Status status = tracker.process_frame(image, t_us, TickSource(), report);
  if (report.t_us != untouched) return true;
  PROMISE(1, !ok(status));
  PROMISE(3, before.unchanged());
  return false;
}

/// A work limit of up to `most` units, or any number; `limit` becomes the one that holds.
template <class Tracker>
void change_work_limit(Tracker& tracker, Input& input, int most, int& limit) {
  const int units = input.flag() ? static_cast<int>(input.word()) : input.between(0, most);
  const Status status = tracker.set_work_limit(units);
  PROMISE(1, ok(status) == (units >= 0));
  if (ok(status)) limit = units;
}

/// Loads the tracker's own map, up to three bytes of it changed.
template <class Tracker>
void load_changed_map(Tracker& tracker, Input& input) {
  MapBytes map;
  if (!ok(tracker.save_map(map.sink()))) return;
  for (int changes = input.below(4); changes > 0 && map.size > 0; --changes) {
    map.bytes[static_cast<int>(input.word() % static_cast<std::uint32_t>(map.size))] ^=
        input.byte();
  }
  if (input.flag()) map.seal();
  const Before before(tracker);
  MapFileInfo info;
  const NoAllocation none;
  const Status status = tracker.load_map(map.source(), info);
  PROMISE(3, ok(status) || before.unchanged());
}

/// What the runs of all trackers share: pictures, a clock, and what holds after every frame.
template <class Tracker>
class TrackerRun {
 public:
  using Parameters = typename Tracker::Parameters;

 protected:
  /// `always`: units of work that no limit leaves out; `most`: landmarks that a tracker holds.
  TrackerRun(int always, int most) : always_(always), most_(most) {}

  void show(const ImageView& image) {
    FrameReport report;
    if (!process_frame(tracker_, image, t_us_, report)) return;
    PROMISE(4, good_pose(report.T_map_camera) && good_pose(report.T_world_camera));
    PROMISE(6, report.work <= std::max(limit_, always_));
    PROMISE(6, report.inliers <= report.matches && report.landmarks <= most_);
  }
  /// The next picture there and back, so that every step is small.
  void show_next() {
    t_us_ = later(t_us_, kFrameUs);
    const int at = frame_++ % (2 * kPictures - 2);
    show(picture(at < kPictures ? at : 2 * kPictures - 2 - at));
  }
  /// The `kind`-th of kVideoSteps that pictures alone allow.
  static constexpr int kVideoSteps = 6;
  void video_step(int kind, Input& input) {
    if (kind == 2) frame_ = input.below(kPictures);
    if (kind == 3) return show_odd(input);
    if (kind == 4) leap(input);
    if (kind == 5) return change_limit(input, 14000);
    show_next();
  }
  /// Without anything to see.
  void show_dark() {
    static const std::vector<std::uint8_t> dark(
        static_cast<std::size_t>(SmallConfig::kMaxImageWidth * SmallConfig::kMaxImageHeight), 16);
    t_us_ = later(t_us_, kFrameUs);
    show(test::view(dark, scene_camera()));
  }
  void show_odd(Input& input) {
    const OddPicture odd(input);
    if (input.flag()) t_us_ = later(t_us_, kFrameUs);
    show(odd.view());
  }
  void leap(Input& input) { t_us_ = later(input.time(), t_us_); }
  void change_limit(Input& input, int most) { change_work_limit(tracker_, input, most, limit_); }

  /// Up to two of the numbers become any.
  template <int Count>
  static void change(Input& input, float* const (&numbers)[Count]) {
    for (int changes = input.below(3); changes > 0; --changes) {
      *numbers[input.below(Count)] = input.wild();
    }
  }
  /// Initialises the tracker by `initialise`; whether it did. A refusal leaves its state.
  template <class Initialise>
  bool restart(const Parameters& parameters, const Initialise& initialise) {
    const Before before(tracker_);
    const NoAllocation none;
    const Status status = initialise();
    PROMISE(3, ok(status) || before.unchanged());
    if (ok(status)) limit_ = parameters.work_limit;
    return ok(status);
  }

  Tracker tracker_;
  std::int64_t t_us_ = 0;
  int frame_ = 0;

 private:
  int always_;
  int most_;
  int limit_ = Parameters().work_limit;
};

/// Where a run may begin: with nothing, with a young map, with one that is known, and lost with its
/// map.
template <class Run>
class Starts {
 public:
  static constexpr int kCount = 4;

  explicit Starts(int warm_frames) {
    add(Run());
    for (const int frames : {warm_frames / 4, warm_frames - warm_frames / 4}) {
      Run& next = add(*runs_.back());
      for (int i = 0; i < frames; ++i) next.usual_frame();
    }
    Run& lost = add(*runs_.back());
    for (int i = 0; i < kDarkFrames; ++i) lost.dark_frame();
  }
  const Run& operator[](int i) const { return *runs_[static_cast<std::size_t>(i)]; }

 private:
  static constexpr int kDarkFrames = 45;

  Run& add(const Run& from) {
    runs_.push_back(std::make_unique<Run>(from));
    return *runs_.back();
  }

  std::vector<std::unique_ptr<Run>> runs_;
};

/// Steps of a run with the fuzzer's bytes, the first of which says of the start. `Run` lies in one
/// place for all executions.
template <class Run>
int run_from_start(const std::uint8_t* bytes, std::size_t size, int warm_frames, int steps) {
  count_allocations();
  static const Starts<Run> starts(warm_frames);
  alignas(Run) static std::uint8_t memory[sizeof(Run)];
  Input input(bytes, size);
  Run* const run = new (memory) Run(starts[input.below(Starts<Run>::kCount)]);
  for (int i = 0; i < steps && !input.empty(); ++i) run->step(input);
  run->~Run();
  return 0;
}

}  // namespace cairn::fuzz
