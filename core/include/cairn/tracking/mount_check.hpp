#pragma once

#include <cstdint>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/mount_evidence.hpp"

namespace cairn {

/// How a vehicle came from one frame to the next, by odometry.
struct OdometryStep {
  PlanarPose<float> path;      ///< odometry's own pose at the frame, from any start
  float yaw_variance = 0.0F;   ///< of the yaw increment since the frame before, rad^2
  float tilt_variance = 0.0F;  ///< of pitch and of roll since the frame before, rad^2
  float step_s = 0.0F;
};

/// Watches the matches of a vehicle's landmarks for what a wrong mount or focal length does to
/// them, beside the filter and without a part in tracking. It compares each frame with a reference
/// frame, until the points have moved far enough to tell the direction of travel; then the frame
/// becomes the next reference.
class MountCheck {
 public:
  static constexpr int kMostViews = 24;

  /// Starts anew with the assumed camera and mount. `sigma_px`: standard deviation of a match.
  void reset(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
             float sigma_px);

  /// The matches of one frame of the camera given to reset(), whether the filter agrees with them
  /// or not. Looks at the first kMostViews that the reference has too. Cost on a Cortex-M7: some
  /// 25,000 instructions, and 200,000 more in the frames that become the reference.
  void add(const PinholeCamera<float>& camera, const OdometryStep& step,
           const PixelMatch<float>* matches, int count);

  const MountOffset& offset() const { return evidence_.offset(); }

 private:
  /// Where a landmark was seen, in 1/32 px, with the low half of its id, which tells those apart
  /// that are tracked at a time.
  struct View {
    std::uint16_t id = 0;
    std::uint16_t x = 0;
    std::uint16_t y = 0;

    Vector2<float> pixel() const {
      return Vector2<float>(static_cast<float>(x), static_cast<float>(y)) * (1.0F / kPerPixel);
    }
  };
  static constexpr float kPerPixel = 32.0F;
  using Views = FixedVector<View, kMostViews>;

  static View view_of(const PixelMatch<float>& match);
  const View* find(LandmarkId id) const;
  /// Evaluates the matches against the reference: whether it has served.
  bool compare(const PinholeCamera<float>& camera, const OdometryStep& step,
               const PixelMatch<float>* matches, int count);
  void take_reference(const OdometryStep& step, const PixelMatch<float>* matches, int count);

  MountEvidence evidence_;
  Vector3<float> camera_m_ = Vector3<float>::Zero();
  Views reference_;
  PlanarPose<float> path_;
  float yaw_variance_ = 0.0F;  ///< since the reference
  float tilt_variance_ = 0.0F;
  float since_s_ = 0.0F;
};

}  // namespace cairn
