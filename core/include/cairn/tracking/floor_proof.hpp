#pragma once

#include <cstdint>

namespace cairn {

/// What the height of a landmark was found to say about the floor.
enum class FloorTest : std::uint8_t {
  kOpen,     ///< the height is not known well enough yet
  kCounted,  ///< it counts in the proof, and was not used
  kDone,     ///< it was used, or does not lie on the floor
};

/// Whether the ground proves to be the plane that landmarks at height 0 lie on. On a floor a good
/// share of the heights agree with 0 and none is below; on a road few agree, and as many are below
/// as above. Counts of heights, halved from time to time, so that the ground may change.
class FloorProof {
 public:
  /// Starts anew. `needed`: without it the floor counts as proven.
  void reset(bool needed) {
    *this = FloorProof();
    needed_ = needed;
  }
  bool proven() const {
    if (!needed_) return true;
    return tested_ >= kLeastTested && kFloorShare * on_floor_ >= tested_ &&
           kBelowShare * below_ <= on_floor_;
  }

  /// A height was tested. `squared`: its normalised square.
  void note(float height_m, float squared, float gate) {
    ++tested_;
    if (squared <= gate) {
      ++on_floor_;
    } else if (height_m < 0.0F) {
      ++below_;
    }
    if (tested_ < kMemory) return;
    tested_ = static_cast<std::uint8_t>(tested_ / 2);
    on_floor_ = static_cast<std::uint8_t>(on_floor_ / 2);
    below_ = static_cast<std::uint8_t>(below_ / 2);
  }

 private:
  static constexpr int kLeastTested = 16;
  static constexpr int kFloorShare = 3;   ///< one in three lies on the floor
  static constexpr int kBelowShare = 16;  ///< and one below it for 16 of these at most
  static constexpr int kMemory = 96;

  bool needed_ = false;
  std::uint8_t tested_ = 0;
  std::uint8_t on_floor_ = 0;
  std::uint8_t below_ = 0;
};

}  // namespace cairn
