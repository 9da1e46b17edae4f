#include "host_sim/experiments/consistency/reference/reduced_lifted.hpp"

#include <cmath>
#include <complex>

namespace cairn::host {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kVehicleStates = 6;

Vector6 lift(double x, double y, double heading) {
  const double s = std::sin(heading);
  const double c = std::cos(heading);
  Vector6 z;
  z << x, y, s, c, x * c + y * s, y * c - x * s;
  return z;
}

Eigen::Matrix<double, 6, 3> lift_jacobian(double x, double y, double heading) {
  const Vector6 z = lift(x, y, heading);
  Eigen::Matrix<double, 6, 3> j = Eigen::Matrix<double, 6, 3>::Zero();
  j(0, 0) = 1.0;
  j(1, 1) = 1.0;
  j(2, 2) = z(3);
  j(3, 2) = -z(2);
  j.row(4) << z(3), z(2), z(5);
  j.row(5) << -z(2), z(3), -z(4);
  return j;
}

OdometryMonomials monomials(double u1, double a) {
  OdometryMonomials m;
  m << 1.0, u1, std::sin(a), std::cos(a), u1 * std::sin(a), u1 * std::cos(a);
  return m;
}

/// sum_k m_k F_k applied to every column of `columns`; `one` is the value of the state's constant.
Eigen::MatrixXd apply_model(const OdometryMonomials& m, const Eigen::MatrixXd& columns,
                            double one) {
  Eigen::MatrixXd out(columns.rows(), columns.cols());
  const double u1 = m(1);
  const double sine = m(2);
  const double cosine = m(3);
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const double* z = columns.data() + j * columns.rows();
    double* w = out.data() + j * columns.rows();
    w[0] = m(0) * z[0] + u1 * z[3];
    w[1] = m(0) * z[1] + u1 * z[2];
    w[2] = cosine * z[2] + sine * z[3];
    w[3] = cosine * z[3] - sine * z[2];
    for (Eigen::Index i = 4; i < columns.rows(); i += 2) {
      w[i] = cosine * z[i] + sine * z[i + 1];
      w[i + 1] = cosine * z[i + 1] - sine * z[i];
    }
    w[4] += m(5) * one;
    w[5] -= m(4) * one;
  }
  return out;
}

/// F X F^T with F = sum_k m_k F_k, X symmetric.
Eigen::MatrixXd conjugate(const OdometryMonomials& m, const Eigen::MatrixXd& x) {
  const Eigen::MatrixXd half = apply_model(m, x, 0.0).transpose();
  return apply_model(m, half, 0.0);
}

/// E[u1^power e^{i k a}] for Gaussian (u1, a).
std::complex<double> trigonometric_moment(const Increment& step, int power, int k) {
  const std::complex<double> i(0.0, 1.0);
  const double frequency = k;
  const std::complex<double> base =
      std::exp(i * frequency * step.turn_rad - 0.5 * frequency * frequency * step.covariance(1, 1));
  const std::complex<double> shifted = step.distance_m + i * frequency * step.covariance(0, 1);
  if (power == 0) return base;
  if (power == 1) return shifted * base;
  return (shifted * shifted + step.covariance(0, 0)) * base;
}

}  // namespace

MonomialMoments monomial_moments(const Increment& step) {
  // Each monomial is u1^power times 1, sin a or cos a; products follow from e^{ia} and e^{2ia}.
  constexpr std::array<int, 6> kPower{0, 1, 0, 0, 1, 1};
  enum class Wave { kOne, kSine, kCosine };
  constexpr std::array<Wave, 6> kWave{Wave::kOne,    Wave::kOne,  Wave::kSine,
                                      Wave::kCosine, Wave::kSine, Wave::kCosine};
  const auto mean_of = [&](int power, Wave wave) {
    const std::complex<double> e = trigonometric_moment(step, power, 1);
    if (wave == Wave::kSine) return e.imag();
    if (wave == Wave::kCosine) return e.real();
    return trigonometric_moment(step, power, 0).real();
  };
  MonomialMoments moments;
  for (std::size_t i = 0; i < 6; ++i) {
    moments.mean(static_cast<int>(i)) = mean_of(kPower[i], kWave[i]);
  }
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      const int power = kPower[i] + kPower[j];
      double product = 0.0;
      if (kWave[i] == Wave::kOne || kWave[j] == Wave::kOne) {
        product = mean_of(power, kWave[i] == Wave::kOne ? kWave[j] : kWave[i]);
      } else {
        const std::complex<double> twice = trigonometric_moment(step, power, 2);
        const double constant = trigonometric_moment(step, power, 0).real();
        if (kWave[i] != kWave[j]) {
          product = 0.5 * twice.imag();
        } else {
          product =
              0.5 * (kWave[i] == Wave::kCosine ? constant + twice.real() : constant - twice.real());
        }
      }
      const auto row = static_cast<int>(i);
      const auto column = static_cast<int>(j);
      moments.covariance(row, column) = product - moments.mean(row) * moments.mean(column);
    }
  }
  return moments;
}

