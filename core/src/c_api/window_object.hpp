#pragma once

#include "cairn/c_api/window.h"
#include "cairn/runtime/window_tracker.hpp"

#include "config.hpp"
#include "memory.hpp"

namespace cairn::c_api {

using Window = WindowTracker<Config>;

}  // namespace cairn::c_api

struct cairn_window {
  cairn::c_api::Window tracker;
  cairn::FrameReport report;
  cairn::TickSource ticks;
  cairn_window_parameters parameters = {};
  bool accepted = false;
};

static_assert(cairn_size_is_current<sizeof(cairn_window), CAIRN_WINDOW_BYTES>(), "");
static_assert(alignof(cairn_window) <= CAIRN_ALIGNMENT, "alignment of the memory handed in");
static_assert(cairn::c_api::Window::kMaxFeatures == CAIRN_WINDOW_MAX_LANDMARKS,
              "features that are followed");
