#pragma once

#include "cairn/estimation/candidates_first.hpp"
#include "cairn/estimation/one_point_ransac.hpp"
#include "cairn/planar/fixed/consensus.hpp"
#include "cairn/planar/fixed/fixed_planar_slam.hpp"

namespace cairn::detail {

/// One call of FixedPlanarSlam::update_pixels(), as PixelUpdate: it works on the filter's own
/// storage, pixels_ holds the candidates, those used first.
template <class Filter>
class FixedPixelUpdate {
  using Sighting = FixedPixelSighting;
  using PixelModel = typename Filter::PixelModel;
  using Consensus = FixedConsensus<typename Filter::State, Filter::kError>;

 public:
  FixedPixelUpdate(Filter& filter, const FixedCamera& camera, const FixedMount& T_vehicle_camera,
                   FixedPixel sigma_px, FixedPixelMatch* matches, int count,
                   FixedUpdateReport& report)
      : filter_(filter),
        camera_(camera),
        T_vehicle_camera_(T_vehicle_camera),
        sigma_px_(sigma_px),
        matches_(matches),
        count_(count),
        report_(report) {}

  /// With all matches inside their gates.
  Status run_with_all() {
    const Status status = check();
    if (!ok(status)) return status;
    if (rests()) return Status::kOk;
    filter_.apply(filter_.pixels_, candidates_, report_);
    finish(candidates_);
    return Status::kOk;
  }

  /// With those that agree.
  Status run(Random& random) {
    const Status status = check();
    if (!ok(status)) return status;
    if (rests()) return Status::kOk;
    const Consensus consensus(camera_, T_vehicle_camera_, filter_.parameters_.ransac_threshold);
    const auto best = one_point_ransac<Filter::kMaxObservations>(
        candidates_, filter_.parameters_.ransac, random, [&](int candidate, bool* inliers) {
          return consensus.count(candidate, filter_.pixels_, candidates_, matches_, filter_.state_,
                                 filter_.errors_, filter_.correction_, inliers,
                                 filter_.saturations_);
        });
    report_.hypotheses = best.hypotheses;
    if (!best.consensus) {
      note_missing_consensus();
      return Status::kNoConsensus;
    }
    move_to_hypothesis(best.candidate);
    const int low = relinearise(flagged_first(filter_.pixels_, best.inliers, candidates_));
    report_.low_innovation = low;
    filter_.apply(filter_.pixels_, low, report_, true);
    const int high = rescue(low);
    report_.high_innovation = high;
    filter_.apply(filter_.pixels_ + low, high, report_);
    finish(low + high);
    return Status::kOk;
  }

 private:
  Status check() const {
    const Status status = filter_.check_camera(camera_, T_vehicle_camera_, sigma_px_);
    if (!ok(status)) return status;
    const bool fits = count_ >= 0 && count_ <= Filter::kMaxObservations;
    return fits && (count_ == 0 || matches_ != nullptr) ? Status::kOk : Status::kInvalidArgument;
  }

  /// Collects the candidates; whether the vehicle rests and they tell nothing new.
  bool rests() {
    for (int i = 0; i < count_; ++i) matches_[i].inlier = false;
    collect();
    if (!filter_.rest_.resting()) return false;
    if (filter_.tells_nothing_new(filter_.pixels_, candidates_, report_)) {
      report_.low_innovation = candidates_;
      mark_inliers(candidates_);
      return true;
    }
    filter_.end_rest();
    collect();
    return false;
  }

  void finish(int used) {
    filter_.finish_update(filter_.pixels_, used, report_);
    mark_inliers(used);
  }
  void mark_inliers(int count) {
    for (int k = 0; k < count; ++k) matches_[filter_.pixels_[k].source].inlier = true;
  }

  PixelModel look() {
    return PixelModel(filter_.state_, filter_.errors_,
                      filter_.state_.camera_view(camera_, T_vehicle_camera_, filter_.saturations_),
                      sigma_px_);
  }

