#pragma once

#include "cairn/tracking/window_measurement.hpp"

namespace cairn {

/// `later`: units of work to leave.
template <class Config>
bool WindowMeasurement<Config>::search(const Scene& scene, const Rigid<float>& predicted, int first,
                                       int last, int radius, int later) {
  FrameContext& frame = scene.frame;
  Features& features = scene.features;
  const typename Features::Parameters& p = features.parameters();
  const bool near = radius < p.wide_radius_px;
  const int each =
      work::template_search(radius) + (near ? 2 : 1) * work::template_search(p.full_radius_px);
  for (int i = first; i < last; ++i) {
    if (features[i].found) continue;
    if (!frame.work.affords(each + later + work::window_pose(first))) {
      frame.work.raise_cut(i == 0 ? FrameCut::kPredictionOnly : FrameCut::kFewerUpdates);
      return false;
    }
    const Vector2<float> expected = exposures_.expected_pixel(
        frame.camera, scene.window, features[i], scene.track.pose(), predicted);
    if (near) {
      features.search_near(frame, i, expected, radius);
    } else {
      features.search(frame, i, expected, radius);
    }
    ++frame.report.searched;
  }
  return true;
}

template <class Config>
void WindowMeasurement<Config>::find(const Scene& scene, const Rigid<float>& predicted,
                                     const Limits& limits) {
  const typename Features::Parameters& p = scene.features.parameters();
  expose(scene.track, predicted);
  const Rigid<float> from = search_from(scene, predicted);
  const int size = scene.features.size();
  const int all = limits.features < size ? limits.features : size;
  const int first = p.first_features < all ? p.first_features : all;
  const int later = 2 * work::window_pose(kMaxFeatures) + limits.work;
  const int radius = first_radius(scene);
  if (!search(scene, from, 0, first, radius, later)) return;
  Rigid<float> pose = predicted;
  bool agree = first_agree(scene, pose);
  if (!agree && radius < p.wide_radius_px) {
    if (!search(scene, from, 0, first, p.wide_radius_px, later)) return;
    pose = predicted;
    agree = first_agree(scene, pose);
  }
  search(scene, agree ? pose : from, first, all, agree ? p.narrow_radius_px : p.wide_radius_px,
         later);
}

/// Where the features would be beyond three quarters of the wide windows, by the whole picture, the
/// search begins where that shows them.
template <class Config>
Rigid<float> WindowMeasurement<Config>::search_from(const Scene& scene,
                                                    const Rigid<float>& predicted) const {
  constexpr float kReach = 0.75F;
  const ImageView& image = scene.frame.image;
  const int radius =
      scene.features.parameters().wide_radius_px * shrink_factor(image.width, image.height);
  return scene.track.search_from(predicted, scene.step,
                                 kReach * static_cast<float>(radius) / scene.frame.camera.fx);
}

/// Radius in the shrunk image for the features that are searched first: what a gyroscope that
/// agrees leaves of the turn, and what a hand may have moved since.
template <class Config>
int WindowMeasurement<Config>::first_radius(const Scene& scene) const {
  constexpr float kSigmas = 3.0F;
  const typename Features::Parameters& p = scene.features.parameters();
  const float sigma = scene.track.direction_sigma(scene.step);
  if (!(sigma >= 0.0F)) return p.wide_radius_px;
  const ImageView& image = scene.frame.image;
  const auto shrink = static_cast<float>(shrink_factor(image.width, image.height));
  const int radius = 1 + round_to_int(kSigmas * (scene.frame.camera.fx * sigma) / shrink);
  return clamp(radius, p.narrow_radius_px, p.wide_radius_px);
}

/// Whether the features found first agree on a pose.
template <class Config>
bool WindowMeasurement<Config>::first_agree(const Scene& scene, Rigid<float>& pose) {
  Matrix<float, 6, 6> covariance = Matrix<float, 6, 6>::Zero();
  const WindowPoseOptions<float> given = options(scene, pose);
  const int found = gather(scene, pose);
  scene.frame.work.spend(work::window_pose(found));
  const int inliers = estimate_window_pose(sightings_, found, given, pose, covariance);
  return inliers >= parameters_.min_inliers && 4 * inliers >= 3 * found;
}

template <class Config>
WindowPoseOptions<float> WindowMeasurement<Config>::options(const Scene& scene,
                                                            const Rigid<float>& predicted) const {
  WindowPoseOptions<float> options;
  options.sigma = scene.window.parameters().sigma / scene.window.focal_scale();
  scene.track.observe(predicted, covariance_.template topLeftCorner<3, 3>().trace() / 3.0F,
                      options);
  return options;
}

/// What the frame found, as it would be seen at its time from `pose`.
template <class Config>
int WindowMeasurement<Config>::gather(const Scene& scene, const Rigid<float>& pose) {
  expose(scene.track, pose);
  int count = 0;
  for (int i = 0; i < scene.features.size(); ++i) {
    const WindowFeature& feature = scene.features[i];
    if (!feature.found) continue;
    sightings_[count] = scene.window.sighting(feature.slot);
    sightings_[count].seen =
        exposures_.seen_direction(scene.frame.camera, scene.window, feature, pose);
    sighted_[count++] = i;
  }
  return count;
}

template <class Config>
bool WindowMeasurement<Config>::estimate(const Scene& scene, const Rigid<float>& predicted,
                                         Rigid<float>& pose) {
  const WindowPoseOptions<float> given = options(scene, predicted);
  const int found = gather(scene, predicted);
  scene.frame.work.spend(work::window_pose(found));
  pose = predicted;
  Matrix<float, 6, 6> covariance = Matrix<float, 6, 6>::Zero();
  guided_information_ = given.attitude_information;
  inliers_ = estimate_window_pose(sightings_, found, given, pose, covariance);
  if (inliers_ >= 0) covariance_ = covariance;
  if (inliers_ < parameters_.min_inliers || 10 * inliers_ < 9 * found) {
    scene.frame.work.spend(work::window_pose(found));
    bool inlier[kMaxFeatures];
    for (int i = 0; i < found; ++i) inlier[i] = sightings_[i].inlier;
    Rigid<float> standing = scene.track.standing();
    const int from_standing = estimate_window_pose(sightings_, found, given, standing, covariance);
    if (from_standing > inliers_) {
      pose = standing;
      covariance_ = covariance;
      inliers_ = from_standing;
    } else {
      for (int i = 0; i < found; ++i) sightings_[i].inlier = inlier[i];
    }
  }
  note_matches(found);
  const int least =
      scene.track.gyro().sure() ? parameters_.guided_inliers : parameters_.min_inliers;
  return inliers_ >= least &&
         static_cast<float>(inliers_) >= parameters_.min_inlier_share * static_cast<float>(found);
}

template <class Config>
void WindowMeasurement<Config>::note_matches(int found) {
  constexpr float kKept = 0.8F;  // five frames
  agreed_ = kKept * agreed_ + static_cast<float>(inliers_ > 0 ? inliers_ : 0);
  compared_ = kKept * compared_ + static_cast<float>(found);
}

template <class Config>
void WindowMeasurement<Config>::note_agreement(FrameContext& frame, Features& features) const {
  const int found = features.found();
  for (int k = 0; k < found; ++k) {
    WindowFeature& feature = features[sighted_[k]];
    if (sightings_[k].inlier) {
      feature.outliers = 0;
      frame.report.from_library += feature.from_library ? 1 : 0;
      ++frame.health.innovations_used;
    } else {
      ++frame.health.innovations_gated;
      ++frame.report.update.gated;
      ++feature.outliers;
    }
  }
}

template <class Config>
bool WindowMeasurement<Config>::sure(const Features& features, const Window& window) const {
  if (agreed_ < parameters_.sure_share * compared_) return false;
  int from_library = 0;
  int known = 0;
  for (int i = 0; i < features.size(); ++i) {
    const WindowFeature& feature = features[i];
    if (!feature.found) continue;
    from_library += feature.outliers == 0 && feature.from_library ? 1 : 0;
    known +=
        window.sigma(feature.slot) < parameters_.known_depth * window.inverse_depth(feature.slot)
            ? 1
            : 0;
  }
  return 2 * known >= inliers_ || from_library >= parameters_.min_inliers;
}

template <class Config>
bool WindowMeasurement<Config>::attitude_alone(const Rigid<float>& predicted,
                                               const Rigid<float>& pose,
                                               Quaternion<float>& attitude,
                                               Matrix3<float>& covariance) const {
  constexpr float kLeast = 1e-4F;
  attitude = pose.rotation;
  covariance = covariance_.template topLeftCorner<3, 3>();
  const float added = guided_information_;
  if (!(added > 0.0F)) return true;
  Matrix3<float> information;
  if (!detail::invert_spd(covariance, kLeast, information)) return false;
  const Vector3<float> moved = rotation_log(pose.rotation * predicted.rotation.conjugate());
  const Vector3<float> weighed = information * moved;
  for (int i = 0; i < 3; ++i) information(i, i) -= added;
  if (!detail::invert_spd(information, kLeast, covariance)) return false;
  attitude = rotation_exp(Vector3<float>(covariance * weighed)) * predicted.rotation;
  return true;
}

}  // namespace cairn
