#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/pose_refinement.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {

template <class T>
struct PoseRansacOptions {
  static constexpr int kMaxHypotheses = 512;

  int max_hypotheses = 128;  ///< samples of three matches; clamped to [1, kMaxHypotheses]
  T confidence = T(0.99);    ///< that one sample was free of wrong matches; (0, 1)
  T inlier_px = T(4);   ///< largest reprojection error of a match that is an inlier of a hypothesis
  int min_inliers = 8;  ///< fewer after refinement: kNoConsensus
  /// Another pose with at least this share of the best one's inlier count makes the answer
  /// ambiguous.
  T ambiguity_share = T(0.8);
  PoseRefinementOptions<T> refinement;  ///< its min_inliers, prior and use_only are not used

  /// Whether every value is finite and in its domain; of `refinement` those that are used.
  bool valid() const {
    return max_hypotheses >= 1 && confidence > T(0) && confidence < T(1) &&
           is_positive(static_cast<float>(inlier_px)) && min_inliers >= 3 &&
           ambiguity_share >= T(0) && refinement.huber_sigma > T(0) &&
           refinement.inlier_gate > T(0) &&
           is_finite(ambiguity_share + refinement.huber_sigma + refinement.inlier_gate);
  }
};

template <class T>
struct PoseRansacReport {
  int hypotheses = 0;      ///< samples drawn
  int poses = 0;           ///< solutions of the minimal problem that were scored
  int inlier_count = 0;    ///< matches within inlier_px of the best hypothesis, before refinement
  int second_inliers = 0;  ///< of the best clearly different hypothesis
  Rigid<T> T_world_camera_second;  ///< that hypothesis, not refined; identity when there is none
  /// second_inliers >= ambiguity_share * inlier_count: do not trust the pose without a second
  /// frame.
  bool ambiguous = false;
};

/// A pose, and how many of the matches are its inliers.
template <class T>
struct PoseHypothesis {
  Rigid<T> T_world_camera;
  T score = T(-1);  ///< sum over the inliers of 1 - (error / inlier_px)^2
  int inlier_count = 0;
};

/// A search for a pose between two calls of search_pose().
template <class T>
struct PoseSearch {
  PoseHypothesis<T> best;
  PoseHypothesis<T> second;                ///< clearly different from the best
  Vector3<T> centre = Vector3<T>::Zero();  ///< of the points that are inliers of the best
  int hypotheses = 0;                      ///< samples drawn so far
  int poses = 0;                           ///< hypotheses scored so far
  int needed = PoseRansacOptions<T>::kMaxHypotheses;
};

/// Draws at most `samples` further samples; `done` when their number suffices. For a caller that
/// spreads a search over frames; the matches should be the same in every call.
/// kInvalidArgument, kNonFiniteInput: as estimate_pose_ransac, with everything unchanged.
/// Cost: 4 * samples passes over the matches and `samples` calls of solve_p3p.
template <class T>
Status search_pose(const PinholeCamera<T>& camera, const PoseObservation<T>* observations,
                   int count, const PoseRansacOptions<T>& options, int samples, Random& random,
                   PoseSearch<T>& search, bool& done);

/// Refines what search_pose() found, twice. Errors and outputs: as estimate_pose_ransac.
template <class T>
Status finish_pose(const PinholeCamera<T>& camera, const PoseObservation<T>* observations,
                   int count, const PoseRansacOptions<T>& options, const PoseSearch<T>& search,
                   Rigid<T>& T_world_camera, PoseEstimate<T>& estimate, PoseRansacReport<T>& report,
                   std::uint8_t* inlier_flags = nullptr);

/// Camera pose from point matches of which many may be wrong: RANSAC (Fischler and Bolles 1981)
/// over solve_p3p with a truncated quadratic score (MSAC, Torr and Zisserman 2000), verification by
/// reprojection, then refine_pose on the inliers, twice. The number of samples adapts to the best
/// inlier count so far, n = log(1 - confidence) / log(1 - w^3), and is bounded.
///
/// Two hypotheses are clearly different when their rotations differ by more than 0.15 rad or their
/// centres by more than 10 % of the distance to the centroid of its inliers.
///
/// kInvalidArgument: null, count outside [4, kMaxPoseObservations], an option outside its domain.
/// kNonFiniteInput. kDegenerate: every sample was degenerate, or the inliers do not determine the
/// pose. kNoConsensus: fewer than min_inliers. On an error pose, estimate and flags are unchanged;
/// `random` has advanced by three numbers a sample. `report` is written in every case but
/// kInvalidArgument and kNonFiniteInput.
///
/// Cost: at most 4 * max_hypotheses passes over the matches, about 60 operations a match (fewer
/// where a hypothesis cannot win any more), and two refinements.
template <class T>
Status estimate_pose_ransac(const PinholeCamera<T>& camera, const PoseObservation<T>* observations,
                            int count, const PoseRansacOptions<T>& options, Random& random,
                            Rigid<T>& T_world_camera, PoseEstimate<T>& estimate,
                            PoseRansacReport<T>& report, std::uint8_t* inlier_flags = nullptr);

#define CAIRN_POSE_RANSAC(TEMPLATE, T)                                                           \
  TEMPLATE Status search_pose(const PinholeCamera<T>&, const PoseObservation<T>*, int,           \
                              const PoseRansacOptions<T>&, int, Random&, PoseSearch<T>&, bool&); \
  TEMPLATE Status finish_pose(const PinholeCamera<T>&, const PoseObservation<T>*, int,           \
                              const PoseRansacOptions<T>&, const PoseSearch<T>&, Rigid<T>&,      \
                              PoseEstimate<T>&, PoseRansacReport<T>&, std::uint8_t*);            \
  TEMPLATE Status estimate_pose_ransac(const PinholeCamera<T>&, const PoseObservation<T>*, int,  \
                                       const PoseRansacOptions<T>&, Random&, Rigid<T>&,          \
                                       PoseEstimate<T>&, PoseRansacReport<T>&, std::uint8_t*);
CAIRN_POSE_RANSAC(extern template, float)
CAIRN_POSE_RANSAC(extern template, double)

}  // namespace cairn
