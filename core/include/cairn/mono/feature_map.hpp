#pragma once

#include <cstdint>

#include "cairn/base/hash.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/mono/mono_state.hpp"

namespace cairn {

/// How a feature is written in the state.
enum class FeatureKind : std::uint8_t {
  kInverseDepth,  ///< anchor (3, shared) and theta, phi, rho: m = B direction(theta, phi)
  kPoint,         ///< world point, m
  kDirection,     ///< theta, phi alone: a point at infinity (MotionModel::kRotationOnly)
};

/// Visual record of one feature, for the caller's map management.
struct FeatureStatistics {
  int predicted = 0;           ///< updates in which it was predicted inside the image
  int measured = 0;            ///< updates that used its measurement
  int consecutive_misses = 0;  ///< predicted and not used, since the last use
  int out_of_view = 0;         ///< updates outside the image since it was last inside
};

namespace mono {

/// The monocular filter's features and their anchors: where their blocks lie in the state, how they
/// are measured, and how they are added, rewritten and removed. Each call is given the state that
/// they are part of. Features of one frame share an anchor; when all are in use, the features of
/// the least used one are expressed from the present camera position (to first order).
///
/// Legend (Civera et al. 2008): r camera position, a anchor, m direction, rho inverse depth, B the
/// axes of a feature's angles.
template <class T, int MaxFeatures, int MaxAnchors>
class FeatureMap {
 public:
  static constexpr int kMaxStates = CameraBlock<T>::kMaxStates + 3 * (MaxFeatures + MaxAnchors);
  using State = MonoState<T, kMaxStates>;
  using Parameters = MonoParameters<T>;
  using Rows2 = SparseRows<T, 2>;
  using Rows3 = SparseRows<T, 3>;

  struct Feature {
    LandmarkId id = kNoLandmark;
    FeatureKind kind = FeatureKind::kInverseDepth;
    int at = 0;                                           ///< first index of its block in the state
    int anchor = -1;                                      ///< index of its anchor, -1 for none
    Matrix3<T> R_world_feature = Matrix3<T>::Identity();  ///< axes of theta and phi
    T first_inverse_depth = T(0);
    FeatureStatistics statistics;
  };

  void clear() { count_ = anchor_count_ = next_conversion_ = 0, frame_anchor_ = -1; }
  /// The camera moved, or its position is another: features to come have another anchor.
  void leave_anchor() { frame_anchor_ = -1; }

  int size() const { return count_; }
  bool full() const { return count_ == MaxFeatures; }
  int anchor_count() const { return anchor_count_; }
  Feature& operator[](int slot) { return features_[slot]; }
  const Feature& operator[](int slot) const { return features_[slot]; }
  /// First index of the block of a feature's anchor. Domain: it has one.
  int anchor_at(const Feature& feature) const { return anchors_[feature.anchor].at; }
  /// Slot of `id`, -1 if there is none.
  int find(LandmarkId id) const;

  // What a state vector `x`, that of `state` or a hypothesis, says of a feature.
  static T inverse_depth(const T* x, const Feature& feature) {
    return feature.kind == FeatureKind::kInverseDepth ? x[feature.at + 2] : T(0);
  }
  /// World vector from the camera towards the feature: rho (a - r) + m, p - r, or m.
  Vector3<T> ray_to(const State& state, const T* x, const Feature& feature, T inverse_depth) const;
  Status pixel_at(const State& state, const T* x, int slot, Vector2<T>& pixel) const;

  /// Predicted pixel of a feature and H, its derivative by the state.
  Status linearise(const State& state, const Parameters& parameters, int slot, Vector2<T>& pixel,
                   Rows2& rows) const;
  /// World point of a feature that is no direction, and its derivative.
  void point_rows(const State& state, const Feature& feature, Vector3<T>& p_world,
                  Rows3& rows) const;
  /// Median inverse depth, seen from the present camera, of the features known to 30 %; both values
  /// are left alone where fewer than eight are.
  void expected_inverse_depth(const State& state, T& inverse_depth, T& sigma) const;

  /// New feature at a pixel of the present frame, inside the image. kDegenerate (distortion cannot
  /// be inverted there): nothing changed. Domain: not full.
  Status add(State& state, const Parameters& parameters, LandmarkId id, const Vector2<T>& pixel,
             T inverse_depth, T sigma);
  /// The last feature takes its slot. Domain: 0 <= slot < size().
  void remove(State& state, int slot);
  /// Turns features whose depth is linear enough into points, at most
  /// Parameters::max_conversions_per_update of them.
  void convert_linear_features(State& state, const Parameters& parameters);

  /// Largest variances that fading may reach, of features and anchors: the inverse depth never
  /// needs more than its prior.
  void fading_limits(const Parameters& parameters, T* limit) const;
  void hash(Hash64& hash) const;

 private:
  struct Anchor {
    int at = 0;
    int users = 0;
  };

  int anchor_for_new_feature(State& state, const Parameters& parameters);
  void move_to_camera(State& state, Feature& feature);
  void release_anchor(State& state, int anchor);
  void remove_block(State& state, int at);
  bool is_linear(const State& state, const Parameters& parameters, const Feature& feature) const;
  void convert_to_point(State& state, Feature& feature);

  Feature features_[MaxFeatures];
  Anchor anchors_[MaxAnchors];
  int count_ = 0;
  int anchor_count_ = 0;
  int frame_anchor_ = -1;  ///< anchor of the features added in this frame
  int next_conversion_ = 0;
};

}  // namespace mono
}  // namespace cairn

#include "cairn/mono/detail/feature_map_blocks_impl.hpp"
#include "cairn/mono/detail/feature_map_measure_impl.hpp"
