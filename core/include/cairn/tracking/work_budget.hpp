#pragma once

#include "cairn/numeric/math.hpp"

namespace cairn {

/// Work of one frame, counted and never timed: a unit is 1000 instructions of a Cortex-M7. Before a
/// piece of work a stage checks that the budget covers its worst case; after it, it books what the
/// work took, computed from its counts. So a frame stays within its budget whatever the image
/// shows, and the same input does the same work on every machine.
class WorkBudget {
 public:
  /// Without a limit.
  WorkBudget() = default;
  explicit WorkBudget(int units) : left_(units) {}

  bool affords(int units) const { return units <= left_; }
  void spend(int units) {
    left_ -= units;
    spent_ += units;
  }
  int left() const { return left_; }
  int spent() const { return spent_; }

 private:
  static constexpr int kUnlimited = 1 << 30;
  int left_ = kUnlimited;
  int spent_ = 0;
};

/// Costs of pieces of work, in units: upper bounds on the Cortex-M7 (docs/reference/timing.md),
/// checked by the work column of scripts/firmware.sh --timing.
namespace work {

inline constexpr int kDescriptor = 17;  ///< describe_freak() and a comparison
inline constexpr int kAlignment = 46;   ///< align_patch(), template included
inline constexpr int kPatchWindow = 6;  ///< make_patch_window()
inline constexpr int kProjection = 4;   ///< of a landmark, with its innovation covariance
inline constexpr int kAppearance = 24;  ///< make_appearance()

/// detect_fast() over a window: in the worst case, where every pixel is a corner, and with a given
/// number of corners before non-maximum suppression (FastReport::candidates).
inline constexpr int fast(int width, int height) {
  return 1 + width * height / 8;
}
inline constexpr int fast(int width, int height, int candidates) {
  const int counted = 1 + width * height / 60 + candidates / 2;
  return counted < fast(width, height) ? counted : fast(width, height);
}

inline constexpr int kFrame = 150;  ///< prediction, lists, reports
/// PlanarSlam::recentre() where it moves the centre.
inline constexpr int recentring(int states) {
  return 2 + states * states / 90;
}
inline constexpr int kRemoval = 60;  ///< of a landmark, with its archiving
inline constexpr int kLandmarkInitialisation =
    90;  ///< a seed or a library landmark becomes a landmark
inline constexpr int kKeyframe = 60;
inline constexpr int kCellMotion = 2;   ///< a cell's middle a few frames later
inline constexpr int kLibrarySlot = 3;  ///< projection of a library landmark

/// update_pixels(): `hypotheses` of `candidates`, then `used` measurements of two rows, with
/// `states` in the covariance.
inline int planar_update(int states, int candidates, int hypotheses, int used) {
  const int look = 12 + 16 * candidates + hypotheses * (states / 10 + 2 * candidates);
  const int gains = used * (8 + states / 8);
  const int passes = 1 + (used + 3) / 4;
  return look + gains + passes * (states * states / 90);
}

/// What pixels of a camera that tilts with its vehicle take on top: a projection, and
/// update_pixels().
inline constexpr int kTiltedProjection = 1;
inline int tilted_update(int states, int candidates, int hypotheses, int used) {
  const int look = 2 * candidates + hypotheses * (1 + states / 50 + candidates / 6);
  return look + used * (1 + states / 50);
}

/// update_height(): one direction and a pass over the covariance.
inline int height_update(int states) {
  return 8 + states / 8 + states * states / 90;
}

inline constexpr int kMountCheck = 230;            ///< MountCheck::add()
inline constexpr int kRefinement = 400;            ///< refine_pose() with 24 points, 8 iterations
inline constexpr int kMonoFrame = 120;             ///< MonoEkf's prediction, plan, reports
inline constexpr int kFeatureInitialisation = 40;  ///< MonoEkf::add_feature()
inline constexpr int kArchiving = 30;              ///< of a MonoEkf feature

/// MonoEkf::update() with `features` in the map, `hypotheses` of `matches`, and `used` of them.
inline constexpr int mono_update(int states, int features, int matches, int hypotheses, int used) {
  const int look = 20 + features + matches * (3 + states / 18);
  const int tried = hypotheses * (5 + states / 8 + matches / 2);
  const int gains = used * (7 + states / 7);
  const int passes = used > 0 ? 2 + used / 4 : 0;
  return look + tried + gains + passes * (states * states / 110);
}

/// Hypotheses of three matches in MonoEkf::update(), beside mono_update().
inline constexpr int mono_triples(int states, int matches, int triples) {
  return triples * (21 + 3 * (states / 7) + matches / 2);
}

}  // namespace work

}  // namespace cairn
