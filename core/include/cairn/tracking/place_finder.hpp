#pragma once

#include <new>

#include "cairn/geometry/pose_ransac.hpp"
#include "cairn/map/library_matcher.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/vision/fast.hpp"

namespace cairn {

/// Finds the place of a camera in the hand in a map library, without any idea of it, in two frames:
/// the first's image is described and compared with part of the library, in the second the
/// comparison is finished and a pose is looked for. Descriptors are those of make_appearance(),
/// upright and of one scale: the camera must be held within about 15 degrees of how the map was
/// seen.
///
/// Few matches are asked for, so that the pose found is a proposal: the caller must confirm it.
template <class Config>
class PlaceFinder {
 public:
  static constexpr int kMaxFeatures = 144;
  static constexpr int kMaxMatches = 40;  ///< the nearest ones, of which a pose is sought
  using Scalar = typename Config::Scalar;
  using Matcher = LibraryMatcher<Config, kMaxFeatures>;
  static constexpr int kColumns = 8;
  static constexpr int kRows = 6;
  static constexpr int kCells = kColumns * kRows;
  static constexpr int kMaxCellWidth = Config::kMaxImageWidth / kColumns + 1;
  static constexpr int kMaxPerCell = kMaxFeatures / kCells;

  struct Parameters {
    Parameters() {
      ransac.min_inliers = 5;
      ransac.inlier_px = Scalar(8);
      ransac.max_hypotheses = 300;
    }
    int fast_threshold = 12;
    int min_score = 14;
    int margin_px = 34;
    int min_features = 12;    ///< fewer in an image: nothing to be recognised
    int first_pairs = 12288;  ///< compared in the image's own frame
    Scalar sigma_px = Scalar(1.5);
    LibraryMatcherOptions matcher;
    PoseRansacOptions<Scalar> ransac;
  };

  /// Memory of one call, the caller's. Nothing in it outlives the call: copies copy nothing.
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
    struct Pose {
      LibraryMatch matches[kMaxMatches];
      PoseObservation<Scalar> observations[kMaxMatches];
    } pose;
  };

  bool working() const { return working_; }
  void reset() { working_ = false; }

  /// First frame. False when the image has too few corners. Cost: FAST over the image, at most
  /// kMaxFeatures descriptors, `first_pairs` comparisons.
  template <class Library>
  bool begin(const ImageView& image, const Library& library, const Parameters& parameters,
             Scratch& scratch) {
    matcher_.clear();
    auto& corners = *new (&scratch.corners) typename Scratch::Corners();
    for (int cell = 0; cell < kCells; ++cell) find_best(image, cell, parameters, corners);
    for (int k = 0; k < kMaxPerCell; ++k) {
      for (int cell = 0; cell < kCells; ++cell) {
        if (k < corners.count[cell]) describe(image, corners.best[k][cell]);
      }
    }
    working_ = matcher_.feature_count() >= parameters.min_features;
    if (working_) {
      static_cast<void>(matcher_.step(library, parameters.first_pairs, parameters.matcher));
    }
    return working_;
  }

  /// Second frame. True when T_map_camera() is the pose of the first frame. Cost: the comparisons
  /// that are left, a RANSAC over kMaxMatches.
  template <class Library>
  bool finish(const PinholeCamera<Scalar>& camera, const Library& library,
              const Parameters& parameters, Random& random, Scratch& scratch) {
    working_ = false;
    constexpr int kAll = Library::kCapacity * kMaxFeatures;
    if (!matcher_.step(library, kAll, parameters.matcher)) return false;
    auto& pose = *new (&scratch.pose) typename Scratch::Pose();
    const int count = matcher_.matches(parameters.matcher, pose.matches, kMaxMatches);
    const int usable = to_observations(library, matcher_, pose.matches, count, parameters.sigma_px,
                                       pose.observations);
    if (usable < parameters.ransac.min_inliers) return false;
    PoseEstimate<Scalar> estimate;
    PoseRansacReport<Scalar> report;
    return ok(estimate_pose_ransac(camera, pose.observations, usable, parameters.ransac, random,
                                   T_map_camera_, estimate, report));
  }

  /// The pose found, in the map's coordinates.
  const Rigid<Scalar>& T_map_camera() const { return T_map_camera_; }

 private:
  static constexpr int kCornersPerCell = 8;
  void find_best(const ImageView& image, int cell, const Parameters& parameters,
                 typename Scratch::Corners& corners) const {
    corners.count[cell] = 0;
    const int width = (image.width + kColumns - 1) / kColumns;
    const int height = (image.height + kRows - 1) / kRows;
    const int x0 = (cell % kColumns) * width;
    const int y0 = (cell / kColumns) * height;
    const int margin = parameters.margin_px;
    const Rect rect = intersect({x0, y0, x0 + width, y0 + height},
                                {margin, margin, image.width - margin, image.height - margin});
    if (rect.empty() || rect.width() > kMaxCellWidth) return;
    Corner found[kCornersPerCell];
    FastReport fast;
    if (!ok(detect_fast(image, rect, parameters.fast_threshold, corners.fast, found,
                        kCornersPerCell, fast))) {
      return;
    }
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
    // A full matcher has features enough.
    static_cast<void>(matcher_.add_feature(pixel, descriptor));
  }

  Matcher matcher_;
  Rigid<Scalar> T_map_camera_;
  bool working_ = false;
};

}  // namespace cairn
