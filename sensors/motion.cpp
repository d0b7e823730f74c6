// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/motion.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace adit {

Motion::Motion(const Trajectory& path) : path_(&path) {
  ADIT_CHECK(path.size() >= 2);
  enter(0);
}

void Motion::enter(size_t number) {
  number_ = number;
  const Pose &A = path_->X_WB[number], &B = path_->X_WB[number + 1];
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(A.linear().transpose() * B.linear()));
  const Vec3 a = turn.axis();
  Eigen::Matrix3d K;
  K << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  stretch_.from_s = path_->stamp_s[number];
  stretch_.span_s = path_->stamp_s[number + 1] - stretch_.from_s;
  stretch_.from = A.translation();
  stretch_.to = B.translation();
  stretch_.angle_rad = turn.angle();
  stretch_.R = A.linear();
  stretch_.RK = stretch_.R * K;
  stretch_.RKK = stretch_.RK * K;
}

const Stretch& Motion::stretch_at(double t_s) {
  const std::vector<double>& stamp = path_->stamp_s;
  if (t_s < stamp[number_] || t_s > stamp[number_ + 1]) {
    const size_t next = static_cast<size_t>(std::upper_bound(stamp.begin(), stamp.end(), t_s) - stamp.begin());
    const size_t number = std::clamp<size_t>(next, 1, stamp.size() - 1) - 1;
    if (number != number_) enter(number);
  }
  return stretch_;
}

Pose Motion::at(double t_s) {
  const Stretch& it = stretch_at(t_s);
  const double s = std::clamp((t_s - it.from_s) / it.span_s, 0.0, 1.0), angle = s * it.angle_rad;
  const Turned t = it.turns_little() ? turned(angle) : Turned{std::sin(angle), 1 - std::cos(angle)};
  Pose X = Pose::Identity();
  X.linear() = it.R + t.sine * it.RK + t.versine * it.RKK;
  X.translation() = (1 - s) * it.from + s * it.to;
  return X;
}

}  // namespace adit
