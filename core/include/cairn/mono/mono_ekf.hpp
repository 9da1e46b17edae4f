#pragma once

#include <cstdint>

#include "cairn/base/hash.hpp"
#include "cairn/base/health.hpp"
#include "cairn/base/status.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/mono/camera_motion.hpp"
#include "cairn/mono/covariance_guard.hpp"
#include "cairn/mono/fading_memory.hpp"
#include "cairn/mono/feature_map.hpp"
#include "cairn/mono/parameters.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {

/// When prune() removes a feature.
struct FeaturePolicy {
  int min_predicted = 6;  ///< judged by its record only after so many predictions
  float min_measured_share = 0.5F;
  int max_out_of_view = 20;  ///< updates outside the image
};

/// Monocular EKF-SLAM with inverse-depth features, 1-point RANSAC and fading memory: camera pose,
/// velocities and features from matched pixels alone. The world is the camera at initialise(); its
/// scale is set by the prior of the inverse depth.
///
/// State: camera block, then blocks of three (two in kRotationOnly) in any order. Camera block of
/// kSixDof: r (3, m), q (4), [s], v (3, m/s), w (3, rad/s, camera frame); kPivot: lever (3, m), q,
/// [s], w; kRotationOnly: q, [s], w; s is the focal length's relative error where it is estimated.
/// Features initialised in one frame share the anchor, 3 n + 3 a values instead of 6 n; this is
/// exact, because the copies would have the same rows in P for ever.
///
/// When all MaxAnchors are in use, the features of the least used anchor are expressed from the
/// present camera position instead (to first order), so that a new feature never lacks an
/// anchor. Features of the same frame should be added together.
///
/// Rounding is counted as noise in the prediction, in S and in what an update leaves, so that P
/// stays positive semi-definite; after each update a part of it is looked at in turn, and what
/// still had to be mended is counted (Health::covariance_repairs, Health::resets).
///
/// Sources: J. Civera, O. Grasa, A. Davison, J. Montiel, "1-Point RANSAC for EKF filtering", 2010;
/// J. Civera, A. Davison, J. Montiel, "Inverse depth parametrization for monocular SLAM", 2008;
/// Qi Naixin et al., "1-point RANSAC based on fading memory filtering for attitude estimation with
/// monocular vision", 2016. Derivation and errata: docs/explanation/mono-ekf.md.
template <class T, int MaxFeatures, int MaxAnchors = (MaxFeatures < 20 ? 4 : MaxFeatures / 5)>
class MonoEkf {
  static_assert(MaxFeatures >= 1 && MaxAnchors >= 1 && MaxAnchors <= MaxFeatures, "capacities");

 public:
  using Scalar = T;
  using Parameters = MonoParameters<T>;
  static constexpr int kMaxFeatures = MaxFeatures;
  static constexpr int kMaxAnchors = MaxAnchors;
  static constexpr int kMaxCameraStates = mono::CameraBlock<T>::kMaxStates;
  static constexpr int kMaxStates = kMaxCameraStates + 3 * (MaxFeatures + MaxAnchors);

  /// Starts over: pose at the origin, no features, Health zero. kBadConfig (nothing changed) when
  /// the camera or a parameter is impossible.
  Status initialise(const PinholeCamera<T>& camera, const Parameters& parameters);

  /// Starts over with the camera at a known pose, taken as exact: no features, velocities as after
  /// initialise(), Health kept but for one more reset. kNotInitialised; kBadConfig for kPivot,
  /// whose position follows from the lever; kNonFiniteInput (also for a quaternion far from length
  /// 1). On an error the filter is unchanged.
  Status restart(const Rigid<T>& T_world_camera);
  /// The same for a camera that goes on moving: with the estimated velocities, and with the map's
  /// typical inverse depth (Parameters::depth_from_map says how it is found) as that of the first
  /// new features, so that the scale stays nearly the same.
  Status restart_moving(const Rigid<T>& T_world_camera);

