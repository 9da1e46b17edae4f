// The parts of a KeyframeWindow, each alone.
#include <gtest/gtest.h>

#include "cairn/window/window_bounds.hpp"
#include "cairn/window/window_equations.hpp"
#include "cairn/window/window_graph.hpp"
#include "cairn/window/window_start.hpp"

namespace cairn {
namespace {

using Graph = WindowGraph<double, WindowBounds>;
using Solution = WindowSolution<double, WindowBounds>;

int add_landmark(Graph& graph, int host) {
  WindowLandmark<double> landmark;
  landmark.id = 1;
  landmark.host = static_cast<std::int8_t>(host);
  landmark.prior = 1.0;
  landmark.prior_sigma = 0.5;
  return graph.add_landmark(landmark);
}

TEST(WindowGraph, CountsEachPairOfAHostAndAKeyframeOnce) {
  Graph graph;
  const int host = graph.add_keyframe();
  const int first = add_landmark(graph, host);
  const int second = add_landmark(graph, host);
  graph.add_keyframe();
  graph.observe(first, Vector2<double>(0.1, 0.2));
  graph.observe(second, Vector2<double>(0.3, 0.4));
  const Graph::Size size = graph.size();
  EXPECT_EQ(size.landmarks, 2);
  EXPECT_EQ(size.observations, 2);
  EXPECT_EQ(size.pairs, 1);
}

TEST(WindowGraph, AKeyframeThatLeavesTakesItsObservationsAndLeavesItsPoseToItsLandmarks) {
  Graph graph;
  const int host = graph.add_keyframe();
  const int slot = add_landmark(graph, host);
  graph.observe(slot, Vector2<double>(0.1, 0.2));
  graph.add_keyframe();
  graph.observe(slot, Vector2<double>(0.1, 0.3));
  graph.drop(0);
  EXPECT_EQ(graph.keyframes(), 1);
  EXPECT_EQ(graph.place_of(host), -1);
  EXPECT_TRUE(graph.landmark(slot).used);
  EXPECT_EQ(graph.landmark(slot).observers(), 1);
  EXPECT_TRUE(graph.newest_sees(slot));
}

TEST(WindowGraph, TurnsAreJoinedWhereTheKeyframeBetweenLeaves) {
  const auto about_x = [](double angle) { return rotation_exp(Vector3<double>(angle, 0.0, 0.0)); };
  Graph graph;
  for (int i = 0; i < 3; ++i) {
    graph.add_keyframe();
    graph.set_turn(about_x(0.1 * i), 0.01 * i);
  }
  EXPECT_FALSE(graph.turn_at(0).known);
  graph.drop(1);
  ASSERT_TRUE(graph.turn_at(1).known);
  EXPECT_NEAR(rotation_log(graph.turn_at(1).rotation).x(), 0.3, 1e-12);
  EXPECT_NEAR(graph.turn_at(1).variance, 0.03, 1e-12);
  graph.drop(0);
  EXPECT_FALSE(graph.turn_at(0).known);
}

TEST(WindowGraph, GivesUpTheHostWithTheFewestLandmarks) {
  Graph graph;
  int hosts[Graph::kPoses] = {};
  for (int& host : hosts) host = graph.take_pose();
  // Nothing holds a host but its landmarks: the first free pose is taken again.
  EXPECT_EQ(hosts[0], hosts[1]);
  int slots[2] = {add_landmark(graph, hosts[0]), add_landmark(graph, hosts[0])};
  const int other = graph.take_pose();
  EXPECT_NE(other, hosts[0]);
  EXPECT_TRUE(graph.landmark(slots[0]).used && graph.landmark(slots[1]).used);
  for (int pose = 0; pose < Graph::kPoses; ++pose) {
    if (pose != hosts[0]) {
      add_landmark(graph, pose);
      add_landmark(graph, pose);
      add_landmark(graph, pose);
    }
  }
  EXPECT_EQ(graph.take_pose(), hosts[0]);
  EXPECT_FALSE(graph.landmark(slots[0]).used || graph.landmark(slots[1]).used);
}

TEST(WindowEquations, AStepBringsADepthToWhereItWasSeen) {
  Graph graph;
  Solution solution;
  WindowFocal<double, WindowBounds> focal;
  focal.reset(0.0);
  focal.clear(1.0);
  const int host = graph.add_keyframe();
  const int slot = add_landmark(graph, host);
  const int other = graph.add_keyframe();
  solution.pose[other].translation = Vector3<double>(-0.2, 0.0, 0.0);
  graph.observe(slot, Vector2<double>(-0.1, 0.0));  // a depth of 2
  solution.rho[slot] = 1.0;
  WindowEquations<double, WindowBounds> equations;
  const WindowProblem<double, WindowBounds> problem{graph, focal, 1e-3, 1e3};
  const double before = equations.build(problem, solution);
  EXPECT_EQ(equations.states(), 6);
  EXPECT_DOUBLE_EQ(before, equations.cost_of(problem, solution));
  // The poses stay, as they would with many landmarks.
  const double step[6] = {};
  solution.rho[slot] += equations.landmark(slot).step(step, 6, 0.0);
  EXPECT_NEAR(solution.rho[slot], 0.5, 1e-3);
  EXPECT_LT(equations.cost_of(problem, solution), 1e-3 * before);
}

TEST(WindowStart, GoesBackToTheSolutionBeforeWhereThatCostsNoMore) {
  WindowStart<double, WindowBounds> start;
  start.clear();
  start.add_host(0, {});
  start.add_landmark(0, 0.25);
  Solution solution;
  solution.rho[0] = 0.5;
  EXPECT_FALSE(start.settle(1.0, 2.0, solution));
  EXPECT_DOUBLE_EQ(solution.rho[0], 0.5);
  EXPECT_EQ(start.corrected(), 0);
  EXPECT_TRUE(start.settle(2.0, 2.0, solution));
  EXPECT_DOUBLE_EQ(solution.rho[0], 0.25);
  EXPECT_EQ(start.corrected(), 1);
}

TEST(WindowStart, AKeyframeGivesUpACheck) {
  WindowStart<double, WindowBounds> start;
  start.clear();
  EXPECT_FALSE(start.pending());
  start.begin();
  EXPECT_TRUE(start.pending());
  start.stop();
  EXPECT_FALSE(start.pending());
}

}  // namespace
}  // namespace cairn
