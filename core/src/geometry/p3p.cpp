#include "cairn/geometry/p3p.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kRootSteps = 48;
constexpr int kPolishSteps = 4;

template <class T>
constexpr T epsilon() {
  return sizeof(T) == sizeof(float) ? T(1.2e-7) : T(2.3e-16);
}

/// |sine| below which three points count as collinear and two bearings as one.
template <class T>
constexpr T min_sine() {
  return sizeof(T) == sizeof(float) ? T(1e-3) : T(1e-6);
}

template <class T>
bool finite3(const Vector3<T>& v) {
  return is_finite(v.x()) && is_finite(v.y()) && is_finite(v.z());
}

template <class T>
T determinant(const Vector3<T>& a, const Vector3<T>& b, const Vector3<T>& c) {
  return a.dot(b.cross(c));
}

/// The three distance equations, scaled so that the largest side is 1. Pairs: (0,1), (0,2), (1,2).
template <class T>
struct DistanceProblem {
  T side_squared[3];
  T cosine[3];
  Vector3<T> bearing[3];  // unit

  static constexpr int kFirst[3] = {0, 0, 1};
  static constexpr int kSecond[3] = {1, 2, 2};

  Matrix3<T> form(int pair) const {
    Matrix3<T> m = Matrix3<T>::Zero();
    const int i = kFirst[pair];
    const int j = kSecond[pair];
    m(i, i) = T(1);
    m(j, j) = T(1);
    m(i, j) = m(j, i) = -cosine[pair];
    return m;
  }
  Vector3<T> residual(const Vector3<T>& lambda) const {
    Vector3<T> r;
    for (int pair = 0; pair < 3; ++pair) {
      const T a = lambda[kFirst[pair]];
      const T b = lambda[kSecond[pair]];
      r[pair] = a * a + b * b - T(2) * cosine[pair] * a * b - side_squared[pair];
    }
    return r;
  }
};

/// A root t in [0, 1] of the cubic through the Bernstein-free values f(u(t), v(t)), where
/// f(u, v) = c0 u^3 + c1 u^2 v + c2 u v^2 + c3 v^3 changes sign between the ends (u, v) of a
/// segment. Newton's step where it stays inside the bracket, bisection otherwise.
template <class T>
Vector2<T> root_on_segment(const T (&c)[4], const Vector2<T>& begin, const Vector2<T>& end) {
  const Vector2<T> direction = end - begin;
  const auto value = [&c](const Vector2<T>& p) {
    return ((c[0] * p.x() + c[1] * p.y()) * p.x() + c[2] * p.y() * p.y()) * p.x() +
           c[3] * p.y() * p.y() * p.y();
  };
  T low = T(0);
  T high = T(1);
  const bool rising = value(begin) < T(0);
  T t = T(0.5);
  for (int i = 0; i < kRootSteps; ++i) {
    const Vector2<T> p = begin + t * direction;
    const T f = value(p);
    if (f == T(0)) break;
    if ((f < T(0)) == rising) {
      low = t;
    } else {
      high = t;
    }
    const T du = (T(3) * c[0] * p.x() + T(2) * c[1] * p.y()) * p.x() + c[2] * p.y() * p.y();
    const T dv = (c[1] * p.x() + T(2) * c[2] * p.y()) * p.x() + T(3) * c[3] * p.y() * p.y();
    const T slope = du * direction.x() + dv * direction.y();
    T next = slope != T(0) ? t - f / slope : T(-1);
    if (!(next > low && next < high)) next = T(0.5) * (low + high);
    if (abs(next - t) <= epsilon<T>()) break;
    t = next;
  }
  return begin + t * direction;
}

/// Weights (u, v) for which u D1 + v D2 is singular. The cubic is odd on the projective line, so it
/// changes sign on the way (1, 0) -> (0, 1) -> (-1, 0).
template <class T>
Vector2<T> singular_member(const Matrix3<T>& d1, const Matrix3<T>& d2) {
  const Vector3<T> a0 = d1.col(0), a1 = d1.col(1), a2 = d1.col(2);
  const Vector3<T> b0 = d2.col(0), b1 = d2.col(1), b2 = d2.col(2);
  const T c[4] = {determinant(a0, a1, a2),
                  determinant(b0, a1, a2) + determinant(a0, b1, a2) + determinant(a0, a1, b2),
                  determinant(a0, b1, b2) + determinant(b0, a1, b2) + determinant(b0, b1, a2),
                  determinant(b0, b1, b2)};
  const Vector2<T> first(T(1), T(0));
  const Vector2<T> middle(T(0), T(1));
  if ((c[0] < T(0)) != (c[3] < T(0))) return root_on_segment(c, first, middle);
  return root_on_segment(c, middle, Vector2<T>(-first));
}

