#pragma once

#include <string>

#include "cairn/tracking/handheld_gyro.hpp"

namespace cairn::host {

/// In a sentence, whether the gyroscope turned as the pictures did and, where it did not, by which
/// rotation its mounting seems to be wrong.
std::string meaning_of_gyro(const GyroReport& gyro);

}  // namespace cairn::host
