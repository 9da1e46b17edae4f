#pragma once

#include "cairn/tracking/odometry_motion.hpp"

namespace cairn {

/// Which samples of the odometry are believed: none that jumps, none that the images contradict;
/// and how far the speed of those that are may be off because wheels slip.
class OdometryTrust {
 public:
  static constexpr float kLongestContradiction_s = 10.0F;
  /// Glitches in a row, each like the one before, after which they are believed.
  static constexpr int kGlitchesToBelieve = 3;

  void reset() { *this = OdometryTrust(); }

  /// Whether a reading changed faster than a vehicle can, and is not yet believed for its
  /// persistence. The wheels are then taken for slipping by the jump.
  bool is_glitch(const OdometrySample& sample, const OdometryMotion& motion);
  /// While the images hold the motion: whether the sample differs from what they show. While they
  /// are blind nothing contradicts it.
  bool is_contradicted(const OdometrySample& sample, const OdometryMotion& motion);
  /// An image moved the pose by `ahead_m` within `step_s`: whether images contradict the samples,
  /// low-passed, by more than their noise and by more than a fifth.
  bool note_image(float ahead_m, float step_s, const OdometryMotion& motion);
  /// An image shows a speed that is off by `seen_mps`.
  void note_slip(float seen_mps, float step_s, const OdometryMotion& motion);
  /// With time, seen or not: what the wheels did a while ago says little about now.
  void fade(float step_s);

  /// Standard deviation of the speed that glitches and images show.
  float slip_mps() const { return slip_mps_; }
  /// Whether the images contradict the samples, or did for so long that these are believed all the
  /// same, since the scale is theirs to tell: doubted for as long again.
  bool doubts() const { return contradicted_ || doubted_s_ > 0.0F; }

 private:
  OdometrySample glitch_;
  int glitches_ = 0;
  float slip_mps_ = 0.0F;
  float excess_mps_ = 0.0F;  ///< low-passed speed by images less that of samples
  float doubted_s_ = 0.0F;   ///< that a contradiction has lasted; after it, that doubt still lasts
  bool contradicted_ = false;
};

}  // namespace cairn
