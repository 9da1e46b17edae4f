#pragma once

#include "cairn/c_api/vehicle.h"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"

#include "config.hpp"
#include "map_bytes.hpp"
#include "memory.hpp"

namespace cairn::c_api {

using VehicleFilter = GroupIekfSlam<float, Config::kMaxLandmarks, 3>;
using Vehicle = VehicleTracker<Config, VehicleFilter>;

}  // namespace cairn::c_api

struct cairn_vehicle {
  cairn::c_api::Vehicle tracker;
  cairn::FrameReport report;
  cairn::TickSource ticks;
  cairn_vehicle_parameters parameters = {};
  bool accepted = false;
};

static_assert(cairn_size_is_current<sizeof(cairn_vehicle), CAIRN_VEHICLE_BYTES>(), "");
static_assert(alignof(cairn_vehicle) <= CAIRN_ALIGNMENT, "alignment of the memory handed in");
static_assert(cairn::c_api::map_bytes<cairn::c_api::Vehicle::Library>(
                  cairn::c_api::Config::kLibraryLandmarks) == CAIRN_VEHICLE_MAP_BYTES,
              "bytes of a full map");
static_assert(cairn::c_api::Config::kMaxLandmarks == CAIRN_VEHICLE_MAX_LANDMARKS,
              "landmarks of the filter");
static_assert(cairn::c_api::Config::kMaxImageWidth == CAIRN_MAX_IMAGE_WIDTH, "largest picture");
static_assert(cairn::c_api::Config::kMaxImageHeight == CAIRN_MAX_IMAGE_HEIGHT, "largest picture");
