#pragma once

namespace cairn::detail {

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::predict_pixel(int slot, const PinholeCamera<T>& camera,
                                          const Rigid<T>& T_vehicle_camera, T sigma_px,
                                          PixelPrediction<T>& prediction) const {
  if constexpr (LandmarkDim != 3) {
    return Status::kInvalidArgument;
  } else {
    if (!initialised_) return Status::kNotInitialised;
    if (slot < 0 || slot >= table_.size()) return Status::kNotFound;
    if (!(sigma_px > T(0))) return Status::kInvalidArgument;
    CameraView<T> view(camera, T_vehicle_camera, sigma_px);
    view.frame = derived().frame();
    T relative[3];
    RelativeCovariance<T> covariance;
    derived().relative(slot, relative);
    derived().relative_covariance(slot, covariance);
    Pair pair;
    Vector3<T> p_camera;
    if (!linearise(view, relative, covariance, pair, p_camera)) return Status::kOutOfView;
    const Vector2<T> pixel(-pair.innovation[0], -pair.innovation[1]);
    if (!camera.contains(pixel)) return Status::kOutOfView;
    const InnovationCovariance<T> s = innovation_covariance(pair, covariance);
    prediction.id = table_.id(slot);
    prediction.slot = slot;
    prediction.pixel = pixel;
    prediction.covariance << s.s00, s.s01, s.s01, s.s11;
    prediction.p_camera = p_camera;
    return Status::kOk;
  }
}

CAIRN_PLANAR_TEMPLATE
int CAIRN_PLANAR_FILTER::resolve(const PixelMatch<T>& match) const {
  const bool same = match.slot >= 0 && match.slot < table_.size() && match.id != kNoLandmark &&
                    table_.id(match.slot) == match.id;
  return same ? match.slot : find(match.id);
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::check_pixels(const PinholeCamera<T>& camera, T sigma_px,
                                         const PixelMatch<T>* matches, int count) const {
  if (!initialised_) return Status::kNotInitialised;
  if (count < 0 || count > kMaxObservations || (count > 0 && matches == nullptr)) {
    return Status::kInvalidArgument;
  }
  bool finite = is_finite(sigma_px);
  for (int i = 0; i < count; ++i) finite = finite && all_finite(matches[i].pixel);
  if (!finite) return Status::kNonFiniteInput;
  if (!(sigma_px > T(0))) return Status::kInvalidArgument;
  return camera.validate();
}

/// Fills pairs_ with the matches inside their own gates; the number of them.
CAIRN_PLANAR_TEMPLATE
int CAIRN_PLANAR_FILTER::collect_pixels(const CameraView<T>& view, const PixelMatch<T>* matches,
                                        int count, UpdateReport& report) {
  int candidates = 0;
  for (int i = 0; i < count; ++i) {
    const int slot = resolve(matches[i]);
    if (slot < 0) continue;
    ++report.matches;
    T relative[3];
    RelativeCovariance<T> covariance;
    derived().relative(slot, relative);
    derived().relative_covariance(slot, covariance);
    Pair& pair = pairs_[candidates];
    Vector3<T> p_camera;
    pair.slot = slot;
    pair.source = i;
    if (!linearise(view, relative, covariance, pair, p_camera)) {
      refuse(slot, report);
      continue;
    }
    pair.innovation[0] += matches[i].pixel.x();
    pair.innovation[1] += matches[i].pixel.y();
    prior_[candidates] = innovation_covariance(pair, covariance);
    if (admit(pair, covariance, parameters_.gate, report)) ++candidates;
  }
  return candidates;
}

/// Corrects the mean by one candidate alone and counts the candidates that agree then: the pixel at
/// the corrected mean, judged by the covariance that is left, S_j - (H_j P H_i^T) S_i^-1 (...)^T.
CAIRN_PLANAR_TEMPLATE
int CAIRN_PLANAR_FILTER::hypothesis(const CameraView<T>& view, const PixelMatch<T>* matches,
                                    int candidate, int count, bool* supporters) {
  const int n = P_.size();
  for (int i = 0; i < n; ++i) d_[i] = T(0);
  T nis = T(0);
  if (!whiten(pairs_[candidate], 0, nis)) return 0;
  const auto trial = derived().begin_trial(d_);
  int support = 0;
  for (int k = 0; k < count; ++k) {
    const Pair& pair = pairs_[k];
    if (k != candidate) {
      T relative[3];
      derived().relative_after(pair.slot, d_, trial, relative);
      Vector2<T> pixel;
      if (!ok(view.camera->project(view.to_camera(relative), pixel))) continue;
      const Vector2<T>& measured = matches[pair.source].pixel;
      const T residual[2] = {measured.x() - pixel.x(), measured.y() - pixel.y()};
      InnovationCovariance<T> left = prior_[k];
      for (int r = 0; r < 2; ++r) {
        derived().relative_of(pair.slot, w_[r], relative);
        const T f0 = pair.row(0, relative);
        const T f1 = pair.row(1, relative);
        left.s00 -= f0 * f0;
        left.s01 -= f0 * f1;
        left.s11 -= f1 * f1;
      }
      T squared = T(0);
      if (!left.mahalanobis(residual, squared)) continue;
      if (!(squared <= parameters_.ransac_threshold)) continue;
    }
    supporters[k] = true;
    ++support;
  }
  return support;
}

/// Corrects the mean by one candidate alone, to linearise there: the curvature of a pixel in the
/// heading is a radial pattern, which looks like motion ahead. The correction is kept in d_ as the
/// prior's own deviation.
CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::move_to_hypothesis(int candidate) {
  const int n = P_.size();
  for (int i = 0; i < n; ++i) d_[i] = T(0);
  T nis = T(0);
  if (!whiten(pairs_[candidate], 0, nis)) return;
  derived().correct(d_);
  for (int i = 0; i < n; ++i) d_[i] = -d_[i];
}

/// Linearises the landmark of a pair at the mean as it is now; false, pair unusable, where it has
/// no pixel.
CAIRN_PLANAR_TEMPLATE
bool CAIRN_PLANAR_FILTER::look_again(const CameraView<T>& view, const PixelMatch<T>* matches,
                                     Pair& pair, RelativeCovariance<T>& covariance) const {
  T relative[3];
  derived().relative(pair.slot, relative);
  derived().relative_covariance(pair.slot, covariance);
  Vector3<T> p_camera;
  if (!linearise(view, relative, covariance, pair, p_camera)) return false;
  const Vector2<T>& measured = matches[pair.source].pixel;
  pair.innovation[0] += measured.x();
  pair.innovation[1] += measured.y();
  return true;
}

/// Linearises pairs_[0 .. count) at the mean as it is now. Those that have no pixel there go to the
/// end; the number of the others.
CAIRN_PLANAR_TEMPLATE
int CAIRN_PLANAR_FILTER::relinearise(CameraView<T>& view, const PixelMatch<T>* matches, int count) {
  view.frame = derived().frame();
  int k = 0;
  while (k < count) {
    RelativeCovariance<T> covariance;
    if (look_again(view, matches, pairs_[k], covariance)) {
      ++k;
      continue;
    }
    const Pair lost = pairs_[k];
    pairs_[k] = pairs_[--count];
    pairs_[count] = lost;
  }
  return count;
}

/// Looks at pairs_[first .. count) again from the corrected state and keeps, from `first` on, those
/// that fit now; the number kept.
CAIRN_PLANAR_TEMPLATE
int CAIRN_PLANAR_FILTER::rescue(CameraView<T>& view, const PixelMatch<T>* matches, int first,
                                int count, UpdateReport& report) {
  view.frame = derived().frame();
  int kept = 0;
  for (int k = first; k < count; ++k) {
    Pair& pair = pairs_[first + kept];
    pair.slot = pairs_[k].slot;
    pair.source = pairs_[k].source;
    RelativeCovariance<T> covariance;
    if (!look_again(view, matches, pair, covariance)) {
      refuse(pair.slot, report);
      continue;
    }
    if (admit(pair, covariance, parameters_.rescue_gate, report)) ++kept;
  }
  return kept;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::update_pixels(const PinholeCamera<T>& camera,
                                          const Rigid<T>& T_vehicle_camera, T sigma_px,
                                          PixelMatch<T>* matches, int count, Random& random,
                                          UpdateReport& report) {
  if constexpr (LandmarkDim != 3) {
    return Status::kInvalidArgument;
  } else {
    const Status status = check_pixels(camera, sigma_px, matches, count);
    if (status == Status::kNonFiniteInput) ++health_.non_finite_inputs;
    if (!ok(status)) return status;

    report = UpdateReport{};
    refused_count_ = 0;
    for (int i = 0; i < count; ++i) matches[i].inlier = false;
    CameraView<T> view(camera, T_vehicle_camera, sigma_px);
    view.frame = derived().frame();
    const int candidates = collect_pixels(view, matches, count, report);

    derived().begin_update();
    const auto best = one_point_ransac<kMaxObservations>(
        candidates, parameters_.ransac, random, [&](int candidate, bool* supporters) {
          return hypothesis(view, matches, candidate, candidates, supporters);
        });
    report.hypotheses = best.hypotheses;
    if (!best.consensus) {
      ++health_.ransac_no_consensus;
      // A gate that refuses most matches is evidence, matches that disagree are none. The next
      // prediction may widen the pose, this call may not.
      if (parameters_.reacquire_after > 0 && refused_count_ > candidates) {
        reacquisition_.note(candidates, refused_count_, parameters_.reacquire_after,
                            parameters_.reacquire_steps);
      }
      return Status::kNoConsensus;
    }

    move_to_hypothesis(best.candidate);
    int low = 0;
    for (int k = 0; k < candidates; ++k) {
      if (!best.supporters[k]) continue;
      const Pair supporter = pairs_[k];
      pairs_[k] = pairs_[low];
      pairs_[low++] = supporter;
    }
    low = relinearise(view, matches, low);
    report.low_innovation = low;
    use(0, low, report, true);
    const int high = rescue(view, matches, low, candidates, report);
    report.high_innovation = high;
    use(low, high, report);
    for (int k = 0; k < low + high; ++k) matches[pairs_[k].source].inlier = true;
    conclude(low + high, report);
    return Status::kOk;
  }
}

}  // namespace cairn::detail
