// Camera, P3P, RANSAC, refinement and planes with arbitrary numbers.
#include "cairn/ar/plane_fit.hpp"
#include "cairn/geometry/p3p.hpp"
#include "cairn/geometry/pose_ransac.hpp"
#include "cairn/vision/image.hpp"

#include "fuzz_input.hpp"

namespace cairn::fuzz {
namespace {

constexpr int kMost = 24;

template <class T>
Vector3<T> vector(Input& input, float low, float high) {
  return {static_cast<T>(input.number(low, high)), static_cast<T>(input.number(low, high)),
          static_cast<T>(input.number(low, high))};
}

template <class T>
PinholeCamera<T> camera(Input& input) {
  PinholeCamera<T> c;
  c.fx = static_cast<T>(input.number(100.0F, 600.0F));
  c.fy = static_cast<T>(input.number(100.0F, 600.0F));
  c.cx = static_cast<T>(input.number(100.0F, 220.0F));
  c.cy = static_cast<T>(input.number(80.0F, 160.0F));
  if (input.flag()) {
    c.k1 = static_cast<T>(input.number(-0.4F, 0.4F));
    c.k2 = static_cast<T>(input.number(-0.2F, 0.2F));
    c.p1 = static_cast<T>(input.number(-0.02F, 0.02F));
    c.p2 = static_cast<T>(input.number(-0.02F, 0.02F));
    c.k3 = static_cast<T>(input.number(-0.1F, 0.1F));
    const int lens = input.between(0, 2);
    if (lens == 1) {
      c.k4 = static_cast<T>(input.number(-0.4F, 0.4F));
      c.k5 = static_cast<T>(input.number(-0.2F, 0.2F));
      c.k6 = static_cast<T>(input.number(-0.1F, 0.1F));
    } else if (lens == 2) {
      c.lens = Lens::kFisheye;
      c.k4 = static_cast<T>(input.number(-0.1F, 0.1F));
      c.p1 = c.p2 = T(0);
    }
  }
  c.width = input.flag() ? 320 : static_cast<int>(input.word());
  c.height = input.flag() ? 240 : input.between(-2, 5000);
  return c;
}

template <class T>
bool good(const Rigid<T>& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
         abs(pose.rotation.norm() - T(1)) < T(1e-2);
}

template <class T>
void try_camera(Input& input) {
  const PinholeCamera<T> c = camera<T>(input);
  if (!ok(c.validate()) || c.width > ImageView::kMaxExtent || c.height > ImageView::kMaxExtent) {
    return;
  }
  for (int i = 0; i < 8; ++i) {
    Vector2<T> pixel(T(-7), T(-7));
    const Status status = c.project(vector<T>(input, -3.0F, 3.0F), pixel);
    PROMISE(3, ok(status) || pixel == Vector2<T>(T(-7), T(-7)));
    const Vector2<T> inside(static_cast<T>(input.between(0, c.width - 1)),
                            static_cast<T>(input.between(0, c.height - 1)));
    Vector3<T> ray;
    PROMISE(4, ok(c.unproject(inside, ray)) && ray.allFinite());
    Vector2<T> back;
    PROMISE(4, ok(c.project(ray, back)) && (back - inside).norm() < T(0.06));
    const Vector2<T> anywhere(static_cast<T>(input.wild()), static_cast<T>(input.wild()));
    if (ok(c.unproject(anywhere, ray)) && anywhere.allFinite()) PROMISE(4, ray.allFinite());
  }
}

template <class T>
void try_p3p(Input& input) {
  Vector3<T> points[3];
  Vector3<T> bearings[3];
  for (int i = 0; i < 3; ++i) {
    points[i] = vector<T>(input, -3.0F, 3.0F);
    bearings[i] = vector<T>(input, -1.0F, 1.0F);
  }
  P3pSolutions<T> solutions;
  const Status status = solve_p3p(points, bearings, solutions);
  PROMISE(3, ok(status) || solutions.count == 0);
  PROMISE(6, solutions.count >= 0 && solutions.count <= P3pSolutions<T>::kMax);
  for (int i = 0; i < solutions.count; ++i) PROMISE(4, good(solutions.T_world_camera[i]));
}

template <class T>
void try_pose(Input& input) {
  const PinholeCamera<T> c = camera<T>(input);
  const int count = input.below(kMost + 1);
  PoseObservation<T> seen[kMost];
  for (int i = 0; i < count; ++i) {
    seen[i].p_world = vector<T>(input, -2.0F, 2.0F) + Vector3<T>(T(0), T(0), T(4));
    if (!ok(c.project(seen[i].p_world, seen[i].pixel))) seen[i].pixel.setZero();
    if (input.byte() < 60) seen[i].pixel.x() += static_cast<T>(input.number(-50.0F, 50.0F));
    seen[i].sigma_px = static_cast<T>(input.byte() > 250 ? input.wild() : 1.0F);
    if (input.byte() > 240) {
      seen[i].covariance(input.below(3), input.below(3)) = static_cast<T>(input.wild());
    }
  }
  Rigid<T> pose;
  if (input.byte() > 200) pose.rotation.y() = static_cast<T>(input.wild());
  if (input.byte() > 200) pose.translation = vector<T>(input, -1.0F, 1.0F);
  const Rigid<T> guess = pose;
  PoseEstimate<T> estimate;
  Status status;
  if (input.flag()) {
    PoseRefinementOptions<T> options;
    options.max_iterations = static_cast<int>(input.word() % 40U) - 5;
    if (input.byte() > 230) options.huber_sigma = static_cast<T>(input.wild());
    options.use_prior = input.flag();
    if (options.use_prior) options.prior_information.setIdentity();
    status = refine_pose(c, seen, count, options, pose, estimate);
  } else {
    PoseRansacOptions<T> options;
    options.max_hypotheses = static_cast<int>(input.word() % 80U) - 5;
    if (input.byte() > 230) options.confidence = static_cast<T>(input.wild());
    PoseRansacReport<T> report;
    Random random(input.byte());
    status = estimate_pose_ransac(c, seen, count, options, random, pose, estimate, report);
    PROMISE(6, report.hypotheses <= PoseRansacOptions<T>::kMaxHypotheses);
  }
  if (!ok(status)) {
    PROMISE(3, std::memcmp(&guess, &pose, sizeof guess) == 0);
    return;
  }
  PROMISE(4, good(pose));
  PROMISE(4, estimate.covariance.allFinite());
  for (int i = 0; i < 6; ++i) PROMISE(5, estimate.covariance(i, i) >= T(0));
}

void try_plane(Input& input) {
  Vector3<float> points[kMost];
  const int count = input.below(kMost + 1);
  for (int i = 0; i < count; ++i) points[i] = vector<float>(input, -3.0F, 3.0F);
  PlaneFitOptions options;
  options.inlier_m = input.number(1e-3F, 0.5F);
  options.samples = static_cast<int>(input.word() % 300U) - 10;
  Random random(input.byte());
  PlaneFit plane;
  if (!ok(fit_plane(points, count, vector<float>(input, -3.0F, 3.0F), options, random, plane))) {
    PROMISE(3, plane.inliers == 0);
    return;
  }
  PROMISE(4, abs(plane.normal.norm() - 1.0F) < 1e-2F && is_finite(plane.offset));
  Rigid<float> pose;
  if (ok(pose_on_plane(plane, vector<float>(input, -3.0F, 3.0F), vector<float>(input, -1.0F, 1.0F),
                       pose))) {
    PROMISE(4, good(pose));
  }
}

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  count_allocations();
  Input input(bytes, size);
  const NoAllocation none;
  const bool single = input.flag();
  switch (input.below(4)) {
    case 0:
      single ? try_camera<float>(input) : try_camera<double>(input);
      break;
    case 1:
      single ? try_p3p<float>(input) : try_p3p<double>(input);
      break;
    case 2:
      single ? try_pose<float>(input) : try_pose<double>(input);
      break;
    default:
      try_plane(input);
      break;
  }
  return 0;
}
