#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/base/shard.hpp"

namespace cairn::host {

/// What the camera shows while it is kidnapped.
enum class KidnapKind : std::uint8_t { kBlack, kOtherPlace };

const char* to_string(KidnapKind kind);

struct KidnapSettings {
  int trials = 100;                           ///< of each kind and length
  std::vector<int> lengths = {30, 100, 300};  ///< frames without the true picture
  std::uint64_t seed = 1;
  int width = 640;
  int first_frame = 2400;  ///< trials begin from here on; the hall's laps have 2,400 frames
  int last_frame = 4400;   ///< and here at the latest
  int watched = 120;       ///< frames after the picture is back
};

struct KidnapTrial {
  int number = 0;  ///< among all trials, from 0
  KidnapKind kind = KidnapKind::kBlack;
  int length = 0;
  int start = 0;                     ///< frame from which on the picture is wrong
  int frames_to_recovery = -1;       ///< from the picture's return to lasting tracking; -1: never
  bool relocalised = false;          ///< by the library, not by the landmarks still in the filter
  double error_m = 0.0;              ///< position, at the end, against the truth
  double undisturbed_error_m = 0.0;  ///< of the tracker that saw every picture
  /// Of the pose against the undisturbed tracker's at the end (3 degrees of freedom): in the
  /// covariance of both, and in that plus what odometry alone had left open when the picture came
  /// back. The first shows overconfidence, the second a jump to a wrong place.
  double claimed_squared = 0.0;
  double jump_squared = 0.0;
  bool claimed = false;  ///< it says that it tracks at the end
};

/// Drives the built-in hall once with the group filter, and beside it, from every trial's frame on,
/// a copy of the tracker whose camera goes black or shows the opposite side of the hall while the
/// odometry goes on. Only the trials of `shard`, sorted by number. Deterministic in the settings;
/// a trial does not depend on the others. `progress` gets frames done and their number.
std::vector<KidnapTrial> run_kidnap_trials(const KidnapSettings& settings, const Shard& shard,
                                           const std::function<void(int, int)>& progress);

}  // namespace cairn::host
