#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/depth_filter.hpp"
#include "cairn/tracking/seed.hpp"

namespace cairn {

/// The visual odometry of a pool of seeds: where its camera and keyframes are, where each seed is
/// expected in the image, and how the pixels found correct rotations and inverse depths. The
/// camera's translation comes from the caller's poses, its rotation is corrected together with the
/// depths (DepthFilter).
template <int MaxSeeds, int MaxKeyframes>
class SeedOdometry {
 public:
  using Filter = DepthFilter<MaxKeyframes, MaxSeeds>;
  using Seeds = FixedVector<Seed, MaxSeeds>;
  using Pose = Rigid<float>;

  /// What the searches and corrections of a frame use.
  struct View {
    const PinholeCamera<float>* camera = nullptr;
  };
  /// Where to search a seed.
  struct Search {
    PixelPrediction<float> prediction;
    PatchWarp warp;

    int work(const PatchSearchParameters& parameters) const {
      return patch_search_work(prediction, parameters);
    }
    Status find(const ImageView& image, const Patch& patch, const PatchSearchParameters& parameters,
                Vector2<float>& pixel) const {
      return search_patch(image, prediction, patch, warp, parameters, pixel);
    }
  };

  /// Where a seed is expected.
  struct Expected {
    Vector2<float> pixel;
    Vector3<float> p_camera;
    typename Filter::Residual residual;  ///< all but the measured pixel
    float sigma_px = 0.0F;               ///< of the pixel, path errors included
  };

  void clear() {
    for (Keyframe& keyframe : keyframes_) keyframe.id = kNoLandmark;
    filter_.clear();
    has_pose_ = false;
  }

  bool has_pose() const { return has_pose_; }
  const Rigid<float>& T_pool_camera() const { return T_pool_camera_; }
  LandmarkId keyframe_id(int slot) const { return keyframes_[slot].id; }
  float sigma_rho(int seed) const { return sqrt(filter_.variance(seed)); }
  bool has_converged(int seed, float rho, float max_relative_sigma) const {
    return !(sigma_rho(seed) > max_relative_sigma * rho);
  }
  /// As SeedPool::turn_since().
  bool turn_since(LandmarkId keyframe, Quaternion<float>& now_then, float& yaw_variance) const {
    const int slot = find_keyframe(keyframe);
    if (slot < 0) return false;
    now_then = T_pool_camera_.rotation.conjugate() * keyframes_[slot].T_pool_camera.rotation;
    yaw_variance = filter_.yaw_variance(slot);
    return true;
  }
  Rigid<float> T_camera_first(const Seed& seed) const {
    return T_pool_camera_.inverse() * keyframes_[seed.keyframe].T_pool_camera;
  }

  /// Moves the camera by what the caller's estimate moved since the last call.
  void move_to(const Rigid<float>& T_odometry_camera, const SeedParameters& parameters) {
    if (has_pose_) {
      T_pool_camera_ = T_pool_camera_ * (T_odometry_last_.inverse() * T_odometry_camera);
      filter_.predict(parameters.sigma_pitch_rad, parameters.sigma_yaw_rad);
    }
    T_odometry_last_ = T_odometry_camera;
    has_pose_ = true;
  }
  /// The caller's estimate was corrected to this, without motion.
  void stand_at(const Rigid<float>& T_odometry_camera) { T_odometry_last_ = T_odometry_camera; }
  /// False for a camera that has no form here.
  bool look(const PinholeCamera<float>& camera, const SeedParameters& /*parameters*/,
            View& view) const {
    view.camera = &camera;
    return true;
  }

  /// Slot of a keyframe, or with kNoLandmark a free one; -1 where there is none.
  int find_keyframe(LandmarkId id) const {
    for (int k = 0; k < MaxKeyframes; ++k) {
      if (keyframes_[k].id == id) return k;
    }
    return -1;
  }
  /// Makes the present camera the keyframe `id` in a free slot.
  void begin_keyframe(int slot, LandmarkId id) {
    keyframes_[slot] = {id, T_pool_camera_};
    filter_.begin_keyframe(slot);
  }
  void end_keyframe(int slot) {
    keyframes_[slot].id = kNoLandmark;
    filter_.end_keyframe(slot);
  }

