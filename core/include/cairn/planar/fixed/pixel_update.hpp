#pragma once

#include "cairn/estimation/one_point_ransac.hpp"
#include "cairn/planar/fixed/fixed_planar_slam.hpp"

namespace cairn::detail {

/// One call of FixedPlanarSlam::update_pixels(), as PixelUpdate: it works on the filter's own
/// storage, pixels_ holds the candidates, those used first.
template <class Filter>
class FixedPixelUpdate {
  using Sighting = typename Filter::PixelSighting;
  using Hypothesis = FixedHypothesis<Filter::kStates>;

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
    const auto best = one_point_ransac<Filter::kMaxObservations>(
        candidates_, filter_.parameters_.ransac, random,
        [this](int candidate, bool* inliers) { return test_hypothesis(candidate, inliers); });
    report_.hypotheses = best.hypotheses;
    if (!best.consensus) {
      note_missing_consensus();
      return Status::kNoConsensus;
    }
    move_to_hypothesis(best.candidate);
    const int low = relinearise(inliers_first(best.inliers));
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
    if (filter_.tells_nothing_new(candidates_, report_)) {
      report_.low_innovation = candidates_;
      mark_inliers(candidates_);
      return true;
    }
    filter_.end_rest();
    collect();
    return false;
  }

  void finish(int used) {
    for (int k = 0; k < used; ++k) {
      filter_.used_[k] = static_cast<std::int16_t>(filter_.pixels_[k].slot);
    }
    filter_.finish_update(used, report_);
    mark_inliers(used);
  }
  void mark_inliers(int count) {
    for (int k = 0; k < count; ++k) matches_[filter_.pixels_[k].source].inlier = true;
  }

  FixedCameraView look() {
    return filter_.camera_view(camera_, T_vehicle_camera_, filter_.saturations_);
  }

  /// Fills pixels_ with the matches of known landmarks inside their gates.
  void collect() {
    filter_.absorb_motion();
    report_ = FixedUpdateReport{};
    filter_.refused_count_ = 0;
    filter_.admitted_score_ = 0;
    const FixedCameraView view = look();
    candidates_ = 0;
    for (int i = 0; i < count_; ++i) {
      const int slot = filter_.find(matches_[i].id);
      if (slot < 0) continue;
      ++report_.matches;
      if (!admit(view, candidates_, slot, i, filter_.parameters_.gate)) continue;
      filter_.used_[candidates_++] = static_cast<std::int16_t>(slot);
    }
  }

  /// Makes the sighting at `place` of a match; whether it is inside its gate at the present mean.
  bool admit(const FixedCameraView& view, int place, int slot, int source, FixedScore gate) {
    Sighting& sighting = filter_.pixels_[place];
    sighting.slot = slot;
    sighting.source = source;
    if (linearise(view, sighting)) {
      std::uint32_t& saturations = filter_.saturations_;
      sighting.own = filter_.innovation_of(sighting, filter_.scratch_, saturations);
      const FixedVariance noise[2] = {sighting.noise(0, saturations),
                                      sighting.noise(1, saturations)};
      const FixedScore score =
          mahalanobis(sighting.own, noise, sighting.innovation, kPixelBits, saturations);
      if (score <= gate) {
        filter_.admitted_score_ += score.raw();
        return true;
      }
    }
    filter_.refuse(slot, report_);
    return false;
  }

  /// At the mean as it is now; false where it has no pixel.
  bool linearise(const FixedCameraView& view, Sighting& sighting) {
    FixedPixelRows rows;
    if (!filter_.sight(view, sighting.slot, sigma_px_, sighting, rows, filter_.scratch_,
                       filter_.saturations_)) {
      return false;
    }
    innovation(sighting, rows.pixel, sighting.innovation);
    return true;
  }

  void innovation(const Sighting& sighting, const FixedPixel (&expected)[2],
                  std::int64_t (&out)[2]) {
    for (int i = 0; i < 2; ++i) {
      const std::int64_t missed =
          std::int64_t{matches_[sighting.source].pixel[i].raw()} - expected[i].raw();
      out[i] = wide::multiply(missed, sighting.per_pixel[i], FixedPixel::kFractionBits,
                              filter_.saturations_);
    }
  }

  FixedMeasurement measurement_of(const Sighting& sighting) const {
    static_assert(FixedMeasurement::kBits == kPixelBits);
    FixedMeasurement out;
    out.last = filter_.state_of(sighting.slot) + Filter::kLandmarkDim - 1;
    for (int i = 0; i < 2; ++i) {
      out.row[i] = filter_.row_of(sighting, i);
      out.innovation[i] = sighting.innovation[i];
      out.sigma[i] = sighting.sigma[i];
    }
    return out;
  }

  /// The correction of the mean by one candidate alone, into the filter's.
  Hypothesis form(int candidate) {
    Hypothesis hypothesis(filter_.factor_, filter_.scratch_);
    hypothesis.form(measurement_of(filter_.pixels_[candidate]), filter_.saturations_);
    for (int i = 0; i < filter_.factor_.size(); ++i) {
      filter_.correction_[i] =
          hypothesis.correction(i, filter_.correction_bits(i), filter_.saturations_);
    }
    return hypothesis;
  }

  /// Corrects the mean by one candidate alone and counts the candidates that agree then: the pixel
  /// at the corrected mean, judged by the covariance that is left.
  int test_hypothesis(int candidate, bool* inliers) {
    const Hypothesis hypothesis = form(candidate);
    const FixedExponential exponential(FixedAngle::from_raw(filter_.correction_[0]),
                                       filter_.saturations_);
    const FixedCameraView view = view_after(exponential);
    int count = 0;
    for (int k = 0; k < candidates_; ++k) {
      if (k != candidate && !agrees(hypothesis, exponential, view, filter_.pixels_[k])) continue;
      inliers[k] = true;
      ++count;
    }
    return count;
  }

