#pragma once

#include <cstdint>

namespace cairn {

/// Moves FAST's threshold from frame to frame so that the corner count stays near a target: the
/// cost of a frame of heavy texture or noise stays bounded, and a dull one still gives corners.
/// Integers; the same counts give the same thresholds everywhere.
///
/// The count falls roughly by half for every third more of threshold, so steps are a share of the
/// threshold that grows with the error: a third from four times the target on, a twelfth inside
/// twice of it, nothing within a fifth.
class ThresholdController {
 public:
  /// Domain: target >= 1, 1 <= lowest <= initial <= highest <= 254; anything else is moved to the
  /// nearest value inside.
  ThresholdController(int target, int initial = 20, int lowest = 5, int highest = 120)
      : target_(at_least(target, 1)),
        lowest_(at_least(lowest, 1)),
        highest_(at_most(at_least(highest, lowest_), 254)),
        threshold_(at_most(at_least(initial, lowest_), highest_)) {}

  int threshold() const { return threshold_; }

  /// Takes the number of corners found at the current threshold.
  void update(int found) {
    const std::int64_t count = at_least(found, 0);
    const std::int64_t target = target_;
    int step = 0;
    if (5 * count > 6 * target) {
      step = count >= 4 * target   ? threshold_ / 3
             : count >= 2 * target ? threshold_ / 6
                                   : threshold_ / 12;
      step = at_least(step, 1);
    } else if (5 * count < 4 * target) {
      step = 4 * count <= target   ? threshold_ / 4
             : 2 * count <= target ? threshold_ / 7
                                   : threshold_ / 13;
      step = -at_least(step, 1);
    }
    threshold_ = at_most(at_least(threshold_ + step, lowest_), highest_);
  }

 private:
  static constexpr int at_least(int value, int low) { return value < low ? low : value; }
  static constexpr int at_most(int value, int high) { return value > high ? high : value; }

  int target_;
  int lowest_;
  int highest_;
  int threshold_;
};

}  // namespace cairn
