#pragma once

#include "dense_reference.hpp"

namespace cairn::planar_test {

/// The exact quotient of paper A's filter, 6 + 2n: [x, y, s, c, q, q_i] with q = R^T x and q_i =
/// R^T p_i. Dense; noise by Jacobians, or by Gauss-Hermite quadrature over (distance, turn).
class ReducedLifted {
 public:
  ReducedLifted(const Drive& drive, bool moments) : drive_(drive), moments_(moments) {
    const Eigen::Vector3d x0 = drive.start_estimate;
    if (!moments) {
      z_ = lift(x0);
      Eigen::MatrixXd J(6, 3);
      for (int i = 0; i < 3; ++i) {
        Eigen::Vector3d step = Eigen::Vector3d::Zero();
        step(i) = 1e-6;
        J.col(i) = (lift(x0 + step) - lift(x0 - step)) / 2e-6;
      }
      P_ = J * drive.start_covariance * J.transpose();
      return;
    }
    std::vector<Eigen::Vector3d> nodes;
    std::vector<double> weights;
    const Eigen::Vector3d sd = drive.start_covariance.diagonal().cwiseSqrt();
    for (int i = 0; i < kNodes; ++i) {
      for (int j = 0; j < kNodes; ++j) {
        for (int k = 0; k < kNodes; ++k) {
          nodes.push_back(x0 + Eigen::Vector3d(sd(0) * node(i), sd(1) * node(j), sd(2) * node(k)));
          weights.push_back(weight(i) * weight(j) * weight(k));
        }
      }
    }
    z_ = Eigen::VectorXd::Zero(6);
    for (std::size_t n = 0; n < nodes.size(); ++n) z_ += weights[n] * lift(nodes[n]);
    P_ = Eigen::MatrixXd::Zero(6, 6);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Eigen::VectorXd d = lift(nodes[n]) - z_;
      P_ += weights[n] * d * d.transpose();
    }
  }

  void feed(const Step& step) {
    const PlanarIncrement<double> u = drive_.increment(step);
    if (moments_) {
      predict_moments(u);
    } else {
      predict_jacobian(u);
    }
    if (step.update) update(step);
  }

