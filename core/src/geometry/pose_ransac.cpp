#include "cairn/geometry/pose_ransac.hpp"

#include "cairn/geometry/p3p.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kSampleSize = 3;

template <class T>
constexpr T different_rotation_rad() {
  return T(0.15);
}
template <class T>
constexpr T different_centre_share() {
  return T(0.1);
}

template <class T>
struct Problem {
  const PinholeCamera<T>& camera;
  const PoseObservation<T>* observations;
  int count;
  const PoseRansacOptions<T>& options;
};

template <class T>
Status check(const Problem<T>& problem) {
  const PoseRansacOptions<T>& o = problem.options;
  if (problem.observations == nullptr || problem.count < kSampleSize + 1 ||
      problem.count > kMaxPoseObservations) {
    return Status::kInvalidArgument;
  }
  if (!(o.confidence > T(0) && o.confidence < T(1)) || !(o.inlier_px > T(0)) ||
      o.min_inliers < kSampleSize + 1) {
    return Status::kInvalidArgument;
  }
  for (int i = 0; i < problem.count; ++i) {
    const PoseObservation<T>& m = problem.observations[i];
    if (!is_finite(m.p_world.sum() + m.pixel.sum() + m.covariance.sum() + m.sigma_px)) {
      return Status::kNonFiniteInput;
    }
    if (!(m.sigma_px > T(0))) return Status::kInvalidArgument;
  }
  return problem.camera.check_numbers();
}

/// Three distinct indices below `count`.
void draw_sample(Random& random, int count, int (&sample)[kSampleSize]) {
  sample[0] = random.below(count);
  sample[1] = random.below(count - 1);
  sample[2] = random.below(count - 2);
  if (sample[1] >= sample[0]) ++sample[1];
  const int low = sample[0] < sample[1] ? sample[0] : sample[1];
  const int high = sample[0] < sample[1] ? sample[1] : sample[0];
  if (sample[2] >= low) ++sample[2];
  if (sample[2] >= high) ++sample[2];
}

/// Scores a pose; stops early once it cannot reach `to_beat`.
template <class T>
void score(const Problem<T>& problem, T to_beat, PoseHypothesis<T>& hypothesis) {
  const Rigid<T> T_camera_world = hypothesis.T_world_camera.inverse();
  const T limit = square(problem.options.inlier_px);
  hypothesis.score = T(0);
  hypothesis.inlier_count = 0;
  for (int i = 0; i < problem.count; ++i) {
    if (hypothesis.score + static_cast<T>(problem.count - i) < to_beat) return;
    const PoseObservation<T>& m = problem.observations[i];
    Vector2<T> pixel;
    if (!ok(problem.camera.project(T_camera_world * m.p_world, pixel))) continue;
    const T error = (m.pixel - pixel).squaredNorm();
    if (!(error < limit)) continue;
    hypothesis.score += T(1) - error / limit;
    ++hypothesis.inlier_count;
  }
}

/// Marks the matches within inlier_px of a pose; returns how many. `centre` becomes their centroid.
template <class T>
int mark_inliers(const Problem<T>& problem, const Rigid<T>& pose, std::uint8_t* flags,
                 Vector3<T>& centre) {
  const Rigid<T> T_camera_world = pose.inverse();
  const T limit = square(problem.options.inlier_px);
  int inlier_count = 0;
  Vector3<T> sum = Vector3<T>::Zero();
  for (int i = 0; i < problem.count; ++i) {
    const PoseObservation<T>& m = problem.observations[i];
    Vector2<T> pixel;
    const bool inside = ok(problem.camera.project(T_camera_world * m.p_world, pixel)) &&
                        (m.pixel - pixel).squaredNorm() < limit;
    flags[i] = inside ? 1 : 0;
    if (!inside) continue;
    ++inlier_count;
    sum += m.p_world;
  }
  if (inlier_count > 0) centre = sum / static_cast<T>(inlier_count);
  return inlier_count;
}

template <class T>
bool clearly_different(const Rigid<T>& a, const Rigid<T>& b, const Vector3<T>& centre) {
  const Quaternion<T> turn = a.rotation.conjugate() * b.rotation;
  T s = T(0);
  T c = T(1);
  sin_cos(T(0.5) * different_rotation_rad<T>(), s, c);
  if (abs(turn.w()) < c) return true;
  const T distance_squared = (a.translation - centre).squaredNorm();
  return (a.translation - b.translation).squaredNorm() >
         square(different_centre_share<T>()) * distance_squared;
}

/// Samples needed so that one is free of wrong matches with the given confidence.
template <class T>
int samples_needed(int inlier_count, int count, T confidence, int most) {
  const T w = static_cast<T>(inlier_count) / static_cast<T>(count);
  const T clean = w * w * w;
  if (!(clean < T(0.999))) return 1;
  if (!(clean > T(1e-6))) return most;
  const T needed = log(T(1) - confidence) / log(T(1) - clean);
  return clamp(round_to_int(floor(needed)) + 1, 1, most);
}

template <class T>
int most_samples(const PoseRansacOptions<T>& options) {
  return clamp(options.max_hypotheses, 1, PoseRansacOptions<T>::kMaxHypotheses);
}

