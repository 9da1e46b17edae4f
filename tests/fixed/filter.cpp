// The planar filters and the seeds' odometry without floating point, for the symbols of their
// archive.
#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"
#include "cairn/tracking/fixed_seed_odometry.hpp"

#include "tests/fixed/filters.hpp"

template class cairn::FixedPlanarSlam<20, 2, cairn::FixedError::kGroup>;
template class cairn::FixedPlanarSlam<16, 3, cairn::FixedError::kGroup>;
template class cairn::FixedPlanarSlam<20, 2, cairn::FixedError::kWorld>;
template class cairn::FixedVehicleSlam<16>;
template class cairn::FixedSeedOdometry<16, 8>;
