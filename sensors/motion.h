// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/trajectory.h"

namespace adit {

/// Poses of a path at instants that mostly grow by little, as for the beams of a turn: position linear, rotation about
/// one axis at an even rate between neighbours, as Trajectory::at, at a fraction of its cost.
class Motion {
 public:
  /// The path must outlive this and have two poses.
  explicit Motion(const Trajectory& path);
  /// X_WB at t_s; before and after the path its first and last pose.
  Pose at(double t_s);

 private:
  void enter(size_t stretch);

  const Trajectory* path_;
  size_t stretch_ = 0;  // between poses stretch_ and stretch_ + 1
  double angle_rad_ = 0;
  // R(angle) = R + sin(angle) RK + (1 - cos(angle)) RKK, with K the cross product by the axis (Rodrigues).
  Eigen::Matrix3d R_, RK_, RKK_;
};

}  // namespace adit
