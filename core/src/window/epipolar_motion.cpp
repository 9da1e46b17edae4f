#include "cairn/window/epipolar_motion.hpp"

#include "cairn/base/fixed_vector.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/numeric/solve_positive_definite.hpp"

namespace cairn {
namespace {

constexpr int kRoughPairs = 24;
constexpr int kKeptFirst = 6;
constexpr int kKept = 2;
constexpr int kParallaxOverSpread = 2;
constexpr int kMostStarts = 25;
constexpr int kStarts[13][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 0},  {1, -1, 0},
                                {1, 0, 1},  {1, 0, -1}, {0, 1, 1},  {0, 1, -1}, {1, 1, 1},
                                {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};

template <class T>
Vector3<T> ray(const Vector2<T>& direction) {
  return {direction.x(), direction.y(), T(1)};
}

/// Two directions at right angles to a unit vector and to each other.
template <class T>
void tangents(const Vector3<T>& unit, Vector3<T>& u, Vector3<T>& v) {
  int least = 0;
  for (int i = 1; i < 3; ++i) {
    if (abs(unit(i)) < abs(unit(least))) least = i;
  }
  Vector3<T> axis = Vector3<T>::Zero();
  axis(least) = T(1);
  u = unit.cross(axis);
  u *= T(1) / sqrt(u.squaredNorm());
  v = unit.cross(u);
}

template <class T>
struct Candidate {
  Rigid<T> motion;
  T cost = T(0);
};

/// Cost at a motion, and the normal equations of a step from it: a turn of the second camera, and a
/// movement of the translation along two tangents.
template <class T>
class Linearised {
 public:
  T cost = T(0);
  T bounded = T(0);  ///< the same, with no pair above the mismatch's cost

  Linearised() = default;
  Linearised(const DirectionPair<T>* pairs, int count, const EpipolarOptions<T>& options,
             const Rigid<T>& motion) {
    tangents(motion.translation, u_, v_);
    information_.resize(kStates);
    const Matrix3<T> rotation = motion.rotation.toRotationMatrix();
    const T per_sigma = T(1) / options.sigma;
    for (int i = 0; i < count; ++i) {
      add(pairs[i], rotation, motion.translation, per_sigma, options);
    }
  }

  /// False where the step is not determined.
  bool step(const Rigid<T>& motion, T damping, Rigid<T>& moved) const {
    PackedSymmetric<T, kStates> information = information_;
    T x[kStates];
    for (int r = 0; r < kStates; ++r) {
      information(r, r) *= T(1) + damping;
      x[r] = gradient_[r];
    }
    if (!solve_positive_definite(information, x)) return false;
    moved.rotation = rotation_exp(Vector3<T>(x[0], x[1], x[2])) * motion.rotation;
    moved.rotation.coeffs() *= T(1) / sqrt(moved.rotation.squaredNorm());
    moved.translation = motion.translation + x[3] * u_ + x[4] * v_;
    const T length = moved.translation.squaredNorm();
    if (!is_finite(length) || !is_finite(moved.rotation.squaredNorm())) return false;
    moved.translation *= T(1) / sqrt(length);
    return true;
  }

 private:
  static constexpr int kStates = 5;

  void add(const DirectionPair<T>& pair, const Matrix3<T>& rotation, const Vector3<T>& t,
           T per_sigma, const EpipolarOptions<T>& options) {
    const T huber = options.huber_sigma;
    constexpr T kLeastSlope = T(1e-12);
    const Vector3<T> q = rotation * ray(pair.first);
    const Vector3<T> b = ray(pair.second);
    const Vector3<T> line = t.cross(q);
    const Vector3<T> across = b.cross(t);
    const T slope = square(line.x()) + square(line.y()) + square(rotation.col(0).dot(across)) +
                    square(rotation.col(1).dot(across));
    if (!(slope > kLeastSlope)) return;
    const T scale = per_sigma / sqrt(slope);
    const T residual = scale * b.dot(line);
    const T distance = abs(residual);
    const T own = detail::window_cost(distance, huber);
    cost += own;
    bounded += own < options.mismatch_cost ? own : options.mismatch_cost;
    const T weight = distance < huber ? T(1) : huber / distance;
    const Vector3<T> turned = q.cross(across);
    const Vector3<T> moved = q.cross(b);
    const T row[kStates] = {scale * turned.x(), scale * turned.y(), scale * turned.z(),
                            scale * moved.dot(u_), scale * moved.dot(v_)};
    for (int r = 0; r < kStates; ++r) {
      const T scaled = weight * row[r];
      T* const information = information_.row(r);
      for (int c = 0; c <= r; ++c) information[c] += scaled * row[c];
      gradient_[r] -= scaled * residual;
    }
  }