void ReducedLifted::initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  slots_ = SlotTable();
  if (noise_ == Noise::kJacobian) {
    initialise_jacobian(pose, covariance);
  } else {
    initialise_moments(pose, covariance);
  }
}

void ReducedLifted::initialise_jacobian(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  const auto j = lift_jacobian(pose.position.x(), pose.position.y(), pose.heading);
  mean_ = lift(pose.position.x(), pose.position.y(), pose.heading);
  covariance_ = j * covariance * j.transpose();
}

void ReducedLifted::initialise_moments(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  // Exact for Gaussian (x, y, heading): the lifted entries are products of at most one of x, y with
  // a sine or cosine, so conditioning on the heading leaves trigonometric moments of u1 = x or y.
  const Eigen::Matrix3d& p = covariance;
  Increment along_x;
  along_x.distance_m = pose.position.x();
  along_x.turn_rad = pose.heading;
  along_x.covariance << p(0, 0), p(0, 2), p(0, 2), p(2, 2);
  Increment along_y = along_x;
  along_y.distance_m = pose.position.y();
  along_y.covariance << p(1, 1), p(1, 2), p(1, 2), p(2, 2);
  const auto ex = [&](int power, int k) { return trigonometric_moment(along_x, power, k); };
  const auto ey = [&](int power, int k) { return trigonometric_moment(along_y, power, k); };
  // E[x y e^{ika}]: both means are shifted by i k times their covariance with the heading.
  const auto exy = [&](int k) {
    const std::complex<double> i(0.0, 1.0);
    const double frequency = k;
    return ((along_x.distance_m + i * frequency * p(0, 2)) *
                (along_y.distance_m + i * frequency * p(1, 2)) +
            p(0, 1)) *
           ex(0, k);
  };
  const std::complex<double> e1 = ex(0, 1);
  const std::complex<double> e2 = ex(0, 2);
  const std::complex<double> x1 = ex(1, 1);
  const std::complex<double> y1 = ey(1, 1);
  const std::complex<double> x2 = ex(1, 2);
  const std::complex<double> y2 = ey(1, 2);
  const std::complex<double> xx1 = ex(2, 1);
  const std::complex<double> yy1 = ey(2, 1);
  const double x0 = ex(1, 0).real();
  const double y0 = ey(1, 0).real();
  const double xx0 = ex(2, 0).real();
  const double yy0 = ey(2, 0).real();
  const double xy0 = exy(0).real();

  Vector6 mean;
  mean << x0, y0, e1.imag(), e1.real(), x1.real() + y1.imag(), y1.real() - x1.imag();
  Matrix6 second = Matrix6::Zero();
  second(0, 0) = xx0;
  second(1, 0) = xy0;
  second(1, 1) = yy0;
  second.row(2).head<3>() << x1.imag(), y1.imag(), 0.5 * (1.0 - e2.real());
  second.row(3).head<4>() << x1.real(), y1.real(), 0.5 * e2.imag(), 0.5 * (1.0 + e2.real());
  const std::complex<double> xy1 = exy(1);
  const std::complex<double> xy2 = exy(2);
  const std::complex<double> xx2 = ex(2, 2);
  const std::complex<double> yy2 = ey(2, 2);
  // q1 = x cos + y sin, q2 = y cos - x sin
  second(4, 0) = xx1.real() + xy1.imag();
  second(4, 1) = xy1.real() + yy1.imag();
  second(4, 2) = 0.5 * x2.imag() + 0.5 * (y0 - y2.real());
  second(4, 3) = 0.5 * (x0 + x2.real()) + 0.5 * y2.imag();
  second(4, 4) = 0.5 * (xx0 + xx2.real()) + xy2.imag() + 0.5 * (yy0 - yy2.real());
  second(5, 0) = xy1.real() - xx1.imag();
  second(5, 1) = yy1.real() - xy1.imag();
  second(5, 2) = 0.5 * y2.imag() - 0.5 * (x0 - x2.real());
  second(5, 3) = 0.5 * (y0 + y2.real()) - 0.5 * x2.imag();
  second(5, 4) = xy2.real() + 0.5 * yy2.imag() - 0.5 * xx2.imag();
  second(5, 5) = 0.5 * (yy0 + yy2.real()) - xy2.imag() + 0.5 * (xx0 - xx2.real());
  const Matrix6 full = second.selfadjointView<Eigen::Lower>();
  mean_ = mean;
  covariance_ = full - mean * mean.transpose();
}

