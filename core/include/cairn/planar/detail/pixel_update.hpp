#pragma once

#include "cairn/estimation/candidates_first.hpp"
#include "cairn/estimation/one_point_ransac.hpp"
#include "cairn/numeric/positive_definite.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/planar/observation/camera_view.hpp"
#include "cairn/planar/types.hpp"

namespace cairn::detail {

/// One call of PlanarSlam::update_pixels(). It works on the filter's own storage: observations_
/// holds the candidates, those used first.
template <class Filter>
class PixelUpdate {
  using T = typename Filter::Scalar;
  using Linearised = LinearisedObservation<T, 3>;

 public:
  PixelUpdate(Filter& filter, const PinholeCamera<T>& camera, const Rigid<T>& T_vehicle_camera,
              T sigma_px, PixelMatch<T>* matches, int count, UpdateReport& report)
      : filter_(filter),
        T_vehicle_camera_(T_vehicle_camera),
        view_(camera, T_vehicle_camera, sigma_px),
        matches_(matches),
        count_(count),
        report_(report) {}

  Status run(Random& random) {
    const Status status = check();
    if (status == Status::kNonFiniteInput) ++filter_.health_.non_finite_inputs;
    if (!ok(status)) return status;

    for (int i = 0; i < count_; ++i) matches_[i].inlier = false;
    candidates_ = collect_candidates();
    if (filter_.rest_.resting()) {
      if (filter_.tells_nothing_new(candidates_, report_)) {
        report_.low_innovation = candidates_;
        mark_inliers(candidates_);
        return Status::kOk;
      }
      filter_.end_rest();
      candidates_ = collect_candidates();
    }

    filter_.update_.begin(filter_.model_);
    const auto best = one_point_ransac<Filter::kMaxObservations>(
        candidates_, filter_.parameters_.ransac, random,
        [this](int candidate, bool* inliers) { return test_hypothesis(candidate, inliers); });
    report_.hypotheses = best.hypotheses;
    if (!best.consensus) {
      note_missing_consensus();
      return Status::kNoConsensus;
    }

    move_to_hypothesis(best.candidate);
    const int low = relinearise(flagged_first(filter_.observations_, best.inliers, candidates_));
    report_.low_innovation = low;
    filter_.apply_update(0, low, report_, true);
    const int high = rescue(low);
    report_.high_innovation = high;
    filter_.apply_update(low, high, report_);
    mark_inliers(low + high);
    filter_.finish_update(low + high, report_);
    return Status::kOk;
  }

 private:
  Status check() const {
    if (!filter_.initialised_) return Status::kNotInitialised;
    if (count_ < 0 || count_ > Filter::kMaxObservations || (count_ > 0 && matches_ == nullptr)) {
      return Status::kInvalidArgument;
    }
    bool finite = is_finite(view_.sigma_px);
    for (int i = 0; i < count_; ++i) finite = finite && all_finite(matches_[i].pixel);
    if (!finite) return Status::kNonFiniteInput;
    if (!(view_.sigma_px > T(0))) return Status::kInvalidArgument;
    return view_.camera->validate();
  }

  void mark_inliers(int count) {
    for (int k = 0; k < count; ++k) matches_[filter_.observations_[k].source].inlier = true;
  }

  int slot_of(const PixelMatch<T>& match) const {
    const auto& slots = filter_.slots_;
    const bool same = match.slot >= 0 && match.slot < slots.size() && match.id != kNoLandmark &&
                      slots.id(match.slot) == match.id;
    return same ? match.slot : filter_.find(match.id);
  }

  /// Takes the view of the camera at the mean as it is now.
  void look() { view_ = filter_.camera_view(*view_.camera, T_vehicle_camera_, view_.sigma_px); }
  /// The same where the mean is corrected by `d`, the axes of relative vectors staying.
  CameraView<T> view_after([[maybe_unused]] const T* d) const {
    CameraView<T> view = view_;
    if constexpr (Filter::kTilts) {
      if (view.tilts) {
        view.mount(filter_.model_.tilt_after(d).T_level_vehicle() * T_vehicle_camera_);
      }
    }
    return view;
  }

  /// Fills observations_ with the matches inside their own gates; the number of them.
  int collect_candidates() {
    report_ = UpdateReport{};
    filter_.refused_count_ = 0;
    filter_.admitted_nis_ = T(0);
    filter_.singular_ = false;
    look();
    int candidates = 0;
    for (int i = 0; i < count_; ++i) {
      const int slot = slot_of(matches_[i]);
      if (slot < 0) continue;
      ++report_.matches;
      Linearised& candidate = filter_.observations_[candidates];
      candidate.slot = slot;
      candidate.source = i;
      RelativeCovariance<T> covariance;
      if (!linearise(candidate, covariance)) {
        filter_.refuse(slot, report_);
        continue;
      }
      const InnovationCovariance<T> s = filter_.innovation_of(candidate, covariance, view_.frame);
      filter_.prior_[candidates] = s;
      if (filter_.admit(candidate, s, filter_.parameters_.gate, report_)) ++candidates;
    }
    return candidates;
  }

