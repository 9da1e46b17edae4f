#pragma once

#include "cairn/tracking/live_landmark.hpp"
#include "cairn/tracking/relocaliser.hpp"

// Relocaliser: the pose of an image near a prior.

namespace cairn {

template <class Config>
template <class Library, class Live>
bool Relocaliser<Config>::find_near(const PlanarView& view, const PlanarPrior& prior,
                                    const Library& library, const Live& live,
                                    const Parameters& parameters, Scratch& scratch) {
  constexpr float kBeyondImage_px = 80.0F;
  auto& near = *new (&scratch.near) typename Scratch::Near();
  VisibilityOptions<float> options;
  options.margin_px = -kBeyondImage_px;
  options.min_cosine = 0.7F;
  options.min_scale = 0.5F;
  options.max_scale = 2.2F;
  int sightings = 0;
  LandmarkId in_filter[Config::kMaxLandmarks];
  int live_count = 0;
  if (live.size() > 0) {
    // An unsure heading may turn into view whatever lies ahead.
    const float turn_px = sqrt(prior.covariance(2, 2)) * view.camera.fx;
    const auto width_px = static_cast<float>(view.camera.width);
    options.margin_px -= turn_px < width_px ? turn_px : width_px;
    sightings = sight_live(view, prior, live, options.margin_px, parameters, near.sightings);
    for (; live_count < live.size(); ++live_count) in_filter[live_count] = live.id(live_count);
  }
  const Rigid<float> T_map_vehicle = on_floor(prior.pose);
  const int count =
      find_visible(library, view.camera, T_map_vehicle * view.T_vehicle_camera, options,
                   Span<LandmarkId>{in_filter, live_count}, near.visible, kMaxNear);
  for (int i = 0; i < count && sightings < kMaxNear; ++i) {
    const auto& landmark = library[near.visible[i].slot];
    const float distance = near.visible[i].prediction.p_camera.z();
    PlanarSighting& sighting = near.sightings[sightings];
    sighting.p_map = landmark.p_map;
    sighting.sigma_px =
        sqrt(square(parameters.sigma_px) +
             landmark.covariance.trace() / 3.0F * square(view.camera.fx / distance) +
             square(view.tilt_px()));
    sightings += sight(view, prior, landmark.views[0].descriptor, parameters, sighting) ? 1 : 0;
  }
  PlanarPose<float> pose;
  int inlier_count = 0;
  if (!ok(find_planar_pose(view, prior, near.sightings, sightings, parameters.near, pose,
                           inlier_count))) {
    return false;
  }
  T_map_camera_ = on_floor(pose) * view.T_vehicle_camera;
  working_ = false;
  return true;
}

/// Sightings of the filter's own landmarks; their number.
template <class Config>
template <class Live>
int Relocaliser<Config>::sight_live(const PlanarView& view, const PlanarPrior& prior,
                                    const Live& live, float margin_px, const Parameters& parameters,
                                    PlanarSighting* sightings) const {
  int count = 0;
  for (int slot = 0; slot < live.size() && count < kMaxNear; ++slot) {
    constexpr float kOwnErrors = 4.0F;  // in variances of a pixel
    LiveLandmark landmark;
    if (!live.get(slot, landmark) || !landmark.record->appearance.has_descriptor) continue;
    Vector2<float> pixel;
    Matrix<float, 2, 3> jacobian;
    PlanarSighting& sighting = sightings[count];
    sighting.p_map = landmark.p_map;
    if (!ok(view.predict(prior.pose, sighting.p_map, pixel, jacobian)) ||
        !view.camera.contains(pixel, margin_px)) {
      continue;
    }
    sighting.sigma_px = sqrt(kOwnErrors * square(parameters.sigma_px) + square(view.tilt_px()));
    const Descriptor& descriptor = landmark.record->appearance.descriptor;
    count += sight(view, prior, descriptor, parameters, sighting) ? 1 : 0;
  }
  return count;
}

/// Finds the pixel of a sighting whose place and noise are given: the feature in its ellipse that
/// looks like `descriptor`.
template <class Config>
bool Relocaliser<Config>::sight(const PlanarView& view, const PlanarPrior& prior,
                                const Descriptor& descriptor, const Parameters& parameters,
                                PlanarSighting& sighting) const {
  constexpr float kWideGate = 13.82F;  // 99.9 %
  Vector2<float> pixel;
  Matrix<float, 2, 3> jacobian;
  if (!ok(view.predict(prior.pose, sighting.p_map, pixel, jacobian))) return false;
  const Matrix2<float> S = jacobian * prior.covariance * jacobian.transpose() +
                           square(sighting.sigma_px) * Matrix2<float>::Identity();
  float i00 = 0.0F;
  float i01 = 0.0F;
  float i11 = 0.0F;
  if (!invert_spd2(S(0, 0), S(0, 1), S(1, 1), i00, i01, i11)) return false;
  const int feature =
      matcher_.best_of(descriptor, parameters.matcher, [&](const Vector2<float>& at) {
        const Vector2<float> e = at - pixel;
        return e.x() * e.x() * i00 + 2.0F * e.x() * e.y() * i01 + e.y() * e.y() * i11 <= kWideGate;
      });
  if (feature < 0) return false;
  sighting.pixel = matcher_.pixel(feature);
  return true;
}

}  // namespace cairn
