#pragma once

#include <new>

#include "cairn/geometry/pose_ransac.hpp"
#include "cairn/map/library_matcher.hpp"
#include "cairn/map/visibility.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/planar_pose_search.hpp"
#include "cairn/tracking/work_budget.hpp"
#include "cairn/vision/fast.hpp"

namespace cairn {

/// Finds the camera's pose in a map library from one image, without a prior: corners spread over
/// the whole image, upright descriptors, every library landmark compared with every one of them,
/// P3P with RANSAC. The work is cut into steps of at most `max_pairs_per_step` comparisons or
/// `samples_per_step` samples, of which a frame takes as many as its caller's budget affords.
///
/// Descriptors are those of make_appearance(): upright, one scale. A vehicle's camera does not
/// roll; a hand-held camera must be held within about 15 degrees of the roll at which the map was
/// seen.
template <class Config>
class Relocaliser {
 public:
  static constexpr int kMaxFeatures = Config::kRelocalisationFeatures;
  static constexpr int kMaxMatches = Config::kRelocalisationMatches;
  using Scalar = typename Config::Scalar;
  using Matcher = LibraryMatcher<Config, kMaxFeatures>;
  static constexpr int kColumns = 8;
  static constexpr int kRows = 6;
  static constexpr int kCells = kColumns * kRows;
  static constexpr int kStride = 19;  ///< coprime to kCells: what is left out is spread
  static constexpr int kMaxCellWidth = Config::kMaxImageWidth / kColumns + 1;
  static constexpr int kCornersPerCell = 6;
  static constexpr int kMaxNear = PlanarPoseOptions::kMaxSightings;
  static constexpr int kMaxPerCell = 3;  ///< of these, described

  struct Parameters {
    Parameters() {
      ransac.min_inliers = 7;
      ransac.inlier_px = Scalar(4);
    }
    int fast_threshold = 20;
    int min_score = 25;
    int margin_px = 34;
    int min_features = 12;  ///< fewer in an image: it is not compared
    /// Of the pixels. Where more of them are corners, before non-maximum suppression, the image is
    /// noise: it is not compared.
    int max_corner_percent = 15;
    int max_capture_work = 8000;  ///< units; the rest of an image is left out
    int max_pairs_per_step = 12288;
    int samples_per_step = 24;
    Scalar sigma_px = Scalar(1.5);
    LibraryMatcherOptions matcher;
    PlanarPoseOptions near;
    PoseRansacOptions<Scalar> ransac;

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good =
          fast_threshold >= 1 && fast_threshold <= 254 && min_score >= 0 && margin_px >= 0 &&
          margin_px <= 4096 && min_features >= 1 && max_corner_percent >= 1 &&
          max_corner_percent <= 100 && max_capture_work >= 1 && max_pairs_per_step >= 1 &&
          max_pairs_per_step <= (1 << 24) && samples_per_step >= 1 &&
          samples_per_step <= PoseRansacOptions<Scalar>::kMaxHypotheses &&
          is_positive(static_cast<float>(sigma_px)) && matcher.valid() && is_positive(near.gate) &&
          is_positive(near.inlier_px) && near.min_inliers >= 1 && ransac.valid();
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  enum class Outcome : std::uint8_t {
    kNothingToSee,  ///< the image has too few corners, or far too many
    kWorking,       ///< call step() with the next frame
    kFailed,        ///< the whole library was compared, and no pose found
    kFound,         ///< T_map_camera() is the pose of the image that capture() had
  };

  /// Memory of one step, the caller's. Nothing in it outlives the step: copies copy nothing.
  union Scratch {
    Scratch() {}
    Scratch(const Scratch&) {}
    Scratch& operator=(const Scratch&) { return *this; }
    ~Scratch() = default;
    struct Corners {
      FastScratch<kMaxCellWidth> fast;
      Corner best[kMaxPerCell][kCells];  // best[k]: the k-th best of each cell
      int count[kCells];
    } corners;
    struct Near {
      VisibleLandmark<float> visible[kMaxNear];
      PlanarSighting sightings[kMaxNear];
    } near;
    struct Pose {
      LibraryMatch matches[kMaxMatches];
      PoseObservation<Scalar> observations[kMaxMatches];
    } pose;
  };

  bool working() const { return working_; }
  void reset() { working_ = false; }

