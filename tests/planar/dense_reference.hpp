#pragma once

#include <map>

#include "planar_world.hpp"

namespace cairn::planar_test {

/// Joint batch update x += K nu, P -= K S K^T of a dense filter; returns K nu.
inline Eigen::VectorXd dense_update(Eigen::MatrixXd& P, const Eigen::MatrixXd& H,
                                    const Eigen::MatrixXd& R, const Eigen::VectorXd& nu) {
  const Eigen::MatrixXd S = H * P * H.transpose() + R;
  const Eigen::MatrixXd K = S.llt().solve(H * P).transpose();
  P -= K * S * K.transpose();
  P = (0.5 * (P + P.transpose())).eval();
  return K * nu;
}

inline const Eigen::Matrix2d kJ = (Eigen::Matrix2d() << 0, -1, 1, 0).finished();

/// Textbook EKF-SLAM, dense, batch, body-frame rows.
class DenseEkf {
 public:
  explicit DenseEkf(const Drive& drive)
      : drive_(drive), x_(drive.start_estimate), P_(drive.start_covariance) {}

  void feed(const Step& step) {
    const PlanarIncrement<double> u = drive_.increment(step);
    const auto d = displacement(u);
    const Eigen::Matrix2d R = rotation(x_(2));
    const int n = static_cast<int>(x_.size());
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(n, n);
    F.block<2, 1>(0, 2) = kJ * R * d.u;
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, 2);
    G.block<2, 1>(0, 0) = R * d.by_distance;
    G.block<2, 1>(0, 1) = R * d.by_turn;
    G(2, 1) = 1;
    P_ = (F * P_ * F.transpose() + G * u.covariance * G.transpose()).eval();
    x_.head<2>() += R * d.u;
    x_(2) += u.turn_rad;
    if (step.update) update(step);
  }
  Eigen::Vector3d pose() const { return x_.head<3>(); }
  Eigen::Matrix3d covariance() const { return P_.topLeftCorner<3, 3>(); }

 private:
  void update(const Step& step) {
    std::vector<Sighting> known;
    std::vector<Sighting> fresh;
    for (const Sighting& s : step.sightings)
      (index_.count(s.id) != 0U ? known : fresh).push_back(s);
    const int m = static_cast<int>(known.size());
    const int n = static_cast<int>(x_.size());
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2 * m, n);
    Eigen::VectorXd nu(2 * m);
    const Eigen::Matrix2d Rt = rotation(x_(2)).transpose();
    for (int k = 0; k < m; ++k) {
      const int l = index_[known[k].id];
      const Eigen::Vector2d delta = x_.segment<2>(l) - x_.head<2>();
      H.block<2, 2>(2 * k, 0) = -Rt;
      H.block<2, 1>(2 * k, 2) = -Rt * kJ * delta;
      H.block<2, 2>(2 * k, l) = Rt;
      nu.segment<2>(2 * k) = known[k].y - Rt * delta;
    }
    if (m > 0) {
      x_ += dense_update(P_, H,
                         drive_.settings.sigma_r * drive_.settings.sigma_r *
                             Eigen::MatrixXd::Identity(2 * m, 2 * m),
                         nu);
    }
    for (const Sighting& s : fresh) {
      const int l = static_cast<int>(x_.size());
      index_[s.id] = l;
      const Eigen::Vector2d delta = rotation(x_(2)) * s.y;
      x_.conservativeResize(l + 2);
      x_.segment<2>(l) = x_.head<2>() + delta;
      Eigen::MatrixXd G = Eigen::MatrixXd::Zero(l + 2, l);
      G.topLeftCorner(l, l).setIdentity();
      G.block<2, 2>(l, 0).setIdentity();
      G.block<2, 1>(l, 2) = kJ * delta;
      P_ = (G * P_ * G.transpose()).eval();
      P_.bottomRightCorner<2, 2>() += sighting_noise(drive_);
    }
  }

  const Drive& drive_;
  Eigen::VectorXd x_;
  Eigen::MatrixXd P_;
  std::map<LandmarkId, int> index_;
};

