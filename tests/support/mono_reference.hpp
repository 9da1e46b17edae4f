#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Dense>

#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/mono/parameters.hpp"

#include "dual.hpp"

namespace cairn::test {

/// Rotation of `v` by the quaternion (w, x, y, z), homogeneous form, written as the sandwich
/// product; S is a scalar or a dual number.
template <class S>
std::array<S, 3> rotate(const S* q, const std::array<S, 3>& v, bool inverse) {
  const S w = q[0];
  const S x = inverse ? -q[1] : q[1], y = inverse ? -q[2] : q[2], z = inverse ? -q[3] : q[3];
  // t = q (0, v), then vector part of t q*
  const S t0 = -(x * v[0] + y * v[1] + z * v[2]);
  const S t1 = w * v[0] + y * v[2] - z * v[1];
  const S t2 = w * v[1] + z * v[0] - x * v[2];
  const S t3 = w * v[2] + x * v[1] - y * v[0];
  return {-(t0 * x) + t1 * w - t2 * z + t3 * y, -(t0 * y) + t2 * w - t3 * x + t1 * z,
          -(t0 * z) + t3 * w - t1 * y + t2 * x};
}

/// Pixel of a camera-frame vector, radial-tangential distortion, focal length times (1 + s).
template <class S>
std::array<S, 2> distorted_pixel(const PinholeCamera<double>& c, const S& s,
                                 const std::array<S, 3>& p) {
  const S x = p[0] / p[2], y = p[1] / p[2];
  const S r2 = x * x + y * y;
  const S radial = 1.0 + r2 * (S(c.k1) + r2 * (S(c.k2) + c.k3 * r2));
  const S xd = x * radial + 2.0 * c.p1 * (x * y) + c.p2 * (r2 + 2.0 * (x * x));
  const S yd = y * radial + c.p1 * (r2 + 2.0 * (y * y)) + 2.0 * c.p2 * (x * y);
  return {c.fx * ((1.0 + s) * xd) + S(c.cx), c.fy * ((1.0 + s) * yd) + S(c.cy)};
}

/// q * exp(w dt).
template <class S>
std::array<S, 4> turn(const S* q, const S* rate, double dt) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const S a = dt * rate[0], b = dt * rate[1], c = dt * rate[2];
  const S squared = a * a + b * b + c * c;
  S f(0.5), w(1.0);  // limits for no rotation, where the square root has no derivative
  if (value_of(squared) > 1e-16) {
    const S angle = sqrt(squared);
    f = sin(0.5 * angle) / angle;
    w = cos(0.5 * angle);
  }
  const S x = f * a, y = f * b, z = f * c;
  return {q[0] * w - q[1] * x - q[2] * y - q[3] * z, q[0] * x + q[1] * w + q[2] * z - q[3] * y,
          q[0] * y - q[1] * z + q[2] * w + q[3] * x, q[0] * z + q[1] * y - q[2] * x + q[3] * w};
}

/// The plain filter of the paper: dense, state r q v w and 13 + 6 n with an anchor of its own for
/// every feature, Jacobians by dual numbers, one batch update with H stacked. No RANSAC, no
/// conversion to XYZ: every match is used.
class MonoReference {
 public:
  MonoReference(const PinholeCamera<double>& camera, const MonoParameters<double>& parameters)
      : camera_(camera), parameters_(parameters) {
    x_ = Eigen::VectorXd::Zero(13);
    x_(3) = 1.0;
    p_ = Eigen::MatrixXd::Zero(13, 13);
    for (int i = 7; i < 10; ++i) p_(i, i) = square(parameters.initial_velocity_sigma_mps);
    for (int i = 10; i < 13; ++i) p_(i, i) = square(parameters.initial_rate_sigma_radps);
  }