  PackedSymmetric<T, kStates> information_;
  T gradient_[kStates] = {};
  Vector3<T> u_ = Vector3<T>::Zero();
  Vector3<T> v_ = Vector3<T>::Zero();
};

template <class T>
class Search {
 public:
  Search(const DirectionPair<T>* pairs, int count, const EpipolarOptions<T>& options)
      : pairs_(pairs), count_(count), options_(options) {}

  /// At most so many steps of Levenberg and Marquardt; returns the cost of bounded pairs.
  T improve(Rigid<T>& motion, int iterations) const {
    constexpr T kSmall = T(1e-3);  // of the cost
    T damping = T(1e-3);
    Linearised<T> at(pairs_, count_, options_, motion);
    for (int i = 0; i < iterations; ++i) {
      Rigid<T> trial;
      if (!at.step(motion, damping, trial)) {
        damping *= T(10);
        continue;
      }
      const Linearised<T> there(pairs_, count_, options_, trial);
      if (!(there.cost < at.cost)) {
        damping *= T(10);
        continue;
      }
      const bool done = at.cost - there.cost < kSmall * at.cost;
      motion = trial;
      at = there;
      damping *= T(0.2);
      if (done) break;
    }
    return at.bounded;
  }

  /// The turn that explains the picture best without translation; what it leaves, in the mean.
  Quaternion<T> turn(T& left) const {
    Quaternion<T> rotation = Quaternion<T>::Identity();
    constexpr int kIterations = 4;
    constexpr T kParallax = T(0.02);  // of most pairs, as far as it matters here
    for (int k = 0; k < kIterations; ++k) {
      const Matrix3<T> matrix = rotation.toRotationMatrix();
      PackedSymmetric<T, 3> information;
      information.resize(3);
      T x[3] = {};
      T sum = T(0);
      for (int i = 0; i < count_; ++i) {
        const Vector3<T> q = matrix * ray(pairs_[i].first);
        if (!(q.z() > T(0.05))) continue;
        const T u = q.x() / q.z();
        const T v = q.y() / q.z();
        const T by[2][3] = {{-u * v, T(1) + u * u, -v}, {-(T(1) + v * v), u * v, u}};
        const T residual[2] = {pairs_[i].second.x() - u, pairs_[i].second.y() - v};
        const T distance = sqrt(square(residual[0]) + square(residual[1]));
        const T weight = T(1) / (kParallax + distance);
        sum += distance;
        for (int axis = 0; axis < 2; ++axis) {
          for (int r = 0; r < 3; ++r) {
            const T scaled = weight * by[axis][r];
            for (int c = 0; c <= r; ++c) information(r, c) += scaled * by[axis][c];
            x[r] += scaled * residual[axis];
          }
        }
      }
      left = sum / static_cast<T>(count_);
      if (!solve_positive_definite(information, x)) break;
      rotation = rotation_exp(Vector3<T>(x[0], x[1], x[2])) * rotation;
    }
    rotation.coeffs() *= T(1) / sqrt(rotation.squaredNorm());
    return rotation;
  }

