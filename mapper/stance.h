// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/rig.h"
#include "base/trajectory.h"

#include <Eigen/Core>

#include <vector>

namespace adit {

/// How the horizontal laser stands in space while it takes a scan. Where it stands in plan, and which way it looks, is the
/// planar pose's matter: B is the body kept level at that pose.
struct Stance {
  Eigen::Matrix3d R_BS = Eigen::Matrix3d::Identity();  // at the stamp
  Eigen::Matrix3d R_BS_s = Eigen::Matrix3d::Zero();    // its change per second
  double z_m = 0, z_m_s = 0;                           // height of the laser in M, and its change per second
};

/// At each stamp, by a path with pitch, roll and height. @param scan_s  over which the changes are taken; 0 for a laser whose beams leave at once
std::vector<Stance> stances_along(const Trajectory& X_MB, const std::vector<double>& stamp_s, const Mount& horizontal,
                                  double scan_s);

}  // namespace adit
