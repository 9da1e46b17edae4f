#pragma once

// Update cycles of one planar filter, 5 odometry steps and 1 update of 8 landmarks: what the
// instruction counter and the wall-time comparison run.

#include <cstdlib>
#include <cstring>
#include <memory>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

namespace cairn::planar_test {

inline constexpr int kMaxLandmarks = 64;
inline constexpr int kSeen = 8;
inline constexpr int kOdometrySteps = 5;

/// A filter that runs update cycles.
struct Runner {
  Runner() = default;
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;
  virtual ~Runner() = default;
  virtual void cycles(int count) = 0;
  virtual void restart() = 0;  ///< back to where it was made
};

template <class Filter>
class FilterRunner : public Runner {
  using T = typename Filter::Scalar;

 public:
  explicit FilterRunner(int landmarks) {
    PlanarPose<T> pose;
    Matrix3<T> covariance = Matrix3<T>::Identity() * T(0.01);
    PlanarParameters<T> parameters;
    parameters.gate = T(1e6);
    if (!ok(filter_.initialise(pose, covariance, parameters))) std::abort();
    const Matrix2<T> noise = Matrix2<T>::Identity() * T(0.01);
    for (int i = 0; i < landmarks; ++i) {
      const Vector2<T> y(T(3) + T(0.1) * static_cast<T>(i % 7),
                         T(-2) + T(0.4) * static_cast<T>(i % 11));
      if (!ok(filter_.add_landmark(static_cast<LandmarkId>(i + 1), y, noise))) {
        std::abort();
      }
    }
    for (int k = 0; k < kSeen; ++k) {
      const int i = k * landmarks / kSeen;
      points_[k].id = static_cast<LandmarkId>(i + 1);
      points_[k].y = {T(3) + T(0.1) * static_cast<T>(i % 7),
                      T(-2) + T(0.4) * static_cast<T>(i % 11)};
      points_[k].R = noise;
    }
    increment_ = ackermann_increment<T>(T(0.02), T(0.01), T(0.1), T(0.5), T(0.05), T(0.03));
    start_ = filter_;
  }

  void restart() override { filter_ = start_; }

  void cycles(int count) override {
    for (int k = 0; k < count; ++k) {
      for (int i = 0; i < kOdometrySteps; ++i) {
        if (!ok(filter_.predict(increment_))) std::abort();
      }
      UpdateReport report;
      if (!ok(filter_.update_points({points_, kSeen}, report))) std::abort();
      if (report.nis_dof != 2 * kSeen) std::abort();
    }
  }

 private:
  Filter filter_;
  Filter start_;
  PointObservation<T> points_[kSeen];
  PlanarIncrement<T> increment_;
};

template <class T>
std::unique_ptr<Runner> make_runner(const char* name, int landmarks) {
  if (std::strcmp(name, "ekf") == 0) {
    return std::make_unique<FilterRunner<EkfSlam<T, kMaxLandmarks>>>(landmarks);
  }
  if (std::strcmp(name, "group") == 0) {
    return std::make_unique<FilterRunner<GroupIekfSlam<T, kMaxLandmarks>>>(landmarks);
  }
  if (std::strcmp(name, "lifted") == 0) {
    return std::make_unique<FilterRunner<LiftedIekfSlam<T, kMaxLandmarks>>>(landmarks);
  }
  return nullptr;
}

}  // namespace cairn::planar_test