 private:
  const DirectionPair<T>* pairs_;
  int count_;
  EpipolarOptions<T> options_;
};

/// Improves all, and keeps the `most` of least cost, sorted.
template <class T, int Capacity>
void improve_and_keep(const Search<T>& search, int iterations, int most,
                      FixedVector<Candidate<T>, Capacity>& candidates) {
  for (int i = 0; i < candidates.size(); ++i) {
    Candidate<T> improved = candidates[i];
    improved.cost = search.improve(improved.motion, iterations);
    int k = i;
    for (; k > 0 && improved.cost < candidates[k - 1].cost; --k) candidates[k] = candidates[k - 1];
    candidates[k] = improved;
  }
  while (candidates.size() > most) candidates.pop_back();
}

}  // namespace

template <class T>
T triangulate_inverse_depth(const DirectionPair<T>& pair, const Rigid<T>& motion) {
  const Vector3<T> q = motion.rotation * ray(pair.first);
  const Vector3<T>& t = motion.translation;
  // Of (b_z p_xy - b_xy p_z) with p = q + rho t.
  const T x = pair.second.x();
  const T y = pair.second.y();
  const T at[2] = {q.x() - x * q.z(), q.y() - y * q.z()};
  const T by[2] = {t.x() - x * t.z(), t.y() - y * t.z()};
  const T squared = square(by[0]) + square(by[1]);
  return squared > T(0) ? -(at[0] * by[0] + at[1] * by[1]) / squared : T(0);
}

template <class T>
T improve_epipolar_motion(const DirectionPair<T>* pairs, int count,
                          const EpipolarOptions<T>& options, Rigid<T>& motion) {
  constexpr T kLeastLength = T(1e-9);
  const T length = sqrt(motion.translation.squaredNorm());
  if (length > kLeastLength) {
    motion.translation *= T(1) / length;
  } else {
    motion.translation = Vector3<T>(T(1), T(0), T(0));
  }
  return Search<T>(pairs, count, options).improve(motion, options.believed_iterations);
}

template <class T>
bool estimate_epipolar_motion(const DirectionPair<T>* pairs, int count,
                              const EpipolarOptions<T>& options, Rigid<T>& motion, T& cost) {
  constexpr int kFewest = 8;
  if (count < kFewest) return false;
  DirectionPair<T> some[kRoughPairs];
  const int few = count < kRoughPairs ? count : kRoughPairs;
  for (int i = 0; i < few; ++i) some[i] = pairs[i * count / few];
  const Search<T> rough(some, few, options);
  const Search<T> search(pairs, count, options);
  T left = T(0);
  const Quaternion<T> turn = search.turn(left);
  FixedVector<Candidate<T>, kMostStarts> candidates;
  for (const auto& direction : kStarts) {
    Candidate<T> candidate;
    Vector3<T>& t = candidate.motion.translation;
    t = Vector3<T>(static_cast<T>(direction[0]), static_cast<T>(direction[1]),
                   static_cast<T>(direction[2]));
    t *= T(1) / sqrt(t.squaredNorm());
    const Vector3<T> parallax = kParallaxOverSpread * left * Vector3<T>(-t.y(), t.x(), T(0));
    candidate.motion.rotation = rotation_exp(parallax) * turn;
    candidates.push_back(candidate);
    if (direction[0] == 0 && direction[1] == 0) continue;
    candidate.motion.rotation = rotation_exp(Vector3<T>(-parallax)) * turn;
    candidates.push_back(candidate);
  }
  improve_and_keep(rough, options.first_iterations, kKeptFirst, candidates);
  improve_and_keep(rough, options.rough_iterations, kKept, candidates);
  improve_and_keep(search, options.fine_iterations, 1, candidates);
  Rigid<T> best = candidates[0].motion;
  const T least = candidates[0].cost;
  if (!is_finite(least)) return false;
  int ahead = 0;
  for (int i = 0; i < count; ++i) {
    ahead += triangulate_inverse_depth(pairs[i], best) > T(0) ? 1 : -1;
  }
  if (ahead < 0) best.translation = -best.translation;
  motion = best;
  cost = least;
  return true;
}

template bool estimate_epipolar_motion(const DirectionPair<float>*, int,
                                       const EpipolarOptions<float>&, Rigid<float>&, float&);
template bool estimate_epipolar_motion(const DirectionPair<double>*, int,
                                       const EpipolarOptions<double>&, Rigid<double>&, double&);
template float improve_epipolar_motion(const DirectionPair<float>*, int,
                                       const EpipolarOptions<float>&, Rigid<float>&);
template double improve_epipolar_motion(const DirectionPair<double>*, int,
                                        const EpipolarOptions<double>&, Rigid<double>&);
template float triangulate_inverse_depth(const DirectionPair<float>&, const Rigid<float>&);
template double triangulate_inverse_depth(const DirectionPair<double>&, const Rigid<double>&);

}  // namespace cairn
