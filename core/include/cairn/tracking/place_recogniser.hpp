#pragma once

#include <new>

#include "cairn/geometry/pose_ransac.hpp"
#include "cairn/map/library_matcher.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/work_budget.hpp"

namespace cairn {

/// Recognises the place of a hand-held camera in a map library: points of one image, described at
/// the roll that the camera is believed to have, are compared with every landmark; P3P with RANSAC
/// proposes a pose, which the caller is to confirm. The work is cut into steps.
///
/// `Config`: kLibraryLandmarks, kRelocalisationFeatures (points of an image),
/// kRelocalisationMatches (the best, for RANSAC).
template <class Config>
class PlaceRecogniser {
 public:
  static constexpr int kMaxPoints = Config::kRelocalisationFeatures;
  static constexpr int kMaxMatches = Config::kRelocalisationMatches;
  using Library = MapLibrary<Config>;
  using Matcher = LibraryMatcher<Config, kMaxPoints>;

  struct Parameters {
    Parameters() {
      ransac.min_inliers = 5;
      ransac.inlier_px = 8.0F;
      ransac.max_hypotheses = 300;
    }
    int max_pairs_per_step = 4096;
    int samples_per_step = 12;
    float sigma_px = 1.5F;
    LibraryMatcherOptions matcher;
    PoseRansacOptions<float> ransac;
    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good =
          max_pairs_per_step >= 1 && max_pairs_per_step <= (1 << 24) && samples_per_step >= 1 &&
          samples_per_step <= PoseRansacOptions<float>::kMaxHypotheses && is_positive(sigma_px) &&
          matcher.valid() && ransac.valid() && ransac.min_inliers >= 4;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  enum class Outcome : std::uint8_t {
    kWorking,   ///< call step() again
    kFailed,    ///< the whole library was compared, and no pose found
    kProposed,  ///< T_map_camera() is a pose that another look may confirm
  };

  /// Forgets the image.
  void reset() {
    matcher_.clear();
    matched_ = false;
    search_ = PoseSearch<float>();
  }
  /// Describes a point of the image at the camera's roll. False where it is too near to the border,
  /// or there is no more room. Cost: work::kDescriptor.
  bool add(const ImageView& image, const Vector2<float>& pixel, std::uint8_t orientation_bin);
  int points() const { return matcher_.feature_count(); }
  const Vector2<float>& pixel(int point) const { return matcher_.pixel(point); }

  /// The most units of work that step() takes.
  static int step_work(const Parameters& parameters) {
    const int match = match_work(parameters.max_pairs_per_step + kMaxPoints,
                                 parameters.max_pairs_per_step + kMaxPoints);
    const int pose =
        pose_work(parameters.samples_per_step, 4 * parameters.samples_per_step, kMaxMatches) +
        kConclusion;
    return match > pose ? match : pose;
  }
  /// Units that so many samples of P3P take, and their poses.
  static int pose_work(int samples, int poses, int matches) {
    constexpr int kSample = 5;  // P3P
    constexpr int kMatchesPerUnit = 5;
    return samples * kSample + poses * matches / kMatchesPerUnit;
  }
  /// Continues: comparisons first, then RANSAC samples. Books its work in `budget`.
  Outcome step(const PinholeCamera<float>& camera, const Library& library,
               const Parameters& parameters, Random& random, WorkBudget& budget);

  /// The pose proposed, in the map's coordinates.
  const Rigid<float>& T_map_camera() const { return T_map_camera_; }

 private:
  static constexpr int kConclusion = 50 + 9 * kMaxMatches;  // units
  static int match_work(int pairs, int compared) { return 1 + pairs / 12 + compared / 5; }
  Matcher matcher_;
  PoseSearch<float> search_;
  Rigid<float> T_map_camera_;
  bool matched_ = false;  ///< the whole library was compared
  LibraryMatch matches_[kMaxMatches];
  PoseObservation<float> observations_[kMaxMatches];
};

/// Orientation bin of FREAK for a camera at T_camera_world: the roll at which the world's y axis,
/// down where the first camera was held upright, points down in the image.
inline std::uint8_t roll_bin(const Rigid<float>& T_camera_world) {
  constexpr float kLeast = 0.1F;  // squared sine of the angle between axis and line of sight
  constexpr float kBinsPerRadian = 256.0F / 6.28318531F;
  const Vector3<float> down = T_camera_world.rotation * Vector3<float>(0.0F, 1.0F, 0.0F);
  float angle = 0.0F;
  if (square(down.x()) + square(down.y()) > kLeast) {
    angle = atan2(-down.x(), down.y());
  } else {
    const Vector3<float> right = T_camera_world.rotation * Vector3<float>(1.0F, 0.0F, 0.0F);
    angle = atan2(right.y(), right.x());
  }
  return static_cast<std::uint8_t>(static_cast<unsigned>(round_to_int(angle * kBinsPerRadian)) &
                                   0xFFU);
}

template <class Config>
bool PlaceRecogniser<Config>::add(const ImageView& image, const Vector2<float>& pixel,
                                  std::uint8_t orientation_bin) {
  FreakPose pose;
  pose.scale_index = kReferenceScaleIndex;
  pose.orientation_bin = orientation_bin;
  Descriptor descriptor;
  return points() < kMaxPoints &&
         ok(describe_freak(image, round_to_int(pixel.x()), round_to_int(pixel.y()), pose,
                           descriptor)) &&
         ok(matcher_.add_feature(pixel, descriptor));
}

template <class Config>
typename PlaceRecogniser<Config>::Outcome PlaceRecogniser<Config>::step(
    const PinholeCamera<float>& camera, const Library& library, const Parameters& parameters,
    Random& random, WorkBudget& budget) {
  if (!matched_) {
    const int pairs = matcher_.pairs();
    const int compared = matcher_.compared_whole();
    matched_ = matcher_.step(library, parameters.max_pairs_per_step, parameters.matcher);
    budget.spend(match_work(matcher_.pairs() - pairs, matcher_.compared_whole() - compared));
    return Outcome::kWorking;
  }
  const int count = matcher_.matches(parameters.matcher, matches_, kMaxMatches);
  const int usable =
      to_observations(library, matcher_, matches_, count, parameters.sigma_px, observations_);
  if (usable < parameters.ransac.min_inliers) return Outcome::kFailed;
  const int samples = search_.hypotheses;
  const int poses = search_.poses;
  bool done = false;
  const Status searched = search_pose(camera, observations_, usable, parameters.ransac,
                                      parameters.samples_per_step, random, search_, done);
  budget.spend(pose_work(search_.hypotheses - samples, search_.poses - poses, usable));
  if (!ok(searched)) return Outcome::kFailed;
  if (!done) return Outcome::kWorking;
  budget.spend(kConclusion);
  PoseEstimate<float> estimate;
  PoseRansacReport<float> report;
  const Status concluded = finish_pose(camera, observations_, usable, parameters.ransac, search_,
                                       T_map_camera_, estimate, report);
  return ok(concluded) ? Outcome::kProposed : Outcome::kFailed;
}

}  // namespace cairn
