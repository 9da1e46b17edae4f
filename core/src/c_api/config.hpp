#pragma once

#include "cairn/base/config.hpp"

namespace cairn::c_api {

#if defined(CAIRN_CONFIG_TINY)
using Config = TinyConfig;
#elif defined(CAIRN_CONFIG_LARGE)
using Config = LargeConfig;
#else
using Config = DefaultConfig;
#endif

}  // namespace cairn::c_api
