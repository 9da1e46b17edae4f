#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/numeric/fixed_vector.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/active_search.hpp"
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

/// Bounded pool of candidates with a visual odometry of its own: motion comes from the caller's
/// poses, and each frame the rotation is corrected by the shift that the candidates have in common,
/// weighed by how well each one's depth is known. So it works while the map is still empty and the
/// heading only as good as the odometry. The caller's poses should be dead reckoning, not the
/// filter's: depths taken from a map's own scale let an error of that scale grow from landmark to
/// landmark. Cost per frame: at most 4 patch alignments a candidate.
template <int MaxCandidates>
class CandidatePool {
 public:
  struct Parameters {
    float initial_depth_m = 4.0F;
    float initial_sigma_rho = 0.25F;  ///< 1/m: everything beyond about 1.3 m within 2 sigma
    float sigma_px = 1.0F;
    float promote_relative_sigma = 0.10F;  ///< sigma(rho) / rho
    float min_depth_m = 0.5F;
    float max_depth_m = 25.0F;
    float depth_inflation = 1.5F;  ///< of the depth's sigma at promotion
    /// Noise of the caller's translation, m per sqrt(m): what the depth of all candidates shares.
    float translation_noise = 0.0F;
    float rotation_sigma_rad = 0.002F;  ///< of the caller's rotation since the frame before
    float gate = 9.21F;
    float search_step_px = 2.5F;  ///< sideways starts tried when few candidates are found
    int min_views = 6;
    int max_views = 150;
    int max_misses = 2;
    int min_correlation_q10 = 768;
    SearchParameters search;
  };

  int size() const { return candidates_.size(); }
  bool full() const { return candidates_.full(); }
  const Candidate& operator[](int i) const { return candidates_[i]; }
  void clear() {
    candidates_.clear();
    has_pose_ = false;
  }

  /// Starts following the corner at integer pixel (x, y) of the frame last given to follow().
  /// kFull, kOutOfView, kNotInitialised (no frame yet).
  Status add(const ImageView& image, const PinholeCamera<float>& camera, int x, int y,
             const Parameters& parameters) {
    if (!has_pose_) return Status::kNotInitialised;
    if (candidates_.full()) return Status::kFull;
    Candidate candidate;
    const Status status = make_appearance(image, x, y, T_pool_camera_, candidate.appearance);
    if (!ok(status)) return status;
    candidate.pixel = Vector2<float>(static_cast<float>(x), static_cast<float>(y));
    candidate.first_ray = camera.unproject(candidate.pixel);
    candidate.rho = 1.0F / parameters.initial_depth_m;
    candidate.variance = square(parameters.initial_sigma_rho);
    candidates_.push_back(candidate);
    return Status::kOk;
  }

  /// Follows every candidate into `image`, taken at the caller's estimate `T_world_camera` (only
  /// its motion since the last call counts). Lost candidates are dropped, their number returned.
  int follow(const ImageView& image, const PinholeCamera<float>& camera,
             const Rigid<float>& T_odometry_camera, const Parameters& parameters,
             SearchScratch& scratch) {
    if (has_pose_) {
      T_pool_camera_ = T_pool_camera_ * (T_odometry_last_.inverse() * T_odometry_camera);
    }
    T_odometry_last_ = T_odometry_camera;
    has_pose_ = true;
    measure_all(image, camera, parameters);
    search_missing(image, camera, parameters, scratch);
    correct_rotation(camera, parameters);
    return correct_depths(camera, parameters);
  }

  /// Takes the next candidate that was seen in this frame and whose depth is known; false when
  /// there is none. Call until false. `T_world_camera`: where the map has the camera now.
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
  using Pixels = Vector2<float>[MaxCandidates];

  struct Expected {
    Vector2<float> pixel;
    Vector2<float> slope;  ///< d pixel / d rho
    Vector3<float> p_camera;
  };

  bool expect(const PinholeCamera<float>& camera, const Candidate& c, Expected& expected) const {
    const Rigid<float> T_camera_first = T_pool_camera_.inverse() * c.appearance.T_world_reference;
    const Vector3<float> turned = T_camera_first.rotation * c.first_ray;
    const Vector3<float> scaled = turned + c.rho * T_camera_first.translation;
    Matrix<float, 2, 3> jacobian;
    if (!ok(camera.project(scaled, expected.pixel, jacobian))) return false;
    expected.slope = jacobian * T_camera_first.translation;
    expected.p_camera = scaled * (1.0F / c.rho);
    return camera.contains(expected.pixel, 10.0F);
  }

