#pragma once

#include "cairn/planar/fixed/fixed_group_slam.hpp"

// The filters of the archive: compiled once.

extern template class cairn::FixedGroupSlam<20>;
extern template class cairn::FixedGroupSlam<16, 3>;
