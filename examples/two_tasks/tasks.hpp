#pragma once

#include <cstdint>

#include "cairn/map/map_builder.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/frame_tracker.hpp"

namespace example {

using Config = cairn::DefaultConfig;
using Filter = cairn::GroupIekfSlam<float, Config::kMaxLandmarks, 3>;

/// All that the two tasks share lies in `map`; the rest belongs to one task each.
struct Slam {
  cairn::FrameTracker<Config, Filter> tracker;
  cairn::MapBuilder<Config> builder;
  cairn::SharedMap<Config> map;
};

/// Before the tasks start.
cairn::Status start(Slam& slam, const cairn::PinholeCamera<float>& camera,
                    const cairn::Rigid<float>& T_vehicle_camera);

/// The task of high priority: odometry and one frame after the other, until there is none.
/// Returns the number of frames that tracked.
int tracker_task(Slam& slam);

/// One slice of the task of low priority: call it whenever there is time. Returns the number of
/// messages handled; 0: wait a little.
int builder_slice(Slam& slam);

}  // namespace example