  bool align(const ImageView& image, const PinholeCamera<float>& camera, const Candidate& c,
             const Expected& expected, const Vector2<float>& shift, const Parameters& parameters,
             Vector2<float>& pixel) const {
    Matrix2<float> warp;
    PatchWarp patch_warp;
    if (!ok(predict_warp(camera, c.appearance.T_world_reference, T_pool_camera_, expected.p_camera,
                         warp)) ||
        !to_patch_warp(warp, patch_warp)) {
      return false;
    }
    int x_q8 = round_to_int((expected.pixel.x() + shift.x()) * 256.0F);
    int y_q8 = round_to_int((expected.pixel.y() + shift.y()) * 256.0F);
    PatchAlignment alignment;
    if (!ok(align_patch(image, c.appearance.patch, patch_warp, x_q8, y_q8, alignment)) ||
        !alignment.converged || alignment.correlation < parameters.min_correlation_q10) {
      return false;
    }
    pixel = Vector2<float>(static_cast<float>(x_q8) / 256.0F, static_cast<float>(y_q8) / 256.0F);
    return true;
  }

  /// Candidates found when all are expected `shift` away from their prediction.
  int measure_shifted(const ImageView& image, const PinholeCamera<float>& camera,
                      const Vector2<float>& shift, const Parameters& parameters, bool* found,
                      Pixels& pixels) const {
    int count = 0;
    for (int i = 0; i < candidates_.size(); ++i) {
      Expected expected;
      found[i] = expect(camera, candidates_[i], expected) &&
                 align(image, camera, candidates_[i], expected, shift, parameters, pixels[i]);
      count += found[i] ? 1 : 0;
    }
    return count;
  }

  void measure_all(const ImageView& image, const PinholeCamera<float>& camera,
                   const Parameters& parameters) {
    int best = measure_shifted(image, camera, Vector2<float>::Zero(), parameters, found_, pixels_);
    const float steps[] = {-parameters.search_step_px, parameters.search_step_px};
    for (const float step : steps) {
      if (10 * best >= 7 * candidates_.size()) return;
      bool found[MaxCandidates];
      Pixels pixels;
      const int count =
          measure_shifted(image, camera, Vector2<float>(step, 0.0F), parameters, found, pixels);
      if (count <= best) continue;
      best = count;
      for (int i = 0; i < candidates_.size(); ++i) {
        found_[i] = found[i];
        pixels_[i] = pixels[i];
      }
    }
  }

  /// Looks for the candidates that alignment did not find in the window of their unknown depth and
  /// rotation, by descriptor.
  void search_missing(const ImageView& image, const PinholeCamera<float>& camera,
                      const Parameters& parameters, SearchScratch& scratch) {
    const float shared =
        square(camera.fx * parameters.rotation_sigma_rad) + square(parameters.sigma_px);
    for (int i = 0; i < candidates_.size(); ++i) {
      if (found_[i]) continue;
      const Candidate& c = candidates_[i];
      Expected expected;
      Matrix2<float> warp;
      if (!expect(camera, c, expected) ||
          !ok(predict_warp(camera, c.appearance.T_world_reference, T_pool_camera_,
                           expected.p_camera, warp))) {
        continue;
      }
      PixelPrediction<float> prediction;
      prediction.pixel = expected.pixel;
      prediction.covariance = c.variance * (expected.slope * expected.slope.transpose()) +
                              shared * Matrix2<float>::Identity();
      prediction.p_camera = expected.p_camera;
      SearchReport report;
      found_[i] = ok(search_landmark(image, prediction, c.appearance, warp, parameters.search,
                                     scratch, pixels_[i], report));
    }
  }

