#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/experiments/faults/fault.hpp"
#include "host_sim/sources/frame_source.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

constexpr int kOneSecond = 30;  ///< frames, of the scenes' rate
constexpr int kTwoSeconds = 60;
constexpr double kOutside9999Dof3 = 21.108;  ///< chi-square, 3 degrees of freedom

/// A frame on its way to the tracker, which an injection may change.
struct FaultStep {
  Frame frame;
  bool dropped = false;   ///< the picture does not come; its odometry does
  bool repeated = false;  ///< the picture comes twice
};

/// Changes `step`, whose frame is `k` frames after the fault's begin.
using Injection = std::function<void(int k, FaultStep& step)>;

/// What a drive with a fault gave, from the fault's begin on.
struct FaultDrive {
  int frames = 0;                                ///< pictures handed over
  int refused = 0;                               ///< of these
  int refused_odometry = 0;                      ///< samples
  int refused_and_changed = 0;                   ///< refused inputs that changed the estimate
  std::map<std::string, int> statuses;           ///< of frames
  std::map<std::string, int> odometry_statuses;  ///< of samples
  std::map<std::string, int> states;
  int false_claims = 0;  ///< state tracking while the truth lies outside 99.99 %
  int not_positive = 0;  ///< frames in which a covariance was not finite and positive definite
  int not_finite = 0;    ///< frames in which the pose was not finite
  int over_work = 0;     ///< frames that took more work than they may
  int most_work = 0;
  std::optional<double> worst_error_m;  ///< against the truth
  std::optional<double> final_error_m;
  std::optional<double> worst_nees;  ///< 3 degrees of freedom
  int frames_to_return = -1;         ///< from the fault's end to five frames of tracking; -1: never
  int losses = 0;
  int relocalisations = 0;
  std::string end_state;
  std::string counters;  ///< as they grew
  Health grown;
};

struct FaultSettings {
  int from = 300;          ///< frames before a fault
  int work_limit = 10000;  ///< of the tracker that is driven
  bool brief = false;      ///< fewer draws, shorter faults
  std::uint64_t seed = 1;
};

/// An input with a tracker that has seen the part of it before every fault.
class FaultScene {
 public:
  /// Domain: more frames than settings.from.
  FaultScene(SourceInfo info, std::vector<Frame> frames, const TrackerOptions& options,
             const FaultSettings& settings);

  const SourceInfo& info() const { return info_; }
  const std::vector<Frame>& frames() const { return frames_; }
  const TrackerOptions& options() const { return options_; }
  const FaultSettings& settings() const { return settings_; }
  bool vehicle() const { return options_.mode == Mode::kVehicle; }
  bool ackermann() const;
  bool has_gyro() const { return vehicle() && !ackermann(); }
  /// Frames from a fault's begin to the end.
  int rest() const { return static_cast<int>(frames_.size()) - settings_.from; }

  /// The tracker before the fault. Tracks the frames before it when first called.
  std::unique_ptr<Tracker> tracker() const;
  /// Drives it on with `injection` for the first `length` frames and without it after them.
  FaultDrive drive(int length, const Injection& injection) const;
  /// The same for a tracker of one's own, over the frames from `first` on.
  FaultDrive drive(Tracker& tracker, int first, int length, const Injection& injection) const;

 private:
  SourceInfo info_;
  std::vector<Frame> frames_;
  TrackerOptions options_;
  FaultSettings settings_;
  mutable std::unique_ptr<Tracker> before_;
};

/// Starts the vehicle at the true pose of `first`, where that is known.
void start_at(const Frame& first, TrackerOptions& options);

/// "name +n" of every counter of faults that grew.
std::string grown_counters(const Health& before, const Health& after);

/// What every drive must keep: finite, positive definite, refused inputs without effect, no more
/// work than allowed, and no frame called tracking while the truth lies outside 99.99 %.
FaultJudge& expect_honest(FaultJudge& judge, const FaultDrive& drive);
/// Adds the figures of the drive.
FaultJudge& describe(FaultJudge& judge, const FaultDrive& drive);

}  // namespace cairn::host
