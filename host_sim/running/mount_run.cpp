#include "host_sim/running/mount_run.hpp"

#include <fmt/format.h>

#include "cairn/numeric/math.hpp"

#include "host_sim/io/interruption.hpp"

namespace cairn::host {

MountRun run_for_mount(FrameSource& source, Frame& first, Tracker& tracker) {
  MountRun run;
  cv::Mat overlay;
  do {
    first.grey.copyTo(overlay);
    FrameReport report;
    static_cast<void>(tracker.process(first, overlay, report));
    ++run.frames;
    run.tracked += report.not_tracked == NotTracked::kTracked ? 1 : 0;
  } while (interrupted() == 0 && source.next(first));
  run.offset = tracker.mount_offset().value();
  run.ground = tracker.ground();
  run.yaw = tracker.yaw();
  run.suspect_frames = tracker.health().mount_suspicions;
  return run;
}

std::string describe(const MountOffset& offset, MountOffset::Part part) {
  constexpr const char* kNames[MountOffset::kParts] = {"yaw", "pitch", "roll", "focal length"};
  const bool angle = part != MountOffset::kFocal;
  const double unit = angle ? 180.0 / kPi<double> : 100.0;
  return fmt::format("{} {:+.1f} +- {:.1f} {}", kNames[part],
                     unit * static_cast<double>(offset.value[part]),
                     unit * static_cast<double>(offset.sigma[part]), angle ? "deg" : "%");
}

const char* meaning_of(MountOffset::Part part) {
  constexpr const char* kMeanings[MountOffset::kParts] = {
      "the camera points further left (+) than its mount says, or the principal point lies "
      "further right",
      "the camera points further down (+) than its mount says, or the principal point lies "
      "further up",
      "the camera is turned further to the right (+) about its line of sight than its mount says",
      "longer (+) than the camera file says, or the odometry's yaw rate is too small"};
  return kMeanings[part];
}

}  // namespace cairn::host
