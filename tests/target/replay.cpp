// Replays an input log and prints one line per frame: number, time, status, hash of everything that
// the frame decided. The same text on every target.
//
// usage: replay_* LOG [--frames N] [--ticks yes]
// --frames: stop after N frames; --ticks: print the port's ticks per stage and frame as well
//
// CAIRN_REPLAY_VEHICLE chooses the tracker, CAIRN_REPLAY_CONFIG its capacities.

#include "cairn/runtime/replay.hpp"

#include <cstdint>

#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/port/files.h"
#include "cairn/port/port.h"
#include "cairn/runtime/config.hpp"

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
#if CAIRN_REPLAY_VEHICLE
using Tracker =
    cairn::VehicleTracker<Config, cairn::GroupIekfSlam<float, Config::kMaxLandmarks, 3>>;
#else
using Tracker = cairn::HandheldTracker<Config>;
#endif

CAIRN_IN_FRAME_MEMORY std::uint8_t pixels[Config::kMaxImageWidth * Config::kMaxImageHeight];
Tracker tracker;

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

void print_ticks(const cairn::LogFrame& frame, const cairn::FrameReport& report,
                 std::uint32_t total) {
  write("ticks ");
  write_decimal(frame.number);
  for (const std::uint32_t ticks : report.stage_ticks) {
    write(" ");
    write_decimal(ticks);
  }
  write(" ");
  write_decimal(total);
  write("\n");
}

int replay(File& file, int frames, bool with_ticks) {
  cairn::InputLogReader<File> reader(file);
  cairn::InputLogHeader header;
  cairn::Status status = reader.open(header);
  if (!ok(status)) return fail("log", status);
  status = cairn::start_replay(header, tracker);
  if (!ok(status)) return fail("start", status);

  const cairn::MutableImageView image{pixels, header.camera.width, header.camera.height,
                                      header.camera.width};
  const cairn::TickSource ticks{with_ticks ? &read_ticks : nullptr, nullptr};
  cairn::LogEvent event = cairn::LogEvent::kEnd;
  cairn::OdometrySample sample;
  cairn::LogFrame frame;
  for (int done = 0; done < frames;) {
    status = reader.next(event, sample, frame, image);
    if (!ok(status)) return fail("log", status);
    if (event == cairn::LogEvent::kEnd) return 0;
    if (event == cairn::LogEvent::kOdometry) {
      // A sample that is refused is in the tracker's counters, and so in the hash.
      static_cast<void>(cairn::replay_odometry(sample, tracker));
      continue;
    }
    cairn::FrameReport report;
    const std::uint32_t begin = cairn_port_ticks();
    cairn_frame_begin();
    report.status = tracker.process_frame(image, frame.t_us, ticks, report);
    cairn_frame_end();
    const std::uint32_t total = cairn_port_ticks() - begin;
    print_frame(frame, report);
    if (with_ticks) print_ticks(frame, report, total);
    ++done;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    write("usage: replay LOG [--frames N] [--ticks yes]\n");
    return 2;
  }
  File file{cairn_file_open(argv[1])};
  if (file.handle < 0) {
    write(argv[1]);
    write(": cannot be opened\n");
    return 2;
  }
  const bool with_ticks =
      cairn_test::equal_text(cairn_test::argument(argc, argv, "--ticks", "no"), "yes");
  const int frames =
      cairn_test::parse_decimal(cairn_test::argument(argc, argv, "--frames", "99999999"));
  const int result = replay(file, frames, with_ticks);
  cairn_file_close(file.handle);
  if (with_ticks) {
    write("stack ");
    write_decimal(cairn_port_stack_used_bytes());
    write("\n");
  }
  return result;
}
