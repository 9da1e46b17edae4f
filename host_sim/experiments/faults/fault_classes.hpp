#pragma once

#include <vector>

#include "host_sim/experiments/faults/fault.hpp"

namespace cairn::host {

using FaultOutcomes = std::vector<FaultOutcome>;

// picture_faults.cpp
FaultOutcomes inject_dropped_frames(const FaultScene& scene);
FaultOutcomes inject_blind_frames(const FaultScene& scene);
FaultOutcomes inject_corrupted_frames(const FaultScene& scene);
FaultOutcomes inject_aliases(const FaultScene& scene);
FaultOutcomes inject_flicker(const FaultScene& scene);
FaultOutcomes inject_kidnapping(const FaultScene& scene);
// time_faults.cpp
FaultOutcomes inject_frame_order(const FaultScene& scene);
FaultOutcomes inject_time_jumps(const FaultScene& scene);
// odometry_faults.cpp
FaultOutcomes inject_odometry_garbage(const FaultScene& scene);
FaultOutcomes inject_wrong_odometry(const FaultScene& scene);
// setup_faults.cpp
FaultOutcomes inject_bad_calibration(const FaultScene& scene);
// call_faults.cpp
FaultOutcomes inject_wrong_pictures(const FaultScene& scene);
FaultOutcomes inject_short_work(const FaultScene& scene);
FaultOutcomes inject_standing(const FaultScene& scene);
// core_faults.cpp
FaultOutcomes inject_full_map(const FaultScene& scene);
FaultOutcomes inject_call_order(const FaultScene& scene);
FaultOutcomes inject_tick_wrap(const FaultScene& scene);
FaultOutcomes inject_overwriting(const FaultScene& scene);
// geometry_faults.cpp
FaultOutcomes inject_planar_ambiguity(const FaultScene& scene);
FaultOutcomes inject_singular_innovation(const FaultScene& scene);
FaultOutcomes inject_domain_edges(const FaultScene& scene);
// memory_faults.cpp
FaultOutcomes inject_bit_flips(const FaultScene& scene);
// file_faults.cpp
FaultOutcomes inject_other_versions(const FaultScene& scene);
FaultOutcomes inject_damaged_files(const FaultScene& scene);

}  // namespace cairn::host
