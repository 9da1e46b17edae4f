#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/tracking/epipolar_pair.hpp"
#include "cairn/tracking/mount_offset.hpp"

namespace cairn {

/// Estimates a MountOffset from points seen twice, without their depths: by the mount, the camera
/// and the motion that odometry tells, the second view lies on a line in the image (epipolar
/// constraint). A wrong mount or camera leaves distances from that line.
///
/// Weighted least squares on those distances over many pairs of frames. The vehicle's own roll,
/// pitch and yaw between two frames are unknowns of each pair and are eliminated from it. What is
/// older than half a minute fades.
class MountEvidence {
 public:
  static constexpr int kMotions = EpipolarPair::kMotions;

  /// Starts anew. `rotation_vehicle_camera`: the assumed mount; `focal_px`: the assumed focal
  /// length; `sigma_px`: standard deviation of a view, > 0.
  void reset(const Quaternion<float>& rotation_vehicle_camera, float focal_px, float sigma_px);

  /// The camera as it is estimated by now; `origin_m` in the vehicle's frame.
  EpipolarPair::Camera camera(const Vector3<float>& origin_m) const;

  /// Takes in a pair that began with camera(), unless a third of its points disagree; the one
  /// before was `step_s` older. Cost: some 2,000 operations.
  void add(const EpipolarPair& pair, float step_s);

  const MountOffset& offset() const { return offset_; }

 private:
  static constexpr int kParts = MountOffset::kParts;

  void solve();
  void relinearise();

  Matrix3<float> assumed_ = Matrix3<float>::Identity();  ///< camera to vehicle
  float focal_px_ = 1.0F;
  float sigma_px_ = 1.0F;
  float information_[kParts][kParts] = {};
  float right_[kParts] = {};
  float squares_ = 0.0F;  ///< of normalised residuals
  float rows_ = 0.0F;
  float linearised_[kParts] = {};  ///< offset around which most of the sums were taken
  MountOffset offset_;
};

}  // namespace cairn
