#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/geometry/types.hpp"
#include "cairn/window/detail/window_cost.hpp"

namespace cairn {

/// A landmark as two cameras see it: directions (x / z, y / z).
template <class T>
struct DirectionPair {
  Vector2<T> first = Vector2<T>::Zero();
  Vector2<T> second = Vector2<T>::Zero();
};

template <class T>
struct EpipolarOptions {
  T sigma = T(0.0015);  ///< of a direction, each axis
  T huber_sigma = T(1.5);
  T mismatch_cost = detail::kMismatchAcross<T>;  ///< of a pair, where motions are compared
  int first_iterations = 2;                      ///< from each start, over few of the pairs
  int rough_iterations = 3;                      ///< of the best of these, over the same
  int fine_iterations = 8;                       ///< of the best of those, over all
  int believed_iterations = 2;                   ///< of improve_epipolar_motion()
};

/// Motion between two cameras from their pictures alone: points of the first camera's frame to the
/// second's, the translation of length 1. Levenberg-Marquardt on Huber's cost of Sampson's
/// distances to the epipolar lines (Hartley and Zisserman 2004, 11.4.3), of which there are several
/// minima. It begins from 13 directions of translation that cover the half sphere, each with the
/// turn that explains the picture best without translation, more and less by what a translation to
/// either side takes of it, over at most 24 of the pairs; the best six are improved further, and
/// the best two of these over all pairs. The best are those of the least cost in which no pair
/// counts more than `mismatch_cost`: else a single mismatch would choose. Of the two signs of the
/// translation the one with more points in front of the first camera is taken. `cost` is its cost,
/// of pairs so bounded.
///
/// False, outputs unchanged, with fewer than 8 pairs or where they determine no motion. Cost, in
/// passes over a pair of some 80 multiply-adds and a square root: 24 * (25 (first + 1) + 6 (rough +
/// 1)), and 2 fine + 7 for each pair.
template <class T>
bool estimate_epipolar_motion(const DirectionPair<T>* pairs, int count,
                              const EpipolarOptions<T>& options, Rigid<T>& motion, T& cost);

/// Improves a believed motion by a few steps, which lead to the next minimum; the translation's
/// length becomes 1. Returns the cost there, of bounded pairs.
template <class T>
T improve_epipolar_motion(const DirectionPair<T>* pairs, int count,
                          const EpipolarOptions<T>& options, Rigid<T>& motion);

/// Inverse depth, in the first camera, of a point that both see, by least squares in the second's
/// picture. Negative behind the first camera, 0 where the pair shows no depth.
template <class T>
T triangulate_inverse_depth(const DirectionPair<T>& pair, const Rigid<T>& motion);

extern template bool estimate_epipolar_motion(const DirectionPair<float>*, int,
                                              const EpipolarOptions<float>&, Rigid<float>&, float&);
extern template bool estimate_epipolar_motion(const DirectionPair<double>*, int,
                                              const EpipolarOptions<double>&, Rigid<double>&,
                                              double&);
extern template float improve_epipolar_motion(const DirectionPair<float>*, int,
                                              const EpipolarOptions<float>&, Rigid<float>&);
extern template double improve_epipolar_motion(const DirectionPair<double>*, int,
                                               const EpipolarOptions<double>&, Rigid<double>&);
extern template float triangulate_inverse_depth(const DirectionPair<float>&, const Rigid<float>&);
extern template double triangulate_inverse_depth(const DirectionPair<double>&,
                                                 const Rigid<double>&);

}  // namespace cairn
