#include "cairn/tracking/planar_pose_search.hpp"

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn {
namespace {

constexpr float kMinPivot = detail::min_regular_pivot<float>();
constexpr int kMaxCount = PlanarPoseOptions::kMaxSightings;
constexpr int kIterations = 4;      // a heading error of 0.3 rad is far from linear,
constexpr int kFarIterations = 10;  // and one of 0.8 rad farther

struct Problem {
  const PlanarView& view;
  const PlanarPrior& prior;
  const PlanarSighting* sightings;
  int count;
  const PlanarPoseOptions& options;
  Matrix3<float> information;  // of the prior
  int iterations;
};

struct Estimate {
  PlanarPose<float> pose;
  Matrix3<float> covariance;
};

/// Pose that fits the prior and the sightings that are `used`; false where it is not determined.
bool fit(const Problem& problem, const bool* used, Estimate& estimate) {
  constexpr float kSettled = 1e-7F;  // m^2, rad^2
  for (int iteration = 0; iteration < problem.iterations; ++iteration) {
    Matrix3<float> normal = problem.information;
    const PlanarPose<float>& from = problem.prior.pose;
    const Vector3<float> moved(estimate.pose.position.x() - from.position.x(),
                               estimate.pose.position.y() - from.position.y(),
                               wrap_angle(estimate.pose.heading - from.heading));
    Vector3<float> right = -(problem.information * moved);
    for (int i = 0; i < problem.count; ++i) {
      if (!used[i]) continue;
      const PlanarSighting& s = problem.sightings[i];
      Vector2<float> pixel;
      Matrix<float, 2, 3> jacobian;
      if (!ok(problem.view.predict(estimate.pose, s.p_map, pixel, jacobian))) continue;
      const float weight = 1.0F / square(s.sigma_px);
      normal += weight * (jacobian.transpose() * jacobian);
      right += weight * (jacobian.transpose() * (s.pixel - pixel));
    }
    if (!detail::invert_spd(normal, kMinPivot, estimate.covariance)) return false;
    const Vector3<float> step = estimate.covariance * right;
    if (!is_finite(step.sum())) return false;
    estimate.pose.position += step.head<2>();
    estimate.pose.heading = wrap_angle(estimate.pose.heading + step.z());
    if (step.squaredNorm() < kSettled) break;
  }
  return true;
}

/// Marks the sightings that agree with an estimate within its own covariance; their number.
int mark_agreeing(const Problem& problem, const Estimate& estimate, bool* agrees) {
  int inlier_count = 0;
  for (int i = 0; i < problem.count; ++i) {
    const PlanarSighting& s = problem.sightings[i];
    Vector2<float> pixel;
    Matrix<float, 2, 3> jacobian;
    agrees[i] = false;
    if (!ok(problem.view.predict(estimate.pose, s.p_map, pixel, jacobian))) continue;
    const Matrix2<float> S = jacobian * estimate.covariance * jacobian.transpose();
    float i00 = 0.0F;
    float i01 = 0.0F;
    float i11 = 0.0F;
    const float noise = square(s.sigma_px);
    if (!invert_spd2(S(0, 0) + noise, S(0, 1), S(1, 1) + noise, i00, i01, i11)) continue;
    const Vector2<float> e = s.pixel - pixel;
    const float squared = e.x() * e.x() * i00 + 2.0F * e.x() * e.y() * i01 + e.y() * e.y() * i11;
    agrees[i] = squared <= problem.options.gate;
    inlier_count += agrees[i] ? 1 : 0;
  }
  return inlier_count;
}

/// Largest distance of a sighting from its pixel.
float most_px(const Problem& problem) {
  return problem.options.inlier_px + 3.0F * problem.view.tilt_px();
}

/// Marks the sightings within `most_px` of their pixels; their number.
int mark_near(const Problem& problem, const PlanarPose<float>& pose, float most_px, bool* is_near) {
  int near = 0;
  for (int i = 0; i < problem.count; ++i) {
    Vector2<float> pixel;
    Matrix<float, 2, 3> jacobian;
    const PlanarSighting& s = problem.sightings[i];
    is_near[i] = ok(problem.view.predict(pose, s.p_map, pixel, jacobian)) &&
                 (s.pixel - pixel).squaredNorm() <= square(most_px);
    near += is_near[i] ? 1 : 0;
  }
  return near;
}

/// Whether false sightings would agree as those in `inliers` do. Two of them determine the pose.
bool may_be_chance(const Problem& problem, const PlanarConsensusOptions& options,
                   const bool* inliers) {
  constexpr float kLeast = 1e-30F;
  float squared_chance = 1.0F;
  int counted = -2;
  const float agreeing = square(kPi<float> * square(most_px(problem)));
  for (int i = 0; i < problem.count; ++i) {
    if (!inliers[i] || ++counted <= 0) continue;
    const PlanarSighting& s = problem.sightings[i];
    float window = square(options.most_window_px2);
    Vector2<float> pixel;
    Matrix<float, 2, 3> jacobian;
    if (ok(problem.view.predict(problem.prior.pose, s.p_map, pixel, jacobian))) {
      const Matrix2<float> S = jacobian * problem.prior.covariance * jacobian.transpose() +
                               square(s.sigma_px) * Matrix2<float>::Identity();
      const float own =
          square(kPi<float> * options.window_gate) * (S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0));
      if (own < window) window = own;
    }
    const float share = agreeing / window;
    if (share < 1.0F && squared_chance > kLeast) squared_chance *= share;
  }
  return squared_chance > square(options.max_chance);
}

}  // namespace