/// Keeps a hypothesis if it is the best one so far, or the best that is clearly different from it.
template <class T>
void offer(const Problem<T>& problem, PoseHypothesis<T> candidate, PoseSearch<T>& search) {
  Vector3<T>& centre = search.centre;
  if (candidate.score > search.best.score) {
    const PoseHypothesis<T> previous = search.best;
    search.best = candidate;
    std::uint8_t flags[kMaxPoseObservations];
    mark_inliers(problem, search.best.T_world_camera, flags, centre);
    search.needed = samples_needed(search.best.inlier_count, problem.count,
                                   problem.options.confidence, most_samples(problem.options));
    if (search.second.score >= T(0) &&
        !clearly_different(search.best.T_world_camera, search.second.T_world_camera, centre)) {
      search.second = PoseHypothesis<T>();
    }
    candidate = previous;
  }
  if (candidate.score > search.second.score &&
      clearly_different(search.best.T_world_camera, candidate.T_world_camera, centre)) {
    search.second = candidate;
  }
}

template <class T>
void try_sample(const Problem<T>& problem, Random& random, PoseSearch<T>& search) {
  int sample[kSampleSize];
  draw_sample(random, problem.count, sample);
  ++search.hypotheses;
  Vector3<T> p_world[kSampleSize];
  Vector3<T> bearing[kSampleSize];
  for (int k = 0; k < kSampleSize; ++k) {
    const PoseObservation<T>& m = problem.observations[sample[k]];
    p_world[k] = m.p_world;
    bearing[k] = problem.camera.unproject(m.pixel);
  }
  P3pSolutions<T> solutions;
  if (!ok(solve_p3p(p_world, bearing, solutions))) return;
  for (int s = 0; s < solutions.count; ++s) {
    ++search.poses;
    PoseHypothesis<T> candidate;
    candidate.T_world_camera = solutions.T_world_camera[s];
    score(problem, search.second.score, candidate);
    if (candidate.score > search.second.score) offer(problem, candidate, search);
  }
}

}  // namespace

template <class T>
Status search_pose(const PinholeCamera<T>& camera, const PoseObservation<T>* observations,
                   int count, const PoseRansacOptions<T>& options, int samples, Random& random,
                   PoseSearch<T>& search, bool& done) {
  const Problem<T> problem{camera, observations, count, options};
  const Status status = check(problem);
  if (!ok(status)) return status;
  if (search.needed > most_samples(options)) search.needed = most_samples(options);
  for (int h = 0; h < samples && search.hypotheses < search.needed; ++h) {
    try_sample(problem, random, search);
  }
  done = search.hypotheses >= search.needed;
  return Status::kOk;
}

template <class T>
Status finish_pose(const PinholeCamera<T>& camera, const PoseObservation<T>* observations,
                   int count, const PoseRansacOptions<T>& options, const PoseSearch<T>& search,
                   Rigid<T>& T_world_camera, PoseEstimate<T>& estimate, PoseRansacReport<T>& report,
                   std::uint8_t* inlier_flags) {
  const Problem<T> problem{camera, observations, count, options};
  const Status status = check(problem);
  if (!ok(status)) return status;

  const PoseHypothesis<T>& best = search.best;
  const PoseHypothesis<T>& second = search.second;
  report = PoseRansacReport<T>();
  report.hypotheses = search.hypotheses;
  report.poses = search.poses;
  if (report.poses == 0) return Status::kDegenerate;
  report.inlier_count = best.inlier_count;
  if (second.inlier_count > 0) {
    report.second_inliers = second.inlier_count;
    report.T_world_camera_second = second.T_world_camera;
  }
  report.ambiguous =
      second.inlier_count > 0 && static_cast<T>(second.inlier_count) >=
                                     options.ambiguity_share * static_cast<T>(best.inlier_count);

  // The second round takes in what the pose of a minimal sample missed.
  Rigid<T> pose = best.T_world_camera;
  PoseEstimate<T> result;
  std::uint8_t is_inlier[kMaxPoseObservations];
  std::uint8_t flags[kMaxPoseObservations];
  PoseRefinementOptions<T> refinement = options.refinement;
  refinement.min_inliers = kSampleSize + 1;
  refinement.use_prior = false;
  refinement.use_only = is_inlier;
  for (int round = 0; round < 2; ++round) {
    Vector3<T> centre;
    if (mark_inliers(problem, pose, is_inlier, centre) < options.min_inliers) {
      return Status::kNoConsensus;
    }
    const Status refined =
        refine_pose(camera, observations, count, refinement, pose, result, flags);
    if (!ok(refined)) return refined;
  }
  if (result.inliers < options.min_inliers) return Status::kNoConsensus;
  T_world_camera = pose;
  estimate = result;
  if (inlier_flags != nullptr) {
    for (int i = 0; i < count; ++i) inlier_flags[i] = flags[i];
  }
  return Status::kOk;
}

template <class T>
Status estimate_pose_ransac(const PinholeCamera<T>& camera, const PoseObservation<T>* observations,
                            int count, const PoseRansacOptions<T>& options, Random& random,
                            Rigid<T>& T_world_camera, PoseEstimate<T>& estimate,
                            PoseRansacReport<T>& report, std::uint8_t* inlier_flags) {
  PoseSearch<T> search;
  bool done = false;
  const Status status = search_pose(camera, observations, count, options,
                                    PoseRansacOptions<T>::kMaxHypotheses, random, search, done);
  if (!ok(status)) return status;
  return finish_pose(camera, observations, count, options, search, T_world_camera, estimate, report,
                     inlier_flags);
}

CAIRN_POSE_RANSAC(template, float)
CAIRN_POSE_RANSAC(template, double)

}  // namespace cairn
