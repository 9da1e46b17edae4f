#include "cairn/window/schur_solve.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

constexpr int kStates = 12;
constexpr int kLandmarks = 9;

/// Normal equations of random observations, as one dense system and with the landmarks apart.
struct RandomSystem {
  Eigen::Matrix<double, kStates + kLandmarks, kStates + kLandmarks> matrix;
  Eigen::Matrix<double, kStates + kLandmarks, 1> gradient;
  PackedSymmetric<double, kStates> poses;
  double pose_gradient[kStates];
  LandmarkEquation<double, kStates> landmarks[kLandmarks];

  explicit RandomSystem(std::uint64_t seed) {
    Random random(seed);
    const auto value = [&] { return 2e-6 * random.below(1000000) - 1.0; };
    matrix.setIdentity();
    matrix *= 0.1;
    gradient.setZero();
    for (int k = 0; k < kLandmarks; ++k) {
      for (int i = 0; i < 8; ++i) {
        Eigen::Matrix<double, kStates + kLandmarks, 1> row;
        row.setZero();
        for (int c = 0; c < kStates; ++c) row(c) = value();
        row(kStates + k) = value();
        matrix += row * row.transpose();
        gradient += value() * row;
      }
    }
    poses.resize(kStates);
    for (int r = 0; r < kStates; ++r) {
      for (int c = 0; c <= r; ++c) poses(r, c) = matrix(r, c);
      pose_gradient[r] = gradient(r);
    }
    for (int k = 0; k < kLandmarks; ++k) {
      for (int c = 0; c < kStates; ++c) landmarks[k].by_pose[c] = matrix(kStates + k, c);
      landmarks[k].information = matrix(kStates + k, kStates + k);
      landmarks[k].gradient = gradient(kStates + k);
      landmarks[k].used = true;
    }
  }
};

TEST(SolveWithLandmarks, EqualsADenseSolve) {
  for (const double damping : {0.0, 0.01, 10.0}) {
    const RandomSystem system(7);
    auto dense = system.matrix;
    dense.diagonal() *= 1.0 + damping;
    const auto want =
        Eigen::Matrix<double, kStates + kLandmarks, 1>(dense.ldlt().solve(system.gradient));
    PackedSymmetric<double, kStates> reduced;
    double step[kStates] = {};
    ASSERT_TRUE(solve_with_landmarks(system.poses, system.pose_gradient, system.landmarks,
                                     kLandmarks, damping, reduced, step));
    for (int i = 0; i < kStates; ++i) EXPECT_NEAR(step[i], want(i), 1e-7);
    for (int k = 0; k < kLandmarks; ++k) {
      EXPECT_NEAR(system.landmarks[k].step(step, kStates, damping), want(kStates + k), 1e-7);
    }
  }
}

TEST(SolveWithLandmarks, RefusesASingularSystem) {
  RandomSystem system(3);
  for (int c = 0; c < kStates; ++c) system.poses(kStates - 1, c) = -1.0;
  PackedSymmetric<double, kStates> reduced;
  double step[kStates] = {};
  EXPECT_FALSE(solve_with_landmarks(system.poses, system.pose_gradient, system.landmarks,
                                    kLandmarks, 0.0, reduced, step));
}

TEST(SolveWithLandmarks, LeavesOutLandmarksThatAreNotUsed) {
  const RandomSystem system(5);
  RandomSystem without = system;
  without.landmarks[2].used = false;
  PackedSymmetric<double, kStates> reduced;
  double all[kStates] = {};
  double fewer[kStates] = {};
  ASSERT_TRUE(solve_with_landmarks(system.poses, system.pose_gradient, system.landmarks, kLandmarks,
                                   0.0, reduced, all));
  ASSERT_TRUE(solve_with_landmarks(without.poses, without.pose_gradient, without.landmarks,
                                   kLandmarks, 0.0, reduced, fewer));
  double change = 0.0;
  for (int i = 0; i < kStates; ++i) change += abs(all[i] - fewer[i]);
  EXPECT_GT(change, 1e-6);
}

}  // namespace
}  // namespace cairn
