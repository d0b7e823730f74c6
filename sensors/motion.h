// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/trajectory.h"

namespace adit {

/// A path between two of its poses: position even in time, rotation about one axis at an even rate.
struct Stretch {
  double from_s = 0, span_s = 1;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double angle_rad = 0;  // turned over the whole of it
  // R(angle) = R + sin(angle) RK + (1 - cos(angle)) RKK, with K the cross product by the axis (Rodrigues).
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity(), RK = Eigen::Matrix3d::Zero(), RKK = Eigen::Matrix3d::Zero();

  double to_s() const { return from_s + span_s; }
  /// Whether the series of `turned` holds for all of it.
  bool turns_little() const { return angle_rad * angle_rad < 0.01; }
};

struct Turned {
  double sine, versine;  // versine = 1 - cosine
};
/// Of an angle with square below 0.01: four terms of the series are exact.
inline Turned turned(double angle_rad) {
  const double q = angle_rad * angle_rad;
  return {angle_rad * (1 - q * (1.0 / 6) * (1 - q * (1.0 / 20) * (1 - q * (1.0 / 42)))),
          q * 0.5 * (1 - q * (1.0 / 12) * (1 - q * (1.0 / 30) * (1 - q * (1.0 / 56))))};
}

/// Poses of a path at instants that mostly grow by little, as for the beams of a turn: as Trajectory::at, at a fraction
/// of its cost.
class Motion {
 public:
  /// The path must outlive this and have two poses.
  explicit Motion(const Trajectory& path);
  /// The stretch that holds an instant; before and after the path its first and last.
  const Stretch& stretch_at(double t_s);
  /// X_WB at t_s; before and after the path its first and last pose.
  Pose at(double t_s);

 private:
  void enter(size_t number);

  const Trajectory* path_;
  size_t number_ = 0;  // of the stretch: between poses number_ and number_ + 1
  Stretch stretch_;
};

}  // namespace adit
