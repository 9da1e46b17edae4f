#pragma once

#include <string>
#include <string_view>

namespace cairn::host {

/// Reads `text`, all of it, as a finite number; a plus sign may stand before it. Returns what was
/// expected where it is none, "a number" or "a number of 2.3e-308 to 1.7e308" (of a double); empty:
/// it is one.
std::string number_problem(std::string_view text, double& value);

/// A message with its long runs of digits cut: "10000000... (309 digits)" for a number of 309.
std::string with_short_numbers(std::string_view message);

}  // namespace cairn::host
