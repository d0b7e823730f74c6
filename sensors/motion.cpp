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

void Motion::enter(size_t stretch) {
  stretch_ = stretch;
  const Eigen::AngleAxisd turn(
      Eigen::Matrix3d(path_->X_WB[stretch].linear().transpose() * path_->X_WB[stretch + 1].linear()));
  const Vec3 a = turn.axis();
  Eigen::Matrix3d K;
  K << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  angle_rad_ = turn.angle();
  R_ = path_->X_WB[stretch].linear();
  RK_ = R_ * K;
  RKK_ = RK_ * K;
}

Pose Motion::at(double t_s) {
  const std::vector<double>& stamp = path_->stamp_s;
  if (t_s < stamp[stretch_] || t_s > stamp[stretch_ + 1]) {
    const size_t next = static_cast<size_t>(std::upper_bound(stamp.begin(), stamp.end(), t_s) - stamp.begin());
    const size_t stretch = std::clamp<size_t>(next, 1, stamp.size() - 1) - 1;
    if (stretch != stretch_) enter(stretch);
  }
  const double from_s = stamp[stretch_], span_s = stamp[stretch_ + 1] - from_s;
  const double s = std::clamp((t_s - from_s) / span_s, 0.0, 1.0);
  const Pose &A = path_->X_WB[stretch_], &B = path_->X_WB[stretch_ + 1];
  Pose X = Pose::Identity();
  // Within one stretch a vehicle turns by so little that four terms of the series are exact.
  const double angle = s * angle_rad_, q = angle * angle;
  const bool little = q < 0.01;
  const double sine = little ? angle * (1 - q / 6 * (1 - q / 20 * (1 - q / 42))) : std::sin(angle);
  const double versine = little ? q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56))) : 1 - std::cos(angle);
  X.linear() = R_ + sine * RK_ + versine * RKK_;
  X.translation() = (1 - s) * A.translation() + s * B.translation();
  return X;
}

}  // namespace adit