  void predict(double dt) {
    using D = Dual<13>;
    D s[13];
    for (int i = 0; i < 13; ++i) s[i] = D::variable(x_(i), i);
    const auto q = turn(s + 3, s + 10, dt);
    D out[13];
    for (int i = 0; i < 3; ++i) {
      out[i] = s[i] + dt * s[7 + i];
      out[7 + i] = s[7 + i];
      out[10 + i] = s[10 + i];
    }
    for (std::size_t i = 0; i < 4; ++i) out[3 + i] = q[i];
    const auto n = static_cast<int>(x_.size());
    Eigen::MatrixXd f = Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd g = Eigen::MatrixXd::Zero(n, 6);
    for (int i = 0; i < 13; ++i) {
      for (int j = 0; j < 13; ++j) f(i, j) = out[i].d[j];
      for (int j = 0; j < 6; ++j) g(i, j) = out[i].d[7 + j];
      x_(i) = out[i].v;
    }
    Eigen::VectorXd noise(6);
    noise << Eigen::Vector3d::Constant(square(parameters_.velocity_noise) * dt),
        Eigen::Vector3d::Constant(square(parameters_.rate_noise) * dt);
    p_ =
        parameters_.fading_factor * f * p_ * f.transpose() + g * noise.asDiagonal() * g.transpose();
  }

