#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/numeric/fixed_vector.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/appearance.hpp"

namespace cairn {

/// A point that is followed from frame to frame until its depth is known well enough to become a
/// landmark (delayed initialisation). Its inverse depth rho along the first ray is a one-state
/// Kalman filter on the relative camera motion since the first view; camera poses count as exact,
/// which is what the inflation at promotion pays for.
struct Candidate {
  Appearance appearance;     ///< first view; appearance.T_world_reference is the first camera pose
  Vector3<float> first_ray;  ///< (x, y, 1) in the first camera
  Vector2<float> pixel;      ///< last measured
  float rho = 0.0F;          ///< 1 / depth (z) in the first camera, 1/m
  float variance = 0.0F;     ///< of rho
  int seen = 1;
  int misses = 0;
};

/// A candidate whose depth is known: what the filter needs to add it.
struct Promotion {
  Appearance appearance;
  Vector3<float> p_camera;    ///< m
  Matrix3<float> covariance;  ///< of p_camera, m^2, relative to the current camera
  Vector2<float> pixel;
};

/// Bounded pool of candidates. Cost per frame: at most `MaxCandidates` patch alignments.
template <int MaxCandidates>
class CandidatePool {
 public:
  struct Parameters {
    float initial_depth_m = 4.0F;
    float initial_sigma_rho = 0.25F;  ///< 1/m: everything beyond about 1.3 m within 2 sigma
    float sigma_px = 1.0F;
    float promote_relative_sigma = 0.08F;  ///< sigma(rho) / rho
    float min_depth_m = 0.5F;
    float max_depth_m = 25.0F;
    float depth_inflation = 1.5F;  ///< of the depth's sigma at promotion
    float gate = 9.21F;
    int min_views = 4;
    int max_views = 150;
    int max_misses = 2;
    int min_correlation_q10 = 768;
  };

  int size() const { return candidates_.size(); }
  bool full() const { return candidates_.full(); }
  const Candidate& operator[](int i) const { return candidates_[i]; }
  void clear() { candidates_.clear(); }

  /// Starts following the corner at integer pixel (x, y). kFull, kOutOfView.
  Status add(const ImageView& image, const PinholeCamera<float>& camera,
             const Rigid<float>& T_world_camera, int x, int y, const Parameters& parameters) {
    if (candidates_.full()) return Status::kFull;
    Candidate candidate;
    const Status status = make_appearance(image, x, y, T_world_camera, candidate.appearance);
    if (!ok(status)) return status;
    candidate.pixel = Vector2<float>(static_cast<float>(x), static_cast<float>(y));
    candidate.first_ray = camera.unproject(candidate.pixel);
    candidate.rho = 1.0F / parameters.initial_depth_m;
    candidate.variance = square(parameters.initial_sigma_rho);
    candidates_.push_back(candidate);
    return Status::kOk;
  }

  /// Follows every candidate into `image`; those that are lost are dropped, their number returned.
  int follow(const ImageView& image, const PinholeCamera<float>& camera,
             const Rigid<float>& T_world_camera, const Parameters& parameters) {
    int dropped = 0;
    for (int i = candidates_.size() - 1; i >= 0; --i) {
      Candidate& c = candidates_[i];
      if (measure(image, camera, T_world_camera, parameters, c)) {
        ++c.seen;
        c.misses = 0;
      } else {
        ++c.misses;
      }
      const bool stale = c.seen + c.misses > parameters.max_views;
      if (c.misses > parameters.max_misses || stale) {
        candidates_.remove_unordered(i);
        ++dropped;
      }
    }
    return dropped;
  }

  /// Takes the next candidate that was seen in this frame and whose depth is known; false when
  /// there is none. Call until false.
  bool promote(const PinholeCamera<float>& camera, const Rigid<float>& T_world_camera,
               const Parameters& parameters, Promotion& promotion) {
    for (int i = candidates_.size() - 1; i >= 0; --i) {
      const Candidate& c = candidates_[i];
      if (c.misses > 0 || c.seen < parameters.min_views || !(c.rho > 0.0F)) continue;
      const float sigma = sqrt(c.variance);
      if (sigma > parameters.promote_relative_sigma * c.rho) continue;
      const float depth = 1.0F / c.rho;
      const bool usable = depth > parameters.min_depth_m && depth < parameters.max_depth_m;
      if (usable) fill(camera, T_world_camera, parameters, c, promotion);
      candidates_.remove_unordered(i);
      if (usable) return true;
    }
    return false;
  }

