// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Frames, all right-handed. X_AB is the pose of frame B in frame A, R_AB its rotation, p_AQ a point Q in A; adjoining
// letters cancel: p_WQ = X_WB * X_BS * p_SQ. SI units, radians, angles counter-clockwise.
//   W world, z up          B body of the vehicle, x forward, y left, z up, origin on the floor below its middle
//   M the mapper's map     S laser: scan plane is xy, x along the middle beam

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace adit {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Pose = Eigen::Isometry3d;

/// The angle's equal in (-pi, pi].
double wrap_angle(double angle_rad);

/// A pose in the plane.
struct Pose2 {
  double x_m = 0, y_m = 0, yaw_rad = 0;

  Vec2 position() const { return {x_m, y_m}; }
  Pose2 inverse() const;
  /// Composition X_AC = X_AB * X_BC; the yaw is wrapped to (-pi, pi].
  Pose2 operator*(const Pose2& X_BC) const;
  /// The point p_A = X_AB * p_B.
  Vec2 operator*(const Vec2& p_B) const;
};

/// Rotation by yaw about z, then pitch about y, then roll about x (R = Rz Ry Rx); pitch > 0 looks down.
Eigen::Matrix3d rotation_of(double yaw_rad, double pitch_rad, double roll_rad);

struct YawPitchRoll {
  double yaw_rad, pitch_rad, roll_rad;
};
/// Inverse of rotation_of, with |pitch| < pi/2.
YawPitchRoll yaw_pitch_roll(const Eigen::Matrix3d& R);

Pose pose_of(const Vec3& position, double yaw_rad, double pitch_rad = 0, double roll_rad = 0);
/// The planar pose lifted to height z_m, level.
Pose lift(const Pose2& X, double z_m = 0);
/// x, y and yaw of a pose.
Pose2 flatten(const Pose& X);
/// From A (s = 0) to B (s = 1): straight in position, shortest arc in rotation.
Pose interpolate(const Pose& A, const Pose& B, double s);

}  // namespace adit
