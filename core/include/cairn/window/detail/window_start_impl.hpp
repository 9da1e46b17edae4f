#pragma once

#include "cairn/numeric/median.hpp"
#include "cairn/window/window_start.hpp"

namespace cairn {

template <class T, class Bounds>
int WindowStart<T, Bounds>::step_work(const Graph& graph) const {
  if (stage_ == Stage::kJudge) return kJudgeWork;
  if (stage_ == Stage::kSeek) return kSeekWork;
  return kTakeWork + kPoseWork * (graph.keyframes() - 2 - from_);
}

template <class T, class Bounds>
void WindowStart<T, Bounds>::step(Graph& graph, Solution& solution, const Parameters& parameters) {
  const Stage stage = stage_;
  stage_ = Stage::kNone;
  View view;
  if (stage == Stage::kJudge) return judge(graph, solution, parameters, view);
  common_view(graph, solution, graph.places()[from_], view);
  if (stage == Stage::kSeek) seek(solution, parameters, view);
  if (stage == Stage::kTake) take(graph, solution, parameters, view);
}

/// What the keyframe at `place` and the newest both see, doubted or not.
template <class T, class Bounds>
void WindowStart<T, Bounds>::common_view(const Graph& graph, const Solution& solution, int place,
                                         View& view) const {
  const int newest_place = graph.places().back();
  view.pairs.clear();
  for (int slot = 0; slot < Graph::kLandmarks && !view.pairs.full(); ++slot) {
    const WindowLandmark<T>& landmark = graph.landmark(slot);
    if (!landmark.used || !landmark.shown_at(place) || !landmark.shown_at(newest_place)) continue;
    view.slots[view.pairs.size()] = static_cast<std::int16_t>(slot);
    view.pairs.push_back({solution.as_estimated(graph.observed(place, slot)),
                          solution.as_estimated(graph.observed(newest_place, slot))});
  }
}

/// What the window's motion since the oldest keyframe that sees enough of the same leaves
/// unexplained; whether another could explain clearly more.
template <class T, class Bounds>
void WindowStart<T, Bounds>::judge(const Graph& graph, const Solution& solution,
                                   const Parameters& parameters, View& view) {
  from_ = 0;
  for (; from_ + 1 < graph.keyframes(); ++from_) {
    common_view(graph, solution, graph.places()[from_], view);
    if (view.pairs.size() >= kLeastPairs) break;
  }
  if (from_ + 1 >= graph.keyframes()) return;
  Rigid<T> believed = solution.pose[graph.newest()] * solution.pose[graph.pose_at(from_)].inverse();
  cost_ = improve_epipolar_motion(view.pairs.begin(), view.pairs.size(),
                                  options(solution, parameters), believed);
  if (parameters.start_gain * cost_ > parameters.start_margin) stage_ = Stage::kSeek;
}

template <class T, class Bounds>
void WindowStart<T, Bounds>::seek(const Solution& solution, const Parameters& parameters,
                                  const View& view) {
  T cost = T(0);
  if (estimate_epipolar_motion(view.pairs.begin(), view.pairs.size(), options(solution, parameters),
                               motion_, cost) &&
      cost < parameters.start_gain * cost_ - parameters.start_margin) {
    stage_ = Stage::kTake;
  }
}

/// Poses and depths from the start's motion; the scale stays.
template <class T, class Bounds>
void WindowStart<T, Bounds>::take(Graph& graph, Solution& solution, const Parameters& parameters,
                                  const View& view) {
  T rho[kPairs];
  const T typical = depths(graph, solution, view, rho);
  if (!(typical > T(0))) return;
  graph.trust_doubted();
  if (compared_) before_ = solution;
  compared_ = false;
  take_poses(graph, view, rho, parameters.sigma, solution);
  take_hosts(graph, view, rho, typical, solution);
  ++corrected_;
}

/// Inverse depths in the first of the two keyframes. Scales them, and the motion, to the median
/// that the window has of these landmarks, and returns that; 0, nothing changed, where too few are
/// in front of both.
template <class T, class Bounds>
T WindowStart<T, Bounds>::depths(const Graph& graph, const Solution& solution, const View& view,
                                 T* rho) {
  const Rigid<T>& first = solution.pose[graph.pose_at(from_)];
  FixedVector<T, kPairs> positive;
  for (int i = 0; i < view.pairs.size(); ++i) {
    rho[i] = triangulate_inverse_depth(view.pairs[i], motion_);
    if (rho[i] > T(0)) positive.push_back(rho[i]);
  }
  if (2 * positive.size() < kLeastPairs) return T(0);
  const T found = sort_for_median(positive);
  positive.clear();
  for (int i = 0; i < view.pairs.size(); ++i) {
    const T depth = graph.inverse_depth_in(solution, view.slots[i], first);
    if (depth > T(0)) positive.push_back(depth);
  }
  if (positive.empty()) return T(0);
  const T typical = sort_for_median(positive);
  const T scale = typical / found;
  motion_.translation *= T(1) / scale;
  for (int i = 0; i < view.pairs.size(); ++i) {
    rho[i] = clamp(scale * rho[i], typical / kRange, typical * kRange);
  }
  return typical;
}

/// The newest keyframe from the motion, those between from the landmarks as they are known now.
template <class T, class Bounds>
void WindowStart<T, Bounds>::take_poses(const Graph& graph, const View& view, const T* rho, T sigma,
                                        Solution& solution) const {
  constexpr T kSigma = T(0.2);  // of a depth, relative
  constexpr int kFewest = 8;
  const Rigid<T> first = solution.pose[graph.pose_at(from_)];
  const Rigid<T> T_world_first = first.inverse();
  const int last = graph.keyframes() - 1;
  solution.pose[graph.newest()] = motion_ * first;
  const Vector3<T> turn = rotation_log(motion_.rotation);
  WindowPoseOptions<T> options;
  options.sigma = sigma / solution.focal;
  options.max_iterations = 5;
  for (int index = from_ + 1; index < last; ++index) {
    const int place = graph.places()[index];
    WindowSighting<T> sightings[kPairs];
    int count = 0;
    for (int i = 0; i < view.pairs.size(); ++i) {
      const int slot = view.slots[i];
      if (!graph.landmark(slot).seen_at(place)) continue;
      const Vector2<T>& direction = view.pairs[i].first;
      WindowSighting<T>& s = sightings[count++];
      s.rho = rho[i];
      s.sigma = kSigma * rho[i];
      s.host = T_world_first.translation;
      s.direction =
          T_world_first.rotation * Vector3<T>(direction.x(), direction.y(), T(1)) + s.rho * s.host;
      s.seen = solution.as_estimated(graph.observed(place, slot));
    }
    const T part = static_cast<T>(index - from_) / static_cast<T>(last - from_);
    Rigid<T> between;
    between.rotation = rotation_exp(Vector3<T>(part * turn));
    between.translation = part * motion_.translation;
    Rigid<T> pose = between * first;
    Matrix<T, 6, 6> covariance;
    if (count >= kFewest) {
      static_cast<void>(estimate_window_pose(sightings, count, options, pose, covariance));
    }
    solution.pose[graph.pose_of(place)] = pose;
  }
}

/// Depths of all landmarks in their hosts: of those of the view from it, of others from where the
/// keyframe farthest from the host sees them.
template <class T, class Bounds>
void WindowStart<T, Bounds>::take_hosts(const Graph& graph, const View& view, const T* rho,
                                        T typical, Solution& solution) const {
  constexpr T kNear = InverseDepthView<T>::kLeastDepth;
  const Rigid<T> T_world_first = solution.pose[graph.pose_at(from_)].inverse();
  bool done[Graph::kLandmarks] = {};
  for (int i = 0; i < view.pairs.size(); ++i) {
    const int slot = view.slots[i];
    const Rigid<T> to_host = solution.pose[graph.landmark(slot).host] * T_world_first;
    const Vector2<T>& direction = view.pairs[i].first;
    const Vector3<T> p = to_host.rotation * Vector3<T>(direction.x(), direction.y(), T(1)) +
                         rho[i] * to_host.translation;
    solution.rho[slot] = rho[i] / (p.z() > kNear ? p.z() : kNear);
    done[slot] = true;
  }
  for (int slot = 0; slot < Graph::kLandmarks; ++slot) {
    const WindowLandmark<T>& landmark = graph.landmark(slot);
    const int host_place = landmark.used ? graph.place_of(landmark.host) : -1;
    if (done[slot] || host_place < 0) continue;
    const Rigid<T> T_world_host = solution.pose[landmark.host].inverse();
    T farthest = T(0);
    for (const std::int8_t place : graph.places()) {
      if (place == host_place || !landmark.seen_at(place)) continue;
      const Rigid<T> moved = solution.pose[graph.pose_of(place)] * T_world_host;
      const T distance = moved.translation.squaredNorm();
      if (!(distance > farthest)) continue;
      farthest = distance;
      const DirectionPair<T> pair{solution.as_estimated(landmark.ray),
                                  solution.as_estimated(graph.observed(place, slot))};
      solution.rho[slot] =
          clamp(triangulate_inverse_depth(pair, moved), typical / kRange, typical * kRange);
    }
  }
}

}  // namespace cairn
