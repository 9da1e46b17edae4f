// The planar filter without floating point, for the symbols of its archive.
#include "tests/fixed/filters.hpp"

template class cairn::FixedGroupSlam<20>;
template class cairn::FixedGroupSlam<16, 3>;