  bool agrees(const Hypothesis& hypothesis, const FixedExponential& exponential,
              const FixedCameraView& view, const Sighting& other) {
    std::uint32_t& saturations = filter_.saturations_;
    FixedLength relative[3];
    relative_after(exponential, other.slot, relative);
    FixedProjection projection;
    if (!view.see(relative, projection, saturations)) return false;
    std::int64_t residual[2];
    innovation(other, projection.pixel, residual);
    const FixedVariance noise[2] = {other.noise(0, saturations), other.noise(1, saturations)};
    bool inside = false;
    if (is_certain(other.own, noise, residual, inside)) return inside;
    const FixedStateRow rows[2] = {filter_.row_of(other, 0), filter_.row_of(other, 1)};
    const FixedCovariance2 left = hypothesis.left(rows, other.own, saturations);
    const FixedScore score = mahalanobis(left, noise, residual, kPixelBits, saturations);
    return score <= filter_.parameters_.ransac_threshold;
  }

  /// Whether any covariance between the noise alone and the prior gives one answer, and which: most
  /// matches need no more.
  bool is_certain(const FixedCovariance2& prior, const FixedVariance (&noise)[2],
                  const std::int64_t (&residual)[2], bool& inside) const {
    std::uint32_t none = 0;  // what is too large is large
    const auto squared = [&](int i) {
      constexpr int kDown = 2 * kPixelBits - FixedVariance::kFractionBits;
      return FixedVariance::from_raw(wide::multiply(residual[i], residual[i], kDown, none));
    };
    const auto allowed = [&](FixedVariance variance) {
      return multiply<FixedVariance>(variance, filter_.parameters_.ransac_threshold, none);
    };
    const FixedVariance x = squared(0);
    const FixedVariance y = squared(1);
    inside = add(x, y, none) <= allowed(noise[0] < noise[1] ? noise[0] : noise[1]);
    return inside || x > allowed(add(prior.xx, noise[0], none)) ||
           y > allowed(add(prior.yy, noise[1], none));
  }

  /// The camera at the mean that the correction would give.
  FixedCameraView view_after(const FixedExponential& exponential) {
    const FixedAxes axes(
        wrapped_angle(std::int64_t{filter_.heading_.raw()} + exponential.angle().raw()));
    const FixedTilt tilt = filter_.tilt_after();
    return FixedCameraView(camera_, T_vehicle_camera_, axes.cosine, axes.sine,
                           filter_.tilts() ? &tilt : nullptr, filter_.saturations_);
  }
  /// A landmark from the vehicle there.
  void relative_after(const FixedExponential& exponential, int slot, FixedLength (&out)[3]) {
    std::uint32_t& saturations = filter_.saturations_;
    const int l = filter_.state_of(slot);
    const auto by = [&](int i) { return FixedOffset::from_raw(filter_.correction_[i]); };
    FixedCoordinate r[2];
    for (int axis = 0; axis < 2; ++axis) {
      r[axis] = convert<FixedCoordinate>(filter_.relative(slot, axis), saturations);
    }
    exponential.move(r[0], r[1], subtract(by(l), by(1), saturations),
                     subtract(by(l + 1), by(2), saturations), saturations);
    for (int axis = 0; axis < 2; ++axis) out[axis] = convert<FixedLength>(r[axis], saturations);
    const auto height = convert<FixedLength>(filter_.landmark_height(slot), saturations);
    out[2] = add(height, convert<FixedLength>(by(l + 2), saturations), saturations);
  }

  /// A gate that refuses most matches is evidence, matches that disagree are none.
  void note_missing_consensus() {
    ++filter_.health_.ransac_no_consensus;
    const FixedPlanarParameters& parameters = filter_.parameters_;
    if (parameters.reacquire_after > 0 && filter_.refused_count_ > candidates_) {
      filter_.reacquisition_.note(candidates_, filter_.refused_count_, parameters.reacquire_after,
                                  parameters.reacquire_steps);
    }
  }

  /// Corrects the mean by one candidate alone, to linearise there; the opposite stays as the
  /// prior's own deviation.
  void move_to_hypothesis(int candidate) {
    (void)form(candidate);
    filter_.correct();
    for (int i = 0; i < filter_.factor_.size(); ++i) {
      filter_.correction_[i] = -filter_.correction_[i];
    }
  }

  /// Moves the inliers to the front of pixels_; the number of them.
  int inliers_first(const bool* inliers) {
    int count = 0;
    for (int k = 0; k < candidates_; ++k) {
      if (inliers[k]) exchange(k, count++);
    }
    return count;
  }
  void exchange(int a, int b) {
    const Sighting moved = filter_.pixels_[a];
    filter_.pixels_[a] = filter_.pixels_[b];
    filter_.pixels_[b] = moved;
  }

  /// Linearises pixels_[0 .. count) at the mean as it is now. Those that have no pixel there go to
  /// the end; the number of the others.
  int relinearise(int count) {
    const FixedCameraView view = look();
    int k = 0;
    while (k < count) {
      if (linearise(view, filter_.pixels_[k])) {
        ++k;
      } else {
        exchange(k, --count);
      }
    }
    return count;
  }

  /// Linearises the candidates from `first` on at the corrected state and keeps, from `first` on,
  /// those inside the rescue gate there; the number kept.
  int rescue(int first) {
    const FixedCameraView view = look();
    int kept = 0;
    for (int k = first; k < candidates_; ++k) {
      const int slot = filter_.pixels_[k].slot;
      const int source = filter_.pixels_[k].source;
      const FixedScore gate = filter_.parameters_.rescue_gate;
      if (admit(view, first + kept, slot, source, gate)) ++kept;
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
