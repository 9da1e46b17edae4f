#pragma once

#include "cairn/planar/fixed/fixed_ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_group_slam.hpp"

// The filters of the archive: compiled once.

namespace cairn_test {
using PlaneFilter = cairn::FixedGroupSlam<20>;
using CameraFilter = cairn::FixedGroupSlam<16, 3>;
using PlaneEkf = cairn::FixedEkfSlam<20>;
}  // namespace cairn_test

extern template class cairn::FixedPlanarSlam<20, 2, cairn::FixedError::kGroup>;
extern template class cairn::FixedPlanarSlam<16, 3, cairn::FixedError::kGroup>;
extern template class cairn::FixedPlanarSlam<20, 2, cairn::FixedError::kWorld>;
