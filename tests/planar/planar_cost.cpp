// Runs update cycles of one planar filter (5 odometry steps, 1 update of 8 landmarks) for an
// instruction counter: planar_cost ekf|group|lifted LANDMARKS CYCLES [float]. Only
// measured_cycles() counts: valgrind --tool=callgrind --toggle-collect=measured_cycles.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted_iekf_slam.hpp"

namespace {

constexpr int kMaxLandmarks = 64;
constexpr int kSeen = 8;
constexpr int kOdometrySteps = 5;

struct Runner {
  virtual ~Runner() = default;
  virtual void cycles(int count) = 0;
};

template <class Filter>
class FilterRunner : public Runner {
  using T = typename Filter::Scalar;

 public:
  explicit FilterRunner(int landmarks) {
    cairn::PlanarPose<T> pose;
    cairn::Matrix3<T> covariance = cairn::Matrix3<T>::Identity() * T(0.01);
    cairn::PlanarParameters<T> parameters;
    parameters.gate = T(1e6);
    if (!cairn::ok(filter_.initialise(pose, covariance, parameters))) std::abort();
    const cairn::Matrix2<T> noise = cairn::Matrix2<T>::Identity() * T(0.01);
    for (int i = 0; i < landmarks; ++i) {
      const cairn::Vector2<T> y(T(3) + T(0.1) * static_cast<T>(i % 7),
                                T(-2) + T(0.4) * static_cast<T>(i % 11));
      if (!cairn::ok(filter_.add_landmark(static_cast<cairn::LandmarkId>(i + 1), y, noise))) {
        std::abort();
      }
    }
    for (int k = 0; k < kSeen; ++k) {
      const int i = k * landmarks / kSeen;
      points_[k].id = static_cast<cairn::LandmarkId>(i + 1);
      points_[k].y = {T(3) + T(0.1) * static_cast<T>(i % 7),
                      T(-2) + T(0.4) * static_cast<T>(i % 11)};
      points_[k].R = noise;
    }
    increment_ = cairn::ackermann_increment<T>(T(0.02), T(0.01), T(0.1), T(0.5), T(0.05), T(0.03));
  }

  void cycles(int count) override {
    for (int k = 0; k < count; ++k) {
      for (int i = 0; i < kOdometrySteps; ++i) {
        if (!cairn::ok(filter_.predict(increment_))) std::abort();
      }
      cairn::UpdateReport report;
      if (!cairn::ok(filter_.update_points({points_, kSeen}, report))) std::abort();
      if (report.nis_dof != 2 * kSeen) std::abort();
    }
  }

 private:
  Filter filter_;
  cairn::PointObservation<T> points_[kSeen];
  cairn::PlanarIncrement<T> increment_;
};

template <class T>
std::unique_ptr<Runner> make_runner(const char* name, int landmarks) {
  if (std::strcmp(name, "ekf") == 0) {
    return std::make_unique<FilterRunner<cairn::EkfSlam<T, kMaxLandmarks>>>(landmarks);
  }
  if (std::strcmp(name, "group") == 0) {
    return std::make_unique<FilterRunner<cairn::GroupIekfSlam<T, kMaxLandmarks>>>(landmarks);
  }
  if (std::strcmp(name, "lifted") == 0) {
    return std::make_unique<FilterRunner<cairn::LiftedIekfSlam<T, kMaxLandmarks>>>(landmarks);
  }
  return nullptr;
}

}  // namespace

extern "C" __attribute__((noinline)) void measured_cycles(void* runner, int count) {
  static_cast<Runner*>(runner)->cycles(count);
}

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const int landmarks = std::atoi(argv[2]);
  if (landmarks < kSeen || landmarks > kMaxLandmarks) return 2;
  const bool single = argc > 4 && std::strcmp(argv[4], "float") == 0;
  const auto runner =
      single ? make_runner<float>(argv[1], landmarks) : make_runner<double>(argv[1], landmarks);
  if (runner == nullptr) return 2;
  measured_cycles(runner.get(), std::atoi(argv[3]));
  return 0;
}
