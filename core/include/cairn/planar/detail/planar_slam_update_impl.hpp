#pragma once

#include "cairn/planar/detail/pixel_update.hpp"
#include "cairn/planar/planar_slam.hpp"

// PlanarSlam: updates and their book-keeping.

namespace cairn {

template <class ErrorModel>
template <class Observation, class Sensor>
Status PlanarSlam<ErrorModel>::check_observations(Span<Observation> observations,
                                                  const Sensor& sensor) {
  if (!initialised_) return Status::kNotInitialised;
  if (observations.size < 0 || observations.size > kMaxObservations) {
    return Status::kInvalidArgument;
  }
  Status worst = Status::kOk;
  for (const Observation& o : observations) {
    const Status status = sensor.check(o);
    if (status == Status::kNonFiniteInput) {
      ++health_.non_finite_inputs;
      return status;
    }
    if (!ok(status)) worst = status;
  }
  return worst;
}

/// Fills observations_ with the sightings of known landmarks inside their gates; the number of
/// them.
template <class ErrorModel>
template <class Observation, class Sensor>
int PlanarSlam<ErrorModel>::collect(Span<Observation> observations, const Sensor& sensor,
                                    UpdateReport& report) {
  report = UpdateReport{};
  refused_count_ = 0;
  admitted_nis_ = T(0);
  singular_ = false;
  const RelativeFrame<T> frame = model_.frame();
  int count = 0;
  for (int i = 0; i < observations.size; ++i) {
    const int slot = find(observations[i].id);
    if (slot < 0) continue;
    ++report.matches;
    Linearised& linearised = observations_[count];
    linearised = Linearised();
    linearised.slot = slot;
    linearised.source = i;
    T relative[kLandmarkDim];
    RelativeCovariance<T> covariance;
    model_.relative(slot, relative);
    model_.relative_covariance(slot, covariance);
    if (!sensor.linearise(observations[i], frame, relative, covariance, linearised)) {
      ++health_.innovations_singular;
      continue;
    }
    if (admit(linearised, innovation_covariance(linearised, covariance), parameters_.gate,
              report)) {
      ++count;
    }
  }
  return count;
}

template <class ErrorModel>
template <class Observation, class Sensor>
Status PlanarSlam<ErrorModel>::update(Span<Observation> observations, const Sensor& sensor,
                                      UpdateReport& report) {
  const Status status = check_observations(observations, sensor);
  if (!ok(status)) return status;
  int count = collect(observations, sensor, report);
  if (rest_.resting()) {
    if (tells_nothing_new(count, report)) return Status::kOk;
    end_rest();
    count = collect(observations, sensor, report);
  }
  apply_update(0, count, report);
  finish_update(count, report);
  return Status::kOk;
}

/// At rest: whether observations_[0 .. count) agree with no motion. They are then counted, and the
/// noise held back is dropped.
template <class ErrorModel>
bool PlanarSlam<ErrorModel>::tells_nothing_new(int count, UpdateReport& report) {
  constexpr int kFewest = 3;        // fewer prove little
  constexpr int kRefusedShare = 4;  // nor do some of which one in four is refused
  if (count < kFewest || refused_count_ * kRefusedShare > count || singular_) return false;
  int rows = 0;
  for (int k = 0; k < count; ++k) rows += observations_[k].rows;
  if (!rest_.agrees(admitted_nis_, rows, parameters_.rest_sigmas)) return false;
  if (!(parameters_.rest_sigmas > T(0))) return false;
  rest_.begin();
  report.nis += static_cast<float>(admitted_nis_);
  report.nis_dof += rows;
  finish_update(count, report);
  return true;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::update_pixels(const PinholeCamera<T>& camera,
                                             const Rigid<T>& T_vehicle_camera, T sigma_px,
                                             PixelMatch<T>* matches, int count, Random& random,
                                             UpdateReport& report) {
  if constexpr (kLandmarkDim != 3) {
    return Status::kInvalidArgument;
  } else {
    detail::PixelUpdate<PlanarSlam> update(*this, camera, T_vehicle_camera, sigma_px, matches,
                                           count, report);
    return update.run(random);
  }
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::update_height(LandmarkId id, T height_m, T sigma_m, T gate) {
  if constexpr (kLandmarkDim != 3) {
    return Status::kInvalidArgument;
  } else {
    if (!initialised_) return Status::kNotInitialised;
    if (!is_finite(height_m) || !is_finite(sigma_m)) return Status::kNonFiniteInput;
    if (!(sigma_m > T(0)) || !(gate > T(0))) return Status::kInvalidArgument;
    Linearised& height = observations_[0];
    height = Linearised();
    height.slot = find(id);
    if (height.slot < 0) return Status::kNotFound;
    T relative[3];
    RelativeCovariance<T> covariance;
    model_.relative(height.slot, relative);
    model_.relative_covariance(height.slot, covariance);
    height.rows = 1;
    height.innovation[0] = height_m - relative[2];
    height.h[0][2] = T(1);
    height.r00 = square(sigma_m);
    T squared = T(0);
    if (!innovation_covariance(height, covariance).mahalanobis(height.innovation, squared)) {
      ++health_.innovations_singular;
      return Status::kSingular;
    }
    if (!(squared <= gate)) return Status::kGated;
    singular_ = false;
    UpdateReport report;
    apply_update(0, 1, report);
    return Status::kOk;
  }
}

template <class ErrorModel>
bool PlanarSlam<ErrorModel>::admit(const Linearised& observation, const InnovationCovariance<T>& s,
                                   T gate, UpdateReport& report) {
  T squared = T(0);
  if (!s.mahalanobis(observation.innovation, squared)) {
    ++health_.innovations_singular;
    singular_ = true;
    return false;
  }
  if (squared <= gate) {
    admitted_nis_ += squared;
    return true;
  }
  refuse(observation.slot, report);
  return false;
}

template <class ErrorModel>
void PlanarSlam<ErrorModel>::refuse(int slot, UpdateReport& report) {
  ++report.gated;
  ++health_.innovations_gated;
  refused_[refused_count_++] = static_cast<std::int16_t>(slot);
}

/// Updates with observations_[first .. first + count), all linearised at the present mean.
/// `deviates`: see WhitenedUpdate::apply().
template <class ErrorModel>
void PlanarSlam<ErrorModel>::apply_update(int first, int count, UpdateReport& report,
                                          bool deviates) {
  T nis = T(0);
  int rows = 0;
  const int singular = update_.apply(model_, observations_ + first, count, deviates, nis, rows);
  report.nis_dof += rows;
  rest_.note_moving(nis, rows);
  health_.innovations_singular += static_cast<std::uint32_t>(singular);
  report.nis += static_cast<float>(nis);
  guard_.check(model_, singular_ || singular > 0, health_);
  if (count > 0 && parameters_.rest_sigmas > T(0)) rest_.begin();
}

/// Book-keeping after an update: which landmarks were refused, and whether the gate has locked the
/// filter out.
template <class ErrorModel>
void PlanarSlam<ErrorModel>::finish_update(int used, UpdateReport& report) {
  if (report.matches == 0) return;
  ++updates_;
  for (int k = 0; k < used; ++k) {
    LandmarkStatistics& s = slots_.statistics(observations_[k].slot);
    ++s.measured;
    s.rejected_in_row = 0;
    s.last_measured = updates_;
  }
  int again = 0;
  for (int k = 0; k < refused_count_; ++k) {
    LandmarkStatistics& s = slots_.statistics(refused_[k]);
    ++s.rejected;
    if (++s.rejected_in_row > 1) ++again;
  }
  health_.innovations_used += static_cast<std::uint32_t>(used);
  if (parameters_.reacquire_after == 0) return;
  reacquisition_.note(used, again, parameters_.reacquire_after, parameters_.reacquire_steps);
  if (reacquisition_.accepted()) widen_refused_landmarks();
}

template <class ErrorModel>
void PlanarSlam<ErrorModel>::widen_refused_landmarks() {
  const auto after = static_cast<std::uint32_t>(parameters_.reacquire_landmark_after);
  for (int k = 0; k < refused_count_; ++k) {
    const std::uint32_t in_row = slots_.statistics(refused_[k]).rejected_in_row;
    if (in_row < after) continue;
    const std::uint32_t step = in_row - after;
    if (step > static_cast<std::uint32_t>(parameters_.reacquire_steps)) continue;
    const T scale = static_cast<T>(1 << static_cast<int>(step));
    model_.widen_landmark(refused_[k],
                          detail::at_most(square(scale * parameters_.reacquire_landmark_m),
                                          kMostPositionVariance<T>));
    ++health_.reacquisitions;
  }
}

}  // namespace cairn
