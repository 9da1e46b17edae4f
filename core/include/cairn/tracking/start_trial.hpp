#pragma once

#include "cairn/tracking/tracking_monitor.hpp"

namespace cairn {

/// The trial of a hand-held start. While rotation and translation look alike, a monocular filter
/// can settle in the mirrored solution, with translation and relief reversed. Its innovations then
/// exceed their covariance: the map has to begin anew.
class StartTrial {
 public:
  struct Parameters {
    int blocks = 5;  ///< of frames, that a start is on trial
    int block_frames = 15;
    float max_misfit = 4.0F;  ///< squared innovations of a block, relative to their covariance
    int max_restarts = 5;

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = blocks >= 0 && blocks <= 10000 && block_frames >= 1 &&
                        block_frames <= 10000 && is_positive(max_misfit) && max_restarts >= 0;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  /// Starts anew.
  void reset(const Parameters& parameters) {
    *this = StartTrial();
    parameters_ = parameters;
  }

  /// The map begins anew, and with it the trial.
  void begin() {
    frames_ = 0;
    misfit_ = dof_ = 0.0F;
  }
  /// The map is known: no trial.
  void pass() { frames_ = parameters_.blocks * parameters_.block_frames; }
  bool over() const { return frames_ >= parameters_.blocks * parameters_.block_frames; }

  /// Takes a frame's matches, 2 degrees of freedom each. A match that was refused counts with the
  /// `gate`, so that refusing matches does not hide a misfit. True at the end of a block whose
  /// innovations are too large: the start has failed.
  bool fails(const MeasurementCounts& counts, float gate) {
    if (over()) return false;
    misfit_ += counts.nis + gate * static_cast<float>(counts.matches - counts.inliers);
    dof_ += static_cast<float>(2 * counts.matches);
    if (++frames_ % parameters_.block_frames != 0) return false;
    const bool mirrored = misfit_ > parameters_.max_misfit * dof_;
    misfit_ = dof_ = 0.0F;
    return mirrored && restarts_ < parameters_.max_restarts;
  }
  /// The map began anew because of a failed start.
  void note_restart() {
    frames_ = 0;
    ++restarts_;
  }

 private:
  Parameters parameters_;
  int frames_ = 0;
  int restarts_ = 0;
  float misfit_ = 0.0F;  ///< of this block
  float dof_ = 0.0F;
};

}  // namespace cairn
