// SPDX-License-Identifier: BSD-3-Clause
#include "base/rig.h"

#include <cmath>

namespace adit {

double Tilt::at(double since_s) const {
  // A triangle of two slopes with its middle at 0: the way from 0 to `to`, to `from` and back is 2 (to - from) long.
  const double way = 2 * (to_rad - from_rad), done = std::fmod(since_s / period_s, 1.0) * way;
  if (done < to_rad) return done;
  if (done < 2 * to_rad - from_rad) return 2 * to_rad - done;
  return done - way;
}

Pose Mount::X_BS_at(double tilt_rad) const {
  return tilt_rad == 0 ? X_BS : X_BS * pose_of(Vec3::Zero(), 0, tilt_rad);
}

View view_of(const Mount& mount) {
  constexpr double straight = 0.9;  // cosine: within some 25 degrees of an axis
  const Vec3 normal = mount.X_BS.linear().col(2), ahead = mount.X_BS.linear().col(0);
  if (std::abs(normal.z()) > straight) return View::horizontal;
  if (std::abs(normal.y()) > straight && ahead.x() > straight) return View::forward_vertical;
  if (std::abs(normal.x()) > straight && ahead.z() > straight) return View::up;
  if (std::abs(normal.x()) > straight && ahead.z() < -straight) return View::down;
  return View::other;
}

int find_view(const Rig& rig, View view) {
  for (size_t i = 0; i < rig.mounts.size(); ++i)
    if (view_of(rig.mounts[i]) == view) return static_cast<int>(i);
  return -1;
}

}  // namespace adit
