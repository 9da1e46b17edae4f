#include "cairn/ar/plane_fit.hpp"

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kMaxSamples = 128;
constexpr int kRefinementRounds = 3;
constexpr int kJacobiSweeps = 6;
/// Share of the longest extent below which points count as lying on a line.
constexpr float kMinSpread = 1e-2F;

bool finite3(const Vector3<float>& v) {
  return is_finite(v.x()) && is_finite(v.y()) && is_finite(v.z());
}

/// Eigenvectors (columns) of a symmetric matrix by cyclic Jacobi rotations, a fixed number of
/// sweeps; `a` becomes diagonal.
Matrix3<float> diagonalise(Matrix3<float>& a) {
  Matrix3<float> v = Matrix3<float>::Identity();
  for (int sweep = 0; sweep < kJacobiSweeps; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a(p, q) == 0.0F) continue;
        const float theta = (a(q, q) - a(p, p)) / (2.0F * a(p, q));
        const float t = (theta < 0.0F ? -1.0F : 1.0F) / (abs(theta) + sqrt(theta * theta + 1.0F));
        const float c = 1.0F / sqrt(t * t + 1.0F);
        const float s = t * c;
        Matrix3<float> rotation = Matrix3<float>::Identity();
        rotation(p, p) = c;
        rotation(q, q) = c;
        rotation(p, q) = s;
        rotation(q, p) = -s;
        a = (rotation.transpose() * a * rotation).eval();
        a(p, q) = a(q, p) = 0.0F;
        v = (v * rotation).eval();
      }
    }
  }
  return v;
}

struct Points {
  const Vector3<float>* p;
  int count;
};

/// Sum over the points of 1 - (distance / limit)^2, where positive.
float support(const Points& points, const Vector3<float>& normal, float offset, float limit,
              int& inliers) {
  float sum = 0.0F;
  inliers = 0;
  for (int i = 0; i < points.count; ++i) {
    const float share = (normal.dot(points.p[i]) - offset) / limit;
    if (!(share * share < 1.0F)) continue;
    sum += 1.0F - share * share;
    ++inliers;
  }
  return sum;
}

bool plane_of_triple(const Points& points, Random& random, Vector3<float>& normal, float& offset) {
  const int a = random.below(points.count);
  const int b = random.below(points.count);
  const int c = random.below(points.count);
  const Vector3<float> side = points.p[b] - points.p[a];
  const Vector3<float> other = points.p[c] - points.p[a];
  const Vector3<float> n = side.cross(other);
  const float length = sqrt(n.squaredNorm());
  const float scale = sqrt(side.squaredNorm() * other.squaredNorm());
  if (!(length > kMinSpread * scale) || !(scale > 0.0F)) return false;
  normal = n / length;
  offset = normal.dot(points.p[a]);
  return true;
}

/// Least-squares plane of the points near the given one.
Status refit(const Points& points, float limit, PlaneFit& plane) {
  Vector3<float> sum = Vector3<float>::Zero();
  int inliers = 0;
  for (int i = 0; i < points.count; ++i) {
    if (!(abs(plane.normal.dot(points.p[i]) - plane.offset) < limit)) continue;
    sum += points.p[i];
    ++inliers;
  }
  if (inliers < 3) return Status::kNoConsensus;
  const Vector3<float> centroid = sum / static_cast<float>(inliers);
  Matrix3<float> scatter = Matrix3<float>::Zero();
  for (int i = 0; i < points.count; ++i) {
    if (!(abs(plane.normal.dot(points.p[i]) - plane.offset) < limit)) continue;
    const Vector3<float> d = points.p[i] - centroid;
    scatter += d * d.transpose();
  }
  const Matrix3<float> axes = diagonalise(scatter);
  int least = 0;
  int most = 0;
  for (int k = 1; k < 3; ++k) {
    if (scatter(k, k) < scatter(least, least)) least = k;
    if (scatter(k, k) >= scatter(most, most)) most = k;
  }
  const int middle = 3 - least - most;
  if (least == most || !(scatter(middle, middle) > square(kMinSpread) * scatter(most, most))) {
    return Status::kDegenerate;
  }
  plane.normal = axes.col(least) / sqrt(axes.col(least).squaredNorm());
  plane.centroid = centroid;
  plane.offset = plane.normal.dot(centroid);
  return Status::kOk;
}

