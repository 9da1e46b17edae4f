#include "tasks.hpp"

#include "board.hpp"

namespace example {
cairn::Status start(Slam& slam, const cairn::PinholeCamera<float>& camera,
                    const cairn::Rigid<float>& T_vehicle_camera) {
  using Tracker = cairn::FrameTracker<Config, Filter>;
  return slam.tracker.initialise(camera, T_vehicle_camera, Tracker::Start{}, Tracker::Parameters{});
}

int tracker_task(Slam& slam) {
  int tracked = 0;
  cairn::ImageView image;
  std::int64_t t_us = 0;
  while (board_wait_for_frame(image, t_us)) {
    cairn::OdometrySample odometry;
    while (board_odometry_until(t_us, odometry)) {
      // What is refused is counted in the tracker's health().
      static_cast<void>(slam.tracker.add_odometry(odometry));
    }
    cairn::FrameReport report;
    const cairn::Status status =
        slam.tracker.process_frame(image, t_us, cairn::TickSource{}, slam.map, report);
    tracked += ok(status) && report.state == cairn::TrackingState::kTracking ? 1 : 0;
  }
  return tracked;
}

int builder_slice(Slam& slam) {
  constexpr int kMessages = 4;
  return slam.builder.run(slam.map, kMessages);
}

}  // namespace example
