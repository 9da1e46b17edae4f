#pragma once

#include <cstdint>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/pose_refinement.hpp"
#include "cairn/map/library.hpp"
#include "cairn/vision/hamming.hpp"

namespace cairn {

struct LibraryMatcherOptions {
  int max_prefix_distance = 40;  ///< of the first 16 bytes (128 bits); beyond: no match
  int max_distance = 120;        ///< of all 512 bits
  /// A landmark's best feature must be nearer than this share of its second best one, in 1/256; the
  /// same between the best two landmarks of one feature.
  int max_ratio_256 = 218;

  bool valid() const {
    return max_prefix_distance >= 0 && max_distance >= 0 && max_ratio_256 >= 0 &&
           max_ratio_256 <= 256;
  }
};

/// A feature of the frame and the landmark it looks like.
struct LibraryMatch {
  int feature = -1;
  LandmarkId id = kNoLandmark;
  int distance = 513;
};

/// Number of differing bits among the first 16 bytes, 0..128.
int hamming_prefix_distance(const Descriptor& a, const Descriptor& b);

/// Matches the descriptors of one frame against a whole library, a bounded number of pairs at a
/// time, so that a lost tracker can spread the work over frames. Brute force with a cascade: the
/// first 16 bytes are compared first, and only pairs that are near in them are compared whole. A
/// match is kept when the feature is clearly the landmark's best one and the landmark clearly the
/// feature's best one.
///
/// The library may change between steps: matches carry ids, and a landmark that came into a slot
/// already compared is not seen until the next run.
template <class Config, int MaxFeatures = 128>
class LibraryMatcher {
 public:
  using Scalar = typename Config::Scalar;
  static constexpr int kMaxFeatures = MaxFeatures;
  static_assert(MaxFeatures <= kMaxPoseObservations, "matches feed estimate_pose_ransac");

  /// Forgets everything.
  void clear() {
    descriptors_.clear();
    pixels_.clear();
    next_slot_ = 0;
    pairs_ = 0;
    compared_whole_ = 0;
  }
  /// Adds a feature of the frame. kFull, kNonFiniteInput.
  Status add_feature(const Vector2<Scalar>& pixel, const Descriptor& descriptor) {
    if (!is_finite(pixel.sum())) return Status::kNonFiniteInput;
    if (!descriptors_.push_back(descriptor)) return Status::kFull;
    pixels_.push_back(pixel);
    best_[descriptors_.size() - 1] = Best();
    return Status::kOk;
  }

  int feature_count() const { return descriptors_.size(); }
  const Vector2<Scalar>& pixel(int feature) const { return pixels_[feature]; }

  /// The feature that looks most like `descriptor` of those whose pixel `may_be` accepts, and
  /// clearly more so than the next; -1 where there is none. Cost: a comparison for each of them.
  template <class MayBe>
  int best_of(const Descriptor& descriptor, const LibraryMatcherOptions& options,
              MayBe may_be) const {
    const Nearest nearest = nearest_to(descriptor, [&](int f) { return may_be(pixels_[f]); });
    return is_match(nearest, options) ? nearest.feature : -1;
  }

  /// Compares further landmarks with every feature until `max_pairs` pairs are spent (at least one
  /// landmark). True when the whole library has been compared.
  /// Cost: about 80 instructions a pair and 200 more for the pairs that pass the cascade
  /// (Cortex-M7).
  template <int Views>
  bool step(const MapLibrary<Config, Views>& library, int max_pairs,
            const LibraryMatcherOptions& options) {
    int spent = 0;
    while (next_slot_ < library.size()) {
      const auto& landmark = library[next_slot_];
      for (int v = 0; v < landmark.view_count; ++v) {
        match_view(landmark.id, landmark.views[v].descriptor, options);
      }
      spent += landmark.view_count * descriptors_.size();
      ++next_slot_;
      if (spent >= max_pairs) break;
    }
    pairs_ += spent;
    return next_slot_ >= library.size();
  }

  /// Pairs that step() has compared since clear(), and those of them that passed the cascade.
  int pairs() const { return pairs_; }
  int compared_whole() const { return compared_whole_; }

