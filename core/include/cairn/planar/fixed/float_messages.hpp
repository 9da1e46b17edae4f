#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/float_bits.hpp"
#include "cairn/planar/fixed/camera.hpp"
#include "cairn/planar/fixed/covariance3.hpp"
#include "cairn/planar/increment.hpp"
#include "cairn/planar/types.hpp"

namespace cairn {

// Between the messages of PlanarSlam<float> and those of FixedPlanarSlam, by integers alone. Of
// what does not fit `saturations` counts one each.

FixedPose fixed_of(const PlanarPose<float>& pose, std::uint32_t& saturations);
PlanarPose<float> float_of(const FixedPose& pose);

FixedCovariance2 fixed_of(const Matrix2<float>& covariance, std::uint32_t& saturations);
Matrix2<float> float_of(const FixedCovariance2& covariance);
FixedCovariance3 fixed_of(const Matrix3<float>& covariance, std::uint32_t& saturations);
Matrix3<float> float_of(const FixedCovariance3& covariance);
/// Of (x, y, heading).
FixedPoseCovariance fixed_pose_covariance_of(const Matrix3<float>& covariance,
                                             std::uint32_t& saturations);
Matrix3<float> float_of(const FixedPoseCovariance& covariance);

FixedIncrement fixed_of(const PlanarIncrement<float>& increment, std::uint32_t& saturations);
FixedPlanarParameters fixed_of(const PlanarParameters<float>& parameters,
                               std::uint32_t& saturations);
FixedRansacParameters fixed_of(const OnePointRansacParameters& ransac, std::uint32_t& saturations);

void float_of(const FixedPixelPrediction& expected, PixelPrediction<float>& out);

}  // namespace cairn