  void add_feature(const Eigen::Vector2d& pixel) {
    const auto n = static_cast<int>(x_.size());
    axes_.push_back(attitude());
    const Eigen::Vector3d ray = camera_.unproject(pixel);
    // theta, phi of B^T R(q) (ray + d ray): derivative by q and by the ray's x and y.
    using D = Dual<6>;
    D q[4];
    for (int i = 0; i < 4; ++i) q[i] = D::variable(x_(3 + i), i);
    const std::array<D, 3> r = {D::variable(ray.x(), 4), D::variable(ray.y(), 5), D(1.0)};
    const auto world = rotate(q, r, false);
    D m[3];
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d b = axes_.back().col(i);
      m[i] = b(0) * world[0] + b(1) * world[1] + b(2) * world[2];
    }
    const D theta = atan2(m[0], m[2]);
    const D phi = atan2(-m[1], sqrt(m[0] * m[0] + m[2] * m[2]));
    // d ray / d pixel: inverse of the projection's.
    using E = Dual<2>;
    const std::array<E, 3> e = {E::variable(ray.x(), 0), E::variable(ray.y(), 1), E(1.0)};
    const auto back = distorted_pixel(camera_, E(0.0), e);
    Eigen::Matrix2d forward;
    forward << back[0].d[0], back[0].d[1], back[1].d[0], back[1].d[1];
    Eigen::Matrix2d wrt_ray;
    wrt_ray << theta.d[4], theta.d[5], phi.d[4], phi.d[5];
    const Eigen::Matrix2d wrt_pixel = wrt_ray * forward.inverse();

    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(n + 6, n + 3);
    j.topLeftCorner(n, n).setIdentity();
    j.block(n, 0, 3, 3).setIdentity();
    for (int i = 0; i < 4; ++i) {
      j(n + 3, 3 + i) = theta.d[i];
      j(n + 4, 3 + i) = phi.d[i];
    }
    j.block(n + 3, n, 2, 2) = wrt_pixel;
    j(n + 5, n + 2) = 1.0;
    Eigen::MatrixXd big = Eigen::MatrixXd::Zero(n + 3, n + 3);
    big.topLeftCorner(n, n) = p_;
    big.block(n, n, 2, 2) = square(parameters_.sigma_px) * Eigen::Matrix2d::Identity();
    big(n + 2, n + 2) = square(parameters_.initial_inverse_depth_sigma);
    p_ = j * big * j.transpose();
    Eigen::VectorXd x(n + 6);
    x << x_, x_.head<3>(), theta.v, phi.v, parameters_.initial_inverse_depth;
    x_ = x;
  }

  /// Batch update with pixel `pixels[k]` of feature `features[k]`.
  void update(const std::vector<int>& features, const std::vector<Eigen::Vector2d>& pixels) {
    const auto n = static_cast<int>(x_.size());
    const auto m = static_cast<int>(features.size());
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(2 * m, n);
    Eigen::VectorXd nu(2 * m);
    for (int k = 0; k < m; ++k) {
      const int feature = features[static_cast<std::size_t>(k)];
      const auto row = measure(feature);
      for (int i = 0; i < 2; ++i) {
        const auto& value = row[static_cast<std::size_t>(i)];
        nu(2 * k + i) = pixels[static_cast<std::size_t>(k)](i) - value.v;
        for (int c = 0; c < 7; ++c) h(2 * k + i, c) = value.d[c];
        for (int c = 0; c < 6; ++c) h(2 * k + i, 13 + 6 * feature + c) = value.d[7 + c];
      }
    }
    const Eigen::MatrixXd s = h * p_ * h.transpose() + square(parameters_.sigma_px) *
                                                           Eigen::MatrixXd::Identity(2 * m, 2 * m);
    const Eigen::MatrixXd k = s.ldlt().solve(h * p_).transpose();
    x_ += k * nu;
    p_ -= k * h * p_;
    p_ = (0.5 * (p_ + p_.transpose())).eval();
    const Eigen::Vector4d q = x_.segment<4>(3);
    const double norm = q.norm();
    const Eigen::Matrix4d j =
        (Eigen::Matrix4d::Identity() - q * q.transpose() / (norm * norm)) / norm;
    p_.middleRows(3, 4) = (j * p_.middleRows(3, 4)).eval();
    p_.middleCols(3, 4) = (p_.middleCols(3, 4) * j.transpose()).eval();
    x_.segment<4>(3) = q / norm;
  }

  const Eigen::VectorXd& state() const { return x_; }
  const Eigen::MatrixXd& covariance() const { return p_; }
  Eigen::Vector2d pixel(int feature) const {
    const auto row = measure(feature);
    return {row[0].v, row[1].v};
  }
  /// H P H' + R of one feature.
  Eigen::Matrix2d innovation_covariance(int feature) const {
    const auto row = measure(feature);
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(2, x_.size());
    for (int i = 0; i < 2; ++i) {
      for (int c = 0; c < 7; ++c) h(i, c) = row[static_cast<std::size_t>(i)].d[c];
      for (int c = 0; c < 6; ++c) {
        h(i, 13 + 6 * feature + c) = row[static_cast<std::size_t>(i)].d[7 + c];
      }
    }
    return h * p_ * h.transpose() + square(parameters_.sigma_px) * Eigen::Matrix2d::Identity();
  }

 private:
  Eigen::Matrix3d attitude() const {
    Eigen::Matrix3d r;
    for (int i = 0; i < 3; ++i) {
      std::array<double, 3> e = {};
      e[static_cast<std::size_t>(i)] = 1.0;
      const auto column = rotate(x_.data() + 3, e, false);
      for (int k = 0; k < 3; ++k) r(k, i) = column[static_cast<std::size_t>(k)];
    }
    return r;
  }

  std::array<Dual<13>, 2> measure(int feature) const {
    using D = Dual<13>;
    D s[13];
    for (int i = 0; i < 7; ++i) s[i] = D::variable(x_(i), i);
    for (int i = 0; i < 6; ++i) s[7 + i] = D::variable(x_(13 + 6 * feature + i), 7 + i);
    const D m[3] = {cos(s[11]) * sin(s[10]), -sin(s[11]), cos(s[11]) * cos(s[10])};
    std::array<D, 3> ray;
    const Eigen::Matrix3d& b = axes_[static_cast<std::size_t>(feature)];
    for (int i = 0; i < 3; ++i) {
      const D direction = b(i, 0) * m[0] + b(i, 1) * m[1] + b(i, 2) * m[2];
      ray[static_cast<std::size_t>(i)] = s[12] * (s[7 + i] - s[i]) + direction;
    }
    return distorted_pixel(camera_, D(0.0), rotate(s + 3, ray, true));
  }

  PinholeCamera<double> camera_;
  MonoParameters<double> parameters_;
  Eigen::VectorXd x_;
  Eigen::MatrixXd p_;
  std::vector<Eigen::Matrix3d> axes_;
};

}  // namespace cairn::test