  /// The matches so far, nearest first (ties: lower feature), at most `capacity`. Returns how many.
  int matches(const LibraryMatcherOptions& options, LibraryMatch* out, int capacity) const {
    int count = 0;
    for (int f = 0; f < descriptors_.size(); ++f) {
      const Best& best = best_[f];
      if (best.id == kNoLandmark || !is_clear(best.distance, best.second_distance, options)) {
        continue;
      }
      int place = count < capacity ? count : capacity;
      while (place > 0 && out[place - 1].distance > best.distance) {
        if (place < capacity) out[place] = out[place - 1];
        --place;
      }
      if (place == capacity) continue;
      out[place].feature = f;
      out[place].id = best.id;
      out[place].distance = best.distance;
      if (count < capacity) ++count;
    }
    return count;
  }

 private:
  struct Best {
    LandmarkId id = kNoLandmark;
    int distance = 513;
    int second_distance = 513;  // of another landmark
  };

  struct Nearest {
    int feature = -1;
    int distance = 513;
    int second_distance = 513;  // of another feature
    int compared = 0;
  };

  static bool is_clear(int distance, int second, const LibraryMatcherOptions& options) {
    return distance * 256 < second * options.max_ratio_256;
  }
  static bool is_match(const Nearest& nearest, const LibraryMatcherOptions& options) {
    return nearest.feature >= 0 && nearest.distance <= options.max_distance &&
           is_clear(nearest.distance, nearest.second_distance, options);
  }

  /// Of the features that `may_be` accepts.
  template <class MayBe>
  Nearest nearest_to(const Descriptor& descriptor, MayBe may_be) const {
    Nearest nearest;
    for (int f = 0; f < descriptors_.size(); ++f) {
      if (!may_be(f)) continue;
      ++nearest.compared;
      const int d = hamming_distance(descriptor, descriptors_[f]);
      if (d < nearest.distance) {
        nearest.second_distance = nearest.distance;
        nearest.distance = d;
        nearest.feature = f;
      } else if (d < nearest.second_distance) {
        nearest.second_distance = d;
      }
    }
    return nearest;
  }

  void match_view(LandmarkId id, const Descriptor& descriptor,
                  const LibraryMatcherOptions& options) {
    const Nearest nearest = nearest_to(descriptor, [&](int f) {
      return hamming_prefix_distance(descriptor, descriptors_[f]) <= options.max_prefix_distance;
    });
    compared_whole_ += nearest.compared;
    if (is_match(nearest, options)) note(best_[nearest.feature], id, nearest.distance);
  }

  static void note(Best& best, LandmarkId id, int distance) {
    if (id == best.id) {
      if (distance < best.distance) best.distance = distance;
    } else if (distance < best.distance || (distance == best.distance && id < best.id)) {
      best.second_distance = best.distance;
      best.distance = distance;
      best.id = id;
    } else if (distance < best.second_distance) {
      best.second_distance = distance;
    }
  }

  FixedVector<Descriptor, MaxFeatures> descriptors_;
  FixedVector<Vector2<Scalar>, MaxFeatures> pixels_;
  Best best_[MaxFeatures];
  int next_slot_ = 0;
  int pairs_ = 0;
  int compared_whole_ = 0;
};

/// Turns matches into observations for estimate_pose_ransac. Matches whose landmark has left the
/// library are skipped. `observations` must hold `count`. Returns how many were written.
template <class Config, int Views, int MaxFeatures>
int to_observations(const MapLibrary<Config, Views>& library,
                    const LibraryMatcher<Config, MaxFeatures>& matcher, const LibraryMatch* matches,
                    int count, typename Config::Scalar sigma_px,
                    PoseObservation<typename Config::Scalar>* observations) {
  int written = 0;
  for (int i = 0; i < count; ++i) {
    const int slot = library.find(matches[i].id);
    if (slot < 0) continue;
    auto& o = observations[written++];
    o.p_world = library[slot].p_map;
    o.covariance = library[slot].covariance;
    o.pixel = matcher.pixel(matches[i].feature);
    o.sigma_px = sigma_px;
  }
  return written;
}

}  // namespace cairn