  /// Fills pixels_ with the matches of known landmarks inside their gates.
  void collect() {
    filter_.absorb_motion();
    report_ = FixedUpdateReport{};
    filter_.records_.begin();
    const PixelModel model = look();
    candidates_ = 0;
    for (int i = 0; i < count_; ++i) {
      const int slot = filter_.find(matches_[i].id);
      if (slot < 0) continue;
      ++report_.matches;
      if (admit(model, candidates_, slot, i, filter_.parameters_.gate)) ++candidates_;
    }
  }

  /// Makes the sighting at `place` of a match; whether it is inside its gate at the present mean.
  bool admit(const PixelModel& model, int place, int slot, int source, FixedScore gate) {
    Sighting& sighting = filter_.pixels_[place];
    sighting.slot = slot;
    sighting.source = source;
    if (linearise(model, sighting)) {
      std::uint32_t& saturations = filter_.saturations_;
      sighting.own = filter_.errors_.innovation_covariance(filter_.state_, sighting,
                                                           filter_.errors_.scratch(), saturations);
      const FixedVariance noise[2] = {sighting.noise(0, saturations),
                                      sighting.noise(1, saturations)};
      const FixedScore score =
          mahalanobis(sighting.own, noise, sighting.innovation, kPixelBits, saturations);
      if (score <= gate) {
        filter_.records_.admit(score);
        return true;
      }
    }
    filter_.records_.refuse(slot, report_, filter_.health_);
    return false;
  }

  /// At the mean as it is now; false where it has no pixel.
  bool linearise(const PixelModel& model, Sighting& sighting) {
    FixedPixelRows rows;
    if (!model.sight(sighting.slot, sighting, rows, filter_.errors_.scratch(),
                     filter_.saturations_)) {
      return false;
    }
    sighting.difference(matches_[sighting.source].pixel, rows.pixel, sighting.innovation,
                        filter_.saturations_);
    return true;
  }

  /// A gate that refuses most matches is evidence, matches that disagree are none.
  void note_missing_consensus() {
    ++filter_.health_.ransac_no_consensus;
    const FixedPlanarParameters& parameters = filter_.parameters_;
    const int refused = filter_.records_.refused();
    if (parameters.reacquire_after > 0 && refused > candidates_) {
      filter_.records_.reacquisition().note(candidates_, refused, parameters.reacquire_after,
                                            parameters.reacquire_steps);
    }
  }

  /// Corrects the mean by one candidate alone, to linearise there; the opposite stays as the
  /// prior's own deviation.
  void move_to_hypothesis(int candidate) {
    auto& correction = filter_.correction_;
    (void)Consensus::form(filter_.pixels_[candidate], filter_.state_, filter_.errors_, correction,
                          filter_.saturations_);
    correction.apply(filter_.state_, filter_.saturations_);
    correction.negate(filter_.state_size());
  }

  /// Linearises pixels_[0 .. count) at the mean as it is now. Those that have no pixel there go to
  /// the end; the number of the others.
  int relinearise(int count) {
    const PixelModel model = look();
    return good_first(filter_.pixels_, count,
                      [&](Sighting& sighting) { return linearise(model, sighting); });
  }

  /// Linearises the candidates from `first` on at the corrected state and keeps, from `first` on,
  /// those inside the rescue gate there; the number kept.
  int rescue(int first) {
    const PixelModel model = look();
    int kept = 0;
    for (int k = first; k < candidates_; ++k) {
      const int slot = filter_.pixels_[k].slot;
      const int source = filter_.pixels_[k].source;
      const FixedScore gate = filter_.parameters_.rescue_gate;
      if (admit(model, first + kept, slot, source, gate)) ++kept;
    }
    return kept;
  }

  Filter& filter_;
  const FixedCamera& camera_;
  const FixedMount& T_vehicle_camera_;
  FixedPixel sigma_px_;
  FixedPixelMatch* matches_;
  int count_;
  FixedUpdateReport& report_;
  int candidates_ = 0;
};

}  // namespace cairn::detail
