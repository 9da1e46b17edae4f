#pragma once

#include "cairn/version.h"

namespace cairn {

inline constexpr int kVersionMajor = CAIRN_VERSION_MAJOR;
inline constexpr int kVersionMinor = CAIRN_VERSION_MINOR;
inline constexpr int kVersionPatch = CAIRN_VERSION_PATCH;
/// "MAJOR.MINOR.PATCH".
inline constexpr const char* kVersion = CAIRN_VERSION_STRING;

}  // namespace cairn
