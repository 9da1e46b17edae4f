// Replays an input log and prints one line per frame: number, time, status, hash of everything that
// the frame decided. The same text on every target.
//
// usage: replay_* LOG [--frames N] [--overlay yes] [--ticks yes]
// --frames: stop after N frames; --overlay: draw the virtual objects into each frame and print the
// picture's hash; --ticks: print the port's ticks per stage and frame, what the frame counted
// (corners, searched, matches, inliers, landmarks), and the stack used
//
// CAIRN_REPLAY_TRACKER chooses the tracker (0 HandheldTracker, 1 VehicleTracker, 2 WindowTracker,
// 3 VehicleTracker in fixed point), CAIRN_REPLAY_CONFIG its capacities.

#include "cairn/runtime/replay.hpp"

#include <cstdint>

#include "cairn/base/config.hpp"
#include "cairn/base/fixed_vector.hpp"
#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/port/files.h"
#include "cairn/port/port.h"
#include "cairn/runtime/augmentation.hpp"
#include "cairn/runtime/window_augmentation.hpp"

#include "text.hpp"

#ifdef CAIRN_PORT_FRAMES_SECTION
#define CAIRN_IN_FRAME_MEMORY __attribute__((section(".frames")))
#else
#define CAIRN_IN_FRAME_MEMORY
#endif

// Bounds of the measured frame, found by name by the block counter; different bodies, so that they
// stay two functions.
extern "C" {
__attribute__((noinline)) void cairn_frame_begin() {
  __asm volatile("" ::: "memory");
}
__attribute__((noinline)) void cairn_frame_end() {
  __asm volatile("nop" ::: "memory");
}
}

namespace {

using cairn_test::write;
using cairn_test::write_decimal;
using cairn_test::write_hex64;

using Config = cairn::CAIRN_REPLAY_CONFIG;
#if CAIRN_REPLAY_TRACKER == 1
using Tracker =
    cairn::VehicleTracker<Config, cairn::GroupIekfSlam<float, Config::kMaxLandmarks, 3>>;
#elif CAIRN_REPLAY_TRACKER == 3
using Tracker = cairn::VehicleTracker<Config, cairn::FixedVehicleSlam<Config::kMaxLandmarks>>;
#elif CAIRN_REPLAY_TRACKER == 2
using Tracker = cairn::WindowTracker<Config>;
#else
using Tracker = cairn::HandheldTracker<Config>;
#endif

CAIRN_IN_FRAME_MEMORY std::uint8_t pixels[Config::kMaxImageWidth * Config::kMaxImageHeight];
Tracker tracker;
cairn::Augmenter augmenter;
cairn::ObjectPlacement placement{{3.5F, 0.7F, 0.0F}, cairn::Random(1)};

struct Options {
  int frames = 0;
  bool with_overlay = false;
  bool with_ticks = false;
};

struct File {
  std::int32_t handle;
  int read(std::uint8_t* bytes, int count) const {
    return cairn_file_read(handle, bytes, static_cast<std::uint32_t>(count));
  }
};

std::uint32_t read_ticks(void*) {
  return cairn_port_ticks();
}

int fail(const char* what, cairn::Status status) {
  write(what);
  write(": ");
  write(cairn::to_string(status));
  write("\n");
  return 2;
}

void print_frame(const cairn::LogFrame& frame, const cairn::FrameReport& report) {
  write("frame ");
  write_decimal(frame.number);
  write(" ");
  write_decimal(static_cast<std::uint64_t>(frame.t_us));
  write(" ");
  write(cairn::to_string(report.status));
  write(" ");
  write_hex64(cairn::frame_hash(tracker, report));
  write("\n");
}

/// Odometry since the last frame, handed on just before the next: so that a measured frame holds
/// its predictions, and not the reading of the log between them.
class PendingOdometry {
 public:
  void add(const cairn::OdometrySample& sample) {
    if (!samples_.push_back(sample)) {
      apply();
      static_cast<void>(samples_.push_back(sample));
    }
  }

  void apply() {
    // A sample that is refused is in the tracker's counters, and so in the hash.
    for (const cairn::OdometrySample& sample : samples_) {
      static_cast<void>(cairn::replay_odometry(sample, tracker));
    }
    samples_.clear();
  }

