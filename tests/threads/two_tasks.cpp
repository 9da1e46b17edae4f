// Paper A's two modules in two threads: FrameTracker answers every frame, MapBuilder keeps the
// library beside it. A vehicle drives to and fro along a wall.
//
// usage: two_tasks FRAMES
// Prints the counts; exit status 1 when the tracker was lost or the builder did nothing.

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include "cairn/map/map_builder.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/frame_tracker.hpp"

#include "plane_scene.hpp"

namespace {

using Config = cairn::TinyConfig;
using Filter = cairn::GroupIekfSlam<float, Config::kMaxLandmarks, 3>;
using Tracker = cairn::FrameTracker<Config, Filter>;
using Builder = cairn::MapBuilder<Config>;
using Map = cairn::SharedMap<Config>;

constexpr int kPlaces = 60;
constexpr double kStep_m = 0.02;
constexpr std::int64_t kPeriodUs = 100000;  // it turns round by 4 m/s^2, as vehicles can

/// Forward and back again.
int place_of(int frame) {
  const int k = frame % (2 * kPlaces - 2);
  return k < kPlaces ? k : 2 * kPlaces - 2 - k;
}

struct Outcome {
  int tracked = 0;
  double worst_m = 0.0;
};

/// The task of high priority: one frame after the other.
Outcome track(Tracker& tracker, Map& map, int frames) {
  const cairn::test::PlaneScene scene(2.0, 0.22);
  std::vector<std::vector<std::uint8_t>> pictures;
  pictures.reserve(kPlaces);
  for (int k = 0; k < kPlaces; ++k) {
    pictures.push_back(
        scene.render(cairn::test::small_camera(),
                     {cairn::Quaternion<double>::Identity(), {k * kStep_m, 0.0, 0.0}}));
  }
  Outcome outcome;
  for (int frame = 0; frame < frames; ++frame) {
    const int place = place_of(frame);
    cairn::OdometrySample sample;
    sample.t_us = frame * kPeriodUs;
    const int moved = frame == 0 ? 0 : place - place_of(frame - 1);
    sample.speed_mps = static_cast<float>(moved * kStep_m / (1e-6 * kPeriodUs));
    static_cast<void>(tracker.add_odometry(sample));
    cairn::FrameReport report;
    const auto& picture = pictures[static_cast<std::size_t>(place)];
    static_cast<void>(tracker.process_frame(cairn::test::view(picture, cairn::test::small_camera()),
                                            sample.t_us, cairn::TickSource{}, map, report));
    outcome.tracked += report.state == cairn::TrackingState::kTracking ? 1 : 0;
    const double x = static_cast<double>(tracker.filter().mean_pose().position.x());
    outcome.worst_m = std::max(outcome.worst_m, std::abs(x - place * kStep_m));
  }
  return outcome;
}

/// The task of low priority: a slice whenever there is time.
int build(Builder& builder, Map& map, const std::atomic<bool>& done) {
  int messages = 0;
  while (!done.load()) {
    messages += builder.run(map, 4);
    std::this_thread::yield();
  }
  return messages;
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 1000;
  const auto tracker = std::make_unique<Tracker>();
  const auto builder = std::make_unique<Builder>();
  const auto map = std::make_unique<Map>();
  // Camera x along the vehicle's x, camera y down, camera z to the left: a quarter turn about x.
  const cairn::Rigid<float> T_vehicle_camera{{0.70710678F, -0.70710678F, 0.0F, 0.0F},
                                             {0.0F, 0.0F, 1.0F}};
  Tracker::Start start;
  start.covariance = 1e-8F * cairn::Matrix3<float>::Identity();
  Tracker::Parameters parameters;
  parameters.odometry = {0.05F, 0.02F, 0.5F, 0.1F};
  if (!ok(tracker->initialise(cairn::test::to_float(cairn::test::small_camera()), T_vehicle_camera,
                              start, parameters))) {
    std::fprintf(stderr, "the tracker refused its settings\n");
    return 1;
  }

  std::atomic<bool> done{false};
  int messages = 0;
  std::thread task([&] { messages = build(*builder, *map, done); });
  const Outcome outcome = track(*tracker, *map, frames);
  done.store(true);
  task.join();

  std::printf("%d frames, %d tracked, worst error %.3f m, %d messages, %d library landmarks\n",
              frames, outcome.tracked, outcome.worst_m, messages, map->exchange.front().size());
  const bool good = outcome.tracked > frames - 60 && outcome.worst_m < 0.3 && messages > 0;
  return good ? 0 : 1;
}
