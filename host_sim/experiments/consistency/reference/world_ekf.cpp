#include "host_sim/experiments/consistency/reference/world_ekf.hpp"

#include <array>
#include <cmath>

#include "cairn/numeric/math.hpp"

namespace cairn::host {
namespace {

constexpr int kIterations = 4;

Eigen::Vector2d expected_point(const Eigen::Vector3d& pose, const Eigen::Vector2d& landmark) {
  return rotation2(pose(2)).transpose() * (landmark - pose.head<2>());
}

/// Three-point Gauss-Hermite rule for a standard normal variable.
constexpr std::array<double, 3> kHermiteNodes{-1.7320508075688772, 0.0, 1.7320508075688772};
constexpr std::array<double, 3> kHermiteWeights{1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0};

}  // namespace

void WorldEkf::initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  mean_.resize(3);
  mean_ << pose.position, pose.heading;
  covariance_ = covariance;
  predicted_pose_ = mean_;
  slots_ = SlotTable();
  first_estimates_.clear();
}

void WorldEkf::propagate(const Eigen::Matrix3d& f, const Eigen::Matrix3d& q) {
  const Eigen::Index rest = mean_.size() - 3;
  const Eigen::Matrix3d pose = f * covariance_.topLeftCorner<3, 3>() * f.transpose() + q;
  covariance_.topLeftCorner<3, 3>() = pose;
  const Eigen::MatrixXd cross = f * covariance_.topRightCorner(3, rest);
  covariance_.topRightCorner(3, rest) = cross;
  covariance_.bottomLeftCorner(rest, 3) = cross.transpose();
}

void WorldEkf::predict(const Increment& step) {
  if (kind_ == Kind::kUnscented) {
    predict_unscented(step);
    return;
  }
  const Eigen::Vector3d before = mean_.head<3>();
  const Eigen::Vector2d direction(std::cos(before(2)), std::sin(before(2)));
  mean_.head<2>() += step.distance_m * direction;
  mean_(2) = wrap_angle(mean_(2) + step.turn_rad);

  const Eigen::Vector2d start =
      (kind_ == Kind::kFirstEstimates ? predicted_pose_ : before).head<2>();
  Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
  f.block<2, 1>(0, 2) = rotation_generator() * (mean_.head<2>() - start);
  Eigen::Matrix<double, 3, 2> g = Eigen::Matrix<double, 3, 2>::Zero();
  g.block<2, 1>(0, 0) = direction;
  g(2, 1) = 1.0;
  propagate(f, g * step.covariance * g.transpose());
  predicted_pose_ = mean_.head<3>();
}

void WorldEkf::predict_unscented(const Increment& step) {
  const double heading = mean_(2);
  const double heading_variance = std::fmax(covariance_(2, 2), 1e-18);
  const double heading_sigma = std::sqrt(heading_variance);
  const double forward_sigma = std::sqrt(step.covariance(0, 0));
  const double coupling = forward_sigma > 0.0 ? step.covariance(0, 1) / forward_sigma : 0.0;
  const double turn_sigma = std::sqrt(std::fmax(step.covariance(1, 1) - coupling * coupling, 0.0));

  std::array<Eigen::Vector3d, 27> points;
  std::array<double, 27> weights{};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector2d cross = Eigen::Vector2d::Zero();
  std::size_t index = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double heading_error = heading_sigma * kHermiteNodes[i];
        const double forward = step.distance_m + forward_sigma * kHermiteNodes[j];
        const double turn =
            step.turn_rad + coupling * kHermiteNodes[j] + turn_sigma * kHermiteNodes[k];
        const Eigen::Vector3d point(forward * std::cos(heading + heading_error),
                                    forward * std::sin(heading + heading_error),
                                    heading_error + turn);
        const double weight = kHermiteWeights[i] * kHermiteWeights[j] * kHermiteWeights[k];
        mean += weight * point;
        cross += weight * heading_error * point.head<2>();
        points[index] = point;
        weights[index++] = weight;
      }
    }
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    spread += weights[i] * (points[i] - mean) * (points[i] - mean).transpose();
  }
  Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
  f.block<2, 1>(0, 2) = cross / heading_variance;
  const Eigen::Vector3d column = f.col(2);
  mean_.head<2>() += mean.head<2>();
  mean_(2) = wrap_angle(mean_(2) + mean(2));
  propagate(f, spread - heading_variance * column * column.transpose());
}

DenseRow WorldEkf::linearise(const PointSighting& sighting, const Eigen::VectorXd& at,
                             double sigma_m) const {
  const int slot = slots_.find(sighting.landmark);
  const Eigen::Vector2d landmark = at.segment<2>(column(slot));
  const bool first = kind_ == Kind::kFirstEstimates;
  const Eigen::Vector3d pose_at = first ? Eigen::Vector3d(mean_.head<3>()) : at.head<3>();
  const Eigen::Vector2d landmark_at =
      first ? first_estimates_[static_cast<std::size_t>(slot)] : landmark;

  DenseRow row;
  row.landmark_column = column(slot);
  row.landmark = rotation2(pose_at(2)).transpose();
  row.vehicle.resize(2, 3);
  row.vehicle.leftCols<2>() = -row.landmark;
  row.vehicle.col(2) = -row.landmark * rotation_generator() * (landmark_at - pose_at.head<2>());
  row.noise = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  row.innovation = sighting.point - expected_point(at.head<3>(), landmark);
  if (kind_ == Kind::kIterated) {
    Eigen::Vector3d moved = mean_.head<3>() - at.head<3>();
    moved(2) = wrap_angle(moved(2));
    row.innovation -=
        row.vehicle * moved + row.landmark * (mean_.segment<2>(column(slot)) - landmark);
  }
  return row;
}