 private:
  cairn::FixedVector<cairn::OdometrySample, 8> samples_;
};

PendingOdometry odometry;

struct FrameTicks {
  std::uint32_t odometry = 0;
  std::uint32_t total = 0;
};

/// The stages' ticks, with odometry as part of the pose's prediction, and the whole frame's.
void print_ticks(const cairn::LogFrame& frame, const cairn::FrameReport& report,
                 const FrameTicks& ticks) {
  write("ticks ");
  write_decimal(frame.number);
  for (int stage = 0; stage < cairn::kStageCount; ++stage) {
    const bool predicts = stage == static_cast<int>(cairn::Stage::kPosePrediction);
    write(" ");
    write_decimal(report.stage_ticks[stage] + (predicts ? ticks.odometry : 0U));
  }
  write(" ");
  write_decimal(ticks.total);
  write("\ncounts ");
  write_decimal(frame.number);
  for (const int count : {report.corners, report.searched, report.matches, report.inliers,
                          report.landmarks, report.work}) {
    write(" ");
    write_decimal(static_cast<std::uint64_t>(count));
  }
  write("\n");
}

FrameTicks process(const cairn::LogFrame& frame, const cairn::MutableImageView& image,
                   const Options& options, cairn::FrameReport& report) {
  const cairn::TickSource ticks{options.with_ticks ? &read_ticks : nullptr, nullptr};
  FrameTicks spent;
  const std::uint32_t begin = cairn_port_ticks();
  cairn_frame_begin();
  odometry.apply();
  cairn::replay_work_limit(frame, tracker);
  spent.odometry = cairn_port_ticks() - begin;
  report.status = tracker.process_frame(image, frame.t_us, ticks, report);
  if (options.with_overlay) {
    cairn::augment(tracker, augmenter, placement, image, ticks, report);
  }
  cairn_frame_end();
  spent.total = cairn_port_ticks() - begin;
  return spent;
}

/// Of the drawn picture, which lies where the frame was.
void print_overlay(const cairn::LogFrame& frame, const cairn::MutableImageView& image) {
  cairn::Hash64 hash;
  hash.add_bytes(image.data, image.width * image.height);
  write("overlay ");
  write_decimal(frame.number);
  write(" ");
  write_hex64(hash.value());
  write("\n");
}

int replay(File& file, const Options& options) {
  cairn::InputLogReader<File> reader(file);
  cairn::InputLogHeader header;
  cairn::Status status = reader.open(header);
  if (!ok(status)) return fail("log", status);
  status = cairn::start_replay(header, tracker);
  if (ok(status)) status = cairn::make_cairn(1.0F, augmenter.shape());
  if (!ok(status)) return fail("start", status);
  augmenter.initialise(cairn::Augmenter::Parameters{});

  const cairn::MutableImageView image{pixels, header.camera.width, header.camera.height,
                                      header.camera.width};
  cairn::LogEvent event = cairn::LogEvent::kEnd;
  cairn::OdometrySample sample;
  cairn::LogFrame frame;
  for (int done = 0; done < options.frames;) {
    status = reader.next(event, sample, frame, image);
    if (!ok(status)) return fail("log", status);
    if (event == cairn::LogEvent::kEnd) return 0;
    if (event == cairn::LogEvent::kOdometry) {
      odometry.add(sample);
      continue;
    }
    if (event == cairn::LogEvent::kAngularRate) {
      // A sample that is refused is in the tracker's counters, and so in the hash.
      static_cast<void>(cairn::replay_angular_rate(reader.angular_rate(), tracker));
      continue;
    }
    cairn::FrameReport report;
    const FrameTicks ticks = process(frame, image, options, report);
    print_frame(frame, report);
    if (options.with_overlay) print_overlay(frame, image);
    if (options.with_ticks) print_ticks(frame, report, ticks);
    ++done;
  }
  return 0;
}

bool is_set(int argc, char** argv, const char* name) {
  return cairn_test::equal_text(cairn_test::argument(argc, argv, name, "no"), "yes");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    write("usage: replay LOG [--frames N] [--overlay yes] [--ticks yes]\n");
    return 2;
  }
  File file{cairn_file_open(argv[1])};
  if (file.handle < 0) {
    write(argv[1]);
    write(": cannot be opened\n");
    return 2;
  }
  Options options;
  options.frames =
      cairn_test::parse_decimal(cairn_test::argument(argc, argv, "--frames", "99999999"));
  options.with_overlay = is_set(argc, argv, "--overlay");
  options.with_ticks = is_set(argc, argv, "--ticks");
  const int result = replay(file, options);
  cairn_file_close(file.handle);
  if (options.with_ticks) {
    write("stack ");
    write_decimal(cairn_port_stack_used_bytes());
    write("\n");
  }
  return result;
}
