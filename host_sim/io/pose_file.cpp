#include "host_sim/io/pose_file.hpp"

#include <cmath>
#include <cstdlib>

#include <Eigen/SVD>
#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

constexpr const char* kTumFields = "t tx ty tz qx qy qz qw";

Rigid<double> to_rigid(const std::vector<double>& rows, const std::filesystem::path& path,
                       int line) {
  Matrix3<double> matrix;
  matrix << rows[0], rows[1], rows[2], rows[4], rows[5], rows[6], rows[8], rows[9], rows[10];
  Rigid<double> pose;
  if (!to_rotation(matrix, pose.rotation)) {
    throw InputError(path, line, "expected a pose matrix whose left 3x3 block is a rotation");
  }
  pose.translation = {rows[3], rows[7], rows[11]};
  return pose;
}

}  // namespace

bool to_rotation(const Matrix3<double>& matrix, Quaternion<double>& rotation) {
  const Matrix3<double> error = matrix.transpose() * matrix - Matrix3<double>::Identity();
  if (!(error.cwiseAbs().maxCoeff() < 0.05) || matrix.determinant() < 0.0) return false;
  const Eigen::JacobiSVD<Matrix3<double>> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3<double> nearest = svd.matrixU() * svd.matrixV().transpose();
  rotation = Quaternion<double>(nearest).normalized();
  if (rotation.w() < 0.0) rotation.coeffs() = -rotation.coeffs();
  return true;
}

std::vector<TimedPose> read_tum(const std::filesystem::path& path) {
  std::vector<TimedPose> poses;
  LineReader lines(path);
  for (TextLine line; lines.next(line);) {
    const std::vector<double> v = parse_numbers(line, 8, path, kTumFields);
    TimedPose timed;
    timed.t_us = parse_time_us(v[0], 1e6, path, line.number);
    timed.pose.translation = {v[1], v[2], v[3]};
    timed.pose.rotation = Quaternion<double>(v[7], v[4], v[5], v[6]);
    const double norm = timed.pose.rotation.norm();
    if (!(std::abs(norm - 1.0) <= 0.01)) {
      throw InputError(
          path, line.number,
          fmt::format("expected a unit quaternion qx qy qz qw, found one of length {:.3g}", norm));
    }
    timed.pose.rotation.normalize();
    if (!poses.empty() && timed.t_us <= poses.back().t_us) {
      throw InputError(path, line.number,
                       fmt::format("expected times in increasing order, found {:.6f} s after "
                                   "{:.6f} s",
                                   1e-6 * static_cast<double>(timed.t_us),
                                   1e-6 * static_cast<double>(poses.back().t_us)));
    }
    poses.push_back(timed);
  }
  if (poses.empty()) throw InputError(path, fmt::format("expected lines of {}", kTumFields));
  return poses;
}

Rigid<double> read_matrix_pose(const std::filesystem::path& path) {
  std::vector<double> rows;
  LineReader lines(path);
  TextLine line;
  for (int i = 0; i < 4; ++i) {
    if (!lines.next(line)) {
      throw InputError(path, fmt::format("expected a 4x4 matrix in 4 lines, found {}", i));
    }
    const std::vector<double> row = parse_numbers(line, 4, path, "a row of a 4x4 matrix");
    rows.insert(rows.end(), row.begin(), row.end());
  }
  for (int i = 0; i < 4; ++i) {
    if (std::abs(rows[12 + i] - (i < 3 ? 0.0 : 1.0)) > 1e-6) {
      throw InputError(path, line.number, "expected 0 0 0 1 in the last row of a pose matrix");
    }
  }
  if (lines.next(line)) {
    throw InputError(path, line.number, "expected a 4x4 matrix in 4 lines, found another line");
  }
  return to_rigid(rows, path, line.number);
}

std::vector<Rigid<double>> read_kitti_poses(const std::filesystem::path& path) {
  std::vector<Rigid<double>> poses;
  LineReader lines(path);
  for (TextLine line; lines.next(line);) {
    poses.push_back(
        to_rigid(parse_numbers(line, 12, path, "a 3x4 pose matrix"), path, line.number));
  }
  if (poses.empty()) throw InputError(path, "expected a 3x4 pose matrix a line");
  return poses;
}

void write_kitti(const std::filesystem::path& path, const std::vector<TimedPose>& poses) {
  OutputFile file(path);
  for (const TimedPose& timed : poses) {
    const Matrix3<double> R = timed.pose.rotation.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      file.print("{}{:.9g} {:.9g} {:.9g} {:.9g}", row == 0 ? "" : " ", R(row, 0), R(row, 1),
                 R(row, 2), timed.pose.translation[row]);
    }
    file.print("\n");
  }
  file.finish();
}

void write_tum(const std::filesystem::path& path, const std::vector<TimedPose>& poses) {
  OutputFile file(path);
  for (const TimedPose& timed : poses) {
    const Vector3<double>& p = timed.pose.translation;
    const Quaternion<double>& q = timed.pose.rotation;
    const std::int64_t size_us = std::abs(timed.t_us);
    file.print("{}{}.{:06d} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n",
               timed.t_us < 0 ? "-" : "", size_us / 1000000, size_us % 1000000, p.x(), p.y(), p.z(),
               q.x(), q.y(), q.z(), q.w());
  }
  file.finish();
}

}  // namespace cairn::host