  void begin_seed(int seed, float sigma_rho) { filter_.begin_seed(seed, square(sigma_rho)); }
  /// Removes a seed; the last one takes its place.
  void remove_seed(int seed, int last) {
    filter_.move_seed(last, seed);
    if (seed == last) filter_.end_seed(seed);
  }

  /// False where the seed is expected far outside the image.
  bool expect(const PinholeCamera<float>& camera, const SeedParameters& parameters,
              const Seeds& seeds, int i, Expected& expected) const;
  /// The window that a seed's uncertain depth and the camera's rotation give. False where it is
  /// expected far outside the image, or its patch cannot be seen.
  bool plan(const View& view, const SeedParameters& parameters, const Seeds& seeds, int i,
            Search& search) const;

  /// Corrects rotations and depths with the seeds `found` at `pixels`. The camera's rotation error
  /// is common to all residuals: those far from their median, compared with what the depth's sigma
  /// allows, are left out and no longer count as found.
  void correct(const View& view, const SeedParameters& parameters, Seeds& seeds,
               const Vector2<float>* pixels, bool* found);

 private:
  static constexpr float kOutside_px = 40.0F;  ///< a seed's window may still reach into the image

  struct Keyframe {
    LandmarkId id = kNoLandmark;
    Rigid<float> T_pool_camera;
  };

  static bool near_median(const typename Filter::Residual& residual, const Vector2<float>& off,
                          float depth_variance);
  bool median_residual(const PinholeCamera<float>& camera, const SeedParameters& parameters,
                       const Seeds& seeds, const Vector2<float>* pixels, const bool* found,
                       Vector2<float>& median) const;
  void apply(const typename Filter::Correction& correction, float min_rho, Seeds& seeds);
  static void insert_sorted(float* values, int count, float value) {
    int k = count;
    for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
    values[k] = value;
  }

