#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/estimation/one_point_ransac.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// How the camera is taken to move. Less freedom is more accuracy where it is true.
enum class MotionModel : std::uint8_t {
  kSixDof,        ///< constant velocity and rate, both free: a hand-held camera
  kRotationOnly,  ///< the camera sits on its rotation axis: attitude alone, features at infinity
  kPivot,         ///< the camera turns about a fixed point at a lever arm from it
};

enum class FadingMode : std::uint8_t {
  kFixed,     ///< the same factor at every prediction
  kAdaptive,  ///< strong tracking: the factor that the innovations ask for, per frame
};

/// Parameters of MonoEkf. Defaults: a hand-held camera at 25 to 30 Hz.
template <class T>
struct MonoParameters {
  MotionModel motion = MotionModel::kSixDof;

  /// Random walk of the velocity, m/s per sqrt(s), and of the rate, rad/s per sqrt(s). Too small a
  /// rate noise is the commonest cause of divergence; too large costs a wider search.
  T velocity_noise = T(0.5);
  T rate_noise = T(1);
  T initial_velocity_sigma_mps = T(2);
  T initial_rate_sigma_radps = T(0.6);
  /// Longest time step of predict().
  T max_step_s = T(1);

  T sigma_px = T(1);  ///< standard deviation of a measured pixel coordinate

  T initial_inverse_depth = T(1);        ///< 1/m (1/unit of the map: the scale is free)
  T initial_inverse_depth_sigma = T(1);  ///< 1/m
  /// New features start at the median inverse depth of the features that are known to 30 %, plus
  /// or minus half of it, once there are eight of these: the scale drifts less.
  bool depth_from_map = true;
  T min_inverse_depth = T(1e-3);  ///< an update that would go below is held here

  /// kPivot: the camera's position from the rotation centre, camera frame, m, and its deviation.
  Vector3<T> lever_m = Vector3<T>::Zero();
  T lever_sigma_m = T(0.005);

  /// Fading memory, P <- S F P F' + Q. 1 is none, to the bit.
  FadingMode fading = FadingMode::kFixed;
  T fading_factor = T(1);
  T adaptive_max_factor = T(21);  ///< kAdaptive: bound of the factor
  T adaptive_memory = T(0.6);     ///< kAdaptive: weight of the past innovations, in [0, 1)
  T adaptive_softening = T(1);    ///< kAdaptive: beta, how much of R the innovations must exceed

  bool estimate_focal_length = false;
  T focal_sigma = T(0.05);  ///< of the focal length, as a share of it

  /// Jacobians are taken at the first estimate of each inverse depth instead of the last.
  bool first_estimate_inverse_depth = false;

  /// Features initialised in the same frame share one anchor (equal to the plain filter up to
  /// rounding).
  bool share_anchors = true;

  OnePointRansacParameters ransac;
  /// Most hypotheses of three matches, drawn where those of one match convince a smaller share of
  /// the matches than `enough_inlier_share`. 0: none, as published.
  int max_triples = 0;
  T enough_inlier_share = T(0.6);
  T inlier_gate = T(kChi2Dof2Level95);  ///< of |z - h|^2 / sigma_px^2, low innovation
  T rescue_gate = T(kChi2Dof2Level99);  ///< of nu' S^-1 nu, high innovation

  /// Inverse depth becomes XYZ below this linearity index (Civera: 0.1); 0 keeps inverse depth for
  /// good, which is more accurate and takes three states more for every anchor in use.
  T linearity_threshold = T(0);
  int max_conversions_per_update = 2;

  /// Largest standard deviation, noise, length or inverse depth: its square times a long step stays
  /// a number.
  static constexpr T kLargest = T(1e6);
  /// Largest factor of the fading memory: what it fades stays a number.
  static constexpr T kLargestFading = T(1e3);

  /// kBadConfig unless every value is finite and inside its domain.
  Status validate() const {
    const T positive[] = {max_step_s,          sigma_px,      initial_inverse_depth,
                          min_inverse_depth,   inlier_gate,   rescue_gate,
                          adaptive_max_factor, fading_factor, initial_inverse_depth_sigma};
    for (const T v : positive) {
      if (!is_finite(v) || !(v > T(0))) return Status::kBadConfig;
    }
    const T not_negative[] = {velocity_noise,  rate_noise,         initial_velocity_sigma_mps,
                              lever_sigma_m,   adaptive_softening, initial_rate_sigma_radps,
                              adaptive_memory, focal_sigma,        linearity_threshold};
    for (const T v : not_negative) {
      if (!is_finite(v) || !(v >= T(0))) return Status::kBadConfig;
    }
    for (const T v : {velocity_noise, rate_noise, initial_velocity_sigma_mps,
                      initial_rate_sigma_radps, lever_sigma_m, sigma_px, initial_inverse_depth,
                      initial_inverse_depth_sigma, max_step_s}) {
      if (v > kLargest) return Status::kBadConfig;
    }
    for (int i = 0; i < 3; ++i) {
      if (!(abs(lever_m(i)) <= kLargest)) return Status::kBadConfig;
    }
    const bool good =
        fading_factor >= T(1) && fading_factor <= kLargestFading && adaptive_max_factor >= T(1) &&
        adaptive_max_factor <= kLargestFading && adaptive_memory < T(1) &&
        initial_inverse_depth >= T(1) / kLargest && focal_sigma < T(0.5) &&
        ransac.max_hypotheses >= 1 && ransac.min_inliers >= 1 && ransac.probability > 0.0F &&
        ransac.probability < 1.0F && ransac.min_inlier_share >= 0.0F &&
        ransac.min_inlier_share <= 1.0F && max_conversions_per_update >= 0 && max_triples >= 0 &&
        is_finite(enough_inlier_share) && enough_inlier_share >= T(0);
    return good ? Status::kOk : Status::kBadConfig;
  }
};

}  // namespace cairn
