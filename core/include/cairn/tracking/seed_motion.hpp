#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/seed.hpp"

namespace cairn {

/// How a vehicle moves between two frames, as far as its seeds need it.
struct VehicleMotion {
  float speed_mps = 0.0F;
  float step_s = 0.0F;        ///< since the frame before
  float yaw_variance = 0.0F;  ///< of odometry's yaw increment since then, rad^2
  int inliers = 0;            ///< by which the filter then corrected it
  float turn_rad = 0.0F;      ///< that odometry expects of a step
};

/// Where the camera will be `steps` such steps from now, seen from where it is.
inline Rigid<float> camera_after(const VehicleMotion& motion, int steps,
                                 const Rigid<float>& T_vehicle_camera) {
  const auto count = static_cast<float>(steps);
  const float yaw = count * motion.turn_rad;
  float sine = 0.0F;
  float cosine = 0.0F;
  sin_cos(0.5F * yaw, sine, cosine);
  const float ahead = count * motion.speed_mps * motion.step_s;
  const Rigid<float> T_now_later = {rotation_exp(Vector3<float>(0.0F, 0.0F, yaw)),
                                    Vector3<float>(ahead * cosine, ahead * sine, 0.0F)};
  return T_vehicle_camera.inverse() * (T_now_later * T_vehicle_camera);
}

/// How far inside the picture a point must stay.
inline constexpr float kStayingMargin_px = 6.0F;

/// Whether a point at a pixel, `depth_m` away, is still in view of the camera at `T_later_now`,
/// when its depth can be known. A seed that is not is in vain, and takes the place of one that
/// stays.
class StayingInView {
 public:
  StayingInView(const PinholeCamera<float>& camera, const Rigid<float>& T_later_now, float depth_m)
      : camera_(camera), T_later_now_(T_later_now), depth_m_(depth_m) {}

  bool operator()(const Vector2<float>& pixel) const {
    const Vector3<float> p_now = depth_m_ * camera_.unproject(pixel);
    Vector2<float> later;
    return ok(camera_.project(T_later_now_ * p_now, later)) &&
           camera_.contains(later, kStayingMargin_px);
  }

 private:
  const PinholeCamera<float>& camera_;
  Rigid<float> T_later_now_;
  float depth_m_;
};

/// Errors of the estimate's motion, as the seeds take it.
struct SeedNoise {
  float inlier_px = 1.2F;  ///< of what one inlier tells of the yaw since the frame before
  float pitch = 5.5e-4F;   ///< about the camera's x axis, rad per root second, beside the tilt's
  float off_path = 0.01F;  ///< SeedParameters::off_path: slip to the side, bumps

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good = is_positive(inlier_px) && is_finite(pitch) && pitch >= 0.0F &&
                      off_path >= 0.0F && off_path <= 1.0F;
    return good ? Status::kOk : Status::kBadConfig;
  }
};

/// Variances of a rotation about the vehicle's axes, about those of the camera.
inline Vector3<float> about_camera_axes(const Matrix3<float>& R_vehicle_camera,
                                        const Vector3<float>& variances) {
  return R_vehicle_camera.cwiseAbs2().transpose() * variances;
}

/// Variances about the vehicle's axes of how wrong the estimate's rotation since the frame before
/// is: no more than the noise of that time, and no more than the tilt's own errors at both ends.
template <class Estimate>
Vector3<float> rotation_since_last_frame(const SeedNoise& noise, const Estimate& estimate,
                                         const VehicleMotion& motion) {
  const Vector2<float> step = estimate.tilt_noise(motion.step_s);
  const Matrix2<float> tilt = estimate.tilt_covariance();
  const auto least = [](float a, float b) { return a < b ? a : b; };
  const float by_odometry = square(sqrt(motion.yaw_variance) + 1e-4F);
  const float by_images =
      static_cast<float>(motion.inliers) * square(estimate.camera().fx / noise.inlier_px);
  const float yaw = by_odometry / (1.0F + by_odometry * by_images);
  return {least(step.y(), 2.0F * tilt(1, 1)), least(step.x(), 2.0F * tilt(0, 0)), yaw};
}

/// Whether the length of the way since a keyframe is known to a quarter of itself. Distances of
/// landmarks are multiples of it: of a vehicle that has moved by hardly more than its odometry's
/// noise, a map of any size would follow, and none of the filter's linear errors says so. True for
/// a keyframe that the filter does not have. `Estimate`: VehicleEstimate.
template <class Estimate>
bool way_is_known(const Estimate& estimate, LandmarkId keyframe) {
  constexpr float kMostRelativeSigma = 0.25F;
  const auto& filter = estimate.filter();
  const int slot = filter.find(keyframe);
  if (slot < 0) return true;
  const Vector2<float> way =
      filter.mean_pose().position - filter.mean_landmark(slot).template head<2>();
  const Matrix2<float> covariance =
      filter.relative_landmark_covariance(slot).template topLeftCorner<2, 2>();
  return way.dot(covariance * way) < square(kMostRelativeSigma * way.dot(way));
}

/// The seeds' parameters for one frame. Depth is measured by the distance travelled: a fast vehicle
/// must expect, and may trust, larger depths. The estimate's rotation is uncertain about the
/// vehicle's axes; the seeds need it about the camera's. `Estimate`: VehicleEstimate.
template <class Estimate>
SeedParameters seeds_in_motion(const SeedParameters& parameters, const SeedNoise& noise,
                               const Estimate& estimate, const VehicleMotion& motion) {
  constexpr float kInitialDepth_s = 1.2F;
  constexpr float kMaxDepth_s = 6.0F;
  SeedParameters seeds = parameters;
  const float speed = abs(motion.speed_mps);
  if (kInitialDepth_s * speed > seeds.initial_depth_m) {
    seeds.initial_depth_m = kInitialDepth_s * speed;
    seeds.initial_sigma_rho = 1.0F / seeds.initial_depth_m;
  }
  if (kMaxDepth_s * speed > seeds.max_depth_m) seeds.max_depth_m = kMaxDepth_s * speed;
  const Matrix3<float> R_vehicle_camera = estimate.T_vehicle_camera().rotation.toRotationMatrix();
  const Vector3<float> step =
      about_camera_axes(R_vehicle_camera, rotation_since_last_frame(noise, estimate, motion));
  const Matrix2<float> tilt = estimate.tilt_covariance();
  const Vector3<float> tilts =
      about_camera_axes(R_vehicle_camera, Vector3<float>(tilt(1, 1), tilt(0, 0), 0.0F));
  seeds.sigma_pitch_rad = sqrt(step.x() + square(noise.pitch) * motion.step_s);
  seeds.sigma_yaw_rad = sqrt(step.y());
  seeds.sigma_roll_rad = sqrt(2.0F * tilts.z());
  seeds.off_path = noise.off_path;
  return seeds;
}

}  // namespace cairn