 private:
  bool measure(const ImageView& image, const PinholeCamera<float>& camera,
               const Rigid<float>& T_world_camera, const Parameters& parameters,
               Candidate& c) const {
    const Rigid<float> T_camera_first = T_world_camera.inverse() * c.appearance.T_world_reference;
    const Vector3<float> turned = T_camera_first.rotation * c.first_ray;
    const Vector3<float> scaled = turned + c.rho * T_camera_first.translation;
    Vector2<float> predicted;
    Matrix<float, 2, 3> jacobian;
    if (!ok(camera.project(scaled, predicted, jacobian)) || !camera.contains(predicted, 10.0F)) {
      return false;
    }
    const Vector3<float> p_camera = scaled * (1.0F / c.rho);
    Matrix2<float> warp;
    PatchWarp patch_warp;
    if (!ok(predict_warp(camera, c.appearance.T_world_reference, T_world_camera, p_camera, warp)) ||
        !to_patch_warp(warp, patch_warp)) {
      return false;
    }
    int x_q8 = round_to_int(predicted.x() * 256.0F);
    int y_q8 = round_to_int(predicted.y() * 256.0F);
    PatchAlignment alignment;
    if (!ok(align_patch(image, c.appearance.patch, patch_warp, x_q8, y_q8, alignment)) ||
        !alignment.converged || alignment.correlation < parameters.min_correlation_q10) {
      return false;
    }
    const Vector2<float> pixel(static_cast<float>(x_q8) / 256.0F,
                               static_cast<float>(y_q8) / 256.0F);
    if (!correct(pixel - predicted, jacobian * T_camera_first.translation, parameters, c))
      return false;
    c.pixel = pixel;
    return true;
  }

  /// One Kalman step of rho with a pixel innovation; false when it is outside the gate.
  static bool correct(const Vector2<float>& innovation, const Vector2<float>& slope,
                      const Parameters& parameters, Candidate& c) {
    const float r = square(parameters.sigma_px);
    // Information form along the epipolar direction: S = P h h^T + r I has the closed inverse
    // below.
    const float slope_squared = slope.dot(slope);
    const float s = c.variance * slope_squared + r;
    const float along = slope.dot(innovation);
    const float nis = (innovation.dot(innovation) - c.variance * along * along / s) / r;
    if (!(nis <= parameters.gate)) return false;
    c.rho += c.variance * along / s;
    c.variance *= r / s;
    const float smallest = 0.2F / parameters.max_depth_m;
    if (c.rho < smallest) c.rho = smallest;
    return true;
  }

  static void fill(const PinholeCamera<float>& camera, const Rigid<float>& T_world_camera,
                   const Parameters& parameters, const Candidate& c, Promotion& promotion) {
    const Rigid<float> T_camera_first = T_world_camera.inverse() * c.appearance.T_world_reference;
    const Vector3<float> p_camera = T_camera_first * Vector3<float>(c.first_ray / c.rho);
    const Vector3<float> ray = camera.unproject(c.pixel);
    const float depth = p_camera.z();
    const float sigma_depth = parameters.depth_inflation * sqrt(c.variance) / square(c.rho);
    const float sigma_lateral = depth * parameters.sigma_px / camera.fx;
    promotion.appearance = c.appearance;
    promotion.pixel = c.pixel;
    promotion.p_camera = ray * depth;
    Matrix3<float> covariance = square(sigma_depth) * (ray * ray.transpose());
    covariance(0, 0) += square(sigma_lateral);
    covariance(1, 1) += square(sigma_lateral);
    promotion.covariance = covariance;
  }

  FixedVector<Candidate, MaxCandidates> candidates_;
};

}  // namespace cairn