  /// Least units of work with which to call capture(): those of a quarter of the image.
  static int least_capture_work(const ImageView& image) {
    return kMaxFeatures * work::kDescriptor + work::fast(image.width, image.height, 0) / 4;
  }
  /// The most units of work that step() takes.
  static int step_work(const Parameters& parameters) {
    const int match = match_work(parameters.max_pairs_per_step + kMaxFeatures,
                                 parameters.max_pairs_per_step + kMaxFeatures);
    const int pose = pose_work(parameters.samples_per_step, 4 * parameters.samples_per_step) +
                     kMatchList + conclusion_work();
    return match > pose ? match : pose;
  }

  /// The most units of work that find_near() takes.
  static constexpr int near_work() {
    constexpr int kPairsPerUnit = 4;
    constexpr int kHypothesesPerUnit = 1;
    return Config::kLibraryLandmarks * work::kLibrarySlot + kMaxNear * work::kLibrarySlot +
           kMaxNear * kMaxFeatures / kPairsPerUnit + kMaxNear * kMaxNear / kHypothesesPerUnit;
  }

  /// Looks for the pose of the image near a prior: each landmark of the library, and of `live`
  /// (LiveLandmarks), that should be in view is compared only with the features inside its ellipse.
  /// True where T_map_camera() is the pose; false where none was found, and step() continues. Cost:
  /// near_work().
  template <class Library, class Live>
  bool find_near(const PlanarView& view, const PlanarPrior& prior, const Library& library,
                 const Live& live, const Parameters& parameters, Scratch& scratch);

  /// Begins with an image: FAST cell by cell, then at most kMaxFeatures descriptors. Cost: at most
  /// `max_capture_work` units, and no more than `budget` has.
  Outcome capture(const ImageView& image, const Parameters& parameters, Scratch& scratch,
                  WorkBudget& budget) {
    matcher_.clear();
    matched_ = false;
    search_ = PoseSearch<Scalar>();
    auto& corners = *new (&scratch.corners) typename Scratch::Corners();
    const int most = parameters.max_capture_work;
    WorkBudget capturing(most < budget.left() ? most : budget.left());
    capturing.spend(kMaxFeatures * work::kDescriptor);
    Seen seen;
    for (int i = 0; i < kCells && !is_noise(seen, parameters); ++i) {
      find_best(image, i * kStride % kCells, parameters, corners, capturing, seen);
    }
    budget.spend(capturing.spent());
    working_ = false;
    if (is_noise(seen, parameters)) return Outcome::kNothingToSee;
    // The best of every cell first: a full matcher is then spread over the whole image.
    for (int k = 0; k < kMaxPerCell; ++k) {
      for (int cell = 0; cell < kCells; ++cell) {
        if (k < corners.count[cell]) describe(image, corners.best[k][cell]);
      }
    }
    working_ = matcher_.feature_count() >= parameters.min_features;
    return working_ ? Outcome::kWorking : Outcome::kNothingToSee;
  }

  /// Continues: comparisons first, then RANSAC samples. Cost: at most step_work(), booked in
  /// `budget`.
  template <class Library>
  Outcome step(const PinholeCamera<Scalar>& camera, const Library& library,
               const Parameters& parameters, Random& random, Scratch& scratch, WorkBudget& budget) {
    if (!matched_) {
      const int pairs = matcher_.pairs();
      const int compared = matcher_.compared_whole();
      matched_ = matcher_.step(library, parameters.max_pairs_per_step, parameters.matcher);
      budget.spend(match_work(matcher_.pairs() - pairs, matcher_.compared_whole() - compared));
      return Outcome::kWorking;
    }
    const Outcome outcome = look_for_pose(camera, library, parameters, random, scratch, budget);
    working_ = outcome == Outcome::kWorking;
    return outcome;
  }

  /// The pose found, in the map's coordinates.
  const Rigid<Scalar>& T_map_camera() const { return T_map_camera_; }

 private:
  static constexpr int kMatchList = 160;  // units
  static int match_work(int pairs, int compared) { return 1 + pairs / 12 + compared / 5; }
  static int pose_work(int samples, int poses) {
    constexpr int kSample = 5;  // P3P
    constexpr int kMatchesPerUnit = 5;
    return samples * kSample + poses * kMaxMatches / kMatchesPerUnit;
  }
  static constexpr int conclusion_work() { return 50 + 9 * kMaxMatches; }

  template <class Live>
  int sight_live(const PlanarView& view, const PlanarPrior& prior, const Live& live,
                 float margin_px, const Parameters& parameters, PlanarSighting* sightings) const;
  bool sight(const PlanarView& view, const PlanarPrior& prior, const Descriptor& descriptor,
             const Parameters& parameters, PlanarSighting& sighting) const;

