#pragma once

#include <cstdint>

#include "cairn/numeric/math.hpp"

namespace cairn {

/// What is known of a camera's focal length, as a factor on the one that was told: a mean and its
/// information (1 / variance), gathered from the windows that left, none of them twice.
///
/// The belief of one window, the *record*, is put aside. As its keyframes leave, each takes its
/// part of what the record adds over to what was known before; when the last has left, the record
/// is all that is known before, and the window of that time the next record. Keyframes that came
/// and left in between are not counted.
template <class T>
class FocalBelief {
 public:
  /// Starts anew with a standard deviation of the factor; 0: it is known to be 1.
  void reset(T sigma) {
    *this = FocalBelief();
    if (sigma > T(0)) known_ = record_ = {T(1), T(1) / square(sigma)};
  }
  /// Whether there is anything to estimate.
  bool uncertain() const { return known_.information > T(0); }

  /// What is known without the keyframes of the present window.
  T mean() const { return prior().mean; }
  T information() const { return prior().information; }

  /// The window's belief, `information` that of mean() and of its own observations together, by the
  /// keyframes at `places`, a bit each. It is the record, unless one of the record's keyframes
  /// left.
  void note(T mean, T information, unsigned places) {
    if (left_ < all_ || places == 0) return;
    record_ = {mean, information};
    places_ = static_cast<std::uint8_t>(places);
    all_ = left_ = count(places);
  }
  /// The keyframe at a place of the window leaves it.
  void leave(int place) {
    const unsigned flag = 1U << static_cast<unsigned>(place);
    if ((places_ & flag) == 0) return;
    places_ = static_cast<std::uint8_t>(places_ & ~flag);
    if (--left_ == 0) leave_all();
  }
  /// All keyframes leave the window at once.
  void leave_all() {
    if (all_ > 0) known_ = record_;
    places_ = 0;
    left_ = all_ = 0;
  }

 private:
  struct Estimate {
    T mean = T(1);
    T information = T(0);
  };
  static int count(unsigned places) {
    int bits = 0;
    for (; places != 0; places >>= 1U) bits += static_cast<int>(places & 1U);
    return bits;
  }
  Estimate prior() const {
    if (left_ == all_) return known_;
    const T share = static_cast<T>(all_ - left_) / static_cast<T>(all_);
    const T added = share * (record_.information - known_.information);
    Estimate sum;
    sum.information = known_.information + added;
    sum.mean =
        known_.mean + share * record_.information * (record_.mean - known_.mean) / sum.information;
    return sum;
  }

  Estimate known_;
  Estimate record_;
  std::uint8_t places_ = 0;  ///< keyframes of the record that are still in the window
  int left_ = 0;             ///< their number
  int all_ = 0;              ///< and of all that the record had
};

}  // namespace cairn
