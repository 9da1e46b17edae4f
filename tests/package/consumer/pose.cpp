#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"
#include "cairn/version.hpp"

static_assert(cairn::kVersionMajor == 0 && cairn::kVersionMinor == 2, "the version asked for");
#if !defined(EIGEN_DONT_VECTORIZE)
#error "the options of cairn::core do not reach its users"
#endif

using Config = cairn::TinyConfig;
using Tracker =
    cairn::VehicleTracker<Config, cairn::GroupIekfSlam<float, Config::kMaxLandmarks, 3>>;

static Tracker tracker;

int main() {
  cairn::PinholeCamera<float> camera;
  camera.fx = camera.fy = 250.0F;
  camera.cx = 159.5F;
  camera.cy = 119.5F;
  camera.width = 320;
  camera.height = 240;
  const cairn::Rigid<float> T_vehicle_camera{{0.5F, -0.5F, 0.5F, -0.5F}, {0.35F, 0.0F, 1.0F}};
  if (!ok(tracker.initialise(camera, T_vehicle_camera, Tracker::Start{}, Tracker::Parameters{}))) {
    return 1;
  }
  return ok(tracker.add_odometry({0, cairn::OdometrySample::Kind::kTwist, 1.0F, 0.0F})) ? 0 : 1;
}
