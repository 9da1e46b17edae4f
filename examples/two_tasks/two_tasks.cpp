// The two tasks as threads of a PC.

#include <atomic>
#include <cstdio>
#include <thread>

#include "tasks.hpp"

int main() {
  static example::Slam slam;
  cairn::PinholeCamera<float> camera;
  camera.fx = camera.fy = 500.0F;
  camera.cx = 319.5F;
  camera.cy = 239.5F;
  camera.width = 640;
  camera.height = 480;
  const cairn::Rigid<float> T_vehicle_camera{{0.48225F, -0.51715F, 0.51715F, -0.48225F},
                                             {0.35F, 0.0F, 1.0F}};
  const cairn::Status status = example::start(slam, camera, T_vehicle_camera);
  if (!ok(status)) {
    std::printf("start: %s\n", cairn::to_string(status));
    return 1;
  }
  std::atomic<bool> done{false};
  int messages = 0;
  std::thread builder([&] {
    while (!done.load()) {
      messages += example::builder_slice(slam);
      std::this_thread::yield();
    }
  });
  const int tracked = example::tracker_task(slam);
  done.store(true);
  builder.join();
  std::printf("%d frames tracked, %d messages to the map\n", tracked, messages);
  return 0;
}
