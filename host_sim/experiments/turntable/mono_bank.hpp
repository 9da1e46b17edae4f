#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

/// Two pivot filters for a camera whose lever arm is not known: one starts with the lever
/// Parameters::lever_m, the other with its negative, both with Parameters::lever_sigma_m. A turn
/// about a near axis looks almost the same when the lever and the relief of the scene are both
/// reversed, and a single filter that starts in the wrong one of the two basins stays there. Both
/// hypotheses see the same matches. Their normalised innovations are summed, scaled by the noise
/// that the better one shows, and the worse hypothesis is dropped once the difference is decisive,
/// which needs parallax and nothing else. (The term log det S of the full likelihood is left out:
/// where sigma_px is larger than the noise it favours the more confident hypothesis, right or
/// wrong.)
///
/// Search, pose and features are those of the leading hypothesis. Interface and errors as MonoEkf;
/// while undecided every call costs twice as much. docs/explanation/mono-ekf.md has the experiment
/// that chose this over holding the translation at zero.
template <class T, int MaxFeatures, int MaxAnchors = (MaxFeatures < 20 ? 4 : MaxFeatures / 5)>
class MonoBank {
 public:
  using Scalar = T;
  using Filter = MonoEkf<T, MaxFeatures, MaxAnchors>;
  using Parameters = MonoParameters<T>;
  /// Difference of the sums that drops the worse hypothesis, and the one that makes the better one
  /// lead.
  static constexpr double kDecisive = 120.0;
  static constexpr double kLeading = 10.0;

  /// kBadConfig also for a motion model other than kPivot.
  Status initialise(const PinholeCamera<T>& camera, const Parameters& parameters) {
    if (parameters.motion != MotionModel::kPivot) return Status::kBadConfig;
    Parameters mirrored = parameters;
    mirrored.lever_m = -parameters.lever_m;
    const Status status = filters_[0].initialise(camera, parameters);
    if (!ok(status)) return status;
    const Status second = filters_[1].initialise(camera, mirrored);
    leader_ = 0;
    decided_ = !ok(second);
    for (int i = 0; i < 2; ++i) nis_[i] = dof_[i] = 0.0;
    switches_ = 0;
    return Status::kOk;
  }

  Status predict(T dt_s) {
    const Status status = lead().predict(dt_s);
    if (ok(status) && !decided_ && !ok(follow().predict(dt_s))) decided_ = true;
    return status;
  }

  Status update(PixelMatch<T>* matches, int count, Random& random, UpdateReport& report) {
    if (decided_) return lead().update(matches, count, random, report);
    PixelMatch<T> copies[MaxFeatures];
    const bool copied = matches != nullptr && count > 0 && count <= MaxFeatures;
    for (int i = 0; copied && i < count; ++i) copies[i] = matches[i];
    const Status status = lead().update(matches, count, random, report);
    if (!ok(status) && status != Status::kNoConsensus) return status;
    UpdateReport other;
    (void)follow().update(copied ? copies : nullptr, copied ? count : 0, random, other);
    nis_[leader_] += report.nis;
    dof_[leader_] += report.nis_dof;
    nis_[1 - leader_] += other.nis;
    dof_[1 - leader_] += other.nis_dof;
    choose();
    return status;
  }

  Status add_feature(LandmarkId id, const Vector2<T>& pixel) {
    const Status status = lead().add_feature(id, pixel);
    if (ok(status) && !decided_ && !ok(follow().add_feature(id, pixel))) decided_ = true;
    return status;
  }

  Status remove_feature(int slot) {
    const Status status = lead().remove_feature(slot);
    if (ok(status) && !decided_ && !ok(follow().remove_feature(slot))) decided_ = true;
    return status;
  }

  int prune(const FeaturePolicy& policy, int room) {
    LandmarkId removed[MaxFeatures];
    const int count = lead().prune(policy, room, removed);
    for (int i = 0; i < count && !decided_; ++i) {
      if (!ok(follow().remove_feature(follow().find(removed[i])))) decided_ = true;
    }
    return count;
  }

  int feature_count() const { return leader().feature_count(); }
  LandmarkId feature_id(int slot) const { return leader().feature_id(slot); }
  Status predict_feature(int slot, PixelPrediction<T>& prediction) const {
    return leader().predict_feature(slot, prediction);
  }
  Rigid<T> T_world_camera() const { return leader().T_world_camera(); }
  Matrix<T, 6, 6> pose_covariance() const { return leader().pose_covariance(); }
  PinholeCamera<T> camera() const { return leader().camera(); }
  T last_fading_factor() const { return leader().last_fading_factor(); }

  const Filter& leader() const { return filters_[leader_]; }
  bool decided() const { return decided_; }
  /// Evidence so far: difference of the scaled sums, positive for the mirrored lever.
  double score() const {
    if (dof_[0] <= 0.0 || dof_[1] <= 0.0) return dof_[1] - dof_[0];
    const double share[2] = {nis_[0] / dof_[0], nis_[1] / dof_[1]};
    const double noise = share[0] < share[1] ? share[0] : share[1];
    if (!(noise > 1e-3)) return 0.0;
    return (nis_[0] - nis_[1]) / noise - (dof_[0] - dof_[1]);
  }
  int switches() const { return switches_; }

 private:
  Filter& lead() { return filters_[leader_]; }
  Filter& follow() { return filters_[1 - leader_]; }

  void choose() {
    const double evidence = score();
    if ((leader_ == 0 ? evidence : -evidence) > kLeading) {
      leader_ = 1 - leader_;
      ++switches_;
    }
    if (evidence > kDecisive || evidence < -kDecisive) decided_ = true;
  }

  Filter filters_[2];
  int leader_ = 0;
  int switches_ = 0;
  bool decided_ = false;
  double nis_[2] = {};
  double dof_[2] = {};
};

}  // namespace cairn
