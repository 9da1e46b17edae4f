#include "host_sim/reports/gyro_meaning.hpp"

#include <cmath>

#include <Eigen/SVD>
#include <fmt/format.h>

namespace cairn::host {
namespace {

/// The rotation that brings the gyroscope's turns to those of the pictures (Kabsch), where turns
/// about two axes determine it.
std::string better_mounting(const Matrix3<float>& products) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products.cast<double>(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& s = svd.singularValues();
  if (!(s(1) > 0.1 * s(0)) || !(s(0) > 0.3)) return "";
  Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(svd.matrixU() * flip * svd.matrixV().transpose()));
  const Eigen::Vector3d& axis = turn.axis();
  return fmt::format(
      "; the pictures' turns are its own turned by {:.0f} deg about ({:.2f}, {:.2f}, "
      "{:.2f}) of the camera",
      turn.angle() * 180.0 / M_PI, axis.x(), axis.y(), axis.z());
}

}  // namespace

std::string meaning_of_gyro(const GyroReport& gyro) {
  const std::string difference =
      fmt::format("{:.2f} over {} turns (0: equal, 1: no better than none, 4: opposite)",
                  gyro.difference, gyro.ways);
  switch (gyro.trust) {
    case GyroTrust::kAgrees:
      return "gyroscope used: it turns as the pictures do, difference " + difference;
    case GyroTrust::kContradicted:
      return "gyroscope NOT used: it turns otherwise than the pictures, difference " + difference +
             ": check how it is turned against the camera, its unit (rad/s) and its times" +
             better_mounting(gyro.products);
    default:
      return gyro.ways == 0
                 ? "gyroscope used for prediction alone: the camera has not turned enough to "
                   "compare it with the pictures"
                 : "gyroscope used for prediction alone: it agrees too little with the pictures, "
                   "difference " +
                       difference;
  }
}

}  // namespace cairn::host
