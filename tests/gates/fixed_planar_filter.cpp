// The planar filter without floating point as one object, for gate_fixed_point.
#include "cairn/planar/fixed/fixed_group_slam.hpp"

template class cairn::FixedGroupSlam<20>;
