// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/trajectory.h"

#include <string>
#include <vector>

namespace adit {

/// Somebody's path, by what its lines hold: TUM ("t x y z qx qy qz qw", or "t x y yaw" of a path in the plane), or the
/// poses of KITTI (twelve numbers, the upper rows of a 4 x 4 matrix), which need `stamp_s`: one for each line.
/// Errors name file and line.
Trajectory read_path(const std::string& file, const std::vector<double>& stamp_s = {});
/// Are its lines twelve numbers?
bool is_kitti(const std::string& file);
/// One stamp in seconds a line (KITTI's times.txt), strictly increasing.
std::vector<double> read_stamps(const std::string& file);

/// Twelve numbers a line.
void write_kitti_path(const std::string& file, const Trajectory& path);

/// Rows "t c11 c12 .. " of a path's covariances: of (x, y, yaw), the 6 numbers of the upper triangle row by row; or of
/// (x, y, z, rx, ry, rz), 21 numbers. Of the error of the pose relative to the path's first one, in the pose's own frame:
/// metres and radians. As many rows as the path has poses, of the same stamps. Errors name file and line.
std::vector<Eigen::MatrixXd> read_covariances(const std::string& file, const Trajectory& path);
void write_covariances(const std::string& file, const Trajectory& path, const std::vector<Eigen::MatrixXd>& covariance);

}  // namespace adit
