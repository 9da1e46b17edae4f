// A vehicle in the hall after three seconds without inputs.

#include <memory>

#include <gtest/gtest.h>

#include "host_sim/sources/hall_source.hpp"
#include "host_sim/trackers/vehicle_adapter.hpp"

namespace cairn::host {
namespace {

/// Where a run with a gap of three seconds after frame `from` ends.
struct End {
  TrackingState state = TrackingState::kInitialising;
  double off_m = 0.0;
};

End end_after_gap(std::uint64_t seed, int from) {
  constexpr int kGap = 90;
  constexpr int kAfter = 40;
  HallOptions hall;
  hall.width = 320;
  hall.seed = seed;
  hall.frame_count = from + kGap + kAfter;
  const auto source = make_hall_source(hall);
  TrackerOptions options;
  options.mode = Mode::kVehicle;
  options.filter = "group-iekf";
  std::unique_ptr<Tracker> tracker;
  FrameReport report;
  Frame frame;
  while (source->next(frame)) {
    if (frame.number > from && frame.number <= from + kGap) continue;
    if (tracker == nullptr) {
      const Rigid<double>& start = *frame.true_T_world_vehicle;
      options.start_x_m = start.translation.x();
      options.start_y_m = start.translation.y();
      tracker = make_vehicle_tracker(options, source->info());
    }
    static_cast<void>(tracker->process(frame, frame.grey, report));
  }
  const Vector3<double> at = report.T_map_camera.translation.cast<double>();
  return {report.state, (at - frame.true_T_world_camera->translation).head<2>().norm()};
}

/// In a turn, where one reading's noise after the gap and the turn's end leave the heading 25 to 40
/// degrees off, beyond what the search windows reach: seven landmarks are in view, or fourteen.
TEST(AGapInTheHall, LeavesAVehicleThatFindsItsPlaceByLandmarksInView) {
  for (const auto& [seed, from] : {std::pair{1, 200}, {1, 360}}) {
    const End end = end_after_gap(static_cast<std::uint64_t>(seed), from);
    EXPECT_EQ(end.state, TrackingState::kTracking) << seed << ", " << from;
    EXPECT_LT(end.off_m, 0.3) << seed << ", " << from;
  }
}

}  // namespace
}  // namespace cairn::host