  Keyframe keyframes_[MaxKeyframes];
  Filter filter_;
  Rigid<float> T_pool_camera_;
  Rigid<float> T_odometry_last_;
  bool has_pose_ = false;
};

template <int MaxSeeds, int MaxKeyframes>
bool SeedOdometry<MaxSeeds, MaxKeyframes>::expect(const PinholeCamera<float>& camera,
                                                  const SeedParameters& parameters,
                                                  const Seeds& seeds, int i,
                                                  Expected& expected) const {
  const Seed& seed = seeds[i];
  const Rigid<float> T = T_camera_first(seed);
  const Vector3<float> scaled = T.rotation * seed.first_ray + seed.rho * T.translation;
  Matrix<float, 2, 3> jacobian;
  if (!ok(camera.project(scaled, expected.pixel, jacobian))) return false;
  const Matrix3<float> by_rotation = skew(scaled);
  const Matrix3<float> rotation = T.rotation.toRotationMatrix();
  const Matrix3<float> by_first_rotation = rotation * skew(seed.first_ray);
  expected.residual.slot = i;
  expected.residual.keyframe = seed.keyframe;
  expected.residual.by_camera = jacobian * by_rotation.template leftCols<2>();
  expected.residual.by_keyframe = -(jacobian * by_first_rotation.template leftCols<2>());
  expected.residual.by_depth = jacobian * T.translation;
  expected.residual.unmodelled = parameters.sigma_roll_rad * (jacobian * by_rotation.col(2));
  expected.sigma_px =
      sqrt(square(parameters.sigma_px) +
           square(parameters.off_path * camera.fx * seed.rho) * T.translation.dot(T.translation));
  expected.p_camera = scaled * (1.0F / seed.rho);
  return camera.contains(expected.pixel, -kOutside_px);
}

template <int MaxSeeds, int MaxKeyframes>
bool SeedOdometry<MaxSeeds, MaxKeyframes>::plan(const View& view, const SeedParameters& parameters,
                                                const Seeds& seeds, int i, Search& search) const {
  const PinholeCamera<float>& camera = *view.camera;
  Expected expected;
  Matrix2<float> warp;
  if (!expect(camera, parameters, seeds, i, expected) ||
      !ok(predict_warp(camera, keyframes_[seeds[i].keyframe].T_pool_camera, T_pool_camera_,
                       expected.p_camera, warp)) ||
      !to_patch_warp(warp, search.warp)) {
    return false;
  }
  search.prediction.pixel = expected.pixel;
  search.prediction.covariance =
      filter_.innovation_covariance(expected.residual, expected.sigma_px);
  search.prediction.p_camera = expected.p_camera;
  return true;
}

template <int MaxSeeds, int MaxKeyframes>
void SeedOdometry<MaxSeeds, MaxKeyframes>::correct(const View& view,
                                                   const SeedParameters& parameters, Seeds& seeds,
                                                   const Vector2<float>* pixels, bool* found) {
  const PinholeCamera<float>& camera = *view.camera;
  Vector2<float> median;
  if (!median_residual(camera, parameters, seeds, pixels, found, median)) return;
  typename Filter::Correction correction;
  for (int i = 0; i < seeds.size(); ++i) {
    Expected expected;
    if (!found[i]) continue;
    found[i] = expect(camera, parameters, seeds, i, expected);
    if (!found[i]) continue;
    expected.residual.pixel = pixels[i] - expected.pixel;
    const Vector2<float> off = expected.residual.pixel - median;
    found[i] = near_median(expected.residual, off, filter_.variance(i)) &&
               filter_.update(expected.residual, expected.sigma_px, parameters.gate, correction);
  }
  apply(correction, 0.2F / parameters.max_depth_m, seeds);
}

/// Whether `off` lies in the ellipse that an unknown depth draws along the epipolar line; across
/// it, only a few pixels are allowed.
template <int MaxSeeds, int MaxKeyframes>
bool SeedOdometry<MaxSeeds, MaxKeyframes>::near_median(const typename Filter::Residual& residual,
                                                       const Vector2<float>& off,
                                                       float depth_variance) {
  constexpr float kAcross_px = 3.0F;
  constexpr float kSigmas = 3.0F;
  const Vector2<float>& roll = residual.unmodelled;
  const float across = square(kAcross_px) + square(kSigmas) * roll.dot(roll);
  const Vector2<float>& slope = residual.by_depth;
  const float variance = square(kSigmas) * depth_variance;
  const float along = off.dot(slope);
  const float share = square(along) * variance / (across + variance * slope.dot(slope));
  return off.dot(off) - share <= across;
}

template <int MaxSeeds, int MaxKeyframes>
void SeedOdometry<MaxSeeds, MaxKeyframes>::apply(const typename Filter::Correction& correction,
                                                 float min_rho, Seeds& seeds) {
  T_pool_camera_.rotation =
      (T_pool_camera_.rotation * rotation_exp(correction.camera())).normalized();
  for (int k = 0; k < MaxKeyframes; ++k) {
    if (keyframes_[k].id == kNoLandmark) continue;
    Quaternion<float>& rotation = keyframes_[k].T_pool_camera.rotation;
    rotation = (rotation * rotation_exp(correction.keyframe(k))).normalized();
  }
  for (int i = 0; i < seeds.size(); ++i) {
    Seed& seed = seeds[i];
    seed.rho += correction.depth(i);
    if (seed.rho < min_rho) seed.rho = min_rho;
  }
}

template <int MaxSeeds, int MaxKeyframes>
bool SeedOdometry<MaxSeeds, MaxKeyframes>::median_residual(
    const PinholeCamera<float>& camera, const SeedParameters& parameters, const Seeds& seeds,
    const Vector2<float>* pixels, const bool* found, Vector2<float>& median) const {
  float u[MaxSeeds];
  float v[MaxSeeds];
  int count = 0;
  for (int i = 0; i < seeds.size(); ++i) {
    Expected expected;
    if (!found[i] || !expect(camera, parameters, seeds, i, expected)) continue;
    insert_sorted(u, count, pixels[i].x() - expected.pixel.x());
    insert_sorted(v, count, pixels[i].y() - expected.pixel.y());
    ++count;
  }
  if (count == 0) return false;
  median = Vector2<float>(u[count / 2], v[count / 2]);
  return true;
}

}  // namespace cairn