  Eigen::Vector3d pose() const { return {z_(0), z_(1), std::atan2(z_(2), z_(3))}; }
  Eigen::Matrix3d covariance() const {
    const double r2 = z_(2) * z_(2) + z_(3) * z_(3);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, P_.rows());
    J(0, 0) = 1;
    J(1, 1) = 1;
    J(2, 2) = z_(3) / r2;
    J(2, 3) = -z_(2) / r2;
    return J * P_ * J.transpose();
  }

 private:
  // Gauss-Hermite, 7 nodes, weight function of the standard normal.
  static constexpr int kNodes = 7;
  static double node(int i) {
    static const double x[kNodes] = {
        -3.750439717725742, -2.366759410734541, -1.154405394739968, 0.0,
        1.154405394739968,  2.366759410734541,  3.750439717725742};
    return x[i];
  }
  static double weight(int i) {
    static const double w[kNodes] = {
        5.482688559722179e-4, 3.075712396758651e-2, 2.401231786050127e-1, 4.571428571428571e-1,
        2.401231786050127e-1, 3.075712396758651e-2, 5.482688559722179e-4};
    return w[i];
  }

  static Eigen::VectorXd lift(const Eigen::Vector3d& p) {
    const Eigen::Vector2d q = rotation(p(2)).transpose() * p.head<2>();
    Eigen::VectorXd z(6);
    z << p(0), p(1), std::sin(p(2)), std::cos(p(2)), q(0), q(1);
    return z;
  }

  /// z' = A z + b of one increment.
  void affine(double distance, double turn, IncrementModel model, Eigen::MatrixXd& A,
              Eigen::VectorXd& b) const {
    const int n = static_cast<int>(z_.size());
    A = Eigen::MatrixXd::Identity(n, n);
    b = Eigen::VectorXd::Zero(n);
    const double half = model == IncrementModel::kExactArc ? 0.5 * turn : 0.0;
    const Eigen::Vector2d u(distance * std::cos(half), distance * std::sin(half));
    A(0, 3) = u(0);
    A(0, 2) = -u(1);
    A(1, 2) = u(0);
    A(1, 3) = u(1);
    A(2, 2) = std::cos(turn);
    A(2, 3) = std::sin(turn);
    A(3, 3) = std::cos(turn);
    A(3, 2) = -std::sin(turn);
    const Eigen::Matrix2d Rt = rotation(turn).transpose();
    for (int i = 4; i < n; i += 2) A.block<2, 2>(i, i) = Rt;
    b.segment<2>(4) = Rt * u;
  }

  void predict_jacobian(const PlanarIncrement<double>& u) {
    Eigen::MatrixXd A;
    Eigen::VectorXd b;
    Eigen::MatrixXd up;
    Eigen::MatrixXd down;
    Eigen::VectorXd b_up;
    Eigen::VectorXd b_down;
    Eigen::MatrixXd G(z_.size(), 2);
    const double h = 1e-5;
    affine(u.distance_m + h, u.turn_rad, u.model, up, b_up);
    affine(u.distance_m - h, u.turn_rad, u.model, down, b_down);
    G.col(0) = ((up - down) * z_ + b_up - b_down) / (2 * h);
    affine(u.distance_m, u.turn_rad + h, u.model, up, b_up);
    affine(u.distance_m, u.turn_rad - h, u.model, down, b_down);
    G.col(1) = ((up - down) * z_ + b_up - b_down) / (2 * h);
    affine(u.distance_m, u.turn_rad, u.model, A, b);
    P_ = (A * P_ * A.transpose() + G * u.covariance * G.transpose()).eval();
    z_ = (A * z_ + b).eval();
  }

  void predict_moments(const PlanarIncrement<double>& u) {
    const Eigen::Matrix2d L = u.covariance.llt().matrixL();
    const int n = static_cast<int>(z_.size());
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
    Eigen::MatrixXd A;
    Eigen::VectorXd b;
    const auto at = [&](int i, int j) {
      const Eigen::Vector2d e = L * Eigen::Vector2d(node(i), node(j));
      affine(u.distance_m + e(0), u.turn_rad + e(1), u.model, A, b);
    };
    for (int i = 0; i < kNodes; ++i) {
      for (int j = 0; j < kNodes; ++j) {
        at(i, j);
        mean += weight(i) * weight(j) * (A * z_ + b);
      }
    }
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < kNodes; ++i) {
      for (int j = 0; j < kNodes; ++j) {
        at(i, j);
        const Eigen::VectorXd d = A * z_ + b - mean;
        sum += weight(i) * weight(j) * (A * P_ * A.transpose() + d * d.transpose());
      }
    }
    P_ = 0.5 * (sum + sum.transpose());
    z_ = mean;
  }

  void update(const Step& step) {
    std::vector<Sighting> known;
    std::vector<Sighting> fresh;
    for (const Sighting& s : step.sightings)
      (index_.count(s.id) != 0U ? known : fresh).push_back(s);
    const int m = static_cast<int>(known.size());
    if (m > 0) {
      Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2 * m, z_.size());
      Eigen::VectorXd nu(2 * m);
      for (int k = 0; k < m; ++k) {
        const int l = index_[known[k].id];
        H.block<2, 2>(2 * k, 4) = -Eigen::Matrix2d::Identity();
        H.block<2, 2>(2 * k, l) = Eigen::Matrix2d::Identity();
        nu.segment<2>(2 * k) = known[k].y - (z_.segment<2>(l) - z_.segment<2>(4));
      }
      z_ += dense_update(P_, H,
                         drive_.settings.sigma_r * drive_.settings.sigma_r *
                             Eigen::MatrixXd::Identity(2 * m, 2 * m),
                         nu);
    }
    for (const Sighting& s : fresh) {
      const int l = static_cast<int>(z_.size());
      index_[s.id] = l;
      z_.conservativeResize(l + 2);
      z_.segment<2>(l) = z_.segment<2>(4) + s.y;
      Eigen::MatrixXd G = Eigen::MatrixXd::Zero(l + 2, l);
      G.topLeftCorner(l, l).setIdentity();
      G.block<2, 2>(l, 4).setIdentity();
      P_ = (G * P_ * G.transpose()).eval();
      P_.bottomRightCorner<2, 2>() += sighting_noise(drive_);
    }
  }

  const Drive& drive_;
  bool moments_;
  Eigen::VectorXd z_;
  Eigen::MatrixXd P_;
  std::map<LandmarkId, int> index_;
};

}  // namespace cairn::planar_test
