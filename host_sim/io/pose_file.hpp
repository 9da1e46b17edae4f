#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "cairn/geometry/rigid.hpp"

namespace cairn::host {

struct TimedPose {
  std::int64_t t_us = 0;
  Rigid<double> pose;
};

/// Nearest rotation to a matrix that is one up to rounding, as a unit quaternion with w >= 0.
/// False when `matrix` is further than 0.05 (any element of M^T M - I) from a rotation.
bool to_rotation(const Matrix3<double>& matrix, Quaternion<double>& rotation);

/// Lines of `t tx ty tz qx qy qz qw` (TUM), t in seconds, strictly increasing.
std::vector<TimedPose> read_tum(const std::filesystem::path& path);
/// One 4x4 matrix in four lines, last row 0 0 0 1 (7-Scenes).
Rigid<double> read_matrix_pose(const std::filesystem::path& path);
/// A 3x4 matrix a line (KITTI).
std::vector<Rigid<double>> read_kitti_poses(const std::filesystem::path& path);

/// Writes the poses as read_kitti_poses() reads them: the upper three rows of each matrix, row by
/// row, without times.
void write_kitti(const std::filesystem::path& path, const std::vector<TimedPose>& poses);
/// Writes `poses` as read_tum() reads them: single spaces, no trailing blank.
void write_tum(const std::filesystem::path& path, const std::vector<TimedPose>& poses);

}  // namespace cairn::host