/// Splits the singular symmetric `d` = l m^T + m l^T into its two planes. False when they are
/// complex.
template <class T>
bool split_planes(const Matrix3<T>& d, Vector3<T>& l, Vector3<T>& m) {
  const Vector3<T> c0 = d.col(0), c1 = d.col(1), c2 = d.col(2);
  Matrix3<T> adjugate;
  adjugate.row(0) = c1.cross(c2);
  adjugate.row(1) = c2.cross(c0);
  adjugate.row(2) = c0.cross(c1);
  int largest = 0;
  for (int i = 1; i < 3; ++i) {
    if (abs(adjugate(i, i)) > abs(adjugate(largest, largest))) largest = i;
  }
  const T scale = d.squaredNorm();
  const T pivot = -adjugate(largest, largest);
  const T tolerance = T(64) * epsilon<T>() * scale;
  if (pivot < -tolerance) return false;
  Matrix3<T> rank_one = d;
  if (pivot > tolerance) {
    const Vector3<T> p = adjugate.col(largest) / sqrt(pivot);
    rank_one += skew(p);
  }
  int row = 0;
  int column = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (abs(rank_one(i, j)) > abs(rank_one(row, column))) {
        row = i;
        column = j;
      }
    }
  }
  l = rank_one.row(row).transpose();
  m = rank_one.col(column);
  return rank_one(row, column) != T(0);
}

/// Newton steps on the three equations; false when the distances do not satisfy them at the end.
template <class T>
bool polish(const DistanceProblem<T>& problem, Vector3<T>& lambda) {
  Vector3<T> residual = problem.residual(lambda);
  for (int step = 0; step < kPolishSteps; ++step) {
    Vector3<T> rows[3];
    for (int pair = 0; pair < 3; ++pair) {
      const int i = problem.kFirst[pair];
      const int j = problem.kSecond[pair];
      rows[pair].setZero();
      rows[pair][i] = T(2) * (lambda[i] - problem.cosine[pair] * lambda[j]);
      rows[pair][j] = T(2) * (lambda[j] - problem.cosine[pair] * lambda[i]);
    }
    const T volume = determinant(rows[0], rows[1], rows[2]);
    if (volume == T(0)) break;
    const Vector3<T> move =
        (residual[0] * rows[1].cross(rows[2]) + residual[1] * rows[2].cross(rows[0]) +
         residual[2] * rows[0].cross(rows[1])) /
        volume;
    const Vector3<T> trial = lambda - move;
    const Vector3<T> at_trial = problem.residual(trial);
    if (!(at_trial.squaredNorm() < residual.squaredNorm())) break;
    lambda = trial;
    residual = at_trial;
  }
  const T tolerance = sizeof(T) == sizeof(float) ? T(1e-3) : T(1e-7);
  return residual.squaredNorm() < tolerance * tolerance && lambda.x() > T(0) && lambda.y() > T(0) &&
         lambda.z() > T(0);
}

template <class T>
struct Distances {
  int count = 0;
  Vector3<T> lambda[P3pSolutions<T>::kMax];

  void add(const Vector3<T>& candidate) {
    if (count == P3pSolutions<T>::kMax) return;
    const T same = T(1e3) * epsilon<T>() * candidate.squaredNorm();
    for (int i = 0; i < count; ++i) {
      if ((lambda[i] - candidate).squaredNorm() < same * same) return;
    }
    lambda[count++] = candidate;
  }
};

/// Distances on the plane `l` . lambda = 0 that also lie on the cone lambda^T d lambda = 0.
template <class T>
void intersect(const DistanceProblem<T>& problem, const Vector3<T>& l, const Matrix3<T>& d,
               Distances<T>& found) {
  int k = 0;
  for (int i = 1; i < 3; ++i) {
    if (abs(l[i]) > abs(l[k])) k = i;
  }
  if (l[k] == T(0)) return;
  const int i = (k + 1) % 3;
  const int j = (k + 2) % 3;
  Vector3<T> b1 = Vector3<T>::Zero();
  Vector3<T> b2 = Vector3<T>::Zero();
  b1[i] = T(1);
  b1[k] = -l[i] / l[k];
  b2[j] = T(1);
  b2[k] = -l[j] / l[k];
  const Vector3<T> d_b1 = d * b1;
  const Vector3<T> d_b2 = d * b2;
  const T q11 = b1.dot(d_b1);
  const T q12 = b1.dot(d_b2);
  const T q22 = b2.dot(d_b2);
  T discriminant = q12 * q12 - q11 * q22;
  const T scale = q12 * q12 + abs(q11 * q22);
  if (discriminant < T(-256) * epsilon<T>() * scale) return;
  if (discriminant < T(0)) discriminant = T(0);
  const T root = sqrt(discriminant);
  const T h = q12 < T(0) ? root - q12 : -q12 - root;
  const Vector3<T> directions[2] = {h * b1 + q11 * b2, q22 * b1 + h * b2};
  const Matrix3<T> total = problem.form(0) + problem.form(1) + problem.form(2);
  const T sides = problem.side_squared[0] + problem.side_squared[1] + problem.side_squared[2];
  for (const Vector3<T>& direction : directions) {
    const T length_squared = direction.dot(total * direction);
    if (!(length_squared > T(0))) continue;
    const T sign = direction.sum() < T(0) ? T(-1) : T(1);
    Vector3<T> lambda = (sign * sqrt(sides / length_squared)) * direction;
    if (polish(problem, lambda)) found.add(lambda);
  }
}