DenseRow WorldEkf::linearise_unscented(const PointSighting& sighting, double sigma_m) const {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  constexpr double kKappa = 1.0;
  const int first_column = column(slots_.find(sighting.landmark));
  const std::array<int, 5> index{0, 1, 2, first_column, first_column + 1};
  Vector5 mean;
  Matrix5 marginal;
  for (int a = 0; a < 5; ++a) {
    mean(a) = mean_(index[static_cast<std::size_t>(a)]);
    for (int b = 0; b < 5; ++b) {
      marginal(a, b) =
          covariance_(index[static_cast<std::size_t>(a)], index[static_cast<std::size_t>(b)]);
    }
  }
  marginal += 1e-12 * Matrix5::Identity();
  const Matrix5 root = std::sqrt(5.0 + kKappa) * Matrix5(marginal.llt().matrixL());

  std::array<Vector5, 11> points;
  std::array<Eigen::Vector2d, 11> images;
  std::array<double, 11> weights{};
  weights.fill(0.5 / (5.0 + kKappa));
  weights[0] = kKappa / (5.0 + kKappa);
  points[0] = mean;
  for (int a = 0; a < 5; ++a) {
    points[static_cast<std::size_t>(1 + a)] = mean + root.col(a);
    points[static_cast<std::size_t>(6 + a)] = mean - root.col(a);
  }
  Eigen::Vector2d image_mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    images[i] = expected_point(points[i].head<3>(), points[i].tail<2>());
    image_mean += weights[i] * images[i];
  }
  Eigen::Matrix<double, 5, 2> cross = Eigen::Matrix<double, 5, 2>::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d d = images[i] - image_mean;
    cross += weights[i] * (points[i] - mean) * d.transpose();
    spread += weights[i] * d * d.transpose();
  }
  const Eigen::Matrix<double, 2, 5> h = marginal.llt().solve(cross).transpose();
  DenseRow row;
  row.landmark_column = first_column;
  row.vehicle = h.leftCols<3>();
  row.landmark = h.rightCols<2>();
  row.innovation = sighting.point - image_mean;
  const Eigen::Matrix2d remainder = spread - h * marginal * h.transpose();
  row.noise =
      sigma_m * sigma_m * Eigen::Matrix2d::Identity() + 0.5 * (remainder + remainder.transpose());
  return row;
}

void WorldEkf::update(const std::vector<PointSighting>& sightings, double sigma_m) {
  std::vector<PointSighting> known;
  for (const auto& s : sightings) {
    if (slots_.find(s.landmark) >= 0) known.push_back(s);
  }
  if (!known.empty()) {
    const int passes = kind_ == Kind::kIterated ? kIterations : 1;
    Eigen::VectorXd at = mean_;
    DenseGain gain;
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<DenseRow> rows;
      rows.reserve(known.size());
      for (const auto& s : known) {
        rows.push_back(kind_ == Kind::kUnscented ? linearise_unscented(s, sigma_m)
                                                 : linearise(s, at, sigma_m));
      }
      gain = dense_gain(covariance_, rows);
      at = mean_ + gain.gain * gain.innovation;
      at(2) = wrap_angle(at(2));
    }
    mean_ = at;
    apply_gain(gain, covariance_);
  }
  for (const auto& s : sightings) {
    if (slots_.find(s.landmark) < 0) add_landmark(s, sigma_m);
  }
}

void WorldEkf::add_landmark(const PointSighting& sighting, double sigma_m) {
  const Eigen::Index n = mean_.size();
  const Eigen::Vector2d world = mean_.head<2>() + rotation2(mean_(2)) * sighting.point;
  const Eigen::Vector2d origin = kind_ == Kind::kFirstEstimates
                                     ? Eigen::Vector2d(predicted_pose_.head<2>())
                                     : Eigen::Vector2d(mean_.head<2>());
  Eigen::Matrix<double, 2, 3> g;
  g.leftCols<2>().setIdentity();
  g.col(2) = rotation_generator() * (world - origin);
  const Eigen::MatrixXd cross = g * covariance_.topRows(3);
  const Eigen::Matrix2d own = g * covariance_.topLeftCorner<3, 3>() * g.transpose() +
                              sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  mean_.conservativeResize(n + 2);
  mean_.tail<2>() = world;
  covariance_.conservativeResize(n + 2, n + 2);
  covariance_.bottomLeftCorner(2, n) = cross;
  covariance_.topRightCorner(n, 2) = cross.transpose();
  covariance_.bottomRightCorner<2, 2>() = own;
  slots_.add(sighting.landmark);
  first_estimates_.push_back(world);
}

PoseEstimate WorldEkf::pose() const {
  return {{mean_.head<2>(), mean_(2)}, covariance_.topLeftCorner<3, 3>()};
}

bool WorldEkf::landmark(int landmark, LandmarkEstimate& estimate) const {
  const int slot = slots_.find(landmark);
  if (slot < 0) return false;
  estimate.position = mean_.segment<2>(column(slot));
  estimate.covariance = covariance_.block<2, 2>(column(slot), column(slot));
  return true;
}

}  // namespace cairn::host
