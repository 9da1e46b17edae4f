#pragma once

namespace cairn::detail {

/// Detects that a gate has locked its filter out: updates that refused again, one after the other,
/// most of the landmarks they were shown. Counts such updates, never predictions, so it does the
/// same at every rate; an update that shows nothing says nothing.
class Reacquisition {
 public:
  void clear() { *this = Reacquisition{}; }

  /// An update that used `used` landmarks and refused `again` that it had refused before. From the
  /// `after`-th refusal in a row on each one asks for a step, `most` + 1 steps in all. Accepting as
  /// many as it refuses proves little right after a step, when two landmarks can be explained by a
  /// wrong pose: the steps go on with the next refusal, until `after` updates in a row accept.
  void note(int used, int again, int after, int most) {
    if (used == 0 && again == 0) return;
    accepted_ = used >= again;
    if (accepted_) {
      ++accepted_in_row_;
      const bool trusted = steps_ == 0 || steps_ > most || accepted_in_row_ >= after;
      if (trusted) clear();
      return;
    }
    accepted_in_row_ = 0;
    if (refused_ < after) ++refused_;
    if (refused_ < after || steps_ > most) return;
    ++steps_;
    due_ = true;
  }

  /// True once for each step asked for.
  bool take() {
    const bool due = due_;
    due_ = false;
    return due;
  }
  /// Steps asked for since an update was last trusted.
  int steps() const { return steps_; }
  /// Whether the last update that said something was accepted.
  bool accepted() const { return accepted_; }

 private:
  int refused_ = 0;
  int accepted_in_row_ = 0;
  int steps_ = 0;
  bool due_ = false;
  bool accepted_ = true;
};

}  // namespace cairn::detail