  /// Moves the state on by `dt_s` seconds and fades the memory: x <- f(x), P <- S F P F' + Q (paper
  /// B, eq. 31). kNotInitialised, kDuplicate (dt = 0), kTimeBackwards, kTimeGap (beyond
  /// Parameters::max_step_s), kNonFiniteInput. Cost: O(n), with fading O(n^2 / 2).
  Status predict(T dt_s);

  /// Motion noise from the next prediction on (MonoParameters::velocity_noise and rate_noise).
  /// kNonFiniteInput, kInvalidArgument (negative, or beyond kLargest): unchanged.
  Status set_motion_noise(T velocity_noise, T rate_noise);
  /// Takes the camera's rotation over the step of the last prediction, `dt_s`, as it was measured
  /// by other means (a rotation vector, camera axes, rad), with its standard deviations. Call it
  /// between predict() and update(). kNotInitialised, kNonFiniteInput, kInvalidArgument (step or
  /// deviation not positive): unchanged. Cost: 2 n^2 multiply-adds.
  Status observe_rotation(const Vector3<T>& rotation, const Vector3<T>& sigma_rad, T dt_s);
  /// Hypotheses of three matches that an update may draw from now on, at most max_triples: for a
  /// frame that can pay for fewer.
  void set_triple_limit(int most) { triple_limit_ = most; }

  int feature_count() const { return features_.size(); }
  int anchor_count() const { return features_.anchor_count(); }
  int state_size() const { return state_.size(); }
  /// Identity of the feature in `slot`, 0 <= slot < feature_count(). Removing a feature moves the
  /// last one into its slot.
  LandmarkId feature_id(int slot) const { return features_[slot].id; }
  FeatureKind feature_kind(int slot) const { return features_[slot].kind; }
  const FeatureStatistics& feature_statistics(int slot) const { return features_[slot].statistics; }
  /// Slot of `id`, -1 if there is none.
  int find(LandmarkId id) const { return features_.find(id); }

  /// Where the feature is expected in the image, and S = H P H' + R. kInvalidArgument for a bad
  /// slot; kOutOfView behind the camera or outside the image, `prediction` untouched.
  Status predict_feature(int slot, PixelPrediction<T>& prediction) const;

  /// Uses the matches of one frame: 1-point RANSAC, inlier gate, update with the low-innovation
  /// inliers, rescue, update with the high-innovation inliers. Sets `inlier` of every match and
  /// fills `report` (nis is the sum over the used matches, 2 degrees of freedom each). Then turns
  /// at most Parameters::max_conversions_per_update features into points. Call it every frame, with
  /// count = 0 where nothing was matched, so that the statistics go on.
  ///
  /// kNoConsensus: too few inliers (also for count = 0), kInvalidArgument (count, slots that are
  /// repeated or do not belong to the id), kNonFiniteInput. On each of these the estimate is
  /// unchanged to the bit. Cost: about n_s^2 multiply-adds per inlier, n_s = state_size(), and at
  /// most (Parameters::ransac.max_hypotheses + max_triples) * count projections.
  Status update(PixelMatch<T>* matches, int count, Random& random, UpdateReport& report);

  /// New feature at `pixel` of the present frame, with the inverse depth of the map or of the
  /// parameters (Parameters::depth_from_map), or with the one given (1/m; positive; ignored in
  /// kRotationOnly). kNotInitialised, kInvalidArgument (id 0,
  /// inverse depth or sigma not positive), kDuplicate (id in use), kFull, kOutOfView, kDegenerate
  /// (distortion cannot be inverted there), kNonFiniteInput.
  Status add_feature(LandmarkId id, const Vector2<T>& pixel);
  Status add_feature(LandmarkId id, const Vector2<T>& pixel, T inverse_depth, T sigma);

  /// kInvalidArgument for a bad slot. The last feature takes its slot.
  Status remove_feature(int slot);

  /// Removes every feature that is measured in too small a share of the updates in which it was
  /// predicted, or has been out of view for too long; then, while fewer than `room` slots are free,
  /// the ones longest out of view. Returns the number removed. Cost: O(n) per feature removed.
  /// `removed`, where given, has room for MaxFeatures and gets the ids in order.
  int prune(const FeaturePolicy& policy, int room, LandmarkId* removed = nullptr);