  /// Turns the pool's camera by the residuals' weighted mean: a Kalman step of the rotation in
  /// which each unknown depth widens its own residual. Residuals far from the median are left out.
  void correct_rotation(const PinholeCamera<float>& camera, const Parameters& parameters) {
    constexpr float kFarFromMedian = 3.0F;
    Vector2<float> residual[MaxCandidates];
    Vector2<float> variance[MaxCandidates];
    float u[MaxCandidates];
    float v[MaxCandidates];
    int count = 0;
    for (int i = 0; i < candidates_.size(); ++i) {
      Expected expected;
      if (!found_[i] || !expect(camera, candidates_[i], expected)) continue;
      residual[count] = pixels_[i] - expected.pixel;
      const float rho_variance = candidates_[i].variance;
      const float r = square(parameters.sigma_px);
      variance[count] = Vector2<float>(r + rho_variance * square(expected.slope.x()),
                                       r + rho_variance * square(expected.slope.y()));
      insert_sorted(u, count, residual[count].x());
      insert_sorted(v, count, residual[count].y());
      ++count;
    }
    if (count == 0) return;
    const Vector2<float> median(u[count / 2], v[count / 2]);
    const float prior = 1.0F / square(camera.fx * parameters.rotation_sigma_rad);
    Vector2<float> sum = Vector2<float>::Zero();
    Vector2<float> weight(prior, prior);
    for (int i = 0; i < count; ++i) {
      const Vector2<float> off = residual[i] - median;
      if (off.dot(off) > square(kFarFromMedian)) continue;
      for (int k = 0; k < 2; ++k) {
        sum(k) += residual[i](k) / variance[i](k);
        weight(k) += 1.0F / variance[i](k);
      }
    }
    const Vector3<float> phi(sum.y() / weight.y() / camera.fy, -sum.x() / weight.x() / camera.fx,
                             0.0F);
    T_pool_camera_.rotation = (T_pool_camera_.rotation * rotation_exp(phi)).normalized();
  }

  static void insert_sorted(float* values, int count, float value) {
    int k = count;
    for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
    values[k] = value;
  }

  int correct_depths(const PinholeCamera<float>& camera, const Parameters& parameters) {
    int dropped = 0;
    for (int i = candidates_.size() - 1; i >= 0; --i) {
      Candidate& c = candidates_[i];
      Expected expected;
      if (found_[i] && expect(camera, c, expected) &&
          correct(pixels_[i] - expected.pixel, expected.slope, parameters, c)) {
        c.pixel = pixels_[i];
        ++c.seen;
        c.misses = 0;
      } else {
        ++c.misses;
      }
      if (c.misses > parameters.max_misses || c.seen + c.misses > parameters.max_views) {
        candidates_.remove_unordered(i);
        ++dropped;
      }
    }
    return dropped;
  }

  /// One Kalman step of rho with a pixel innovation, in closed form for S = P h h^T + r I; false
  /// when it is outside the gate.
  static bool correct(const Vector2<float>& innovation, const Vector2<float>& slope,
                      const Parameters& parameters, Candidate& c) {
    const float r = square(parameters.sigma_px);
    const float s = c.variance * slope.dot(slope) + r;
    const float along = slope.dot(innovation);
    const float nis = (innovation.dot(innovation) - c.variance * along * along / s) / r;
    if (!(nis <= parameters.gate)) return false;
    c.rho += c.variance * along / s;
    c.variance *= r / s;
    const float smallest = 0.2F / parameters.max_depth_m;
    if (c.rho < smallest) c.rho = smallest;
    return true;
  }

  void fill(const PinholeCamera<float>& camera, const Rigid<float>& T_world_camera,
            const Parameters& parameters, const Candidate& c, Promotion& promotion) const {
    const Rigid<float> T_camera_first = T_pool_camera_.inverse() * c.appearance.T_world_reference;
    const Vector3<float> ray = camera.unproject(c.pixel);
    const float depth = (T_camera_first * Vector3<float>(c.first_ray / c.rho)).z();
    const Vector3<float>& baseline = T_camera_first.translation;
    const float length = sqrt(baseline.dot(baseline));
    const float shared =
        length > 0.0F ? square(parameters.translation_noise * depth) / length : 0.0F;
    const float sigma_depth =
        sqrt(c.variance * square(parameters.depth_inflation / square(c.rho)) + shared);
    const float sigma_lateral = depth * parameters.sigma_px / camera.fx;
    promotion.appearance = c.appearance;
    promotion.appearance.T_world_reference = T_world_camera * T_camera_first;
    promotion.pixel = c.pixel;
    promotion.p_camera = ray * depth;
    Matrix3<float> covariance = square(sigma_depth) * (ray * ray.transpose());
    covariance(0, 0) += square(sigma_lateral);
    covariance(1, 1) += square(sigma_lateral);
    promotion.covariance = covariance;
  }

  FixedVector<Candidate, MaxCandidates> candidates_;
  bool found_[MaxCandidates] = {};  ///< this frame's measurements, by candidate
  Pixels pixels_;
  Rigid<float> T_pool_camera_;
  Rigid<float> T_odometry_last_;
  bool has_pose_ = false;
};

}  // namespace cairn
