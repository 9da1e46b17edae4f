#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Dense>

#include "cairn/planar/planar_slam.hpp"

namespace cairn::planar_test {

/// A vehicle that drives along x with a camera ahead, past landmarks seen through a pinhole, and
/// the odometry noise that the vehicle tracker states. Truth and filter, one frame after another.
template <class Filter>
class CameraDrive {
  using T = typename Filter::Scalar;
  static constexpr double kFocalPx = 500.0;
  static constexpr double kFrame_s = 1.0 / 30.0;
  static constexpr double kCamera_m[2] = {0.2, 1.0};  ///< ahead, above

 public:
  explicit CameraDrive(Filter& filter, int landmarks, unsigned seed,
                       PlanarParameters<T> parameters = {})
      : filter_(filter), generator_(seed) {
    camera_.width = 640;
    camera_.height = 480;
    camera_.fx = camera_.fy = T(kFocalPx);
    camera_.cx = T(320);
    camera_.cy = T(240);
    Matrix3<T> axes;
    axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    T_vehicle_camera_.rotation = Quaternion<T>(axes);
    T_vehicle_camera_.translation = {T(kCamera_m[0]), T(0), T(kCamera_m[1])};
    parameters.reacquire_after = 0;
    parameters.gate = T(18.42);
    parameters.ransac.min_inliers = 2;
    const Matrix3<T> start = Vector3<T>(T(1e-4), T(1e-4), T(1e-4)).asDiagonal();
    good_ = ok(filter_.initialise({}, start, parameters));
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int i = 0; i < landmarks; ++i) {
      const double depth = 1.0 + 19.0 * std::pow(uniform(generator_), 1.5);
      const double u = (uniform(generator_) - 0.5) * 560.0;
      const double v = (uniform(generator_) - 0.5) * 400.0;
      landmarks_.emplace_back(kCamera_m[0] + depth, -u / kFocalPx * depth,
                              kCamera_m[1] - v / kFocalPx * depth);
      add(i);
    }
  }

  bool good() const { return good_; }
  double truth_x() const { return x_; }
  const UpdateReport& report() const { return report_; }

  /// One frame: the vehicle is moved `distance_m`, its wheels tell `told_m`.
  void frame(double distance_m, double told_m, double sigma_px) {
    x_ += distance_m;
    const double scale = std::sqrt(0.1 / kFrame_s);
    const auto increment = ackermann_increment<T>(T(told_m / kFrame_s), T(0), T(kFrame_s), T(0.5),
                                                  T(0.1 * scale), T(0.0873 * scale));
    good_ = good_ && ok(filter_.predict(increment));
    see(sigma_px, sigma_px);
  }
  void frame(double distance_m, double sigma_px) { frame(distance_m, distance_m, sigma_px); }

  /// Pixels with noise `sigma_px` of which the filter is told `claimed_px`.
  void see(double sigma_px, double claimed_px) {
    matches_.clear();
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      const Eigen::Vector3d& p = landmarks_[i];
      const double depth = p.x() - x_ - kCamera_m[0];
      const double noise[2] = {normal_(generator_), normal_(generator_)};
      if (depth < 0.5) continue;
      PixelMatch<T> match;
      match.id = static_cast<LandmarkId>(i + 1);
      match.pixel = {T(320.0 - kFocalPx * p.y() / depth + sigma_px * noise[0]),
                     T(240.0 - kFocalPx * (p.z() - kCamera_m[1]) / depth + sigma_px * noise[1])};
      matches_.push_back(match);
    }
    status_ = filter_.update_pixels(camera_, T_vehicle_camera_, T(claimed_px), matches_.data(),
                                    static_cast<int>(matches_.size()), random_, report_);
  }
  Status status() const { return status_; }

  double position_error() const {
    const auto pose = filter_.mean_pose();
    return std::hypot(static_cast<double>(pose.position.x()) - x_,
                      static_cast<double>(pose.position.y()));
  }

 private:
  /// As it is first triangulated: 1 mrad across, a tenth of the distance along the ray.
  void add(int i) {
    const Eigen::Vector3d& p = landmarks_[static_cast<std::size_t>(i)];
    const double depth = p.x() - kCamera_m[0];
    const double sigma = 0.1 * depth;
    const Eigen::Vector3d ray(1.0, p.y() / depth, (p.z() - kCamera_m[1]) / depth);
    const Eigen::Vector3d seen = p + 0.5 * sigma * normal_(generator_) * ray;
    const Matrix3<T> along = (sigma * sigma * ray * ray.transpose()).cast<T>();
    const Matrix3<T> R = along + Matrix3<T>::Identity() * T(std::pow(1e-3 * depth, 2));
    const Matrix3<T> symmetric = T(0.5) * (R + R.transpose());
    good_ = good_ &&
            ok(filter_.add_landmark(static_cast<LandmarkId>(i + 1), seen.cast<T>(), symmetric));
  }

  Filter& filter_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  PinholeCamera<T> camera_;
  Rigid<T> T_vehicle_camera_;
  std::vector<Eigen::Vector3d> landmarks_;
  std::vector<PixelMatch<T>> matches_;
  Random random_{1};
  UpdateReport report_;
  Status status_ = Status::kOk;
  double x_ = 0.0;
  bool good_ = true;
};

/// Smallest eigenvalue of the correlation matrix of a filter's error; -1 where a variance is
/// negative or not finite. Rounding alone can bring it to about -1e-6 in float.
template <class Filter>
double smallest_correlation_eigenvalue(const Filter& filter) {
  const int n = filter.state_size();
  Eigen::MatrixXd P(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) P(i, j) = static_cast<double>(filter.error_covariance(i, j));
  }
  if (!P.allFinite() || P.diagonal().minCoeff() < 0.0) return -1.0;
  const Eigen::VectorXd scale = P.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * P * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(0);
}

}  // namespace cairn::planar_test
