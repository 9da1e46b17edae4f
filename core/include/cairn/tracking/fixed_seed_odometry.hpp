#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/fixed_rigid.hpp"
#include "cairn/numeric/float_bits.hpp"
#include "cairn/numeric/reciprocal.hpp"
#include "cairn/tracking/fixed_depth_filter.hpp"
#include "cairn/tracking/fixed_patch_window.hpp"
#include "cairn/tracking/fixed_warp.hpp"
#include "cairn/tracking/seed.hpp"

namespace cairn {

/// SeedOdometry without floating point, with the same calls; seeds and parameters are messages in
/// float. Its poses are exact to 2^-32 m wherever the vehicle is.
template <int MaxSeeds, int MaxKeyframes>
class FixedSeedOdometry {
 public:
  using Filter = FixedDepthFilter<MaxKeyframes, MaxSeeds>;
  using Seeds = FixedVector<Seed, MaxSeeds>;
  using Pose = FixedRigid;

  /// Camera, parameters and motions of one frame, as its searches and corrections use them.
  struct View {
    FixedCamera camera;
    FixedTangent sigma[2];  ///< of a pixel over the focal lengths
    FixedTangent off_path;
    FixedAngle sigma_roll;
    Fixed<std::int32_t, 16> gate;
    detail::FixedMotionBetween T_camera_first[MaxKeyframes];
  };
  /// Where to search a seed.
  struct Search {
    FixedPatchWindow window;
    PatchWarp warp;

    int work(const PatchSearchParameters& /*parameters*/) const {
      return patch_search_work(window);
    }
    Status find(const ImageView& image, const Patch& patch, const PatchSearchParameters& parameters,
                Vector2<float>& pixel) const {
      return search_patch(image, window, patch, warp, parameters, pixel);
    }
  };

  void clear() {
    for (Keyframe& keyframe : keyframes_) keyframe.id = kNoLandmark;
    filter_.clear();
    has_pose_ = false;
  }

  bool has_pose() const { return has_pose_; }
  Rigid<float> T_pool_camera() const { return float_of(T_pool_camera_); }
  LandmarkId keyframe_id(int slot) const { return keyframes_[slot].id; }
  float sigma_rho(int seed) const { return float_of(filter_.sigma(seed)); }
  bool has_converged(int seed, float rho, float max_relative_sigma) const {
    const auto share = fixed_of<Fixed<std::int32_t, 16>>(max_relative_sigma, lost_);
    const auto depth = fixed_of<typename Filter::Rho>(rho, lost_);
    const std::int64_t most = wide::multiply(share.raw(), depth.raw(), 16, lost_);
    return filter_.sigma(seed).raw() <= most;
  }
  Rigid<float> T_camera_first(const Seed& seed) const;
  /// As SeedPool::turn_since().
  bool turn_since(LandmarkId keyframe, Quaternion<float>& now_then, float& yaw_variance) const;

  void move_to(const FixedRigid& T_odometry_camera, const SeedParameters& parameters);
  void stand_at(const FixedRigid& T_odometry_camera) { T_odometry_last_ = T_odometry_camera; }
  /// False for a camera that has no form here.
  bool look(const PinholeCamera<float>& camera, const SeedParameters& parameters, View& view) const;

  int find_keyframe(LandmarkId id) const {
    for (int k = 0; k < MaxKeyframes; ++k) {
      if (keyframes_[k].id == id) return k;
    }
    return -1;
  }
  void begin_keyframe(int slot, LandmarkId id) {
    keyframes_[slot] = {id, T_pool_camera_};
    filter_.begin_keyframe(slot);
  }
  void end_keyframe(int slot) {
    keyframes_[slot].id = kNoLandmark;
    filter_.end_keyframe(slot);
  }
  void begin_seed(int seed, float sigma_rho) {
    filter_.begin_seed(seed, fixed_of<typename Filter::Rho>(sigma_rho, lost_));
  }
  void remove_seed(int seed, int last) {
    filter_.move_seed(last, seed);
    if (seed == last) filter_.end_seed(seed);
  }

  /// False where the seed is expected far outside the image, or its patch cannot be seen.
  bool plan(const View& view, const SeedParameters& parameters, const Seeds& seeds, int i,
            Search& search) const;
  void correct(const View& view, const SeedParameters& parameters, Seeds& seeds,
               const Vector2<float>* pixels, bool* found);

  /// Results that did not fit their format.
  std::uint32_t saturations() const { return filter_.saturations() + lost_; }

 private:
  using Rho = Fixed<std::int32_t, 24>;
  struct Keyframe {
    LandmarkId id = kNoLandmark;
    FixedRigid T_pool_camera;
  };
  struct Expected {
    FixedPixel pixel[2];
    FixedView seen;  ///< the depth as a multiple of that at the keyframe
    typename Filter::Residual residual;
    FixedTangent sigma[2];  ///< of a pixel over the focal lengths
  };

  /// The camera's rotation back; its translation is not that of an inverse.
  FixedRigid back() const {
    FixedRigid inverse = T_pool_camera_;
    for (int i = 1; i < 4; ++i) inverse.rotation[i] = -inverse.rotation[i];
    return inverse;
  }
  static Rho rho_of(const Seed& seed, std::uint32_t& lost) { return fixed_of<Rho>(seed.rho, lost); }
  bool expect(const View& view, const Seeds& seeds, int i, Expected& expected) const;
  bool off_median(const View& view, const Seeds& seeds, const Vector2<float>* pixels,
                  const bool* found, FixedPixel (&median)[2]) const;
  static void off(const Expected& expected, const Vector2<float>& pixel, FixedPixel (&off)[2],
                  std::uint32_t& lost);
  bool near_median(const View& view, const Expected& expected, const FixedPixel (&off)[2],
                   const FixedPixel (&median)[2]) const;
  void apply(const typename Filter::Correction& correction, const SeedParameters& parameters,
             Seeds& seeds);
  static void turn(FixedRigid& pose, const FixedCoordinate& x, const FixedCoordinate& y) {
    std::uint32_t none = 0;
    pose = pose.times(small_turn(x.raw(), y.raw(), 0), none);
  }
  static void insert_sorted(FixedPixel* values, int count, FixedPixel value) {
    int k = count;
    for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
    values[k] = value;
  }

  Keyframe keyframes_[MaxKeyframes];
  Filter filter_;
  FixedRigid T_pool_camera_;
  FixedRigid T_odometry_last_;
  bool has_pose_ = false;
  mutable std::uint32_t lost_ = 0;
};

}  // namespace cairn

#include "cairn/tracking/detail/fixed_seed_odometry_impl.hpp"
