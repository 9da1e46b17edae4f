#pragma once

#include "cairn/base/status.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/image_rotation.hpp"

namespace cairn {

/// How far a hand-held camera turned since the frame before, from the pictures as a whole: where
/// constant rate would miss the landmarks' windows. What a translation at hand's speed moves the
/// picture is no turn, so that only more than that counts.
class HandheldRotation {
 public:
  struct Parameters {
    bool used = true;
    float hand_speed_mps = 0.3F;  ///< translation that is allowed for, or the filter's, if larger
    float inflation = 2.0F;       ///< of the alignment's deviation
    float significant = 2.0F;     ///< deviations from constant rate; fewer change nothing

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = is_finite(hand_speed_mps) && hand_speed_mps >= 0.0F &&
                        is_positive(inflation) && is_finite(significant) && significant >= 0.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    pictures_.reset();
  }

  /// Takes the picture of each frame, tracked or not, if the frame's work affords it.
  void take(FrameContext& frame) {
    if (!parameters_.used) return;
    if (affordable(frame) &&
        frame.work.take(work::coarse_image(frame.image.width, frame.image.height))) {
      pictures_.take(frame.image);
    } else {
      pictures_.reset();
    }
  }

  /// Seeks the rotation since the frame before, `dt_s` ago. True where constant rate is refuted:
  /// rotation() and sigma_rad() then hold. `speed`: of the translation, in depths a second.
  bool seek(FrameContext& frame, const Vector3<float>& rate_radps, float speed_mps,
            float inverse_depth, float dt_s) {
    aligned_ = false;
    if (!parameters_.used || !affordable(frame)) return false;
    const Vector3<float> expected = rate_radps * dt_s;
    ImageRotation::Result found;
    aligned_ = pictures_.align(frame.camera, expected, found);
    frame.work.spend(work::image_rotation(found.iterations));
    if (!aligned_) return false;
    const float most =
        speed_mps > parameters_.hand_speed_mps ? speed_mps : parameters_.hand_speed_mps;
    const float moved = most * inverse_depth * dt_s;
    bool refuted = false;
    for (int i = 0; i < 3; ++i) {
      sigma_rad_(i) = sqrt(square(parameters_.inflation * found.sigma_rad(i)) + square(moved));
      const float off = abs(found.rotation(i) - expected(i));
      refuted = refuted || off > parameters_.significant * sigma_rad_(i);
    }
    rotation_ = found.rotation;
    alignment_rad_ = parameters_.inflation * found.sigma_rad;
    return refuted;
  }
  const Vector3<float>& rotation() const { return rotation_; }
  const Vector3<float>& sigma_rad() const { return sigma_rad_; }
  /// Whether seek() found how the picture moved, refuting or not: rotation() then holds, as that of
  /// the picture, what a translation moves included, and is good to alignment_rad().
  bool aligned() const { return aligned_; }
  const Vector3<float>& alignment_rad() const { return alignment_rad_; }

 private:
  /// Under a tight limit the landmarks need the work: at most a quarter of what is left.
  static bool affordable(const FrameContext& frame) {
    return frame.work.affords(4 * work::image_rotation(ImageRotation::kMaxIterations));
  }

  Parameters parameters_;
  ImageRotation pictures_;
  Vector3<float> rotation_ = Vector3<float>::Zero();
  Vector3<float> sigma_rad_ = Vector3<float>::Zero();
  Vector3<float> alignment_rad_ = Vector3<float>::Zero();
  bool aligned_ = false;
};

}  // namespace cairn
