#pragma once

#include "cairn/planar/lifted/error_model.hpp"
#include "cairn/planar/planar_slam.hpp"

namespace cairn {

/// Paper A's IEKF-SLAM: the state lifted to second-order polynomials, equations (5) to (28) with
/// the errata corrected and the cross blocks that the paper leaves out
/// (docs/explanation/errata-paper-a.md). Noise by the printed Jacobians, or by exact trigonometric
/// moments (LiftedParameters::exact_moments).
///
/// It is here to be compared with: 9 to 15 times the cost of GroupIekfSlam, which is the same idea
/// reduced, and overconfident from a known start (docs/explanation/iekf-slam.md).
///
/// T is float or double; LandmarkDim 2 or 3. Interface: PlanarSlam. Cost: prediction 8 N^2,
/// N = 11 + 6 n.
template <class T, int MaxLandmarks, int LandmarkDim = 2>
class LiftedIekfSlam : public PlanarSlam<LiftedErrorModel<T, MaxLandmarks, LandmarkDim>> {
  using Slam = PlanarSlam<LiftedErrorModel<T, MaxLandmarks, LandmarkDim>>;

 public:
  /// As PlanarSlam::initialise(), with the settings that this filter has of its own.
  Status initialise(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                    const PlanarParameters<T>& parameters = PlanarParameters<T>{},
                    const LiftedParameters& lifted = LiftedParameters{}) {
    const Status status = Slam::check_start(pose, covariance, parameters);
    if (!ok(status)) return status;
    this->model_.set_parameters(lifted);
    return Slam::initialise(pose, covariance, parameters);
  }

  /// Lifted state i (0 .. state_size() - 1), vehicle first; its covariance: error_covariance().
  T lifted(int i) const { return this->model_.lifted(i); }
};

}  // namespace cairn