  /// Camera pose in the world.
  Rigid<T> T_world_camera() const;
  /// Covariance of position (rows 0 to 2, world axes, m) and of the rotation vector phi (rows 3 to
  /// 5, camera axes, rad) with R_true = R exp(phi).
  Matrix<T, 6, 6> pose_covariance() const;
  /// Velocity in the world, m/s (zero unless kSixDof), and rate in the camera frame, rad/s.
  Vector3<T> velocity_mps() const;
  Vector3<T> rate_radps() const;

  /// World point of a feature, m, and its covariance to first order. kInvalidArgument for a bad
  /// slot, kDegenerate in kRotationOnly.
  Status feature_position(int slot, Vector3<T>& p_world, Matrix3<T>& covariance) const;
  /// Inverse depth from the feature's anchor (from the camera for a point), 1/m, and its standard
  /// deviation. Same errors as feature_position().
  Status feature_inverse_depth(int slot, T& inverse_depth, T& sigma) const;

  /// Median inverse depth of the features that are known to 30 %, 1/m; that of the first features
  /// while there are fewer than eight.
  T typical_inverse_depth() const {
    T inverse_depth = first_inverse_depth_;
    T sigma = first_inverse_depth_sigma_;
    features_.expected_inverse_depth(state_, inverse_depth, sigma);
    return inverse_depth;
  }
  /// Camera with the focal length as it is estimated.
  PinholeCamera<T> camera() const { return state_.camera.camera(state_.x); }
  /// Standard deviation of the focal length, as a share of it; 0 where it is not estimated.
  T focal_sigma() const;
  const Parameters& parameters() const { return parameters_; }
  /// Element of the covariance of the whole state. Domain: indices below state_size().
  T covariance(int i, int j) const { return state_.covariance(i, j); }
  /// Factor of the last fading: Parameters::fading_factor or what the innovations asked for.
  T last_fading_factor() const { return memory_.last_factor(); }
  const Health& health() const { return health_; }
  /// Fingerprint of estimate, covariance and features.
  void hash(Hash64& hash) const;

 private:
  using Features = mono::FeatureMap<T, MaxFeatures, MaxAnchors>;
  using State = typename Features::State;
  using Rows2 = mono::SparseRows<T, 2>;
  using Rows3 = mono::SparseRows<T, 3>;
  static constexpr int kPendingPairs = State::kPendingPairs;

  const mono::CameraLayout& layout() const { return state_.layout(); }
  void fade(T factor, bool keep_process_noise);
  Status check_matches(const PixelMatch<T>* matches, int count) const;
  void count_visibility();
  int evaluate_hypothesis(const PixelMatch<T>* matches, int count, int candidate,
                          bool* inliers) const;
  int evaluate_triple(const PixelMatch<T>* matches, int count, const int* candidates,
                      bool* inliers);
  int mark_inliers(T* x, const PixelMatch<T>* matches, int count, bool* inliers) const;
  enum class Fusion : std::uint8_t { kDone, kOutOfView, kSingular };
  Fusion fuse(const PixelMatch<T>& match, int pairs, T* delta, T& nis);
  void adapt_memory(const PixelMatch<T>* matches, int count, const bool* use);
  int apply(PixelMatch<T>* matches, int count, const bool* use, UpdateReport& report);
  void correct_state(const T* delta);
  void rescue(const PixelMatch<T>* matches, int count, bool* rescued) const;

  Parameters parameters_;
  int triple_limit_ = 1 << 20;
  State state_;
  mono::CameraMotion<T> motion_;
  mono::FadingMemory<T> memory_;
  mono::CovarianceGuard<T> guard_;
  Features features_;
  T first_inverse_depth_ = T(1);  ///< of features while the map knows no better, and its deviation
  T first_inverse_depth_sigma_ = T(1);
  bool initialised_ = false;
  Health health_;
};

}  // namespace cairn

#include "cairn/mono/detail/mono_ekf_features_impl.hpp"
#include "cairn/mono/detail/mono_ekf_measure_impl.hpp"
#include "cairn/mono/detail/mono_ekf_predict_impl.hpp"
#include "cairn/mono/detail/mono_ekf_update_impl.hpp"
