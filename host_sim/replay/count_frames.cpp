// Replays an input log for `cairn_sim timing`, which runs this under callgrind: draws the virtual
// objects into every frame and calls the functions of frame_marks.hpp at the bounds of frames and
// stages. Links the core alone, so that no library of the host's has to run under valgrind.
//
// Prints a line per frame, "stages" and a number in hexadecimal for each stage of FrameReport: bit
// k stands for the instructions between the k-th and the next call of cairn_mark_stage() in the
// frame, counted from 0.
//
// usage: cairn_count_frames LOG
// Exit status as cairn_sim's: 2 wrong command line, 3 no whole log.

#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "cairn/ar/augmenter.hpp"

#include "host_sim/replay/frame_marks.hpp"
#include "host_sim/replay/log_replay.hpp"
#include "host_sim/replay/scene_objects.hpp"

// Different bodies, so that they stay three functions.
extern "C" {
__attribute__((noinline)) void cairn_mark_frame_begin() {
  __asm volatile("" ::: "memory");
}
__attribute__((noinline)) void cairn_mark_stage() {
  __asm volatile("nop" ::: "memory");
}
__attribute__((noinline)) void cairn_mark_frame_end() {
  __asm volatile("nop\nnop" ::: "memory");
}
}

namespace {

using cairn::Status;
using cairn::TickSource;

constexpr int kUsage = 2;
constexpr int kInputInvalid = 3;

/// Ticks that mark the stages and tell no time: the k-th of a frame is 2^k. A difference of two has
/// the bits of the marks from one to the other, so that FrameReport's sums of differences say which
/// pieces of the frame were a stage's.
class StageMarks {
 public:
  void restart() { next_ = 0; }
  TickSource source() { return {&mark, this}; }

 private:
  static std::uint32_t mark(void* context) {
    cairn_mark_stage();
    auto& marks = *static_cast<StageMarks*>(context);
    if (marks.next_ >= kMostMarks) std::abort();
    return 1U << marks.next_++;
  }

  static constexpr unsigned kMostMarks = 32;
  unsigned next_ = 0;
};

class CountedFrame {
 public:
  template <class Tracker>
  void operator()(const cairn::host::ReplayFrame& frame, Tracker& tracker) {
    marks_.restart();
    const TickSource ticks = marks_.source();
    cairn::FrameReport report;
    cairn_mark_frame_begin();
    cairn::host::process_frame(frame, tracker, ticks, report);
    objects_.draw(tracker, frame.image, ticks, report);
    cairn_mark_frame_end();
    std::fputs("stages", stdout);
    for (const std::uint32_t pieces : report.stage_ticks) std::printf(" %x", pieces);
    std::fputc('\n', stdout);
  }

 private:
  StageMarks marks_;
  cairn::host::SceneObjects objects_{cairn::host::kVehicleObjectHeight, cairn::host::kNearObjects};
};

Status replay(cairn::host::LogFile& file) {
  cairn::InputLogReader<cairn::host::LogFile> reader(file);
  cairn::InputLogHeader header;
  CountedFrame on_frame;
  const Status status = reader.open(header);
  if (!cairn::ok(status)) return status;
  if (cairn::host::fits<cairn::DefaultConfig>(header.camera)) {
    return cairn::host::replay_frames<cairn::DefaultConfig>(reader, header, on_frame);
  }
  return cairn::host::replay_frames<cairn::LargeConfig>(reader, header, on_frame);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: cairn_count_frames LOG\n", stderr);
    return kUsage;
  }
  cairn::host::LogFile file(argv[1]);
  if (!file.opened()) {
    std::fprintf(stderr, "%s: cannot be read: expected an input log\n", argv[1]);
    return kInputInvalid;
  }
  const Status status = replay(file);
  if (cairn::ok(status)) return 0;
  std::fprintf(stderr, "%s: %s: expected a whole input log of version %d\n", argv[1],
               cairn::to_string(status), static_cast<int>(cairn::kInputLogVersion));
  return kInputInvalid;
}