void ReducedLifted::predict(const Increment& step) {
  if (noise_ == Noise::kJacobian) {
    const OdometryMonomials m = monomials(step.distance_m, step.turn_rad);
    OdometryMonomials by_forward;
    by_forward << 0.0, 1.0, 0.0, 0.0, m(2), m(3);
    OdometryMonomials by_turn;
    by_turn << 0.0, 0.0, m(3), -m(2), m(5), -m(4);
    Eigen::MatrixXd g(mean_.size(), 2);
    g.col(0) = apply_model(by_forward, mean_, 1.0);
    g.col(1) = apply_model(by_turn, mean_, 1.0);
    covariance_ = conjugate(m, covariance_) + g * step.covariance * g.transpose();
    mean_ = apply_model(m, mean_, 1.0).eval();
  } else {
    const MonomialMoments moments = monomial_moments(step);
    const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(moments.covariance);
    Eigen::MatrixXd predicted = conjugate(moments.mean, covariance_);
    for (int r = 0; r < 6; ++r) {
      const double weight = eigen.eigenvalues()(r);
      if (weight <= 1e-10 * eigen.eigenvalues()(5)) continue;
      const OdometryMonomials q = std::sqrt(weight) * eigen.eigenvectors().col(r);
      const Eigen::VectorXd w = apply_model(q, mean_, 1.0);
      predicted += conjugate(q, covariance_);
      predicted += w * w.transpose();
    }
    covariance_ = predicted;
    mean_ = apply_model(moments.mean, mean_, 1.0).eval();
  }
  symmetrise(covariance_);
}

void ReducedLifted::update(const std::vector<PointSighting>& sightings, double sigma_m) {
  std::vector<DenseRow> rows;
  for (const auto& s : sightings) {
    const int slot = slots_.find(s.landmark);
    if (slot < 0) continue;
    DenseRow row;
    row.landmark_column = kVehicleStates + 2 * slot;
    row.vehicle = Eigen::MatrixXd::Zero(2, kVehicleStates);
    row.vehicle.rightCols<2>() = -Eigen::Matrix2d::Identity();
    row.innovation = s.point - (mean_.segment<2>(row.landmark_column) - mean_.segment<2>(4));
    row.noise = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
    rows.push_back(row);
  }
  if (!rows.empty()) {
    const DenseGain gain = dense_gain(covariance_, rows);
    mean_ += gain.gain * gain.innovation;
    apply_gain(gain, covariance_);
  }
  for (const auto& s : sightings) {
    if (slots_.find(s.landmark) >= 0) continue;
    slots_.add(s.landmark);
    const Eigen::Index n = mean_.size();
    const Eigen::MatrixXd cross = covariance_.middleRows(4, 2);
    const Eigen::Matrix2d own =
        covariance_.block<2, 2>(4, 4) + sigma_m * sigma_m * Eigen::Matrix2d::Identity();
    mean_.conservativeResize(n + 2);
    mean_.tail<2>() = mean_.segment<2>(4) + s.point;
    covariance_.conservativeResize(n + 2, n + 2);
    covariance_.bottomLeftCorner(2, n) = cross;
    covariance_.topRightCorner(n, 2) = cross.transpose();
    covariance_.bottomRightCorner<2, 2>() = own;
  }
}

PoseEstimate ReducedLifted::pose() const {
  const double length_squared = mean_(2) * mean_(2) + mean_(3) * mean_(3);
  Eigen::Matrix<double, 3, 6> j = Eigen::Matrix<double, 3, 6>::Zero();
  j(0, 0) = 1.0;
  j(1, 1) = 1.0;
  j(2, 2) = mean_(3) / length_squared;
  j(2, 3) = -mean_(2) / length_squared;
  return {{mean_.head<2>(), std::atan2(mean_(2), mean_(3))},
          j * covariance_.topLeftCorner<6, 6>() * j.transpose()};
}

bool ReducedLifted::landmark(int landmark, LandmarkEstimate& estimate) const {
  const int slot = slots_.find(landmark);
  if (slot < 0) return false;
  // p_i = x + R (q_i - q), R from the unit vector along (cos, sin).
  const Eigen::Index column = kVehicleStates + 2 * slot;
  const double length_squared = mean_(2) * mean_(2) + mean_(3) * mean_(3);
  const Eigen::Matrix2d r = rotation2(std::atan2(mean_(2), mean_(3)));
  const Eigen::Vector2d relative = r * (mean_.segment<2>(column) - mean_.segment<2>(4));
  estimate.position = mean_.head<2>() + relative;
  Eigen::Matrix<double, 2, 8> j;
  j.leftCols<2>().setIdentity();
  j.col(2) = rotation_generator() * relative * (mean_(3) / length_squared);
  j.col(3) = rotation_generator() * relative * (-mean_(2) / length_squared);
  j.middleCols<2>(4) = -r;
  j.rightCols<2>() = r;
  Eigen::Matrix<double, 8, 8> marginal;
  marginal.topLeftCorner<6, 6>() = covariance_.topLeftCorner<6, 6>();
  marginal.topRightCorner<6, 2>() = covariance_.block<6, 2>(0, column);
  marginal.bottomLeftCorner<2, 6>() = covariance_.block<2, 6>(column, 0);
  marginal.bottomRightCorner<2, 2>() = covariance_.block<2, 2>(column, column);
  estimate.covariance = j * marginal * j.transpose();
  return true;
}

}  // namespace cairn::host
