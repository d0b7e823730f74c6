// SPDX-License-Identifier: BSD-3-Clause
#include "base/frames.h"

#include <cmath>
#include <numbers>

namespace adit {

double wrap_angle(double angle_rad) {
  constexpr double pi = std::numbers::pi;
  const double a = std::remainder(angle_rad, 2 * pi);
  return a <= -pi ? a + 2 * pi : a;
}

Pose2 Pose2::inverse() const {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {-(c * x_m + s * y_m), s * x_m - c * y_m, wrap_angle(-yaw_rad)};
}

Pose2 Pose2::operator*(const Pose2& X_BC) const {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {x_m + c * X_BC.x_m - s * X_BC.y_m, y_m + s * X_BC.x_m + c * X_BC.y_m, wrap_angle(yaw_rad + X_BC.yaw_rad)};
}

Vec2 Pose2::operator*(const Vec2& p_B) const {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {x_m + c * p_B.x() - s * p_B.y(), y_m + s * p_B.x() + c * p_B.y()};
}

Eigen::Matrix3d rotation_of(double yaw_rad, double pitch_rad, double roll_rad) {
  return (Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()) * Eigen::AngleAxisd(pitch_rad, Vec3::UnitY()) *
          Eigen::AngleAxisd(roll_rad, Vec3::UnitX()))
      .toRotationMatrix();
}

YawPitchRoll yaw_pitch_roll(const Eigen::Matrix3d& R) {
  return {std::atan2(R(1, 0), R(0, 0)), std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0))),
          std::atan2(R(2, 1), R(2, 2))};
}

Pose pose_of(const Vec3& position, double yaw_rad, double pitch_rad, double roll_rad) {
  Pose X = Pose::Identity();
  X.linear() = rotation_of(yaw_rad, pitch_rad, roll_rad);
  X.translation() = position;
  return X;
}

Pose lift(const Pose2& X, double z_m) {
  return pose_of({X.x_m, X.y_m, z_m}, X.yaw_rad);
}

Pose2 flatten(const Pose& X) {
  return {X.translation().x(), X.translation().y(), std::atan2(X.linear()(1, 0), X.linear()(0, 0))};
}

Pose interpolate(const Pose& A, const Pose& B, double s) {
  Pose X = Pose::Identity();
  X.translation() = A.translation() + s * (B.translation() - A.translation());
  const Eigen::Quaterniond qa(A.linear()), qb(B.linear());
  X.linear() = qa.slerp(s, qb).toRotationMatrix();
  return X;
}

}  // namespace adit