/// Orthonormal axes of a triangle: along its first side, in its plane, along its normal.
template <class T>
Matrix3<T> triangle_axes(const Vector3<T> (&p)[3]) {
  const Vector3<T> side = p[1] - p[0];
  const Vector3<T> normal = side.cross(Vector3<T>(p[2] - p[0]));
  Matrix3<T> axes;
  axes.col(0) = side / sqrt(side.squaredNorm());
  axes.col(2) = normal / sqrt(normal.squaredNorm());
  axes.col(1) = Vector3<T>(axes.col(2)).cross(Vector3<T>(axes.col(0)));
  return axes;
}

template <class T>
Rigid<T> align(const Vector3<T> (&p_world)[3], const Vector3<T> (&p_camera)[3]) {
  const Matrix3<T> rotation = triangle_axes(p_world) * triangle_axes(p_camera).transpose();
  const T third = T(1) / T(3);
  Rigid<T> pose;
  pose.rotation = Quaternion<T>(rotation);
  pose.rotation.coeffs() *= T(1) / sqrt(pose.rotation.squaredNorm());
  const Vector3<T> centre_world = third * (p_world[0] + p_world[1] + p_world[2]);
  const Vector3<T> centre_camera = third * (p_camera[0] + p_camera[1] + p_camera[2]);
  pose.translation = centre_world - pose.rotation * centre_camera;
  return pose;
}

/// Fills the distance problem; returns its length unit through `unit`.
template <class T>
Status set_up(const Vector3<T> (&p_world)[3], const Vector3<T> (&bearing)[3],
              DistanceProblem<T>& problem, T& unit) {
  for (int i = 0; i < 3; ++i) {
    if (!finite3(p_world[i]) || !finite3(bearing[i])) return Status::kNonFiniteInput;
    const T length = sqrt(bearing[i].squaredNorm());
    if (!(length > T(0))) return Status::kDegenerate;
    problem.bearing[i] = bearing[i] / length;
  }
  T longest = T(0);
  for (int pair = 0; pair < 3; ++pair) {
    const int i = problem.kFirst[pair];
    const int j = problem.kSecond[pair];
    problem.side_squared[pair] = (p_world[i] - p_world[j]).squaredNorm();
    problem.cosine[pair] = problem.bearing[i].dot(problem.bearing[j]);
    if (problem.side_squared[pair] > longest) longest = problem.side_squared[pair];
    const T sine_squared = problem.bearing[i].cross(problem.bearing[j]).squaredNorm();
    if (!(sine_squared > square(min_sine<T>()))) return Status::kDegenerate;
  }
  const Vector3<T> normal =
      Vector3<T>(p_world[1] - p_world[0]).cross(Vector3<T>(p_world[2] - p_world[0]));
  if (!(normal.squaredNorm() > square(min_sine<T>() * longest))) return Status::kDegenerate;
  for (T& s : problem.side_squared) s /= longest;
  unit = sqrt(longest);
  return Status::kOk;
}

}  // namespace

template <class T>
Status solve_p3p(const Vector3<T> (&p_world)[3], const Vector3<T> (&bearing)[3],
                 P3pSolutions<T>& solutions) {
  DistanceProblem<T> problem;
  T unit = T(1);
  const Status status = set_up(p_world, bearing, problem, unit);
  if (!ok(status)) return status;

  const T* a = problem.side_squared;
  const Matrix3<T> d1 = a[2] * problem.form(0) - a[0] * problem.form(2);
  const Matrix3<T> d2 = a[2] * problem.form(1) - a[1] * problem.form(2);
  const Vector2<T> weights = singular_member(d1, d2);
  const Matrix3<T> singular = weights.x() * d1 + weights.y() * d2;
  const Matrix3<T>& other = abs(weights.x()) >= abs(weights.y()) ? d2 : d1;

  Vector3<T> planes[2];
  Distances<T> distances;
  if (split_planes(singular, planes[0], planes[1])) {
    intersect(problem, planes[0], other, distances);
    intersect(problem, planes[1], other, distances);
  }
  if (distances.count == 0) return Status::kNotFound;

  solutions.count = distances.count;
  for (int s = 0; s < distances.count; ++s) {
    const Vector3<T> lambda = unit * distances.lambda[s];
    const Vector3<T> p_camera[3] = {lambda[0] * problem.bearing[0], lambda[1] * problem.bearing[1],
                                    lambda[2] * problem.bearing[2]};
    solutions.T_world_camera[s] = align(p_world, p_camera);
  }
  return Status::kOk;
}

template Status solve_p3p(const Vector3<float> (&)[3], const Vector3<float> (&)[3],
                          P3pSolutions<float>&);
template Status solve_p3p(const Vector3<double> (&)[3], const Vector3<double> (&)[3],
                          P3pSolutions<double>&);

}  // namespace cairn
