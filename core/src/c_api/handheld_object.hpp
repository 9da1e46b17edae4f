#pragma once

#include "cairn/c_api/handheld.h"
#include "cairn/runtime/handheld_tracker.hpp"

#include "config.hpp"
#include "map_bytes.hpp"
#include "memory.hpp"

namespace cairn::c_api {

using Handheld = HandheldTracker<Config>;
inline constexpr int kHandheldLibraryLandmarks = HandheldLibraryConfig<Config>::kLibraryLandmarks;

}  // namespace cairn::c_api

struct cairn_handheld {
  cairn::c_api::Handheld tracker;
  cairn::FrameReport report;
  cairn::TickSource ticks;
  cairn_handheld_parameters parameters = {};
  bool accepted = false;
};

static_assert(cairn_size_is_current<sizeof(cairn_handheld), CAIRN_HANDHELD_BYTES>(), "");
static_assert(alignof(cairn_handheld) <= CAIRN_ALIGNMENT, "alignment of the memory handed in");
static_assert(cairn::c_api::map_bytes<cairn::c_api::Handheld::Library>(
                  cairn::c_api::kHandheldLibraryLandmarks) == CAIRN_HANDHELD_MAP_BYTES,
              "bytes of a full map");
static_assert(cairn::c_api::Config::kMaxFeatures == CAIRN_HANDHELD_MAX_LANDMARKS,
              "features of the filter");