Rigid<float> on_floor(const PlanarPose<float>& pose) {
  float sine = 0.0F;
  float cosine = 1.0F;
  sin_cos(0.5F * pose.heading, sine, cosine);
  return {{cosine, 0.0F, 0.0F, sine}, {pose.position.x(), pose.position.y(), 0.0F}};
}

Status PlanarView::predict(const PlanarPose<float>& pose, const Vector3<float>& p_map,
                           Vector2<float>& pixel, Matrix<float, 2, 3>& jacobian) const {
  float sine = 0.0F;
  float cosine = 1.0F;
  sin_cos(pose.heading, sine, cosine);
  const float dx = p_map.x() - pose.position.x();
  const float dy = p_map.y() - pose.position.y();
  const Vector3<float> p_vehicle(cosine * dx + sine * dy, cosine * dy - sine * dx, p_map.z());
  const Matrix3<float> R_camera_vehicle = T_vehicle_camera.rotation.conjugate().toRotationMatrix();
  const Vector3<float> p_camera = R_camera_vehicle * (p_vehicle - T_vehicle_camera.translation);
  Matrix<float, 2, 3> by_point;
  const Status status = camera.project(p_camera, pixel, by_point);
  if (!ok(status)) return status;
  Matrix3<float> by_pose;
  by_pose << -cosine, -sine, p_vehicle.y(), sine, -cosine, -p_vehicle.x(), 0.0F, 0.0F, 0.0F;
  jacobian = by_point * (R_camera_vehicle * by_pose);
  return Status::kOk;
}

Status find_planar_pose(const PlanarView& view, const PlanarPrior& prior,
                        const PlanarSighting* sightings, int count,
                        const PlanarPoseOptions& options, PlanarPose<float>& pose,
                        int& inlier_count) {
  if (count < 0 || count > kMaxCount || (count > 0 && sightings == nullptr)) {
    return Status::kInvalidArgument;
  }
  Problem problem{view, prior, sightings, count, options, Matrix3<float>::Zero(), kIterations};
  if (!detail::invert_spd(prior.covariance, kMinPivot, problem.information))
    return Status::kSingular;
  bool best[kMaxCount] = {};
  int most = 0;
  for (int candidate = 0; candidate < count; ++candidate) {
    bool agrees[kMaxCount] = {};
    agrees[candidate] = true;
    Estimate estimate{prior.pose, prior.covariance};
    if (!fit(problem, agrees, estimate)) continue;
    const int agreeing = mark_agreeing(problem, estimate, agrees);
    if (agreeing <= most) continue;
    most = agreeing;
    for (int i = 0; i < count; ++i) best[i] = agrees[i];
  }
  if (most < options.min_inliers) return Status::kNoConsensus;
  constexpr int kRounds = 3;  // each leaves out the outliers of the one before
  Estimate estimate{prior.pose, prior.covariance};
  for (int round = 0; round < kRounds; ++round) {
    if (!fit(problem, best, estimate)) return Status::kNoConsensus;
    static_cast<void>(mark_agreeing(problem, estimate, best));
  }
  const int near = mark_near(problem, estimate.pose, most_px(problem), best);
  if (near < options.min_inliers) return Status::kNoConsensus;
  pose = estimate.pose;
  inlier_count = near;
  return Status::kOk;
}

Status find_planar_consensus(const PlanarView& view, const PlanarPrior& prior,
                             const PlanarSighting* sightings, int count,
                             const PlanarConsensusOptions& options, PlanarPose<float>& pose,
                             bool* inliers, int& inlier_count) {
  if (count < 0 || count > kMaxCount || (count > 0 && sightings == nullptr)) {
    return Status::kInvalidArgument;
  }
  Problem problem{view,          prior, sightings, count, options.pose, Matrix3<float>::Zero(),
                  kFarIterations};
  if (!detail::invert_spd(prior.covariance, kMinPivot, problem.information))
    return Status::kSingular;
  if (count < options.pose.min_inliers || count < 2) return Status::kNoConsensus;
  constexpr float kOfTwo = 2.0F;  // the pose of two is less sure than that of all
  bool best[kMaxCount] = {};
  int most = 0;
  Estimate estimate{prior.pose, prior.covariance};
  const int pairs = count * (count - 1) / 2;
  constexpr int kMost = PlanarConsensusOptions::kMostPairs;
  for (int k = 0; k < (pairs < kMost ? pairs : kMost); ++k) {
    const int apart = 1 + (k / count) % (count - 1);  // all neighbours first, then the next ones
    bool used[kMaxCount] = {};
    used[k % count] = true;
    used[(k + apart) % count] = true;
    Estimate of_two{prior.pose, prior.covariance};
    if (!fit(problem, used, of_two)) continue;
    const int near = mark_near(problem, of_two.pose, kOfTwo * most_px(problem), used);
    if (near <= most) continue;
    most = near;
    estimate = of_two;
    for (int i = 0; i < count; ++i) best[i] = used[i];
  }
  constexpr int kRounds = 3;
  for (int round = 1; round <= kRounds; ++round) {
    if (most < options.pose.min_inliers || !fit(problem, best, estimate)) {
      return Status::kNoConsensus;
    }
    const float within = round < kRounds ? kOfTwo : 1.0F;
    most = mark_near(problem, estimate.pose, within * most_px(problem), best);
  }
  if (most < options.pose.min_inliers || may_be_chance(problem, options, best)) {
    return Status::kNoConsensus;
  }
  pose = estimate.pose;
  inlier_count = most;
  for (int i = 0; i < count; ++i) inliers[i] = best[i];
  return Status::kOk;
}

}  // namespace cairn
