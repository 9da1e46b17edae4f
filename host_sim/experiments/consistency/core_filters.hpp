#pragma once

#include <memory>

#include "host_sim/experiments/consistency/filter.hpp"

namespace cairn::host {

/// Largest map of the core's filters as instantiated for the simulated world.
inline constexpr int kSimulatedCapacity = 64;

/// The core's filters behind the experiment's face. Gates and re-acquisition are off: the simulated
/// sightings hold no outliers, and a gate would cut the tails that the NEES is about.
std::unique_ptr<FilterUnderTest> make_core_ekf();
std::unique_ptr<FilterUnderTest> make_core_group_iekf();
std::unique_ptr<FilterUnderTest> make_core_ekf_float();
std::unique_ptr<FilterUnderTest> make_core_group_iekf_float();
std::unique_ptr<FilterUnderTest> make_core_group_iekf_fixed();
std::unique_ptr<FilterUnderTest> make_core_ekf_fixed();
std::unique_ptr<FilterUnderTest> make_core_lifted_iekf();
std::unique_ptr<FilterUnderTest> make_core_lifted_iekf_moments();

}  // namespace cairn::host
