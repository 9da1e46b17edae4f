#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/geometry/types.hpp"

namespace cairn {

template <class T>
struct P3pSolutions {
  static constexpr int kMax = 4;
  int count = 0;
  Rigid<T> T_world_camera[kMax];
};

/// Every camera pose from which three world points (m) are seen along three bearings (camera frame,
/// any length, in the same order). Up to four; the order is deterministic.
///
/// The three distances obey lambda_i^2 + lambda_j^2 - 2 c_ij lambda_i lambda_j = |p_i - p_j|^2. Two
/// combinations of them are homogeneous; a singular member of their pencil is a pair of planes in
/// lambda space (Persson and Nordberg, "Lambda Twist", ECCV 2018). Here the root of the cubic is
/// found on the projective line of the pencil, where one is always bracketed, and the pair of
/// planes is split by the adjugate (Richter-Gebert 2011, section 11), so that no eigenvectors are
/// needed. Distances are then polished by Newton steps on the three equations.
///
/// kNonFiniteInput. kDegenerate: the points are collinear or coincide, or two bearings coincide.
/// kNotFound: no real solution. On an error the output is unchanged.
/// Cost: about 2,500 floating-point operations, at most twice that.
template <class T>
Status solve_p3p(const Vector3<T> (&p_world)[3], const Vector3<T> (&bearing)[3],
                 P3pSolutions<T>& solutions);

extern template Status solve_p3p(const Vector3<float> (&)[3], const Vector3<float> (&)[3],
                                 P3pSolutions<float>&);
extern template Status solve_p3p(const Vector3<double> (&)[3], const Vector3<double> (&)[3],
                                 P3pSolutions<double>&);

}  // namespace cairn