/// Right-invariant EKF-SLAM (Barrau and Bonnabel 2015), dense, batch, noise added at every odometry
/// step. State order: heading, x, landmarks; anchored at the first estimate.
class DenseRightInvariantEkf {
 public:
  explicit DenseRightInvariantEkf(const Drive& drive)
      : drive_(drive),
        heading_(drive.start_estimate(2)),
        anchor_(drive.start_estimate.head<2>()),
        x_(Eigen::VectorXd::Zero(2)) {
    Eigen::Matrix3d order;
    order << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    P_ = order * drive.start_covariance * order.transpose();
  }

  void feed(const Step& step) {
    const PlanarIncrement<double> u = drive_.increment(step);
    const auto d = displacement(u);
    const Eigen::Matrix2d R = rotation(heading_);
    x_.head<2>() += R * d.u;
    heading_ += u.turn_rad;
    const int n = static_cast<int>(P_.rows());
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, 2);
    G(0, 1) = 1;
    G.block<2, 1>(1, 0) = R * d.by_distance;
    G.block<2, 1>(1, 1) = R * d.by_turn;
    for (int i = 0; i < x_.size() / 2; ++i) {
      G.block<2, 1>(1 + 2 * i, 1) -= kJ * x_.segment<2>(2 * i);
    }
    P_ += G * u.covariance * G.transpose();
    if (step.update) update(step);
  }
  double heading() const { return heading_; }
  Eigen::Vector2d position() const { return anchor_ + x_.head<2>(); }
  Eigen::Vector2d landmark(LandmarkId id) const { return anchor_ + x_.segment<2>(index_.at(id)); }
  /// Over (heading, xi).
  Eigen::Matrix3d covariance() const { return P_.topLeftCorner<3, 3>(); }
  Eigen::Vector2d relative_position() const { return x_.head<2>(); }
  const Eigen::MatrixXd& full_covariance() const { return P_; }

 private:
  void update(const Step& step) {
    std::vector<Sighting> known;
    std::vector<Sighting> fresh;
    for (const Sighting& s : step.sightings)
      (index_.count(s.id) != 0U ? known : fresh).push_back(s);
    const int m = static_cast<int>(known.size());
    if (m > 0) {
      Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2 * m, P_.rows());
      Eigen::VectorXd nu(2 * m);
      const Eigen::Matrix2d R = rotation(heading_);
      for (int k = 0; k < m; ++k) {
        const int l = index_[known[k].id];
        H.block<2, 2>(2 * k, 1) = -Eigen::Matrix2d::Identity();
        H.block<2, 2>(2 * k, 1 + l) = Eigen::Matrix2d::Identity();
        nu.segment<2>(2 * k) = R * known[k].y - (x_.segment<2>(l) - x_.head<2>());
      }
      const Eigen::VectorXd d = dense_update(P_, H,
                                             drive_.settings.sigma_r * drive_.settings.sigma_r *
                                                 Eigen::MatrixXd::Identity(2 * m, 2 * m),
                                             nu);
      const double t = d(0);
      Eigen::Matrix2d V = Eigen::Matrix2d::Identity();
      if (std::abs(t) > 1e-12) {
        V << std::sin(t) / t, -(1 - std::cos(t)) / t, (1 - std::cos(t)) / t, std::sin(t) / t;
      }
      heading_ += t;
      for (int i = 0; i < x_.size() / 2; ++i) {
        x_.segment<2>(2 * i) =
            (rotation(t) * x_.segment<2>(2 * i) + V * d.segment<2>(1 + 2 * i)).eval();
      }
    }
    for (const Sighting& s : fresh) {
      const int l = static_cast<int>(x_.size());
      const int n = static_cast<int>(P_.rows());
      index_[s.id] = l;
      x_.conservativeResize(l + 2);
      x_.segment<2>(l) = x_.head<2>() + rotation(heading_) * s.y;
      Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n + 2, n);
      G.topLeftCorner(n, n).setIdentity();
      G.block<2, 2>(n, 1).setIdentity();
      P_ = (G * P_ * G.transpose()).eval();
      P_.bottomRightCorner<2, 2>() += sighting_noise(drive_);
    }
  }

  const Drive& drive_;
  double heading_;
  Eigen::Vector2d anchor_;
  Eigen::VectorXd x_;
  Eigen::MatrixXd P_;
  std::map<LandmarkId, int> index_;
};

}  // namespace cairn::planar_test
