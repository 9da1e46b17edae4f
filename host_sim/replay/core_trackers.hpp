#pragma once

#include "cairn/base/config.hpp"
#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"
#include "cairn/runtime/handheld_tracker.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"
#include "cairn/runtime/window_tracker.hpp"

/// The core's trackers with the capacities and filters that the host offers, compiled once, in the
/// library cairn_host_trackers: a compiler takes many seconds for each.
///
/// CAIRN_TRACKER_<filter>(prefix, Config): explicit instantiations of a filter and its tracker.
// NOLINTBEGIN(bugprone-macro-parentheses): template arguments take none
#define CAIRN_VEHICLE_TRACKER(prefix, Config, ...) \
  prefix class FrameTracker<Config, __VA_ARGS__>;  \
  prefix class VehicleTracker<Config, __VA_ARGS__>;
#define CAIRN_TRACKER_ekf(prefix, Config)                                       \
  prefix class PlanarSlam<WorldErrorModel<float, Config::kMaxLandmarks, 3, 2>>; \
  CAIRN_VEHICLE_TRACKER(prefix, Config, EkfSlam<float, Config::kMaxLandmarks, 3>)
#define CAIRN_TRACKER_group_iekf(prefix, Config)                                \
  prefix class PlanarSlam<GroupErrorModel<float, Config::kMaxLandmarks, 3, 2>>; \
  CAIRN_VEHICLE_TRACKER(prefix, Config, GroupIekfSlam<float, Config::kMaxLandmarks, 3>)
#define CAIRN_TRACKER_group_iekf_fixed(prefix, Config)  \
  prefix class FixedVehicleSlam<Config::kMaxLandmarks>; \
  CAIRN_VEHICLE_TRACKER(prefix, Config, FixedVehicleSlam<Config::kMaxLandmarks>)
#define CAIRN_TRACKER_lifted_iekf(prefix, Config)                             \
  prefix class PlanarSlam<LiftedErrorModel<float, Config::kMaxLandmarks, 3>>; \
  CAIRN_VEHICLE_TRACKER(prefix, Config, LiftedIekfSlam<float, Config::kMaxLandmarks, 3>)
#define CAIRN_TRACKER_mono(prefix, Config)           \
  prefix class MonoEkf<float, Config::kMaxFeatures>; \
  prefix class HandheldTracker<Config>;
#define CAIRN_TRACKER_window(prefix, Config) prefix class WindowTracker<Config>;

// In one source: the filters' trackers share two thirds of their parts.
#define CAIRN_TRACKER_vehicle(prefix, Config)                                \
  CAIRN_TRACKER_ekf(prefix, Config) CAIRN_TRACKER_group_iekf(prefix, Config) \
      CAIRN_TRACKER_group_iekf_fixed(prefix, Config) CAIRN_TRACKER_lifted_iekf(prefix, Config)

#define CAIRN_TRACKERS(prefix, Config)                                     \
  CAIRN_TRACKER_vehicle(prefix, Config) CAIRN_TRACKER_mono(prefix, Config) \
      CAIRN_TRACKER_window(prefix, Config)
// NOLINTEND(bugprone-macro-parentheses)

namespace cairn {

CAIRN_TRACKERS(extern template, TinyConfig)
CAIRN_TRACKERS(extern template, DefaultConfig)
CAIRN_TRACKERS(extern template, LargeConfig)

}  // namespace cairn

#undef CAIRN_TRACKERS
