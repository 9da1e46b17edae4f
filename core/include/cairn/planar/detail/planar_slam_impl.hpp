#pragma once

#include "cairn/planar/observation/camera_view.hpp"
#include "cairn/planar/planar_slam.hpp"

// PlanarSlam: start, prediction, what is read out.

namespace cairn {

namespace detail {

/// Noise on the pose, as far as a filter reckons with it.
template <class Model, class T>
void widen_pose(Model& model, T position_variance, T heading_variance) {
  model.widen_pose(at_most(position_variance, kMostPositionVariance<T>),
                   at_most(heading_variance, kMostHeadingVariance<T>));
}

}  // namespace detail

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::check_start(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                                           const PlanarParameters<T>& parameters) {
  if (!all_finite(pose.position) || !is_finite(pose.heading) || !all_finite(covariance)) {
    return Status::kNonFiniteInput;
  }
  for (int i = 0; i < 3; ++i) {
    if (!(covariance(i, i) >= T(0))) return Status::kInvalidArgument;
    for (int j = 0; j < i; ++j) {
      const T product = covariance(i, i) * covariance(j, j);
      if (covariance(i, j) != covariance(j, i) ||
          covariance(i, j) * covariance(i, j) > product * T(1.0001)) {
        return Status::kInvalidArgument;
      }
    }
    const T most = i < 2 ? kMostPositionVariance<T> : kMostHeadingVariance<T>;
    if (covariance(i, i) > most) return Status::kInvalidArgument;
  }
  if (abs(pose.heading) > T(1e4)) return Status::kInvalidArgument;
  for (int i = 0; i < 2; ++i) {
    if (abs(pose.position(i)) > kMostPosition<T>) return Status::kInvalidArgument;
  }
  const PlanarParameters<T>& p = parameters;
  const bool sane =
      p.gate > T(0) && p.ransac_threshold > T(0) && p.rescue_gate > T(0) &&
      p.reacquire_after >= 0 && p.reacquire_landmark_after >= 1 && p.reacquire_steps >= 0 &&
      p.reacquire_steps <= 20 && p.reacquire_position_m >= T(0) &&
      p.reacquire_heading_rad >= T(0) && p.reacquire_landmark_m >= T(0) && p.replace_after >= 0 &&
      p.rest_sigmas >= T(0) && p.tilt.valid() && (kTilts || !p.tilt.tilts()) &&
      p.travel_sigma_rad >= T(0) && p.travel_sigma_rad <= T(0.3) &&
      is_finite(p.gate + p.ransac_threshold + p.rescue_gate + p.reacquire_position_m +
                p.reacquire_heading_rad + p.reacquire_landmark_m + p.rest_sigmas) &&
      p.ransac.max_hypotheses >= 1 && p.ransac.probability > 0.0F && p.ransac.probability < 1.0F &&
      p.ransac.min_inlier_share >= 0.0F && p.ransac.min_inlier_share <= 1.0F;
  return sane ? Status::kOk : Status::kBadConfig;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::initialise(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                                          const PlanarParameters<T>& parameters) {
  const Status status = check_start(pose, covariance, parameters);
  if (!ok(status)) return status;
  parameters_ = parameters;
  health_ = Health{};
  slots_.clear();
  model_.start(pose, covariance);
  if constexpr (kTilts) model_.start_tilt(parameters.tilt);
  if constexpr (ErrorModel::kTurnsAboutAnchor) model_.start_travel(parameters.travel_sigma_rad);
  updates_ = 0;
  reacquisition_.clear();
  rest_ = detail::Rest<T>();
  guard_.clear();
  initialised_ = true;
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::predict(const PlanarIncrement<T>& increment) {
  if (!initialised_) return Status::kNotInitialised;
  const Status status = validate(increment);
  if (status == Status::kNonFiniteInput) ++health_.non_finite_inputs;
  if (!ok(status)) return status;
  if (!rest_.hold(increment)) {
    end_rest();
    model_.propagate(increment);
  }
  if (reacquisition_.take()) {
    end_rest();
    const T scale = static_cast<T>(1 << (reacquisition_.steps() - 1));
    detail::widen_pose(model_, square(scale * parameters_.reacquire_position_m),
                       square(scale * parameters_.reacquire_heading_rad));
    ++health_.reacquisitions;
  }
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::predict_tilt(T dt_s) {
  if (!initialised_) return Status::kNotInitialised;
  if (!is_finite(dt_s) || dt_s < T(0)) return Status::kInvalidArgument;
  if constexpr (kTilts) {
    if (!model_.tilts() || rest_.hold_time(dt_s)) return Status::kOk;
    const T decay = parameters_.tilt.decay(dt_s);
    model_.propagate_tilt(decay, parameters_.tilt.noise(decay));
  }
  return Status::kOk;
}

template <class ErrorModel>
Vector2<typename ErrorModel::Scalar> PlanarSlam<ErrorModel>::tilt_noise(T dt_s) const {
  if (!tilts()) return Vector2<T>::Zero();
  return parameters_.tilt.noise(parameters_.tilt.decay(dt_s));
}

template <class ErrorModel>
Matrix3<typename ErrorModel::Scalar> PlanarSlam<ErrorModel>::own_pose_covariance() const {
  if constexpr (ErrorModel::kTurnsAboutAnchor) return model_.own_pose_covariance();
  return pose_covariance();
}

/// The vehicle may have moved, or there is something to learn without motion.
template <class ErrorModel>
void PlanarSlam<ErrorModel>::end_rest() {
  if (!rest_.resting()) return;
  const bool noise = rest_.holds_noise();
  [[maybe_unused]] const T held_s = rest_.held_s();
  const PlanarIncrement<T> held = rest_.end();
  if (noise) model_.propagate(held);
  if constexpr (kTilts) {
    if (held_s > T(0)) static_cast<void>(predict_tilt(held_s));
  }
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::widen_pose(T position_variance, T heading_variance) {
  if (!initialised_) return Status::kNotInitialised;
  if (!is_finite(position_variance) || !is_finite(heading_variance)) return Status::kNonFiniteInput;
  if (position_variance < T(0) || heading_variance < T(0)) return Status::kInvalidArgument;
  end_rest();
  detail::widen_pose(model_, position_variance, heading_variance);
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::slip_laterally(T variance) {
  if (!initialised_) return Status::kNotInitialised;
  if (!is_finite(variance)) return Status::kNonFiniteInput;
  if (variance < T(0)) return Status::kInvalidArgument;
  if (variance == T(0)) return Status::kOk;
  end_rest();
  model_.slip_laterally(detail::at_most(variance, kMostPositionVariance<T>));
  return Status::kOk;
}

template <class ErrorModel>
bool PlanarSlam<ErrorModel>::recentre() {
  if constexpr (ErrorModel::kTurnsAboutAnchor) {
    if (!initialised_ || !model_.bends()) return false;
    model_.move_anchor();
    return true;
  } else {
    return false;
  }
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::predict_range_bearing(int slot, T sensor_offset_m, T sigma_range,
                                                     T sigma_bearing,
                                                     RangeBearingPrediction<T>& prediction) const {
  if (!initialised_) return Status::kNotInitialised;
  if (slot < 0 || slot >= slots_.size()) return Status::kNotFound;
  if (!(sigma_range > T(0)) || !(sigma_bearing > T(0))) return Status::kInvalidArgument;
  T relative[kLandmarkDim];
  RelativeCovariance<T> covariance;
  model_.relative(slot, relative);
  model_.relative_covariance(slot, covariance);
  // Innovations of a sighting at range and bearing zero are minus what is expected.
  RangeBearingObservation<T> zero;
  zero.sigma_range = sigma_range;
  zero.sigma_bearing = sigma_bearing;
  Linearised expected;
  const RangeBearingSensor<T> sensor{sensor_offset_m};
  if (!sensor.linearise(zero, model_.frame(), relative, covariance, expected)) {
    return Status::kOutOfView;
  }
  const InnovationCovariance<T> s = innovation_covariance(expected, covariance);
  prediction.range = -expected.innovation[0];
  prediction.bearing = -expected.innovation[1];
  prediction.covariance << s.s00, s.s01, s.s01, s.s11;
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::predict_pixel(int slot, const PinholeCamera<T>& camera,
                                             const Rigid<T>& T_vehicle_camera, T sigma_px,
                                             PixelPrediction<T>& prediction) const {
  if constexpr (kLandmarkDim != 3) {
    return Status::kInvalidArgument;
  } else {
    if (!initialised_) return Status::kNotInitialised;
    if (slot < 0 || slot >= slots_.size()) return Status::kNotFound;
    if (!(sigma_px > T(0))) return Status::kInvalidArgument;
    const CameraView<T> view = camera_view(camera, T_vehicle_camera, sigma_px);
    T relative[3];
    RelativeCovariance<T> covariance;
    model_.relative(slot, relative);
    model_.relative_covariance(slot, covariance);
    Linearised expected;
    Vector3<T> p_camera;
    if (!view.linearise(relative, covariance, expected, p_camera)) return Status::kOutOfView;
    const Vector2<T> pixel(-expected.innovation[0], -expected.innovation[1]);
    if (!camera.contains(pixel)) return Status::kOutOfView;
    expected.slot = slot;
    const InnovationCovariance<T> s = innovation_of(expected, covariance, view.frame);
    prediction.id = slots_.id(slot);
    prediction.slot = slot;
    prediction.pixel = pixel;
    prediction.covariance << s.s00, s.s01, s.s01, s.s11;
    prediction.p_camera = p_camera;
    return Status::kOk;
  }
}

/// A camera on the vehicle at its mean tilt.
template <class ErrorModel>
CameraView<typename ErrorModel::Scalar> PlanarSlam<ErrorModel>::camera_view(
    const PinholeCamera<T>& camera, const Rigid<T>& T_vehicle_camera, T sigma_px) const {
  const bool tilted = tilts();
  CameraView<T> view(
      camera, tilted ? tilt().T_level_vehicle() * T_vehicle_camera : T_vehicle_camera, sigma_px);
  view.frame = model_.frame();
  view.tilts = tilted;
  return view;
}

/// S of an observation linearised at the present mean in `frame`, whose relative vector has
/// `covariance`.
template <class ErrorModel>
InnovationCovariance<typename ErrorModel::Scalar> PlanarSlam<ErrorModel>::innovation_of(
    const Linearised& observation, const RelativeCovariance<T>& covariance,
    [[maybe_unused]] const RelativeFrame<T>& frame) const {
  InnovationCovariance<T> s = innovation_covariance(observation, covariance);
  if constexpr (kTilts) {
    if (observation.tilts) {
      T relative[3];
      model_.relative(observation.slot, relative);
      const TiltRows<T> rows(observation, relative, model_.tilt_axes(frame));
      TiltCovariance<T> tilt;
      model_.tilt_covariance(observation.slot, tilt);
      add_tilt_covariance(observation, rows, tilt, s);
    }
  }
  return s;
}

template <class ErrorModel>
typename PlanarSlam<ErrorModel>::LandmarkMatrix
PlanarSlam<ErrorModel>::relative_landmark_covariance(int slot) const {
  RelativeCovariance<T> relative;
  model_.relative_covariance(slot, relative);
  LandmarkMatrix out;
  for (int i = 0; i < kLandmarkDim; ++i) {
    for (int j = 0; j <= i; ++j) {
      out(i, j) = relative.s[i * (i + 1) / 2 + j];
      out(j, i) = out(i, j);
    }
  }
  return out;
}

template <class ErrorModel>
void PlanarSlam<ErrorModel>::hash(Hash64& hash) const {
  model_.hash_mean(hash);
  hash.add(static_cast<std::int32_t>(slots_.size()));
  for (int slot = 0; slot < slots_.size(); ++slot) hash.add(slots_.id(slot));
  const auto& P = model_.covariance();
  const int count = P.size() * (P.size() + 1) / 2;
  for (int k = 0; k < count; ++k) hash.add(P.data()[k]);
  if constexpr (ErrorModel::kDefersNoise) model_.hash_deferred(hash);
  hash.add(static_cast<std::uint8_t>(rest_.resting()));
  for (int i = 0; i < 2; ++i) hash.add(rest_.held().covariance(i, i));
}

}  // namespace cairn
