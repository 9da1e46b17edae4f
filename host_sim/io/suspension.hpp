#pragma once

#include <array>
#include <string>

#include "cairn/planar/tilt.hpp"

namespace cairn::host {

/// How a vehicle's body tilts, by name.
struct NamedSuspension {
  const char* name;
  TiltParameters<double> tilt;
};
inline const std::array<NamedSuspension, 3> kSuspensions = {
    {{"flat", TiltParameters<double>::flat_floor()},
     {"car", TiltParameters<double>::car()},
     {"rover", TiltParameters<double>::rover()}}};

/// Null for a name that is none.
inline const NamedSuspension* find_suspension(const std::string& name) {
  for (const NamedSuspension& known : kSuspensions) {
    if (name == known.name) return &known;
  }
  return nullptr;
}

}  // namespace cairn::host
