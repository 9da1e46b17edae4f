#pragma once

#include <cstdlib>
#include <string>

#include "cairn/mono/parameters.hpp"

namespace cairn::host {

/// Sets the fading memory as `--fading` says: `adaptive`, a factor of at least 1, or empty for the
/// filter's own.
inline void set_fading(const std::string& text, MonoParameters<float>& parameters) {
  if (text.empty()) return;
  parameters.fading = text == "adaptive" ? FadingMode::kAdaptive : FadingMode::kFixed;
  if (text != "adaptive") parameters.fading_factor = std::strtof(text.c_str(), nullptr);
}

}  // namespace cairn::host
