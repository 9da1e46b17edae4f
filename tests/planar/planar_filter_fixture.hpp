#pragma once

#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "planar_world.hpp"

namespace cairn::planar_test {

using Filters =
    ::testing::Types<EkfSlam<double, 20>, GroupIekfSlam<double, 20>, LiftedIekfSlam<double, 20>>;

/// One filter at the start of a drive through a plain world.
template <class Filter>
class PlanarFilter : public ::testing::Test {
 protected:
  using T = double;

  void SetUp() override { ASSERT_TRUE(ok(start(filter_, drive_))); }
  void run(int from, int to) {
    for (int k = from; k < to; ++k) feed(filter_, drive_, drive_.steps[k]);
  }
  Status see(LandmarkId id, const Vector2<T>& y, UpdateReport& report) {
    PointObservation<T> o;
    o.id = id;
    o.y = y;
    o.R = 0.01 * Matrix2<T>::Identity();
    return filter_.update_points({&o, 1}, report);
  }
  /// What a perfect sensor would measure at the mean.
  Vector2<T> expected(int slot) const {
    const auto pose = filter_.mean_pose();
    return rotation(pose.heading).transpose() * (filter_.mean_landmark(slot) - pose.position);
  }

  Drive drive_ = make_drive(3);
  Filter filter_;
};

}  // namespace cairn::planar_test