  /// Linearises the landmark of an observation at the mean as it is now; false, observation
  /// unusable, where it has no pixel.
  bool linearise(Linearised& observation, RelativeCovariance<T>& covariance) const {
    T relative[3];
    filter_.model_.relative(observation.slot, relative);
    filter_.model_.relative_covariance(observation.slot, covariance);
    Vector3<T> p_camera;
    if (!view_.linearise(relative, covariance, observation, p_camera)) return false;
    const Vector2<T>& measured = matches_[observation.source].pixel;
    observation.innovation[0] += measured.x();
    observation.innovation[1] += measured.y();
    return true;
  }

  /// Corrects the mean by one candidate alone and counts the candidates that agree then: the pixel
  /// at the corrected mean, judged by the covariance that is left, S_j - (H_j P H_i^T) S_i^-1
  /// (...)^T.
  int test_hypothesis(int candidate, bool* inliers) {
    auto& update = filter_.update_;
    const auto& model = filter_.model_;
    if (!update.add_to_empty_batch(model, filter_.observations_[candidate])) return 0;
    const auto retraction = model.retraction(update.correction());
    const CameraView<T> view = view_after(update.correction());
    int inlier_count = 0;
    for (int k = 0; k < candidates_; ++k) {
      if (k != candidate) {
        const Linearised& other = filter_.observations_[k];
        T relative[3];
        model.relative_after(other.slot, update.correction(), retraction, relative);
        Vector2<T> pixel;
        if (!ok(view.camera->project(view.to_camera(relative), pixel))) continue;
        const Vector2<T>& measured = matches_[other.source].pixel;
        const T residual[2] = {measured.x() - pixel.x(), measured.y() - pixel.y()};
        InnovationCovariance<T> left = filter_.prior_[k];
        const TiltRows<T> tilt = update.tilt_rows(model, other);
        for (int r = 0; r < 2; ++r) {
          T f[2];
          update.rows_of(model, other, tilt, update.direction(r), f);
          left.s00 -= f[0] * f[0];
          left.s01 -= f[0] * f[1];
          left.s11 -= f[1] * f[1];
        }
        T squared = T(0);
        if (!left.mahalanobis(residual, squared)) continue;
        if (!(squared <= filter_.parameters_.ransac_threshold)) continue;
      }
      inliers[k] = true;
      ++inlier_count;
    }
    return inlier_count;
  }

  /// A gate that refuses most matches is evidence, matches that disagree are none. The next
  /// prediction may widen the pose, this call may not.
  void note_missing_consensus() {
    ++filter_.health_.ransac_no_consensus;
    const auto& parameters = filter_.parameters_;
    if (parameters.reacquire_after > 0 && filter_.refused_count_ > candidates_) {
      filter_.reacquisition_.note(candidates_, filter_.refused_count_, parameters.reacquire_after,
                                  parameters.reacquire_steps);
    }
  }

  /// Corrects the mean by one candidate alone, to linearise there: the curvature of a pixel in the
  /// heading is a radial pattern, which looks like motion ahead.
  void move_to_hypothesis(int candidate) {
    auto& update = filter_.update_;
    if (update.add_to_empty_batch(filter_.model_, filter_.observations_[candidate])) {
      update.move_mean(filter_.model_);
    }
  }

  /// Linearises observations_[0 .. count) at the mean as it is now. Those that have no pixel there
  /// go to the end; the number of the others.
  int relinearise(int count) {
    look();
    return good_first(filter_.observations_, count, [this](Linearised& observation) {
      RelativeCovariance<T> covariance;
      return linearise(observation, covariance);
    });
  }

  /// Linearises the candidates from `first` on at the corrected state and keeps, from `first` on,
  /// those inside the rescue gate there; the number kept.
  int rescue(int first) {
    look();
    int kept = 0;
    for (int k = first; k < candidates_; ++k) {
      Linearised& rescued = filter_.observations_[first + kept];
      rescued.slot = filter_.observations_[k].slot;
      rescued.source = filter_.observations_[k].source;
      RelativeCovariance<T> covariance;
      if (!linearise(rescued, covariance)) {
        filter_.refuse(rescued.slot, report_);
        continue;
      }
      const InnovationCovariance<T> s = filter_.innovation_of(rescued, covariance, view_.frame);
      if (filter_.admit(rescued, s, filter_.parameters_.rescue_gate, report_)) ++kept;
    }
    return kept;
  }

  Filter& filter_;
  const Rigid<T>& T_vehicle_camera_;
  CameraView<T> view_;
  PixelMatch<T>* matches_;
  int count_;
  UpdateReport& report_;
  int candidates_ = 0;
};

}  // namespace cairn::detail