  template <class Library>
  Outcome look_for_pose(const PinholeCamera<Scalar>& camera, const Library& library,
                        const Parameters& parameters, Random& random, Scratch& scratch,
                        WorkBudget& budget) {
    auto& pose = *new (&scratch.pose) typename Scratch::Pose();
    LibraryMatch* matches = pose.matches;
    PoseObservation<Scalar>* observations = pose.observations;
    const int count = matcher_.matches(parameters.matcher, matches, kMaxMatches);
    const int usable =
        to_observations(library, matcher_, matches, count, parameters.sigma_px, observations);
    budget.spend(kMatchList);
    if (usable < parameters.ransac.min_inliers) return Outcome::kFailed;
    const int samples = search_.hypotheses;
    const int poses = search_.poses;
    bool done = false;
    const Status searched = search_pose(camera, observations, usable, parameters.ransac,
                                        parameters.samples_per_step, random, search_, done);
    budget.spend(pose_work(search_.hypotheses - samples, search_.poses - poses));
    if (!ok(searched)) return Outcome::kFailed;
    if (!done) return Outcome::kWorking;
    budget.spend(conclusion_work());
    PoseEstimate<Scalar> estimate;
    PoseRansacReport<Scalar> report;
    const Status concluded = finish_pose(camera, observations, usable, parameters.ransac, search_,
                                         T_map_camera_, estimate, report);
    // Two places may look alike: the caller verifies the pose.
    return ok(concluded) ? Outcome::kFound : Outcome::kFailed;
  }

  /// Of an image so far.
  struct Seen {
    int cells = 0;
    int pixels = 0;
    int corners = 0;  // before non-maximum suppression
  };
  static bool is_noise(const Seen& seen, const Parameters& parameters) {
    constexpr int kMinCells = 8;
    return seen.cells >= kMinCells &&
           seen.corners > seen.pixels / 100 * parameters.max_corner_percent;
  }

  void find_best(const ImageView& image, int cell, const Parameters& parameters,
                 typename Scratch::Corners& corners, WorkBudget& budget, Seen& seen) {
    corners.count[cell] = 0;
    const int width = (image.width + kColumns - 1) / kColumns;
    const int height = (image.height + kRows - 1) / kRows;
    const int x0 = (cell % kColumns) * width;
    const int y0 = (cell / kColumns) * height;
    const int margin = parameters.margin_px;
    const Rect rect = intersect({x0, y0, x0 + width, y0 + height},
                                {margin, margin, image.width - margin, image.height - margin});
    if (rect.empty() || rect.width() > kMaxCellWidth ||
        !budget.affords(work::fast(rect.width(), rect.height()))) {
      return;
    }
    Corner found[kCornersPerCell];
    FastReport fast;
    if (!ok(detect_fast(image, rect, parameters.fast_threshold, corners.fast, found,
                        kCornersPerCell, fast))) {
      return;
    }
    budget.spend(work::fast(rect.width(), rect.height(), fast.candidates));
    ++seen.cells;
    seen.pixels += rect.width() * rect.height();
    seen.corners += fast.candidates;
    for (int i = 0; i < fast.found - fast.dropped; ++i) {
      if (found[i].score < parameters.min_score) continue;
      int k = corners.count[cell] < kMaxPerCell ? corners.count[cell]++ : kMaxPerCell - 1;
      if (corners.best[k][cell].score >= found[i].score) continue;  // a new one's is 0
      for (; k > 0 && corners.best[k - 1][cell].score < found[i].score; --k) {
        corners.best[k][cell] = corners.best[k - 1][cell];
      }
      corners.best[k][cell] = found[i];
    }
  }

  void describe(const ImageView& image, const Corner& corner) {
    FreakPose pose;
    pose.scale_index = kReferenceScaleIndex;
    Descriptor descriptor;
    if (!ok(describe_freak(image, corner.x, corner.y, pose, descriptor))) return;
    const Vector2<Scalar> pixel(static_cast<Scalar>(corner.x), static_cast<Scalar>(corner.y));
    // Refused when the matcher is full, which is enough.
    static_cast<void>(matcher_.add_feature(pixel, descriptor));
  }

  Matcher matcher_;
  PoseSearch<Scalar> search_;
  Rigid<Scalar> T_map_camera_;
  bool working_ = false;
  bool matched_ = false;  ///< the whole library was compared
};

}  // namespace cairn

#include "cairn/tracking/detail/relocaliser_near.hpp"