void assess(const Points& points, float limit, PlaneFit& plane) {
  float sum = 0.0F;
  plane.inliers = 0;
  for (int i = 0; i < points.count; ++i) {
    const float distance = plane.normal.dot(points.p[i]) - plane.offset;
    if (!(abs(distance) < limit)) continue;
    sum += distance * distance;
    ++plane.inliers;
  }
  plane.rms_m = plane.inliers > 0 ? sqrt(sum / static_cast<float>(plane.inliers)) : 0.0F;
}

}  // namespace

Status fit_plane(const Vector3<float>* p_world, int count, const Vector3<float>& toward,
                 const PlaneFitOptions& options, Random& random, PlaneFit& plane) {
  if (p_world == nullptr || count < 3 || count > kMaxPlanePoints || !(options.inlier_m > 0.0F) ||
      options.min_inliers < 3) {
    return Status::kInvalidArgument;
  }
  const Points points{p_world, count};
  if (!finite3(toward)) return Status::kNonFiniteInput;
  for (int i = 0; i < count; ++i) {
    if (!finite3(p_world[i])) return Status::kNonFiniteInput;
  }
  PlaneFit best;
  float best_support = -1.0F;
  const int samples = clamp(options.samples, 1, kMaxSamples);
  for (int s = 0; s < samples; ++s) {
    Vector3<float> normal;
    float offset = 0.0F;
    int inliers = 0;
    if (!plane_of_triple(points, random, normal, offset)) continue;
    const float score = support(points, normal, offset, options.inlier_m, inliers);
    if (score > best_support) {
      best_support = score;
      best.normal = normal;
      best.offset = offset;
    }
  }
  if (best_support < 0.0F) return Status::kDegenerate;
  for (int round = 0; round < kRefinementRounds; ++round) {
    const Status status = refit(points, options.inlier_m, best);
    if (!ok(status)) return status;
  }
  assess(points, options.inlier_m, best);
  if (best.inliers < options.min_inliers) return Status::kNoConsensus;
  if (best.normal.dot(toward) < best.offset) {
    best.normal = -best.normal;
    best.offset = -best.offset;
  }
  plane = best;
  return Status::kOk;
}

Status pose_on_plane(const PlaneFit& plane, const Vector3<float>& p_world,
                     const Vector3<float>& facing, Rigid<float>& T_world_object) {
  const Vector3<float> z = plane.normal;
  // Of length one before it is squared: tiny and huge directions are as good as others.
  float most = 0.0F;
  for (int i = 0; i < 3; ++i) most = abs(facing(i)) > most ? abs(facing(i)) : most;
  const Vector3<float> foot = p_world - (z.dot(p_world) - plane.offset) * z;
  if (!facing.allFinite() || !foot.allFinite()) return Status::kNonFiniteInput;
  constexpr float kLeast = 1e-30F;
  if (!(most > kLeast)) return Status::kDegenerate;
  const Vector3<float> direction = facing / most;
  Vector3<float> x = direction - direction.dot(z) * z;
  const float length = sqrt(x.squaredNorm());
  if (!(length > kMinSpread * sqrt(direction.squaredNorm()))) return Status::kDegenerate;
  x /= length;
  Matrix3<float> axes;
  axes.col(0) = x;
  axes.col(1) = z.cross(x);
  axes.col(2) = z;
  T_world_object.rotation = Quaternion<float>(axes);
  T_world_object.translation = foot;
  return Status::kOk;
}

}  // namespace cairn
