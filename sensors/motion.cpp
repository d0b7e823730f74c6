// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/motion.h"

#include "base/error.h"

#include <algorithm>

namespace adit {

Motion::Motion(const Trajectory& path) : path_(&path) {
  ADIT_CHECK(path.size() >= 2);
  enter(0);
}

void Motion::enter(size_t stretch) {
  stretch_ = stretch;
  const Eigen::AngleAxisd turn(
      Eigen::Matrix3d(path_->X_WB[stretch].linear().transpose() * path_->X_WB[stretch + 1].linear()));
  axis_ = turn.axis();
  angle_rad_ = turn.angle();
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
  X.linear() = A.linear() * Eigen::AngleAxisd(s * angle_rad_, axis_).toRotationMatrix();
  X.translation() = (1 - s) * A.translation() + s * B.translation();
  return X;
}

}  // namespace adit
